"""Makes, models, bodies and colors of made vehicles, drawn from `phrases/vehicles.yaml`.

Which kind of vehicle a name is of, the vocabulary of sgcad_core says, as it does where a report is read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from random import Random

from research.generator.records import Phrase, records
from sgcad_core.reading.actors.makes import kind_of

KIND_WEIGHTS = {"car": 58.0, "suv": 15.0, "pickup": 11.0, "van": 8.0, "truck": 4.0, "motorcycle": 2.5, "bus": 1.0}
COLORS = [phrase.text for phrase in records("vehicles")["COLOR"]["counted"]]
YEARS = range(1986, 2008)


def model_text(rng: Random, kind: str) -> str:
    """Make and model alone."""
    return rng.choice(models().get(kind, (kind,)))


def body_text(rng: Random, kind: str) -> str:
    """A body type in the words of investigators."""
    return rng.choice(bodies()[kind])


@cache
def models() -> Mapping[str, tuple[str, ...]]:
    """Kind -> makes and models in the order of the file."""
    return by_kind(records("vehicles")["MODEL"]["counted"])


@cache
def bodies() -> Mapping[str, tuple[str, ...]]:
    """Kind -> body types in the order of the file, each as often as it counts."""
    return by_kind(records("vehicles")["BODY"]["counted"])


def by_kind(phrases: Iterable[Phrase]) -> dict[str, tuple[str, ...]]:
    """Phrases by the kind of vehicle that the vocabulary says they name, or that they are said to need."""
    found: dict[str, tuple[str, ...]] = {}
    for one in phrases:
        kind = one.needs[0] if one.needs else kind_told(one.text)
        found[kind] = found.get(kind, ()) + (one.text,) * one.weight
    return found


def kind_told(text: str) -> str:
    """The kind of vehicle that a name of one says: "Ford Explorer" -> "suv"; "car" where no word says another."""
    return kind_of(text, text.partition(" ")[2] or None)[0]
