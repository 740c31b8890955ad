"""Takes what says who somebody was, not how the crash went, out of a narrative.

Sex, age, names, licence, health and injury data are of no use to a scenario and never reach a prompt.
Motion is never touched: a sentence goes only if it tells of persons alone. Knows no crash facts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

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
    out = "".join(_parts_without_persons(_SENTENCE_END.split(text)))
    out = _AGE.sub(lambda m: f"{m.group('the') or 'a '}person ", out)
    out = _NAME.sub("a person", out)
    out = _SEX.sub(lambda m: _person(m.group(0), m.group(1)), out)
    out = re.sub(r"\bperson (driver|passenger|occupant|pedestrian|rider|operator|bicyclist)\b", r"\1", out)
    for pattern, neutral in _PRONOUNS:
        out = pattern.sub(neutral, out)
    out = _AGREEMENT.sub(lambda m: m.group(1) + _PLURAL[m.group(2)], out)
    out = re.sub(r"(^|[.!?]\s+)a person\b", r"\1A person", out)
    return re.sub(r" +([.,;])", r"\1", re.sub(r"[ \t]{2,}", " ", out)).strip()


def _parts_without_persons(sentences: Iterable[str]) -> Iterator[str]:
    """Sentences without persons; where one goes that named the vehicle, the next one's "he" or "she" names it."""
    named: str | None = None
    for sentence in sentences:
        kept = _without_persons(sentence)
        mention = _MENTION.search(sentence)
        if not kept.strip(" .!?"):
            named = mention.group(0) if mention else named
        elif _PERSON.match(kept) and named:
            kept, named = _PERSON.sub(rf"\1The driver of {named}", kept, count=1), None
        elif _MENTION.search(kept):
            named = None
        yield kept


def _without_persons(sentence: str) -> str:
    """A sentence without the clauses that tell of persons alone; its end mark and line break stay."""
    if not _PERSON_ONLY.search(sentence):
        return sentence
    body, end = re.fullmatch(r"(.*?)([.!?]*\s*)", sentence, re.DOTALL).groups()  # type: ignore[union-attr]
    clauses = _CLAUSE.split(_UNHURT.sub("", body))
    kept = [clause for clause in clauses if not _tells_of_persons_alone(clause)]
    if not kept or (kept[0] is not clauses[0] and not _CRASH.search("".join(kept))):
        kept = []  # what is left has lost its subject and tells of no motion
    text = _CONNECTOR.sub("", "".join(kept).strip(" ,;"))
    space = re.match(r"\s*", body).group(0)  # type: ignore[union-attr]
    return space + text + end if text else end.strip(".!? ")


def _tells_of_persons_alone(clause: str) -> bool:
    return bool(_PERSON_ONLY.search(clause)) and not _CRASH.search(clause)


def _person(found: str, role: str | None) -> str:
    article = "a " if found.lower().startswith(("a ", "an ")) else ""
    return article + (role or "person")
