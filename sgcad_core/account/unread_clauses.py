"""Sentences that tell something of the crash of which no reader made anything.

Words of a kind of telling (lanes, sides, contacts, rollovers, motion) stand in a sentence, and neither a fact nor an
act of the timeline of that kind points to it. What is told once more after it was read elsewhere is not unread.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.kinds import OVER_A_LINE
from sgcad_core.reading.junctions.junction import CIRCLE_LANES
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.language.rules import Rule
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.text.normalise import Sentence, number
from sgcad_core.reading.text.sentence_roles import STORY_ROLES, is_impact
from sgcad_core.records.course import CourseTold

_VEHICLE = rule("common.vehicle")
_SHOWN = 110
"""Characters of a sentence that an item quotes."""
_ABOUT = {
    "lane": "a lane or a number of lanes", "side": "the sides of a contact", "roll": "a rollover",
    "contact": "a contact", "motion": "what a vehicle did", "evasion": "an evasion",
}  # fmt: skip


@dataclass(frozen=True)
class _Read:
    """What was read: names of facts and kinds of acts by the start of their sentence."""

    facts: dict[int, set[str]]
    acts: dict[int, set[str]]
    first_contact: int
    """Start of the sentence of the first contact; the text's length without one."""

    @classmethod
    def of(cls, reading: Reading) -> _Read:
        """The index of a reading."""
        read = cls({}, {}, min((a.start for a in reading.timeline if a.phase == "at" and a.start is not None),
                               default=len(reading.narrative)))  # fmt: skip
        for fact in reading.facts:
            if fact.start is not None:
                read.facts.setdefault(fact.start, set()).add(fact.field)
        for act in reading.timeline:
            if act.start is not None:
                read.acts.setdefault(act.start, set()).add(act.kind)
        return read

    def has(self, start: int, *parts: str) -> bool:
        """Whether a fact of that sentence has one of these words in its name."""
        return any(part in name for name in self.facts.get(start, ()) for part in parts)


def unread_clauses(made: ExecutedCase) -> Iterator[Item]:
    """One item for each sentence of the story and kind of telling that was not read."""
    read = _Read.of(made.reading)
    for sentence in made.reading.sentences:
        if sentence.role in STORY_ROLES or sentence.role == "opening":
            for kind in _told(sentence):
                if not _HEARD[kind](made.reading, sentence, read):
                    yield _unread(made.reading, sentence, kind)


def _told(sentence: Sentence) -> Iterator[str]:
    """The kinds of telling in a sentence."""
    for words in of_role("telling"):
        if words.search(sentence.text):
            yield str(words.yields["tells"])
    if _touches(sentence):
        yield "contact"
    if sentence.role in ("approach", "avoidance") and _VEHICLE.search(sentence.text):
        yield "motion"
    if rule("near_events.act").search(sentence.text):
        yield "evasion"


def _touches(sentence: Sentence) -> bool:
    """Whether a sentence tells a contact with more than the ground; one that only dates something by it does not."""
    told = rule("account.dated_by_impact").sub(" ", sentence.text)
    return is_impact(rule("account.met_ground").sub(" ", told))


def _unread(reading: Reading, sentence: Sentence, kind: str) -> Item:
    words = reading.text_of(sentence)
    quoted = words if len(words) <= _SHOWN else f"{words[: _SHOWN - 3]}..."
    return Item(
        kind="unread", field=f"text.{kind}", subject="", value=None, text=f"{_ABOUT[kind]} seems told: '{quoted}'",
        reason="nothing was read of it", start=sentence.start, end=sentence.end,
    )  # fmt: skip


# ------------------------------------------------------------------ whether it was read
def _lane(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    around = reading.roads.junction.circle_lanes is not None and CIRCLE_LANES.search(sentence.text)
    heard = read.has(sentence.start, "lane", "approaches", "one_way", "divided", "straddles", "stops")
    late = sentence.start > read.first_contact
    return late or heard or bool(around) or not _tells_lanes(_without_known(reading, sentence))


def _tells_lanes(text: str) -> bool:
    return any(words.search(text) for words in of_role("telling") if words.yields["tells"] == "lane")


def _without_known(reading: Reading, sentence: Sentence) -> str:
    """A sentence without the counts of lanes, the lanes and the lines of lanes that are known from elsewhere."""
    named = [v for v in reading.crash.vehicles if v.id in reading.named_in(sentence)]
    lanes = [road.lanes for road in reading.roads.roads]
    counts = {n for one in lanes for n in (one.total, one.each_way, *one.toward.values())}
    text = _out(rule("account.counted_lanes"), sentence.text, counts)
    text = _out(rule("account.numbered_lane"), text, {abs(v.lane) for v in named if v.lane})
    told = [reading.crash.driven.get(v.id, CourseTold()) for v in named]
    aside = any(v.maneuver in OVER_A_LINE for v in named) or any(one.departs or one.moves for one in told)
    return rule("account.edge_of_lane").sub(" ", text) if aside else text


def _out(words: Rule, text: str, known: Collection[int | None]) -> str:
    return words.sub(lambda m: " " if number(m["count"]) in known else m[0], text)


def _side(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    """Sides count where a contact is told; those of the first contact may be told in another sentence."""
    if not _touches(sentence) or read.has(sentence.start, "_area") or not _tells_side(sentence):
        return True
    known = {name for names in read.facts.values() for name in names}
    return {"contacts.0.striker_area", "contacts.0.struck_area"} <= known


def _tells_side(sentence: Sentence) -> bool:
    """Whether a side that a sentence names may have touched: not that of a road, or one to which it rolled."""
    text = rule("account.side_of_road").sub(" ", sentence.text)
    return any(words.search(text) for words in of_role("telling") if words.yields["tells"] == "side")


def _roll(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    spun = read.has(sentence.start, ".spin") and rule("course_rest.turned_by").search(sentence.text)
    return bool(spun) or read.has(sentence.start, ".roll") or any(c.rolls for c in reading.crash.courses.values())


def _contact(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    """A contact of this sentence, or of the vehicles that it names."""
    if reading.crash.near_crash or read.has(sentence.start, "contacts.", "impacts.", "others."):
        return True
    if "contact" in read.acts.get(sentence.start, ()):
        return True
    names = reading.named_in(sentence)
    crash = reading.crash
    pairs = [{c.striker, c.struck} for c in crash.contacts] + [{i.actor, i.other} for i in crash.impacts]
    return len(names) > 1 and any(pair <= names for pair in pairs)


def _motion(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    late = sentence.start > read.first_contact
    return (
        late or read.has(sentence.start, "vehicles.", "near_crash.") or bool(read.acts.get(sentence.start))
        or _is_retold(reading, reading.text_of(sentence).strip())
    )  # fmt: skip


def _evasion(reading: Reading, sentence: Sentence, read: _Read) -> bool:
    """Of a near crash every sentence counts that tells an evasion of one of the two; others have it in the motions."""
    first = next(iter(reading.crash.contacts), None)
    who = _VEHICLE.search(reading.text_of(sentence))
    if reading.crash.near_crash is None or first is None or (who and who[0] not in (first.striker, first.struck)):
        return True
    return read.has(sentence.start, "evasion", "maneuver", "near_crash.")


def _is_retold(reading: Reading, text: str) -> bool:
    """Whether a sentence says no more than what was read elsewhere: a turn, a place that is left or entered, who is
    behind; or how one moved who is struck on foot."""
    crash = reading.crash
    if rule("account.retold_entering").search(text):
        return reading.roads.junction.kind != "none" or len(reading.roads.roads) > 1
    if turn := rule("account.retold_turn").search(text):
        made = crash.vehicle(turn["who"])
        return made is not None and f"turn_{turn['side1'] or turn['side2']}" in (made.maneuver, made.meant)
    if behind := rule("account.retold_behind").search(text):
        pair = (behind["who"] or behind["follows"], behind["ahead"] or behind["first"])
        return any((c.striker, c.struck) == pair and c.struck_area == "back" for c in crash.contacts)
    if tows := rule("account.retold_towing").search(text):
        towing = crash.vehicle(tows["who"])
        return towing is not None and towing.trailer
    if leaves := rule("account.retold_leaving").search(text):
        came = crash.vehicle(leaves["who"])
        return came is not None and (came.origin or "").startswith(leaves["place"].replace(" ", "_"))
    walks = rule("account.walks_in").search(text)
    return walks is not None and any(walks["word"] in other.word.lower() for other in crash.others)


_HEARD: dict[str, Callable[[Reading, Sentence, _Read], bool]] = {
    "lane": _lane, "side": _side, "roll": _roll, "contact": _contact, "motion": _motion,
    "evasion": _evasion,
}  # fmt: skip
