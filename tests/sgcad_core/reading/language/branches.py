"""The alternatives of a pattern as it is written: where each group's branches begin and end. Compiles nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass
class Group:
    """A group of a pattern (or the whole pattern): `opening` such as "(?:", branches as (start, end) in the text."""

    start: int
    opening: str
    branches: list[tuple[int, int]] = field(default_factory=list)

    @property
    def end(self) -> int:
        """Where the group's last branch ends."""
        return self.branches[-1][1]


def groups(pattern: str) -> list[Group]:
    """Every group with its branches, the whole pattern first."""
    whole = Group(0, "")
    found, open_groups, begins = [whole], [whole], [0]
    at = 0
    while at < len(pattern):
        char = pattern[at]
        if char == "\\":
            at += 2
            continue
        if char == "[":
            at = _end_of_set(pattern, at)
            continue
        if char == "(":
            opening = _opening(pattern, at)
            group = Group(at, opening)
            found.append(group)
            open_groups.append(group)
            at += len(opening)
            begins.append(at)
            continue
        if char in "|)":
            open_groups[-1].branches.append((begins[-1], at))
            begins[-1] = at + 1
            if char == ")":
                open_groups.pop()
                begins.pop()
        at += 1
    whole.branches.append((begins[0], len(pattern)))
    return found


def alternatives(pattern: str) -> Iterator[tuple[Group, int]]:
    """(group, number of the branch) of every branch that has a sibling."""
    for group in groups(pattern):
        if len(group.branches) > 1:
            yield from ((group, number) for number in range(len(group.branches)))


def without(pattern: str, group: Group, number: int) -> str:
    """The pattern without one branch of a group."""
    kept = [pattern[start:end] for n, (start, end) in enumerate(group.branches) if n != number]
    return pattern[: group.branches[0][0]] + "|".join(kept) + pattern[group.end :]


def only(pattern: str, group: Group, number: int) -> str:
    """The pattern with one branch of a group alone."""
    start, end = group.branches[number]
    return pattern[: group.branches[0][0]] + pattern[start:end] + pattern[group.end :]


def _opening(pattern: str, at: int) -> str:
    for opening in ("(?:", "(?=", "(?!", "(?<=", "(?<!", "(?>"):
        if pattern.startswith(opening, at):
            return opening
    if pattern.startswith(("(?P<", "(?P="), at):
        end = pattern.find(">", at) if pattern.startswith("(?P<", at) else at + 3
        return pattern[at : end + 1]
    if pattern.startswith("(?", at):
        return pattern[at : pattern.index(":", at) + 1]
    return "("


def _end_of_set(pattern: str, at: int) -> int:
    """Behind the closing bracket of a set of characters."""
    at += 1 + pattern.startswith("^", at + 1)
    at += pattern.startswith("]", at)
    while pattern[at] != "]":
        at += 2 if pattern[at] == "\\" else 1
    return at + 1
