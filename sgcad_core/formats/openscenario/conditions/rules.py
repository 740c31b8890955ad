"""What conditions share: comparisons, and the families that their elements belong to."""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON
from sgcad_core.formats.openscenario.reading.elements import XmlNode

Test = Callable[[Scene], bool]
OfEntity = Callable[[Scene, str], bool]
BY_VALUE: Family[Test] = Family("condition by value")
BY_ENTITY: Family[OfEntity] = Family("condition by entity")

RULES: dict[str, Callable[[float, float], bool]] = {
    "greaterThan": lambda a, b: a > b + EPSILON,
    "greaterOrEqual": lambda a, b: a >= b - EPSILON,
    "lessThan": lambda a, b: a < b - EPSILON,
    "lessOrEqual": lambda a, b: a <= b + EPSILON,
    "equalTo": lambda a, b: abs(a - b) <= EPSILON,
    "notEqualTo": lambda a, b: abs(a - b) > EPSILON,
}


def rule(node: XmlNode) -> Callable[[float], bool]:
    """A number's comparison with the condition's `value`."""
    compare, value = RULES[node.choice("rule", RULES)], node.number("value")
    return lambda found: compare(found, value)


def rule_of_text(node: XmlNode) -> Callable[[str], bool]:
    """A value's comparison: as numbers where both are, else as words, which are equal or not."""
    name, value = node.choice("rule", RULES), node.text("value")

    def holds(found: str) -> bool:
        numbers = _number(found), _number(value)
        if numbers[0] is not None and numbers[1] is not None:
            return RULES[name](numbers[0], numbers[1])
        same = found.strip() == value.strip()
        return same if name in ("equalTo", "greaterOrEqual", "lessOrEqual") else name == "notEqualTo" and not same

    return holds


def _number(text: str) -> float | None:
    try:
        value = float({"true": "1", "false": "0"}.get(text.strip(), text))
    except ValueError:
        return None
    return value if math.isfinite(value) else None
