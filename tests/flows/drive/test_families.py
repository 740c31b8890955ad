"""`sgcad vary`: files, manifest, the hardest, errors."""

import json

import pytest
from typer.testing import CliRunner

from flows.cli import app
from flows.drive.families import family_of, members
from sgcad_core.errors import BadInput
from sgcad_core.execution.contact import first_contact, realised
from tests.flows.drive.test_drives import case as case  # a fixture
from tests.flows.drive.test_drives import written
from tests.sgcad_core.handover.scenes import crossing


def run(*arguments):
    return CliRunner().invoke(app, ["vary", *map(str, arguments)])


def test_a_family_is_written_with_a_reason_for_every_value(case):
    ended = run(case, "-n", 6, "--seed", 2)
    assert ended.exit_code == 0, ended.output
    place = case / "vary" / "seed-2"
    assert sorted(f.name for f in (place / "concrete").iterdir()) == [f"{k:04d}.xosc" for k in range(1, 7)]
    told = json.loads((place / "manifest.json").read_text())
    assert (told["count"], told["seed"], len(told["members"])) == (6, 2, 6)
    assert all(p["reason"] and p["value"] == "varied" for p in told["parameters"])
    assert {k["value_is"] for k in told["kept"]} <= {"report fact", "inferred", "default"}
    names = [p["name"] for p in told["parameters"]]
    assert all(list(m["values"]) == names for m in told["members"])
    assert ended.output.splitlines() == [
        f"{told['case']}: 6 members that crash as declared, of {told['drawn']} that were drawn", f"results: {place}",
    ]  # fmt: skip
    for name in ("logical", "deterministic", "stochastic"):
        assert (place / f"{name}.xosc").is_file()


def test_equal_seeds_give_equal_families_and_others_others(case):
    first, second, other = ([values for values, _ in members(family_of(case), 3, seed)[0]] for seed in (1, 1, 2))
    assert first == second
    assert first != other


def test_every_member_is_the_declared_crash(case):
    found, drawn = members(family_of(case), 8, 4)
    assert drawn >= 8
    assert all(realised(m.declared, first_contact(m.trajectories, m.sizes)) for _, m in found)


def test_the_hardest_for_a_driver_are_told_with_weights_and_what_decides(case):
    ended = run(case, "-n", 20, "--driver", "aeb", "--role", "responder")
    assert ended.exit_code == 0, ended.output
    place = case / "vary" / "seed-1"
    told = json.loads((place / "hardest.json").read_text())
    assert (told["driver"], told["ego"], told["samples"]) == ("aeb", "V1", 20)
    assert 0 <= told["contact_rate"] <= 2
    hard = [h["hardness"] for h in told["hardest"]]
    assert all(h["rules"] for h in told["hardest_by_rules"])
    assert 0 <= told["rule_rate"] <= 1
    assert hard == sorted(hard, reverse=True)
    assert all(-1 <= v <= 1 for v in told["decides"].values())
    said = ended.output.splitlines()
    rate = f"{100 * min(told['contact_rate'], 1):.0f} %"
    assert said[1].startswith(f"aeb drives V1 (responder): touches in {rate} of them, breaks a rule in ")
    assert said[2].startswith(f"hardest: {told['hardest'][0]['outcome']}, ")
    assert f"{hard[0]:.1f} m/s" in said[2] or f"{-hard[0]:.1f} m clear" in said[2]
    assert said[-2].startswith("what decides (rank correlation): ")
    assert said[-1] == f"results: {place}"
    assert (place / "decides.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_map_elites_keeps_the_hardest_of_every_way_of_being_hard(case):
    ended = run(case, "-n", 30, "--driver", "aeb", "--role", "responder", "--search", "map-elites")
    assert ended.exit_code == 0, ended.output
    told = json.loads((case / "vary" / "seed-1" / "hardest.json").read_text())
    assert (told["search"], told["samples"]) == ("map-elites", 30)
    cells = [(tuple(e["closing_mps"]), e["braked_at_ttc"]) for e in told["elites"]]
    assert len(cells) == len(set(cells)) >= 3
    assert max(e["hardness"] for e in told["elites"]) == told["hardest"][0]["hardness"]
    assert all(0 < h["weight"] <= 4 for h in told["hardest"])


def test_members_in_the_dark_say_so_and_what_stays_has_a_reason(case):
    run(case, "-n", 12, "--seed", 3)
    place = case / "vary" / "seed-3"
    told = json.loads((place / "manifest.json").read_text())
    light = next(p for p in told["parameters"] if p["name"] == "light")
    hours = {"day": "T12:00", "dusk": "T20:45", "dawn": "T05:15", "dark": "T23:00", "dark_lit": "T23:00"}
    for m in told["members"]:
        word = light["words"][round(m["values"]["light"])]
        assert hours[word] in (place / m["file"]).read_text()
    assert len({m["values"]["light"] for m in told["members"]}) > 1
    assert set(told["not_varied"]) == {"lane", "reaction"}


def test_a_case_that_crashes_otherwise_than_declared_is_not_varied(tmp_path):
    made = crossing()
    wrong = made.declared.model_copy(update={"struck_area": "right"})
    other = type(made)(made.case, made.actors, made.trajectories, made.graph, wrong, made.roles)
    folder = written(tmp_path / "case-9", other)
    with pytest.raises(BadInput, match="its first contact is not the declared one"):
        family_of(folder)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--role", "both"], "a family is driven in one role"),
        (["--driver", "nobody"], "unknown driver"),
        (["-n", "0"], ""),
        (["--search", "luck"], "no such search; there are cross-entropy, map-elites"),
    ],
)
def test_faults_are_named(case, arguments, message):
    ended = run(case, *arguments)
    assert ended.exit_code != 0
    assert message in str(ended.exception) + ended.output
