"""Kinds of whole commands: how kills are shared, and what is told of few cases."""

from research.benchmarks.attack.kinds import kinds
from research.benchmarks.attack.whole import disasters, kills, many
from research.benchmarks.faults.disasters import DISASTERS
from research.benchmarks.faults.kills import Trial
from research.benchmarks.services.growth import WHAT


def test_kills_are_shared_and_a_command_that_fails_by_itself_costs_its_own(tmp_path, monkeypatch):
    asked = {}

    def killed(names, numbers, kept, folder):
        (name,) = names
        asked[name] = list(numbers)
        if name == "play":
            raise RuntimeError("play ends with 2 without any fault")
        return [Trial(name, 1.0, "command", ("left",) if name == "inbox" else ()) for _ in numbers]

    monkeypatch.setattr(kills, "kills", killed)
    told = kills.whole(16, 1, tmp_path / "kills")
    assert sum(map(len, asked.values())) == 16
    assert len({number for numbers in asked.values() for number in numbers}) == 16
    assert told.tried == 16 - len(asked["play"])
    assert [line.partition(" ")[0].rstrip(",") for line in told.faults] == ["play", "inbox", "inbox"]
    assert set(kills.COMMANDS) == set(asked)


def test_fewer_kills_than_commands_are_tried(tmp_path, monkeypatch):
    monkeypatch.setattr(
        kills, "kills", lambda names, numbers, *_: [Trial(names[0], 1.0, "command", ()) for _ in numbers]
    )
    assert kills.whole(2, 1, tmp_path / "kills").tried == 2


def test_disasters_are_those_of_the_faults(tmp_path, monkeypatch):
    monkeypatch.setattr(disasters, "disasters", lambda names, kept, folder: [])
    assert len(DISASTERS) == disasters.COUNT
    assert {"disk", "moved", "edited", "between"} <= set(DISASTERS)
    assert disasters.whole(3, 1, tmp_path / "d").tried == 0


def test_growth_is_told_from_first_to_last_look_with_workers():
    looks = [
        dict.fromkeys(("pid", *WHAT), 1.0) | {"done": done, "main_kb": kb, "workers_kb": workers}
        for done, kb, workers in ((0, 50, 1), (10, 100, 1), (20, 300, 1), (20, 900, 0))
    ]
    table = many.first_and_last(looks)
    assert "| | at 10 cases | at 20 | a case |" in table
    assert "| memory of the command, kB | 100 | 300 | 20.00 |" in table


def test_kinds_are_found_by_walking_the_folder():
    found = kinds()
    assert {"report text", "picture", "pdf", "plugin metadata", "desk requests", "default config"} <= set(found)
    assert list(found)[-3:] == ["disasters", "kills", "many"]
