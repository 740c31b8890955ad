"""Numbered vehicles, their make, model and kind, and every way they are mentioned.

`read_roster` reads the descriptions; `Roster.resolve` rewrites a sentence so that each vehicle is just "V<n>":
descriptions behind a mention go, "the Ford" becomes the number. Knows no motion and no contact.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

from sgcad_core.kinds import actor_kind
from sgcad_core.reading.actors import vehicle_descriptions as phrases
from sgcad_core.reading.actors.makes import BODY_WORDS, COLORS, MAKES, is_animal, kind_of
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.records.specs import ActorKind

MENTION = rule("vehicles.mention")
_BESIDE = rule("references.unnumbered")
"""A mark that `number_parked` and `number_cyclists` leave, since no report writes so."""


@dataclass(frozen=True)
class VehicleDescription:
    """A vehicle as described: words are lower case except make and model; kind falls back to car."""

    id: str
    year: int | None = None
    make: str | None = None
    model: str | None = None
    color: str | None = None
    kind: ActorKind = "car"
    kind_stated: bool = False
    trailer: bool = False
    animal: bool = False
    counted: bool = False
    """Whether it was numbered here, not by the report."""
    described: tuple[Source, ...] = field(default=(), compare=False, repr=False)
    """Every description of it, in order."""
    beside: bool = False
    """Whether it only stands by the road in a report that numbers the others, and has no number there."""


@dataclass(frozen=True)
class Roster:
    """Every vehicle of the report by number, and how to find it in a sentence."""

    vehicles: tuple[VehicleDescription, ...]
    aliases: dict[str, str] = field(default_factory=dict)
    """Lower-case word or phrase -> id, only where it names one vehicle."""
    bystanders: tuple[str, ...] = ()
    """Numbers of actors in the text that take no part in the crash."""

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """The numbers in order."""
        return tuple(v.id for v in self.vehicles)

    def other(self, vehicle: str) -> str | None:
        """The other one of two vehicles."""
        rest = [v for v in self.vehicles if v.id != vehicle]
        numbered = [v for v in rest if not v.beside] or rest
        return numbered[0].id if len(numbered) == 1 else None

    @cached_property
    def counted(self) -> bool:
        """Whether the numbers were given here: the report has none and tells one account in order."""
        return any(v.counted for v in self.vehicles)

    def without(self, bystanders: Iterable[str]) -> Roster:
        """The roster without bystanders."""
        gone = tuple(bystanders)
        stay = tuple(v for v in self.vehicles if v.id not in gone)
        names = {name: id for name, id in self.aliases.items() if id not in gone}
        return Roster(stay, names, (*self.bystanders, *gone))

    @property
    def called(self) -> dict[str, str]:
        """Number in the text -> the actor's own id (V1, B1, P1, A1); of bystanders, behind all others."""
        counts: dict[str, int] = {}
        found: dict[str, str] = {}
        for v in self.vehicles:
            record = actor_kind(v.kind)
            letter = record.letter if v.counted and record.exposed else "V"
            letter = "O" if v.beside else "A" if v.animal else letter
            counts[letter] = counts.get(letter, 0) + 1
            found[v.id] = f"{letter}{counts[letter]}" if v.counted or v.beside else v.id
        further = {name: f"V{counts.get('V', 0) + n}" for n, name in enumerate(self.bystanders, 1)}
        return found | (further if self.counted else {})

    def resolve(self, sentence: str) -> str:
        """The sentence with every description or name of a vehicle replaced by its number."""
        text = phrases.INTRODUCED.sub(r"\2", sentence) if self.counted else sentence
        text = phrases.BRACKETED.sub(lambda m: _keep_number(m, self.ids, self.counted), text)
        text = self._named.sub(self._number, text) if self._named else text
        text = rule("vehicles.number_in_brackets").sub(r" \1", text)
        text = rule("vehicles.repeated_number").sub(self._once, text)
        text = rule("vehicles.occupied").sub(r"\1 ", phrases.without_descriptions(text))
        text = text if self.counted or not self._full else self._full.sub(self._by_name, text)
        text = rule("vehicles.repeated_number").sub(self._once, rule("vehicles.number_in_brackets").sub(r" \1", text))
        return rule("common.space").sub(" ", text).strip()

    def _once(self, match: re.Match[str]) -> str:
        """A number that stands twice; two mentions in "behind V2, V2 began" of our own numbers and behind "when"."""
        apart = self.counted or rule("vehicles.two_clauses").search(match.string[: match.start()])
        return match.group() if apart and "," in match.group() else match.group(1)

    @cached_property
    def _named(self) -> re.Pattern[str] | None:
        if not self.aliases:
            return None
        return rule("vehicles.alias").given(names=tuple(sorted(self.aliases, key=len, reverse=True)))

    @cached_property
    def _full(self) -> re.Pattern[str] | None:
        told = {_full_name(v) for v in self.vehicles}
        names = [name for name in self.aliases if name in told]
        if not names:
            return None
        return rule("vehicles.full_name").given(models=tuple(sorted(names, key=len, reverse=True)))

    def _by_name(self, match: re.Match[str]) -> str:
        return self.aliases[match.group("model").lower()]

    def _number(self, match: re.Match[str]) -> str:
        return match.group(2) or self.aliases[match.group(1).lower()]


def _keep_number(match: re.Match[str], ids: tuple[str, ...], counted: bool) -> str:
    """The number in place of its description; what that tells of its way ("a westbound van (V1)") stays before it."""
    if match.group(2) not in ids:
        return match.group(0)
    told = None if counted else rule("vehicles.way_or_state").search(match.group(1))
    if not told:
        return match.group(2)
    return f"{told['way']} {match.group(2)}" if told["way"] else f"{match.group(2)}, which was {told['state'].lower()},"


def read_roster(sentences: Iterable[str], counted: bool = False) -> Roster:
    """The vehicles that normalized sentences number, with what is said of them; `counted`: by us, not by the report."""
    told = list(sentences)
    found = tuple(_identity(vehicle, told, counted) for vehicle in _numbers(told))
    found = found if counted else _in_full(found, told)
    found = tuple(_marked(v) if any(_BESIDE.search(c.words) for c in v.described) else v for v in found)
    return Roster(found, _aliases(found))


def _marked(identity: VehicleDescription) -> VehicleDescription:
    """An actor numbered here though the report numbers others: a cyclist, else a parked vehicle."""
    return replace(identity, counted=True) if actor_kind(identity.kind).keeps_right else replace(identity, beside=True)


def _numbers(told: list[str]) -> list[str]:
    """The ids in order, the first one whatever it is; one far beyond the others is a model (Volvo V70), no vehicle."""
    named = (
        m
        for text in told
        for m in rule("vehicles.no_model").finditer(text)
        if not rule("vehicles.no_number").match(text, m.start())
    )
    kept: list[int] = []
    for n in sorted({int(m[0][1:]) for m in named if len(m[0]) <= _LONGEST_ID}):
        if n and (not kept or n <= kept[-1] + 2):
            kept.append(n)
    return [f"V{n}" for n in kept]


_LONGEST_ID = 3
"""Characters: V1 to V99, as specs have them."""


def _identity(vehicle: str, told: list[str], counted: bool) -> VehicleDescription:
    found = phrases.introductions if counted else phrases.descriptions
    described = tuple(Source(n, d) for n, text in enumerate(told) for d in found(text, vehicle))
    if counted and not described:  # a number of the report's own, beside those that were given here
        described = tuple(Source(n, d) for n, text in enumerate(told) for d in phrases.descriptions(text, vehicle))
    words = " ".join(source.words for source in described)
    if not counted and not rule("vehicles.make").search(words):
        described += tuple(Source(n, d) for n, text in enumerate(told) for d in phrases.named_before(text, vehicle))
    return _described(vehicle, described, told, counted)


def _described(vehicle: str, described: tuple[Source, ...], told: list[str], counted: bool) -> VehicleDescription:
    words = " ".join(source.words for source in described)
    year = rule("vehicles.year").search(words)
    make = rule("vehicles.make").search(words)
    color = rule("vehicles.color").search(words)
    model = _model(words, make.end()) if make else _model_alone(words)
    kind, stated = kind_of(words, model)
    trailer = bool(rule("vehicles.trailer").search(words)) or _tows(vehicle, told)
    return VehicleDescription(
        vehicle, int(year.group()) if year else None, MAKES[make.group().lower()] if make else None, model,
        color.group().lower() if color else None, kind, stated, trailer, is_animal(words), counted, described,
    )  # fmt: skip


def _in_full(found: tuple[VehicleDescription, ...], told: list[str]) -> tuple[VehicleDescription, ...]:
    """Identities of which the report tells make and model elsewhere: "a Kia Rio stopped", then "the Rio is V2"."""
    full: dict[str, Source] = {}
    for n, text in enumerate(told):
        for m in rule("vehicles.make_and_model").finditer(text):
            full.setdefault(m.group("name").lower(), Source(n, m[0]))
    known = {f"{v.make} {v.model}".lower() for v in found if v.make and v.model}
    found = tuple(_completed(v, [full[name] for name in full if name not in known], told) for v in found)
    known = {f"{v.make} {v.model}".lower() for v in found if v.make and v.model}
    left = [full[name] for name in full if name not in known]
    nameless = [v for v in found if v.make is None]
    if len(nameless) == len(left) == 1 and _fits(nameless[0], left[0]):
        return tuple(_described(v.id, (*v.described, left[0]), told, False) if v is nameless[0] else v for v in found)
    return found


def _completed(v: VehicleDescription, full: list[Source], told: list[str]) -> VehicleDescription:
    words = " ".join(source.words for source in v.described).lower()
    name = rule("vehicles.make").search(words) or rule("vehicles.model").search(words)
    if (v.make and v.model) or not name:
        return v
    same = [source for source in full if rule("makes.whole_word").given(word=name[0]).search(source.words.lower())]
    return _described(v.id, (same[0], *v.described), told, False) if len(same) == 1 else v


def _fits(v: VehicleDescription, source: Source) -> bool:
    """Whether a vehicle may be of that make and model: a body word allows its own kind only."""
    return not v.kind_stated or kind_of(source.words, None)[0] == v.kind


def _model_alone(words: str) -> str | None:
    """A known model without a make."""
    return next((m[0] for m in rule("vehicles.model").finditer(words) if m[0][0].isupper()), None)


def _model(words: str, start: int) -> str | None:
    """The one or two words behind the make that are neither body nor verb."""
    found: list[str] = []
    for word in rule("vehicles.word").findall(words[start:])[:3]:
        if (
            word in ",;()"
            or rule("vehicles.stop").fullmatch(word)
            or word.lower() in BODY_WORDS
            or rule("vehicles.whole_year").fullmatch(word)
        ):
            break
        bare = word.rstrip(".,")
        if rule("vehicles.doors").match(word) or word.lower() in COLORS or bare.lower() in MAKES or bare in found:
            break
        found.append(bare)
    return " ".join(found[:2]) or None


def _tows(vehicle: str, told: list[str]) -> bool:
    tows = rule("vehicles.tows").given(vehicle=vehicle)
    return any(tows.search(text) and _tow_owner(text) == vehicle for text in told)


def _tow_owner(text: str) -> str | None:
    """The vehicle named last before (or in) the words that tell of the trailer."""
    verb = rule("vehicles.tow_verb").search(text)
    if not verb:
        return None
    before = [] if verb[0].endswith(("of ", "for ")) else MENTION.findall(text[: verb.start()])
    before = before or MENTION.findall(text[verb.start() :])[:1] or MENTION.findall(text)
    return before[-1] if before else None


# ------------------------------------------------------------------ names
def _aliases(vehicles: tuple[VehicleDescription, ...]) -> dict[str, str]:
    """Words that name exactly one vehicle: make, model, first word of the model, kind of vehicle."""
    claims: dict[str, set[str]] = {}
    for v in vehicles:
        for name in _names(v):
            claims.setdefault(name, set()).add(v.id)
    return {name: next(iter(ids)) for name, ids in claims.items() if len(ids) == 1}


def _full_name(v: VehicleDescription) -> str | None:
    """Its model, else its make with a body word, lower case."""
    if v.model or not v.make:
        return v.model.lower() if v.model else None
    found = rule("vehicles.make_and_model").search(" ".join(source.words for source in v.described))
    return found[0].lower() if found and found[0] != found["name"] else None


def _names(v: VehicleDescription) -> set[str]:
    names: set[str] = set()
    if v.make:
        names |= {word for word, make in MAKES.items() if make == v.make}
        names |= set(rule("vehicles.short_make").findall(v.make.lower())) if not v.counted else set()
    if v.model:
        first = v.model.split()[0].lower()
        names |= {v.model.lower()} | ({first} if len(first) > 2 else set())
    if (full := _full_name(v)) and not v.counted:
        names.add(full)
    if not v.counted:
        plain = () if v.kind_stated else ("car", "cab")
        names |= {w for w, kind in BODY_WORDS.items() if kind == v.kind and w not in ("vehicle", "truck", *plain)}
        names |= {"truck"} if v.kind in ("truck", "pickup") else set()
    return names
