"""Queues event by event: reports that arrive at random pass stations with several servers each.

`Station` is a queue with several servers (cores of workers, the Prefect server, the tracker, the storage, GPUs);
`simulate` sends reports through stations one after the other, event by event (heapq, seeded). Reports arrive at
random (Poisson), by day and night alike or with a peak hour; service times are drawn around measured means.
`erlang_c` is the closed form for one station with exponential service, against which the simulation is tested.

Knows no project code: stage times come in as numbers.
"""

from __future__ import annotations

import heapq
import math
import random
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

DAY_S = 86_400.0
PEAK = 1.9
"""The busiest hour's rate against the day's mean."""


@dataclass(frozen=True)
class Station:
    """A part that every report passes: so many servers, each busy for about `seconds` a report.

    `variation` is the coefficient of variation of service times (1: exponential, below 0.001: all alike).
    """

    name: str
    servers: int
    seconds: float
    variation: float = 1.0

    @property
    def capacity(self) -> float:
        """Reports a second with every server busy."""
        return self.servers / self.seconds

    def draw(self, dice: random.Random) -> float:
        """One service time, s: gamma with the station's mean and variation."""
        if self.variation < 1e-3:
            return self.seconds
        shape = 1 / self.variation**2
        return dice.gammavariate(shape, self.seconds / shape)


@dataclass
class Seen:
    """What a simulation saw of one station."""

    station: Station
    busy_s: float = 0.0
    waits: list[float] = field(default_factory=list)
    longest_queue: int = 0

    def utilisation(self, elapsed_s: float) -> float:
        """Share of the servers' time spent working."""
        return self.busy_s / (self.station.servers * elapsed_s)

    @property
    def mean_wait(self) -> float:
        """Mean seconds in the queue."""
        return sum(self.waits) / len(self.waits) if self.waits else 0.0

    def quantile(self, share: float) -> float:
        """Seconds that this share of reports waits at most."""
        ordered = sorted(self.waits)
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else 0.0


@dataclass(frozen=True)
class Outcome:
    """A whole simulation: stations as seen, end-to-end seconds a report, seconds until the last was done."""

    seen: tuple[Seen, ...]
    through: tuple[float, ...]
    elapsed_s: float


def arrivals(
    per_day: float, reports: int, dice: random.Random, shape: Callable[[float], float] | None = None
) -> Iterator[float]:
    """Arrival times, s. `shape` of the hour (0 to 24) multiplies the rate; its mean over a day should be 1.

    With a shape by thinning (Lewis and Shedler 1979), whose bound is twice the mean rate: a shape stays below 2.
    """
    rate, t, done = per_day / DAY_S, 0.0, 0
    bound = 2.0 if shape else 1.0
    while done < reports:
        t += dice.expovariate(rate * bound)
        if shape is None or dice.random() * bound < shape(t / 3600 % 24):
            yield t
            done += 1


def working_hours(hour: float) -> float:
    """A day that peaks at 14 h with 1.9 times the mean and ends at night with a tenth of it."""
    return 1 + (PEAK - 1) * math.cos((hour - 14) / 24 * 2 * math.pi)


def simulate(stations: Sequence[Station], times: Iterator[float] | Sequence[float], seed: int = 1) -> Outcome:
    """Send reports through the stations in order; first come, first served at each."""
    line = _Line(stations, random.Random(f"service {seed}"))  # never the arrivals' own numbers again
    for number, t in enumerate(times):
        line.begun[number] = t
        heapq.heappush(line.events, (t, number, 0, False))
    while line.events:
        line.step()
    return Outcome(tuple(line.seen), tuple(line.through), line.now)


class _Line:
    """The stations at work. An event is (time, report, station, whether a server has finished it)."""

    def __init__(self, stations: Sequence[Station], dice: random.Random) -> None:
        self.dice, self.now = dice, 0.0
        self.seen = [Seen(station) for station in stations]
        self.free = [station.servers for station in stations]
        self.queues: list[deque[tuple[float, int]]] = [deque() for _ in stations]
        self.events: list[tuple[float, int, int, bool]] = []
        self.begun: dict[int, float] = {}
        self.through: list[float] = []

    def step(self) -> None:
        """The next event."""
        self.now, report, place, finished = heapq.heappop(self.events)
        if finished:
            self._leave(report, place)
            return
        queue = self.queues[place]
        queue.append((self.now, report))
        self.seen[place].longest_queue = max(self.seen[place].longest_queue, len(queue))
        self._serve(place)

    def _leave(self, report: int, place: int) -> None:
        self.free[place] += 1
        if place + 1 < len(self.seen):
            heapq.heappush(self.events, (self.now, report, place + 1, False))
        else:
            self.through.append(self.now - self.begun.pop(report))
        self._serve(place)

    def _serve(self, place: int) -> None:
        queue, seen = self.queues[place], self.seen[place]
        while queue and self.free[place]:
            since, report = queue.popleft()
            self.free[place] -= 1
            seen.waits.append(self.now - since)
            seconds = seen.station.draw(self.dice)
            seen.busy_s += seconds
            heapq.heappush(self.events, (self.now + seconds, report, place, True))


def erlang_c(servers: int, rate: float, seconds: float) -> tuple[float, float]:
    """(probability that a report waits, mean wait in s) of M/M/c; Erlang 1917, by the stable recursion of Erlang B.

    Infinite where the servers cannot keep up.
    """
    load = rate * seconds
    if load >= servers:
        return 1.0, math.inf
    blocked = 1.0
    for n in range(1, servers + 1):
        blocked = load * blocked / (n + load * blocked)
    waits = servers * blocked / (servers - load * (1 - blocked))
    return waits, waits * seconds / (servers - load)


def servers_for(per_day: float, seconds: float, wait_s: float, peak: float = 1.0) -> int:
    """Fewest servers that keep the mean wait below `wait_s` at `peak` times the mean rate (M/M/c)."""
    rate = peak * per_day / DAY_S
    servers = max(1, math.floor(rate * seconds) + 1)
    while erlang_c(servers, rate, seconds)[1] > wait_s:
        servers += 1
    return servers
