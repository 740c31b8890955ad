"""Makes, body words and well-known models of the U.S. fleet, and the kind of vehicle they mean.

General knowledge, no report. Knows no sentence.
"""

from __future__ import annotations

from sgcad_core.kinds import ACTORS, kind_of_letter
from sgcad_core.reading.language import rule, values, words
from sgcad_core.reading.language.data import vocabulary
from sgcad_core.records.specs import ActorKind

COLORS = words("color")
MAKES: dict[str, str] = {
    word: make["make"] if isinstance(make, dict) else make for word, make in values("make").items()
}
"""Lower-case spelling -> make."""
BODY_WORDS: dict[str, ActorKind] = values("body")
"""Lower-case body word -> kind."""
ROAD_USERS: dict[str, str] = values("road_user")
"""Lower-case word for people and animals on the road -> what they are."""
ANIMAL = "animal"
"""What a road user is that is no kind of actor; it moves as a pedestrian does."""
_MAKE_KIND: dict[str, ActorKind] = {
    word: make["kind"] for word, make in values("make").items() if isinstance(make, dict)
}
_USUAL = kind_of_letter("V")
_MODEL_KIND: dict[ActorKind, tuple[str, ...]] = {
    kind: words(f"model_{kind}") for kind in ACTORS if kind != _USUAL and f"model_{kind}" in vocabulary().classes
}
"""Models of kinds that are not the usual one, which stands where no model is known."""


def kind_of(words: str, model: str | None) -> tuple[ActorKind, bool]:
    """Kind of road user or thing from its description, and whether a word states it; a car where none does."""
    text = words.lower()
    for user in sorted(ROAD_USERS, key=len, reverse=True):
        if rule("makes.whole_word").given(word=user).search(text):
            return _actor_of(ROAD_USERS[user]), True
    for body in sorted(BODY_WORDS, key=len, reverse=True):
        if rule("makes.whole_word").given(word=body).search(text):
            if BODY_WORDS[body] == "truck" and body == "truck" and _by_model(text, model) == "pickup":
                return "pickup", True
            return BODY_WORDS[body], True
    known = _by_model(text, model) or _by_make(text)
    if known is None and (other := rule("makes.other").fullmatch(text.strip(" ,."))):
        return ("pedestrian" if other["person"] else "object"), True
    return known or _USUAL, False


def is_animal(words: str) -> bool:
    """Whether a description is of an animal."""
    animals = (word for word, kind in ROAD_USERS.items() if kind == ANIMAL)
    return any(rule("makes.whole_word").given(word=word).search(words.lower()) for word in animals)


def on_foot(user: str) -> bool:
    """Whether a road user walks: people and animals."""
    return user == ANIMAL or (user in ACTORS and ACTORS[user].walks)


def no_vehicle(user: str) -> bool:
    """Whether no report calls a road user a vehicle: people, riders of light two-wheelers, animals."""
    return user == ANIMAL or (user in ACTORS and ACTORS[user].exposed)


def is_ridden(user: str) -> bool:
    """Whether a road user is ridden."""
    return user in ACTORS and ACTORS[user].ridden


def is_large(user: str) -> bool:
    """Whether "the truck" may mean a road user."""
    return user in ACTORS and ACTORS[user].large


def _actor_of(user: str) -> ActorKind:
    """Kind of actor that stands for a road user."""
    return kind_of_letter("P") if user == ANIMAL else user


def _by_model(text: str, model: str | None) -> ActorKind | None:
    name = (model or "").lower()
    for kind, models in _MODEL_KIND.items():
        if any(
            name == m or name.startswith(m + " ") or rule("makes.whole_word").given(word=m).search(text) for m in models
        ):
            return kind
    return None


def _by_make(text: str) -> ActorKind | None:
    return next((k for make, k in _MAKE_KIND.items() if rule("makes.make").given(word=make).search(text)), None)
