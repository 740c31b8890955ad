"""The state of the traffic signal for each vehicle when it came to the crash, where the report tells it.

The crash's own sentences come first, of them the last; then interviews, if they agree. Guesses and flashing signals
tell nothing. Knows no map.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.sentence_roles import CRASH_ROLES
from sgcad_core.records.words import SignalState


class SignalTold(NamedTuple):
    """A state and where it is told."""

    state: SignalState
    source: Source

    @property
    def turned(self) -> bool:
        """Whether the words tell that it turned to that state, not that it showed it."""
        return rule("signal_states.turned").search(self.source.words) is not None


def signal_states(segments: Iterable[Segment], statements: Iterable[Statement] = ()) -> Mapping[str, SignalTold]:
    """Signal by vehicle; a vehicle whose signal is not told, or told in two ways by interviews, is left out.

    `statements`: those whose first words tell of the signal of the vehicle that is named next ("as the light turned
    green and V2 began to move").
    """
    story: dict[str, list[SignalTold]] = {}
    quoted: dict[str, list[SignalTold]] = {}
    for segment in segments:
        for told in _told(segment.text, segment.number):
            for vehicle in segment.subjects:
                (story if segment.role in CRASH_ROLES else quoted).setdefault(vehicle, []).append(told)
    for one in statements:
        if one.role in CRASH_ROLES and (opening := rule("signal_states.opening").match(one.text)):
            for told in _told(opening["signal"], one.number):
                story.setdefault(opening["vehicle"], []).append(told)
    agreed = {v: found[-1] for v, found in quoted.items() if len({told.state for told in found}) == 1}
    return {**agreed, **{vehicle: found[-1] for vehicle, found in story.items()}}


def _told(text: str, number: int) -> Iterator[SignalTold]:
    """States in the order of the text."""
    if rule("signal_states.hedged").search(text):
        return
    found = [
        (match.start(), SignalTold(told.yields["signal"], Source(number, match[0], told.id)))
        for told in of_role("signal_state")
        for match in told.finditer(text)
    ]
    yield from (told for _, told in sorted(found, key=lambda at: at[0]))
