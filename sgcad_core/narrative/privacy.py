"""Takes what says who somebody was, not how the crash went, out of a narrative.

Sex, age, names, licence, health and injury data are of no use to a scenario and never reach a prompt.
Motion is never touched: a sentence goes only if it tells of persons alone. Knows no crash facts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from sgcad_core.language import of_role, rule

_AGE = rule("privacy.age")
_SEX = rule("privacy.sex")
_NAME = rule("privacy.name")
_PERSON_ONLY = rule("privacy.person_only")
_CRASH = rule("privacy.crash")
_PLURAL = {"was": "were", "is": "are", "has": "have", "does": "do", "wasn't": "weren't"}
_AGREEMENT = rule("privacy.agreement")
_CONNECTOR = rule("privacy.connector")
_CLAUSE = rule("privacy.clause")
_MENTION = rule("privacy.mention")
_PERSON = rule("privacy.person")
_UNHURT = rule("privacy.unhurt")
_SENTENCE_END = rule("privacy.sentence_end")


def redact(text: str) -> str:
    """The narrative without persons: sentences about people alone dropped, ages, sexes and names replaced."""
    out = "".join(_parts_without_persons(_SENTENCE_END.split(text)))
    out = _AGE.sub(lambda m: f"{m.group('the') or 'a '}person ", out)
    out = _NAME.sub("a person", out)
    out = _SEX.sub(lambda m: _person(m.group(0), m.group(1)), out)
    out = rule("privacy.person_before_role").sub(r"\1", out)
    for pronoun in of_role("personal_pronoun"):
        out = pronoun.sub(pronoun.yields["to"], out)
    out = _AGREEMENT.sub(lambda m: m.group(1) + _PLURAL[m.group(2)], out)
    out = rule("privacy.sentence_begins").sub(r"\1A person", out)
    return rule("privacy.space_before_mark").sub(r"\1", rule("privacy.spaces").sub(" ", out)).strip()


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
    body, end = rule("privacy.body_and_end").fullmatch(sentence).groups()  # type: ignore[union-attr]
    clauses = _CLAUSE.split(_UNHURT.sub("", body))
    kept = [clause for clause in clauses if not _tells_of_persons_alone(clause)]
    if not kept or (kept[0] is not clauses[0] and not _CRASH.search("".join(kept))):
        kept = []  # what is left has lost its subject and tells of no motion
    text = _CONNECTOR.sub("", "".join(kept).strip(" ,;"))
    space = rule("privacy.leading_space").match(body).group(0)  # type: ignore[union-attr]
    return space + text + end if text else end.strip(".!? ")


def _tells_of_persons_alone(clause: str) -> bool:
    return bool(_PERSON_ONLY.search(clause)) and not _CRASH.search(clause)


def _person(found: str, role: str | None) -> str:
    article = "a " if found.lower().startswith(("a ", "an ")) else ""
    return article + (role or "person")
