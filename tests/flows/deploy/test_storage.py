"""A place: writing is whole, and a move that was killed is finished."""

import uuid

import pytest

from flows.deploy.storage import Place
from sgcad_core.errors import ConfigError


@pytest.fixture(params=["local", "memory"])
def place(request, tmp_path):
    """Local files, and a store without renames."""
    return Place(str(tmp_path / "box") if request.param == "local" else f"memory://{uuid.uuid4().hex}")


def test_what_is_not_there_reads_as_nothing(place):
    assert place.read("a") is None
    assert place.entry("a") is None
    assert place.entries() == []
    place.remove("a")


def test_a_folder_is_one_entry_with_all_its_files(place):
    place.write("case/report.txt", b"12345")
    place.write("case/more/diagram.png", b"123")
    place.write(".hidden", b"")
    (entry,) = place.entries()
    assert (entry.name, entry.is_folder) == ("case", True)
    assert {(f.name, f.size) for f in entry.files} == {("report.txt", 5), ("more/diagram.png", 3)}
    assert place.entry("case") == entry


def test_a_moved_folder_takes_the_place_of_what_was_there(place):
    place.write("case/report.txt", b"new")
    place.write("done/case/report.txt", b"old")
    place.move(place.entry("case"), "done/case")
    assert place.read("done/case/report.txt") == b"new"
    assert [e.name for e in place.entries()] == ["done"]


def test_a_file_written_anew_during_a_move_on_a_store_without_renames_stays():
    place = Place(f"memory://{uuid.uuid4().hex}")
    place.write("a.txt", b"old")
    entry = place.entry("a.txt")
    place.write("a.txt", b"newer")
    place.move(entry, "done/a.txt")
    assert place.read("a.txt") == b"newer"


def test_an_address_of_no_kind_is_refused():
    with pytest.raises(ConfigError, match="nowhere://x: cannot be opened"):
        Place("nowhere://x")
