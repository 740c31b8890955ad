"""ParameterValueDistribution files: the parameter sets that a scenario is to be played with.

Deterministic sets are the product of the distributions; of stochastic ones so many are drawn as the file says, by the
file's own seed. None is made before it is asked for. Knows no file system.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable, Iterator

from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.reading.elements import MAX_PARAMETERS, XmlNode

MAX_SETS = 10_000
MAX_VALUES = 10_000
Given = dict[str, str]
Draw = Callable[[random.Random], str]
STOCHASTIC: Family[Draw] = Family("stochastic distribution")
STOCHASTIC.refuses("UserDefinedDistribution", remark="it is the user's own", remedy="use a standard distribution")


def scenario_file(root: XmlNode) -> str | None:
    """The scenario that a distribution file varies; None for a file that is no distribution."""
    holder = root.find("ParameterValueDistribution")
    return None if holder is None else holder.need("ScenarioFile").text("filepath")


class ParameterSets:
    """Parameter sets in order, at least one and at most 10000; each is drawn when it is its turn."""

    def __init__(self, root: XmlNode) -> None:
        """Raises InvalidOutput, Unsupported."""
        holder = root.need("ParameterValueDistribution")
        found = holder.find("Deterministic")
        self._count, self._drawn = _deterministic(found) if found else _stochastic(holder.need("Stochastic"))

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[Given]:
        """The sets from the first on. Raises InvalidOutput where drawing them takes too much."""
        return self._drawn()


Drawn = Callable[[], Iterator[Given]]


def _deterministic(holder: XmlNode) -> tuple[int, Drawn]:
    axes = [_axis(node) for node in holder.children()]
    count = 1
    for axis in axes:
        count *= len(axis)
        if not 1 <= count <= MAX_SETS:
            what = f"makes at least {count} parameter sets, at most {MAX_SETS} are played"
            raise holder.fault(what, remedy="vary fewer values")
    _count_parameters(holder, sum(len(axis[0]) for axis in axes))

    def drawn() -> Iterator[Given]:
        for parts in itertools.product(*axes):
            holder.spend("drawn values", sum(map(len, parts)))
            yield {k: v for part in parts for k, v in part.items()}

    return count, drawn


def _count_parameters(holder: XmlNode, count: int) -> None:
    if count > MAX_PARAMETERS:
        raise holder.fault(f"varies more than {MAX_PARAMETERS} parameters", str(count), "vary fewer")


def _axis(node: XmlNode) -> list[Given]:
    if node.tag == "DeterministicSingleParameterDistribution":
        name, inner = node.naming("parameterName"), node.only()
        return [{name: value} for value in _values(inner)]
    if node.tag != "DeterministicMultiParameterDistribution":
        raise node.unsupported()
    holder = node.find("ValueSetDistribution")
    if holder is None:
        raise node.only().unsupported("user-defined distributions are the user's own", "list the values")
    sets = [
        {a.naming("parameterRef"): a.text("value") for a in values.children("ParameterAssignment")}
        for values in holder.children("ParameterValueSet")
    ]
    if not sets:
        raise holder.fault("holds no <ParameterValueSet>")
    return sets


def _values(node: XmlNode) -> list[str]:
    if node.tag == "DistributionSet":
        values = [e.text("value") for e in node.children("Element")]
    elif node.tag == "DistributionRange":
        values = list(_range(node))
    else:
        raise node.unsupported("user-defined distributions are the user's own", "list the values")
    if not 1 <= len(values) <= MAX_VALUES:
        raise node.fault(f"needs 1 to {MAX_VALUES} values", str(len(values)))
    return values


def _range(node: XmlNode) -> Iterator[str]:
    limits, step = node.need("Range"), node.positive("stepWidth")
    low, high = limits.number("lowerLimit"), limits.number("upperLimit")
    count = int((high - low) / step + 1e-9) + 1
    if not 1 <= count <= MAX_VALUES:
        raise node.fault(f"needs 1 to {MAX_VALUES} values", str(count))
    node.spend("listed values", count)
    return (f"{low + i * step:.12g}" for i in range(count))


# ------------------------------------------------------------------ stochastic
def _stochastic(holder: XmlNode) -> tuple[int, Drawn]:
    count = holder.whole("numberOfTestRuns")
    if not 1 <= count <= MAX_SETS:
        raise holder.fault(f"'numberOfTestRuns' must lie within 1 and {MAX_SETS}", str(count))
    nodes = holder.children("StochasticDistribution")
    _count_parameters(holder, len(nodes))
    draws = {node.naming("parameterName"): STOCHASTIC.compile(node.only()) for node in nodes}
    seed = holder.text("randomSeed", "0")

    def drawn() -> Iterator[Given]:
        rng = random.Random(seed)
        for _ in range(count):
            holder.spend("drawn values", len(draws))
            yield {name: draw(rng) for name, draw in draws.items()}

    return count, drawn


def _within(node: XmlNode) -> tuple[float, float]:
    limits = node.find("Range")
    low, high = (limits.number("lowerLimit"), limits.number("upperLimit")) if limits else (-1e9, 1e9)
    if low > high:
        raise node.fault("the range is empty", f"{low:g} to {high:g}")
    return low, high


@STOCHASTIC.plays("NormalDistribution", "LogNormalDistribution", remark="cut to its range")
def _normal(node: XmlNode) -> Draw:
    low, high = _within(node)
    mean, spread = node.number("expectedValue"), node.positive("variance") ** 0.5
    logarithmic = node.tag == "LogNormalDistribution"

    def draw(rng: random.Random) -> str:
        value = rng.normalvariate(mean, spread) if logarithmic else rng.gauss(mean, spread)
        if logarithmic:  # what is above e^700 is above every range
            value = math.exp(min(value, 700.0))
        return f"{min(max(value, low), high):.12g}"

    return draw


@STOCHASTIC.plays("UniformDistribution")
def _uniform(node: XmlNode) -> Draw:
    low, high = _within(node)
    return lambda rng: f"{rng.uniform(low, high):.12g}"


@STOCHASTIC.plays("PoissonDistribution", remark="cut to its range")
def _poisson(node: XmlNode) -> Draw:
    low, high = _within(node)
    mean = node.positive("expectedValue")
    count = _few if mean < _MANY else _many
    return lambda rng: f"{min(max(count(rng, mean), low), high):.12g}"


_MANY = 30.0
"""From this mean on a draw takes the same time whatever the mean."""


def _few(rng: random.Random, mean: float) -> int:
    """A Poisson number by the waiting times between events."""
    count, passed = 0, rng.expovariate(1.0)
    while passed < mean:
        count, passed = count + 1, passed + rng.expovariate(1.0)
    return count


def _many(rng: random.Random, mean: float) -> int:
    """A Poisson number by transformed rejection: W. Hoermann, Insurance: Mathematics and Economics 12 (1993), PTRS."""
    b = 0.931 + 2.53 * math.sqrt(mean)
    a, inverse = -0.059 + 0.02483 * b, 1.1239 + 1.1328 / (b - 3.4)
    while True:
        u, v = rng.random() - 0.5, 1.0 - rng.random()
        edge = 0.5 - abs(u)
        if edge <= 0:
            continue
        k = math.floor((2 * a / edge + b) * u + mean + 0.43)
        if edge >= 0.07 and v <= 0.9277 - 3.6224 / (b - 2):
            return k
        if k < 0 or (edge < 0.013 and v > edge):
            continue
        chance = k * math.log(mean) - mean - math.lgamma(k + 1)
        if math.log(v * inverse / (a / edge**2 + b)) <= chance:
            return k


@STOCHASTIC.plays("ProbabilityDistributionSet")
def _set(node: XmlNode) -> Draw:
    entries = node.children("Element")
    values, weights = [e.text("value") for e in entries], [e.number("weight") for e in entries]
    if not values or min(weights) < 0 or sum(weights) <= 0:
        raise node.fault("needs elements with weights from 0 on, one above 0")
    summed = list(itertools.accumulate(weights))
    return lambda rng: rng.choices(values, cum_weights=summed)[0]


@STOCHASTIC.plays("Histogram")
def _histogram(node: XmlNode) -> Draw:
    bins = node.children("HistogramBin")
    weights = [b.number("weight") for b in bins]
    spans = [_within(b) for b in bins]
    if not bins or min(weights) < 0 or sum(weights) <= 0:
        raise node.fault("needs bins with weights from 0 on, one above 0")
    summed = list(itertools.accumulate(weights))
    return lambda rng: f"{rng.uniform(*rng.choices(spans, cum_weights=summed)[0]):.12g}"
