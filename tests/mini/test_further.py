"""The further clauses: of lists that there are, in the language of clauses, apart from what is held out."""

import re
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest

from mini.generator import (
    clauses_codes,
    clauses_contact,
    clauses_critical,
    clauses_motion,
    clauses_noise,
    clauses_road,
    clauses_scene,
    further,
)
from mini.generator.grammar import SLOTS, families

MODULES: dict[str, ModuleType] = {
    "codes": clauses_codes,
    "contact": clauses_contact,
    "critical": clauses_critical,
    "motion": clauses_motion,
    "noise": clauses_noise,
    "road": clauses_road,
    "scene": clauses_scene,
}
LISTS = [
    (name, folder, heading)
    for name in MODULES
    for folder in ("", "training/")
    for heading in further._read(folder + name)
]
RUN = 4
"""Words in a row that no further clause may share with held-out ones alone."""
ALIKE = {"dir": "from", "surf": "Surf", "road": "Road"}
"""Slots that tell the same in other words."""


def listed(name: str, heading: str) -> list[str]:
    key, _, inner = heading.partition(".")
    found: Any = getattr(MODULES[name], key)
    return list(found[inner] if inner else found)


def resolved(clause: str, limit: int = 400) -> list[str]:
    """What a clause may become, up to a limit."""
    found = [clause]
    while any("[" in one for one in found) and len(found) < limit:
        next_round: list[str] = []
        for one in found:
            choice = re.search(r"\[([^\[\]]*)\]", one)
            options = choice[1].split("|") if choice else [""]
            next_round += [one.replace(choice[0], option, 1) for option in options] if choice else [one]
        found = next_round
    return found[:limit]


def runs(clauses: Iterator[str]) -> set[tuple[str, ...]]:
    found = set()
    for clause in clauses:
        for one in resolved(clause):
            words = re.sub(r"[,;.:\[\]|]", " ", one.lower()).split()
            found |= {tuple(words[i : i + RUN]) for i in range(len(words) - RUN + 1)}
    return found


@pytest.mark.parametrize(("name", "folder", "heading"), LISTS)
def test_further_clauses_say_what_their_list_says_and_nothing_held_out(name: str, folder: str, heading: str) -> None:
    more, whole = set(further._read(folder + name)[heading]), [c.removeprefix("+") for c in listed(name, heading)]
    own = [clause for clause in whole if clause.lstrip("~") not in more]
    slots = {slot for clause in own for slot in SLOTS.findall(clause)}
    slots |= {other for slot, other in ALIKE.items() if slot in slots}
    held = {clause[1:] for clause in own if clause.startswith("~")}
    kept = runs(clause for clause in own if not clause.startswith("~"))
    private = runs(iter(held)) - kept
    for clause in more:
        assert not clause.startswith(("~", "#")), clause
        assert clause.count("[") == clause.count("]"), clause
        assert "|" not in re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", clause)), clause
        assert set(SLOTS.findall(clause)) <= slots, clause
        assert not (set(resolved(clause)) & held), clause
        assert not (runs(iter([clause])) & private), clause


@pytest.mark.parametrize(("name", "folder", "heading"), LISTS)
def test_the_counted_clauses_keep_their_share(name: str, folder: str, heading: str) -> None:
    more = {clause for part in ("", "training/") for clause in further._read(part + name)[heading]}
    trained = families(listed(name, heading), False)
    share = sum(clause in more for clause in trained) / len(trained)
    assert set(further._read(folder + name)[heading]) <= set(trained)
    assert share <= further.SHARE + 0.15


@pytest.mark.parametrize(("name", "folder", "heading"), LISTS)
def test_what_joined_for_training_is_never_told_when_held_out(name: str, folder: str, heading: str) -> None:
    held = set(families(listed(name, heading), True))
    assert held
    assert not held & set(further._read(f"training/{name}")[heading])
    assert not any(clause.startswith(("~", "+")) for clause in held | set(families(listed(name, heading), False)))


def test_a_clause_is_written_once() -> None:
    for name in MODULES:
        training = further._read(f"training/{name}")
        for heading in {*further._read(name), *training}:
            more = [*further._read(name)[heading], *training[heading]]
            assert len(set(more)) == len(more), heading


def test_a_list_that_there_is_not_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(further, "_read", lambda name: {"NOWHERE": ["{V} stopped"]})
    with pytest.raises(KeyError, match="NOWHERE"):
        further.enlarge("contact", vars(clauses_contact))
