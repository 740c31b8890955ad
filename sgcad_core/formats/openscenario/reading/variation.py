"""ParameterValueDistribution files: the parameter sets that a scenario is to be played with.

Deterministic sets are the product of the distributions; of stochastic ones so many are drawn as the file says, by the
file's own seed. Knows no file system.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator

from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.reading.elements import XmlNode

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


def parameter_sets(root: XmlNode) -> list[Given]:
    """Parameter sets in order, at least one and at most 10000. Raises InvalidOutput, Unsupported."""
    holder = root.need("ParameterValueDistribution")
    if found := holder.find("Deterministic"):
        return _deterministic(found)
    return _stochastic(holder.need("Stochastic"))


def _deterministic(holder: XmlNode) -> list[Given]:
    axes = [_axis(node) for node in holder.children()]
    count = 1
    for axis in axes:
        count *= len(axis)
    if not 1 <= count <= MAX_SETS:
        raise holder.fault(f"makes {count} parameter sets, at most {MAX_SETS} are played", remedy="vary fewer values")
    return [{k: v for part in parts for k, v in part.items()} for parts in itertools.product(*axes)]


def _axis(node: XmlNode) -> list[Given]:
    if node.tag == "DeterministicSingleParameterDistribution":
        name, inner = node.text("parameterName").lstrip("$"), node.only()
        return [{name: value} for value in _values(inner)]
    if node.tag != "DeterministicMultiParameterDistribution":
        raise node.unsupported()
    holder = node.find("ValueSetDistribution")
    if holder is None:
        raise node.only().unsupported("user-defined distributions are the user's own", "list the values")
    sets = [
        {a.text("parameterRef").lstrip("$"): a.text("value") for a in values.children("ParameterAssignment")}
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
    return (f"{low + i * step:.12g}" for i in range(count))


# ------------------------------------------------------------------ stochastic
def _stochastic(holder: XmlNode) -> list[Given]:
    count = holder.whole("numberOfTestRuns")
    if not 1 <= count <= MAX_SETS:
        raise holder.fault(f"'numberOfTestRuns' must lie within 1 and {MAX_SETS}", str(count))
    draws = {
        node.text("parameterName").lstrip("$"): STOCHASTIC.compile(node.only())
        for node in holder.children("StochasticDistribution")
    }
    rng = random.Random(holder.text("randomSeed", "0"))
    return [{name: draw(rng) for name, draw in draws.items()} for _ in range(count)]


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
    draw = random.Random.lognormvariate if node.tag == "LogNormalDistribution" else random.Random.gauss
    return lambda rng: f"{min(max(draw(rng, mean, spread), low), high):.12g}"


@STOCHASTIC.plays("UniformDistribution")
def _uniform(node: XmlNode) -> Draw:
    low, high = _within(node)
    return lambda rng: f"{rng.uniform(low, high):.12g}"


@STOCHASTIC.plays("PoissonDistribution", remark="cut to its range")
def _poisson(node: XmlNode) -> Draw:
    low, high = _within(node)
    mean = node.positive("expectedValue")

    def draw(rng: random.Random) -> str:
        count, passed = 0, rng.expovariate(1.0)
        while passed < min(mean, 1e4):
            count, passed = count + 1, passed + rng.expovariate(1.0)
        return f"{min(max(count, low), high):.12g}"

    return draw


@STOCHASTIC.plays("ProbabilityDistributionSet")
def _set(node: XmlNode) -> Draw:
    entries = node.children("Element")
    values, weights = [e.text("value") for e in entries], [e.number("weight") for e in entries]
    if not values or min(weights) < 0 or sum(weights) <= 0:
        raise node.fault("needs elements with weights from 0 on, one above 0")
    return lambda rng: rng.choices(values, weights)[0]


@STOCHASTIC.plays("Histogram")
def _histogram(node: XmlNode) -> Draw:
    bins = node.children("HistogramBin")
    weights = [b.number("weight") for b in bins]
    spans = [_within(b) for b in bins]
    if not bins or min(weights) < 0 or sum(weights) <= 0:
        raise node.fault("needs bins with weights from 0 on, one above 0")
    return lambda rng: f"{rng.uniform(*rng.choices(spans, weights)[0]):.12g}"
