"""One report from a seed: narrative, crash to draw, answers and weights; the modality is drawn here too.

Modes: "both", "text" (no drawing), "image" (no narrative), "none" (the context-free row, which learns how
answers are distributed), "thin" (nothing told of the road), "no_crash" (a road but no crash), "conflict" (the
text contradicts itself). The last three are refused.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from random import Random
from typing import Any

from research.generator.crash.compass_ties import uncertain_facts
from research.generator.crash.crash import sample_crash, with_glancing_sides, with_rare_actor
from research.generator.crash.roads import beside, one_carriageway, one_way, with_access_mouths, with_wrong_lanes
from research.generator.crash.world import Crash, Leg
from research.generator.grammar import HINT, Written, unmark
from research.generator.targets import Targets, drawn_facts
from research.generator.writer import Writer
from research.model.answer_grammar import MISSING, REASONS
from sgcad_core.kinds import INTERSECTIONS, PLAIN, ROAD

MODES = {"both": 42.0, "image": 17.0, "text": 25.0, "none": 8.0, "thin": 3.0, "no_crash": 2.5, "conflict": 2.5}
TEXT_MODES = {"text": 90.0, "thin": 4.0, "no_crash": 3.0, "conflict": 3.0}
CARELESS = 0.15
"""Share of drawings beside a narrative whose lanes are wrong: where both tell lanes, the narrative is to be believed,
since real drawings differ from made ones and are misread more often than words are."""
UNMENTIONED = 0.4
"""Share of junctions in drawings that the narrative passes over, of those that the crash has nothing to do with."""
UNUSUAL = 0.2
"""Share of narratives alone that keep back lanes although there are several."""
UNUSUAL_ONE_WAY = 0.04
"""The same share where one of the roads whose lanes are kept back is one-way: of these writers pass over one lane."""
SECOND_THOUGHTS = 4
GONE = 0.5
"""The largest share of sentences that a depleted report lacks."""
ONE_WAY = {"text": 0.3, "both": 0.12, "image": 0.05, "none": 0.08}
"""How often a crash that trains, in each mode, gets a one-way street where it can: in words they come without a count
of lanes, at a T and beside two-way streets, and each of these is rare in crashes as they are sampled."""
Json = dict[str, Any]
Sentences = list[tuple[int, frozenset[str]]]


@dataclass
class Report:
    """What a model sees and what it is to answer; `behavior` is None where the road was refused."""

    seed: int
    mode: str
    crash: Crash
    narrative: str
    has_image: bool
    road: Json
    behavior: Json | None
    targets: Targets | None
    stated: set[str]
    drawn: set[str] = field(default_factory=set)
    sentences: Sentences = field(default_factory=list)
    """Where each sentence of the narrative ends and which facts it tells."""
    notes: list[tuple[int, list[str]]] = field(default_factory=list)
    """Where each noted phrase of the narrative ends and what it tells, as names of `phrase_notes.NOTES`."""
    shown: Crash | None = None
    """What the drawing shows, where that is not the crash itself."""
    doubtful: set[str] = field(default_factory=set)
    """What the narrative tells in part, or of a road without saying which legs are meant."""

    def weight(self, path: tuple[Any, ...]) -> float:
        """Weight of a value in the loss."""
        return self.targets.weight(path) if self.targets else 1.0


def make_report(
    seed: int, held_out: bool = False, length: float = 1.0, modes: dict[str, float] | None = None
) -> Report:
    """The report of a seed; `length` scales the sentences that say nothing of the scene (0 none, 1 as in real ones)."""
    rng = Random(seed * 2 + held_out)
    weights = modes or MODES
    mode = rng.choices(list(weights), list(weights.values()))[0]
    crash = _sample(rng, seed, held_out, mode)
    aside = beside(crash) if mode == "both" and not held_out and rng.random() < UNMENTIONED else None
    writer = Writer(rng, aside or crash, held_out, length)
    control, arrows = rng.random() < 0.6, rng.random() < 0.6
    if mode in ("thin", "no_crash", "conflict"):
        return _refused(seed, mode, rng, crash, writer)
    written = writer.finish(writer.write())
    if mode == "text" and not held_out:
        crash, written = _worth_telling(rng, seed, length, crash, written)
    sentences = written.sentences
    half = one_carriageway(crash) if mode in ("both", "image") and rng.random() < 0.4 else None
    if half is not None:
        crash, sentences = half, _without_road(half, sentences)
    if mode in ("both", "image", "none") and not held_out:  # without context no fewer, else contrast invents driveways
        told_of = mode == "both" and any("access" in facts for _, facts in sentences)
        crash = with_access_mouths(Random(f"{seed} mouths"), crash, told_of or mode == "none")
    drawn, shown = drawn_facts(crash, control, arrows, bool(crash.accesses)), None
    if mode == "both" and not held_out and half is None and rng.random() < CARELESS:
        shown = with_wrong_lanes(rng, crash)
        drawn = {fact for fact in drawn if fact.split(".")[0] not in ("lanes", "turns", "median", "lane")}
    if mode in ("image", "none"):
        written, sentences = Written(), []
    told, doubtful = _stated_facts(crash, sentences)
    seen = drawn if mode in ("both", "image") else set()
    targets = Targets(crash, told | doubtful | seen, doubtful - seen, alone=mode == "text")
    if mode == "none":
        targets = _prior(crash, rng)
    return Report(
        seed,
        mode,
        crash,
        written.narrative,
        mode in ("both", "image"),
        targets.road,
        targets.behavior,
        targets,
        told,
        drawn,
        sentences,
        written.notes,
        shown,
        doubtful,
    )


def _sample(rng: Random, seed: int, held_out: bool, mode: str, attempt: int = 0) -> Crash:
    """A crash; of those that train, more on one-way streets, with other sides and, in drawings, of other kinds than the
    sampler knows."""
    crash = sample_crash(rng)
    if held_out:
        return crash
    own = Random(f"{seed} streets {attempt}")
    if mode == "image":
        crash = with_rare_actor(own, crash)
    return with_glancing_sides(own, one_way(own, crash, ONE_WAY.get(mode, 0.0)))


def _worth_telling(rng: Random, seed: int, length: float, crash: Crash, written: Written) -> tuple[Crash, Written]:
    """A report in which an undescribed road is, most often, a plain one: writers mention what is unusual."""
    for attempt in range(1, SECOND_THOUGHTS + 1):
        told = {fact for _, facts in written.sentences for fact in facts}
        rare = [leg for leg in crash.legs if not _plain(leg, told) and f"lanes.{leg.bearing % 4}" not in told]
        if rng.random() < (UNUSUAL if all(leg.two_way for leg in rare) else UNUSUAL_ONE_WAY) or not rare:
            break
        crash = _sample(rng, seed, False, "text", attempt)
        writer = Writer(rng, crash, False, length)
        written = writer.finish(writer.write())
    return crash, written


def _plain(leg: Leg, told: set[str]) -> bool:
    """A lane each way, or one of a street that is said to be one-way; or no street at all."""
    usual = max(leg.lanes_in, leg.lanes_out) < 2 and (leg.two_way or f"ways.{leg.bearing % 4}" in told)
    return leg.kind != ROAD or usual


def _stated_facts(crash: Crash, sentences: Sentences) -> tuple[set[str], set[str]]:
    """What sentences tell of a crash, and what they tell without saying of which legs."""
    facts = {fact for _, some in sentences for fact in some if not fact.startswith(HINT)}
    facts |= {"legs"} if "layout" in facts else set()
    doubtful = facts & uncertain_facts(crash, [some for _, some in sentences])
    return facts - doubtful, doubtful


def _without_road(crash: Crash, sentences: Sentences) -> Sentences:
    """Sentences that tell of both carriageways where a drawing shows the one that matters: the drawing is believed."""
    untrue = {f"{key}.{leg.bearing % 4}" for key in ("lanes", "median") for leg in crash.legs}
    return [(end, facts - untrue) for end, facts in sentences]


def _prior(crash: Crash, rng: Random) -> Targets:
    """Answers to this crash with a random part of it told: the distribution without context."""
    facts = drawn_facts(crash, True, True, bool(crash.accesses)) | {"light", "weather", "surface"}
    facts |= {f"limit.{leg.bearing % 4}" for leg in crash.legs}
    targets = Targets(crash, {fact for fact in sorted(facts) if rng.random() < 0.8})
    targets.flat = 0.7
    return targets


def _refused(seed: int, mode: str, rng: Random, crash: Crash, writer: Writer) -> Report:
    if mode == "conflict":
        narrative = unmark(_conflicting(rng, crash, writer))[0]
        return Report(seed, mode, crash, narrative, False, refusal(2), None, None, set())
    narrative = " ".join(([] if mode == "thin" else writer.place()) + writer.aftermath())
    written = writer.finish(narrative)
    told, doubtful = _stated_facts(crash, written.sentences)
    if mode == "no_crash":
        targets = Targets(crash, told | doubtful, doubtful)
        known = ("layout" in told and crash.layout in INTERSECTIONS) or crash.layout == PLAIN
        road = targets.road if known else refusal(0)
        return Report(seed, mode, crash, written.narrative, False, road, refusal(1) if known else None, targets, told)
    return Report(seed, mode, crash, written.narrative, False, refusal(0), None, None, told)


def _conflicting(rng: Random, crash: Crash, writer: Writer) -> str:
    """The approaches told twice, the second time from elsewhere and on another road."""
    first = writer.scene_and_approach()
    other = sample_crash(rng)
    while other.layout == crash.layout or other.actors[0].leg == crash.actors[0].leg:
        other = sample_crash(rng)
    again = Writer(rng, other, writer.held_out, writer.length)
    again.mentions.style, again.ciren = writer.mentions.style, writer.ciren
    parts = first + again.scene_and_approach()
    return " ".join(parts + again.events() + writer.aftermath())


def refusal(reason: int) -> Json:
    """A refusal: 0 thin, 1 no crash, 2 conflict."""
    missing = {0: list(MISSING), 1: list(MISSING[2:]), 2: [MISSING[0], MISSING[2]]}[reason]
    return {"refuse": REASONS[reason], "missing": missing}


def depleted(report: Report, rng: Random) -> Report:
    """A report that lacks some of its sentences, and so what only these tell: each left out with the same probability,
    which is drawn anew for every report.

    Its answers stay those of the crash; notes are not kept.
    """
    gone, start, text = rng.random() * GONE, 0, ""
    sentences: Sentences = []
    for end, facts in report.sentences:
        if rng.random() >= gone:
            text += report.narrative[start:end]
            sentences.append((len(text), facts))
        start = end
    told, doubtful = _stated_facts(report.crash, sentences)
    return replace(report, narrative=text, sentences=sentences, stated=told, doubtful=doubtful, notes=[])
