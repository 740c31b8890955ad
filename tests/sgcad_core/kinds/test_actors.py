"""Kinds of actors and the words for them agree; a crash and its file have one mass."""

import pytest

from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import parse_xml
from sgcad_core.kinds import ACTORS, actor_kind, is_vehicle_id, kind_of_letter, learned_actors, mass_kg
from sgcad_core.reading.actors.makes import ANIMAL, BODY_WORDS, ROAD_USERS, kind_of
from sgcad_core.reading.language import of_role
from tests.sgcad_core.formats.xosc_samples import actor, trajectory


def test_every_word_means_a_kind_and_every_kind_that_moves_by_itself_has_a_word() -> None:
    meant = {*BODY_WORDS.values(), *ROAD_USERS.values()} - {ANIMAL}
    assert meant == {record.id for record in ACTORS.values() if record.drives or record.walks}
    assert {road_user.yields["kind"] for road_user in of_role("road_user")} <= set(ACTORS)


@pytest.mark.parametrize(("words", "kind"), [
    ("a golf cart", "golf_cart"), ("a streetcar", "tram"), ("a light rail train", "tram"),
    ("an e-scooter", "e_scooter"),
    ("an electric scooter", "e_scooter"), ("a kick scooter rider", "e_scooter"), ("a moped", "motorcycle"),
    ("a motor scooter", "motorcycle"), ("a trolley", "bus"), ("a golf club", "car"),
])  # fmt: skip
def test_words_that_are_alike_mean_their_own_kinds(words: str, kind: str) -> None:
    assert kind_of(words, None)[0] == kind


@pytest.mark.parametrize("longer_m", [0.0, 9.0])
@pytest.mark.parametrize("kind", ACTORS)
def test_the_file_has_the_mass_that_a_crash_is_solved_with(kind: str, longer_m: float) -> None:
    length, width = ACTORS[kind].size
    if longer_m and not ACTORS[kind].wheeled:
        pytest.skip("tows nothing")
    info = actor("V1", kind, (length + longer_m, width))
    text = write_xosc([info], [trajectory("V1", [0.0, 1.0], [0.0, 0.0], [0.0, 0.0])], None)
    (made,) = (e for e in parse_xml(text, "xosc").iter() if e.get("mass"))
    assert float(made.get("mass")) == mass_kg(kind, info.length_m)


def test_what_the_embedded_model_learned_stands_in_its_order() -> None:
    assert learned_actors() == (
        "car", "suv", "pickup", "van", "truck", "bus", "motorcycle", "bicycle", "pedestrian", "trailer", "object",
    )  # fmt: skip


def test_letters_have_a_usual_kind() -> None:
    usual = {"V": "car", "P": "pedestrian", "B": "bicycle", "T": "trailer", "O": "object", "A": "object"}
    assert {letter: kind_of_letter(letter) for letter in usual} == usual


def test_a_kind_that_there_is_not_is_an_error() -> None:
    with pytest.raises(KeyError, match="hovercraft"):
        actor_kind("hovercraft")


def test_a_vehicle_without_a_number_is_a_vehicle_like_others() -> None:
    assert kind_of_letter("N") == kind_of_letter("V") == "car"
    assert [is_vehicle_id(name) for name in ("V2", "N1", "P1", "O1", "")] == [True, True, False, False, False]
