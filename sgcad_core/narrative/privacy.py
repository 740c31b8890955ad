"""Takes what says who somebody was, not how the crash went, out of a narrative.

Sex, age, names, licence, health and injury data are of no use to a scenario and never reach a prompt.
Motion is never touched: a sentence goes only if it tells of persons alone. Knows no crash facts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from sgcad_core.narrative.traced import Traced, joined

_NUMBER = r"(?:\d{1,3}|[a-z]+(?:[- ](?:one|two|three|four|five|six|seven|eight|nine))?)"
_ROLE = "driver|passenger|occupant|pedestrian|rider|operator|bicyclist|person"
_HELD = r"(?:un)?(?:belted|restrained|helmeted)"
_AGE = re.compile(
    rf"\b(?:(?P<the>the )|an? )?(?:{_HELD}[ ,]+)?{_NUMBER}[- ]?(?:year|yr)s?[- ]?(?:old|of[- ]age)\b"
    rf"(?:[, ]+(?:white|black|hispanic|asian)\b)?(?:[, ]+{_HELD}\b)?"
    r"(?:[, ]+(?:male|female|man|woman|boy|girl|gentleman|lady)\b)?"
    rf"(?:[, ]+(?={_ROLE}))?",
    re.IGNORECASE,
)
_SEX = re.compile(rf"\b(?:an? )?(?:male|female)\b ?({_ROLE})?", re.IGNORECASE)
_NAME = re.compile(r"\b(?:Mr|Mrs|Ms|Miss|Dr)\.? [A-Z][a-z]+(?: [A-Z][a-z]+)?")
_PERSON_ONLY = re.compile(
    r"\b(?:(?:un)?injur\w*|hospital\w*|trauma|helicopter|fatal\w*"
    r"|deceased|pronounced|died|sustained|fractur\w*"
    r"|lacerat\w*|contusion\w*|abrasion\w*|concussion|complain\w* of|medical\w*|medicat\w*"
    r"|prescri\w+|surgery|diabet\w*|asthma"
    r"|blood pressure|health\w*|eyeglass\w*|glasses|contact lens\w*|myopi\w*|near[- ]?sighted|far[- ]?sighted"
    r"|seat ?belts?|safety belts?|shoulder belts?|lap belt|three-point|restrain\w*|air ?bags?|pre-?tensioner"
    r"|licen[sc]e\w*"
    r"|alcohol\w*|intoxicat\w*|blood alcohol|drugs?|pregnan\w*|fatigu\w*|slept"
    r"|apnea|drows\w*|belted|sleep\w* hours|case occupant|ambulance|transported|treated|released)\b",
    re.IGNORECASE,
)
_CRASH = re.compile(
    r"\b(?:struck|impact\w*|hit|collid\w*|contacted|rear-?ended|sideswip\w*|travel+ing|travel+ed|turn\w*|lanes?"
    r"|intersection|road\w*|street|highway|north\w*|south\w*|east\w*|west\w*|stopped|stop sign|signal\w*|driveway"
    r"|crossed|crossing|entered|drifted|ran off|swerv\w*|steer\w*|brak\w*|speed|mph|kmph|kph|curve\w*"
    r"|driven by|operated by|drove"
    r"|rotat\w*|front|rear|towed|came to rest|final rest|passing|merg\w*|backing|parked)\b",
    re.IGNORECASE,
)
_PRONOUNS = (
    (re.compile(r"\b(?:he|she)\b"), "they"), (re.compile(r"\b(?:He|She)\b"), "They"),
    (re.compile(r"\bhis or her\b|\bhis/her\b", re.IGNORECASE), "their"),
    (re.compile(r"\b(?:himself|herself)\b", re.IGNORECASE), "themself"),
    (re.compile(r"\bhis\b"), "their"), (re.compile(r"\bHis\b"), "Their"),
    (re.compile(r"\bher\b(?= (?:and|or|but|to|when|as|because|by|in|on|at|from|with|was|were|who)\b)"), "them"),
    (re.compile(r"\bher\b(?= [a-z])"), "their"), (re.compile(r"\bHer\b"), "Their"),
    (re.compile(r"\b(?:him|her)\b"), "them"),
)  # fmt: skip
_PLURAL = {"was": "were", "is": "are", "has": "have", "does": "do", "wasn't": "weren't"}
_AGREEMENT = re.compile(r"\b([Tt]hey )(was|is|has|does|wasn't)\b")
_CONNECTOR = re.compile(r"^(?:and|but|who|with)\b,? ?")
_CLAUSE = re.compile(r"(?=,? (?:who|and|but|with)\b)|(?=[,;] )")
_MENTION = re.compile(
    r"\b(?:vehicle|veh|unit|V)\b\.? ?#? ?(?:\d{1,2}|one|two|three|four)\b|\bV\d{1,2}\b", re.IGNORECASE
)
_PERSON = re.compile(r"(\s*)(?:He|She|(?:The|This) driver)\b(?! of)")
_UNHURT = re.compile(r",? who (?:did not sustain any injur\w+|(?:was|were) (?:not|un)\s?injured)\b,?", re.IGNORECASE)
_SENTENCE_END = re.compile(r"(?<=[.!?])(?=\s+[A-Z(\"'])|(?<=\n)")


def redact(text: str) -> str:
    """The narrative without persons: sentences about people alone dropped, ages, sexes and names replaced."""
    return redacted(Traced.of(text)).text


def redacted(text: Traced) -> Traced:
    """`redact` of a text whose characters know their places."""
    out = joined(list(_parts_without_persons(text.split(_SENTENCE_END))))
    out = out.sub(_AGE, lambda m: f"{m.group('the') or 'a '}person ").sub(_NAME, "a person")
    out = out.sub(_SEX, lambda m: _person(m.group(0), m.group(1))).sub(_PERSON_ROLE, r"\1")
    for pattern, neutral in _PRONOUNS:
        out = out.sub(pattern, neutral)
    out = out.sub(_AGREEMENT, lambda m: m.group(1) + _PLURAL[m.group(2)]).sub(_LOWER_PERSON, r"\1A person")
    return out.sub(_GAP, " ").sub(_SPACE_BEFORE, r"\1").strip()


_PERSON_ROLE = re.compile(r"\bperson (driver|passenger|occupant|pedestrian|rider|operator|bicyclist)\b")
_LOWER_PERSON = re.compile(r"(^|[.!?]\s+)a person\b")
_GAP = re.compile(r"[ \t]{2,}")
_SPACE_BEFORE = re.compile(r" +([.,;])")


def _parts_without_persons(sentences: Iterable[Traced]) -> Iterator[Traced]:
    """Sentences without persons; where one goes that named the vehicle, the next one's "he" or "she" names it."""
    named: str | None = None
    for sentence in sentences:
        kept = _without_persons(sentence)
        mention = _MENTION.search(sentence.text)
        if not kept.text.strip(" .!?"):
            named = mention.group(0) if mention else named
        elif _PERSON.match(kept.text) and named:
            kept, named = kept.sub(_PERSON, rf"\1The driver of {named}", 1), None
        elif _MENTION.search(kept.text):
            named = None
        yield kept


def _without_persons(sentence: Traced) -> Traced:
    """A sentence without the clauses that tell of persons alone; its end mark and line break stay."""
    if not _PERSON_ONLY.search(sentence.text):
        return sentence
    ends = _END_MARK.fullmatch(sentence.text).start(1)  # type: ignore[union-attr]
    body, end = sentence.cut(0, ends), sentence.cut(ends, len(sentence.text))
    clauses = body.sub(_UNHURT, "").split(_CLAUSE)
    kept = [clause for clause in clauses if not _tells_of_persons_alone(clause.text)]
    if not kept or (kept[0] is not clauses[0] and not _CRASH.search("".join(k.text for k in kept))):
        kept = []  # what is left has lost its subject and tells of no motion
    text = joined(kept).strip(" ,;").sub(_CONNECTOR, "")
    space = body.cut(0, len(body.text) - len(body.text.lstrip()))
    return joined([space, text, end]) if text.text else end.strip(".!? ")


_END_MARK = re.compile(r".*?([.!?]*\s*)", re.DOTALL)


def _tells_of_persons_alone(clause: str) -> bool:
    return bool(_PERSON_ONLY.search(clause)) and not _CRASH.search(clause)


def _person(found: str, role: str | None) -> str:
    article = "a " if found.lower().startswith(("a ", "an ")) else ""
    return article + (role or "person")
