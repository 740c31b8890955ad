"""Logical scenarios and their distributions: in the schema, and played they are the members they stand for."""

from importlib.metadata import distribution

import numpy as np
import pytest
from lxml import etree

from flows.drive.families import Family, files_of, members
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.contact import first_contact
from sgcad_core.formats.openscenario.reading.expressions import evaluated
from sgcad_core.formats.openscenario.reading.files import play_file, variations
from sgcad_core.formats.openscenario.writing.entities import SUNS
from sgcad_core.formats.openscenario.writing.logical import (
    ParameterizedActor,
    ParameterRange,
    deterministic_distribution,
    logical_xosc,
    stochastic_distribution,
)
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.handover.family.discrete_parameters import LIGHTS
from sgcad_core.handover.family.parameter_priors import open_parameters
from sgcad_core.handover.family.variant import basis_of, undisturbed, with_earlier_start
from tests.sgcad_core.handover.scenes import crossing
from tests.sgcad_core.handover.test_open_choices import braking, on_road

RANGES = [
    ParameterRange("V1_pace", 1.0, 0.6, 1.4, 1.0, 0.2),
    ParameterRange("V1_aside_m", 0.0, -0.6, 0.6, 0.0, 0.2),
    ParameterRange("V1_length", 1.0, 0.8, 1.2, 1.0, 0.1),
    ParameterRange("V2_late_s", 0.0, -0.4, 0.4, 0.0, 0.0),
]
SETS = [
    {"V1_pace": 1.25, "V1_aside_m": 0.3, "V1_length": 1.1, "V2_late_s": 0.1},
    {"V1_pace": 0.7, "V1_aside_m": -0.2, "V1_length": 0.9, "V2_late_s": -0.15},
]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("family")
    basis = basis_of(crossing())
    nominal = undisturbed(basis, {})
    back = 2.7
    text = write_xosc(nominal.actors, with_earlier_start(nominal, back), None)
    meets = [ParameterizedActor(a.id, basis.contact_s + back) for a in nominal.actors]
    (folder / "logical.xosc").write_text(logical_xosc(text, RANGES, meets, basis.contact_s))
    (folder / "deterministic.xosc").write_text(deterministic_distribution("logical.xosc", SETS))
    (folder / "stochastic.xosc").write_text(stochastic_distribution("logical.xosc", RANGES, 3, 11))
    return folder, basis


@pytest.mark.parametrize("name", ["logical", "deterministic", "stochastic"])
def test_every_file_is_in_the_schema(files, name):
    xsd = distribution("scenariogeneration").locate_file("schemas/OpenSCENARIO_1_2.xsd")
    schema = etree.XMLSchema(etree.parse(str(xsd)))
    assert schema.validate(etree.parse(files[0] / f"{name}.xosc")), schema.error_log


def test_a_played_set_is_the_member_that_it_stands_for(files):
    folder, basis = files
    for values, variation in zip(SETS, variations(folder / "deterministic.xosc"), strict=True):
        played, _ = play_file(variation, ())
        made = undisturbed(basis, values)
        sizes = {name: (b.box.length_m, b.box.width_m) for name, b in played.bodies.items()}
        assert sizes["V1"] == pytest.approx(made.sizes["V1"], abs=1e-3)
        seen, meant = first_contact(played.trajectories, sizes), first_contact(made.trajectories, made.sizes)
        assert seen == meant
        for mine, theirs in zip(played.trajectories, made.trajectories, strict=True):
            k = round(5.0 / 0.05)
            assert np.hypot(mine.x_m[k] - theirs.x_m[k], mine.y_m[k] - theirs.y_m[k]) < 0.02


def test_stochastic_sets_stay_within_the_limits(files):
    for variation in variations(files[0] / "stochastic.xosc"):
        for r in RANGES:
            assert r.low <= float(variation.given[r.name]) <= r.high


def test_parameters_are_constrained_to_their_ranges(files):
    root = etree.parse(files[0] / "logical.xosc")
    limits = {
        p.get("name"): [float(v.get("value")) for v in p.iter("ValueConstraint")]
        for p in root.iter("ParameterDeclaration")
    }
    assert limits["V1_pace"] == [0.6, 1.4]
    assert limits["EndTime"] == []


def test_a_file_without_timed_trajectories_is_refused():
    with pytest.raises(InvalidOutput, match="has no timed trajectory"):
        logical_xosc(
            "<OpenSCENARIO><ParameterDeclarations/></OpenSCENARIO>", RANGES, [ParameterizedActor("V1", 6.0)], 6.0
        )
    with pytest.raises(InvalidOutput, match="no ParameterDeclarations"):
        logical_xosc("<OpenSCENARIO/>", RANGES, [], 6.0)


# ------------------------------------------------------------------ lanes, reactions, light
@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """A family in which a lane, a reaction and the light are open."""
    folder = tmp_path_factory.mktemp("open")
    made = on_road(braking())
    basis = basis_of(made)
    facts = [{"field": "vehicles.V2.evasion.brakes", "value": True, "status": "stated"}]
    family = Family(folder, basis, open_parameters(made, facts, basis.delays), tuple(facts))
    rows = members(family, 6, 11)[0]
    for name, text in files_of(family, [values for values, _ in rows], 11).items():
        (folder / f"{name}.xosc").write_text(text)
    return folder, basis, rows


def test_open_choices_are_in_the_schema(opened):
    folder, _, rows = opened
    assert {"V1_lane_m", "V2_reaction_s", "light"} <= set(rows[0][0])
    for name in ("logical", "deterministic", "stochastic"):
        test_every_file_is_in_the_schema((folder, None), name)


def test_a_played_set_has_the_members_lane_and_reaction(opened):
    folder, basis, rows = opened
    assert len({values["V1_lane_m"] for values, _ in rows}) > 1
    for (values, _), variation in zip(rows, variations(folder / "deterministic.xosc"), strict=True):
        played, _ = play_file(variation, ())
        made = undisturbed(basis, values)
        for mine, theirs in zip(played.trajectories, made.trajectories, strict=True):
            n = round(6.0 / 0.05)
            apart = np.hypot(mine.x_m[:n] - theirs.x_m[:n], mine.y_m[:n] - theirs.y_m[:n])
            assert apart.max() < 0.05


def test_the_light_chooses_the_sun_and_no_time_of_day_contradicts_it(opened):
    root = etree.parse(opened[0] / "logical.xosc").getroot()
    assert not list(root.iter("TimeOfDay"))
    (sun,) = root.iter("Sun")
    for k, light in enumerate(LIGHTS):
        told = [
            evaluated(sun.get(name)[2:-1].replace("$light", str(k))) for name in ("illuminance", "azimuth", "elevation")
        ]
        assert [float(v) for v in told] == pytest.approx(SUNS[light])


def test_stochastic_choices_are_among_the_values(opened):
    for variation in variations(opened[0] / "stochastic.xosc"):
        assert float(variation.given["light"]) in {0.0, 1.0, 2.0, 3.0, 4.0}
        assert float(variation.given["V1_lane_m"]) in {-3.5, 0.0, 3.5}
