"""Families of elements of which a file holds one: from an element's name to the function that compiles it.

What a family plays, accepts with a note and refuses stands in one table, from which docs/conformance.md is made.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Literal, NamedTuple, TypeVar

from sgcad_core.formats.openscenario.reading.elements import XmlNode

T = TypeVar("T")
Status = Literal["played", "noted", "refused"]


class Entry(NamedTuple):
    """How one element is treated, and what there is to know of it."""

    tag: str
    status: Status
    remark: str


class Family(Generic[T]):
    """Elements that may stand in one place."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._known: dict[str, Callable[[XmlNode], T]] = {}
        self.entries: dict[str, Entry] = {}

    def plays(self, *tags: str, remark: str = "") -> Callable[[Callable[[XmlNode], T]], Callable[[XmlNode], T]]:
        """Decorator: this function compiles these elements."""
        return self._add("played", tags, remark)

    def notes(self, *tags: str, remark: str) -> Callable[[Callable[[XmlNode], T]], Callable[[XmlNode], T]]:
        """Decorator: these elements are accepted, and `remark` stands beside the result."""
        return self._add("noted", tags, remark)

    def refuses(self, *tags: str, remark: str, remedy: str = "use timed world polylines") -> None:
        """These elements are refused by name: `remark` says why, `remedy` what would help."""

        def refuse(node: XmlNode) -> T:
            raise node.unsupported(f"the player does not support <{node.tag}>: {remark}", remedy)

        self._add("refused", tags, remark)(refuse)

    def _add(
        self, status: Status, tags: tuple[str, ...], remark: str
    ) -> Callable[[Callable[[XmlNode], T]], Callable[[XmlNode], T]]:
        def added(function: Callable[[XmlNode], T]) -> Callable[[XmlNode], T]:
            for tag in tags:
                self._known[tag] = function
                self.entries[tag] = Entry(tag, status, remark)
            return function

        return added

    def __contains__(self, tag: str) -> bool:
        return tag in self._known

    def compile(self, node: XmlNode) -> T:
        """Compile an element. Raises Unsupported for one that the family does not know or refuses."""
        if node.tag not in self._known:
            raise node.unsupported(f"the player does not support <{node.tag}> as {self.name}")
        if self.entries[node.tag].status == "noted":
            node.note(self.entries[node.tag].remark)
        return self._known[node.tag](node)
