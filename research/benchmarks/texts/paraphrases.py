"""Are plain facts read in words that no report used? Prints, for a file of paraphrases, what share is read right.

    python -m research.benchmarks.texts.paraphrases [FILE.yaml ...]

Without files: the paraphrases that rules are made with (seen) and the held-out ones, of which only totals are looked
at; then those in the styles of other writers, of which half, by the hash of the text, is held out. A paraphrase is a
text of a subject (V1) without numbers with what it tells: `me` and `them`, the maneuvers that are right for the subject
and for the actor that it met; `other`, that actor's id; `sides`, the sides of both that may touch; `junction`.
Looks at the reading alone: no road is drawn and nothing is planned.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from research.rows.coded_incidents import by_hash
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.reading import Reading, read

FOLDER = Path(__file__).resolve().parents[3] / "tests" / "sgcad_core" / "reading"
STYLES = FOLDER / "paraphrases_styles.yaml"
SEEN, HELD_OUT = FOLDER / "paraphrases.yaml", FOLDER / "paraphrases_held_out.yaml"
SUBJECT = "V1"


def paraphrases(file: Path) -> list[dict[str, Any]]:
    """The texts of a file with what they tell."""
    return list(yaml.safe_load(file.read_text(encoding="utf-8")))


def of_styles(*, held_out: bool) -> list[dict[str, Any]]:
    """One half of the texts in other writers' styles."""
    texts = paraphrases(STYLES)
    return [one for one in texts if by_hash(one["text"]) % 2 == held_out]


def judged(told: Mapping[str, Any]) -> dict[str, bool]:
    """What of a paraphrase is read right, field by field."""
    reading = read(told["text"])
    hit = next((c for c in reading.crash.contacts if SUBJECT in (c.striker, c.struck) and c.stated is not False), None)
    met = None if hit is None else hit.struck if hit.striker == SUBJECT else hit.striker
    found = {"other": met == told["other"]}
    for field, who in (("me", SUBJECT), ("them", met)):
        if field in told and (field == "me" or told["other"].startswith("V")):
            found[field] = _maneuver(reading, who) in told[field]
    if "sides" in told:
        found["sides"] = all(mine in may for mine, may in zip(_sides(hit), told["sides"], strict=True))
    if told.get("junction"):
        found["junction"] = reading.roads.junction.kind != "none"
    return found


def _maneuver(reading: Reading, who: str | None) -> str | None:
    vehicle = reading.crash.vehicle(who) if who else None
    return vehicle.maneuver if vehicle else None


def _sides(hit: ContactFacts | None) -> tuple[str | None, str | None]:
    """The subject's side and the other one's."""
    if hit is None:
        return None, None
    return (hit.striker_area, hit.struck_area) if hit.striker == SUBJECT else (hit.struck_area, hit.striker_area)


def line(name: str, told: Sequence[Mapping[str, Any]]) -> str:
    """The totals of some paraphrases."""
    right: Counter[str] = Counter()
    of: Counter[str] = Counter()
    for one in told:
        found = judged(one)
        for field, verdict in (found | {"whole": all(found.values())}).items():
            of[field] += 1
            right[field] += verdict
    return f"{name}: " + ", ".join(f"{field} {right[field]} of {of[field]}" for field in of)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line a file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE.yaml")
    files = parser.parse_args(arguments).files
    lines = [line(file.stem, paraphrases(file)) for file in files or [SEEN, HELD_OUT]]
    if not files:
        lines += [line(f"styles, {'held out' if held else 'seen'}", of_styles(held_out=held)) for held in (False, True)]
    print("\n".join(lines))  # noqa: T201 - a command prints


if __name__ == "__main__":
    main()
