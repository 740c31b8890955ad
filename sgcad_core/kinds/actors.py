"""Kinds of actors, one record each: sizes, masses, what they do, what files and drawings make of them.

Everything that is known of a kind stands in its record; all other code asks the record, so that a new kind is one entry
in `ACTORS` and the words by which reports call it (`body` and `road_user` in `sgcad_core/reading/language/vocabulary`).
Plain data: knows no pydantic, no narrative and no file format. SI units.

Sizes are typical of the U.S. fleet of 1990 to 2007, masses are those on the road: with a driver or rider, without load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

Sort = Literal["vehicle", "person", "animal", "thing"]
Symbol = Literal["car", "wagon", "pickup", "truck", "bus", "motorcycle", "bicycle", "person", "thing"]
Outline = Literal["cab", "box", "round"]


class Overhang(NamedTuple):
    """From a bumper to the nearest axle: share of the length, and the most metres that it grows to."""

    share: float
    most_m: float

    def of(self, length_m: float) -> float:
        """Metres on a body of this length."""
        return min(self.share * length_m, self.most_m)


class Axles(NamedTuple):
    """Where the first and the last axle stand, and the diameter of the wheels."""

    front: Overhang
    rear: Overhang
    wheel_m: float = 0.65


@dataclass(frozen=True, kw_only=True)
class ActorRecord:
    """All that is known of a kind of actor."""

    id: str
    called: str
    sort: Sort = "vehicle"
    letter: str = "V"
    """Of its id where the report gives no number (see the contract of result.json)."""
    learned: bool = False
    """Whether the embedded model knows it: its answer schema has these kinds alone, in the order of `ACTORS`."""

    length_m: float
    width_m: float
    height_m: float
    mass_kg: float
    towed_kg_per_m: float = 150.0
    """Of a longer one: the rest is what it tows."""
    axles: Axles | None = None
    """None: it has no wheels, and turns as it likes."""
    max_speed_mps: float = 70.0
    max_acceleration_mps2: float = 12.0
    max_deceleration_mps2: float = 12.0
    """Bounds for players, not what it usually does."""

    driven: bool = False
    """Whether a driver can be put into it: it is steered, and goes with the traffic."""
    exposed: bool = False
    """Whether a person is struck, not a body around one: on foot or on a light two-wheeler."""
    tumbles: bool = False
    """Whether it slides over the ground on its side when it is struck."""
    keeps_right: bool = False
    """Whether it rides at the right edge of its road."""
    large: bool = False
    """Whether "the truck" may mean it where no other is told."""
    pulled: bool = False
    pace_mps: float | None = None
    """Its usual speed whatever the limit; None: that of the road."""
    trailer_m: float | None = None
    """Length of a usual trailer behind it; None: it tows none."""
    mixed_with: str = ""
    """The kind for which reports take it."""

    category: str
    """Of the vehicle, pedestrian or thing in OpenSCENARIO, in the spelling of the standard."""
    also: tuple[str, ...] = ()
    """Further categories there that are played as this kind."""
    blueprint: str = "vehicle.tesla.model3"
    """In CARLA."""
    symbol: Symbol = "car"
    """In a crash diagram."""
    drawn_m: tuple[float, float]
    """Length and width there: what is small is drawn larger than it is, so that it can be told apart."""

    def __post_init__(self) -> None:
        """Raises ValueError for a vehicle without axles and for anything else with them."""
        if (self.sort == "vehicle") != (self.axles is not None):
            raise ValueError(f"kind {self.id}: give every vehicle axles, and nothing else (a {self.sort})")

    @property
    def size(self) -> tuple[float, float]:
        """Usual length and width, metres."""
        return self.length_m, self.width_m

    @property
    def taken_for(self) -> str:
        """What reports call it, as far as they tell it from others."""
        return self.mixed_with or self.id

    @property
    def walks(self) -> bool:
        """Whether it goes on feet: across lanes, and turning on the spot."""
        return self.sort in ("person", "animal")

    @property
    def thing(self) -> bool:
        """Whether it stands where it is: a tree, a pole."""
        return self.sort == "thing"

    @property
    def laneless(self) -> bool:
        """Whether no lane holds it."""
        return self.walks or self.thing

    @property
    def wheeled(self) -> bool:
        """Whether it rolls, so that not every motion can be driven."""
        return self.axles is not None

    @property
    def drives(self) -> bool:
        """Whether it is a vehicle that moves by itself."""
        return self.sort == "vehicle" and not self.pulled

    @property
    def motor(self) -> bool:
        """Whether it is a vehicle with a motor and a seat for its driver."""
        return self.drives and not self.exposed

    @property
    def ridden(self) -> bool:
        """Whether it is ridden, not driven: "the rider of"."""
        return self.tumbles and not self.walks

    @property
    def usual(self) -> bool:
        """Whether it is one of those that a report's "vehicle" is taken for: a light one with four wheels."""
        return self.trailer_m is not None and not self.large

    @property
    def hauls(self) -> bool:
        """Whether a trailer on its road is likely to be its own."""
        return self.trailer_m is not None and self.trailer_m >= 5.0

    @property
    def outline(self) -> Outline:
        """In players: a box with a windshield, a plain box, a disk."""
        if self.walks:
            return "round"
        return "box" if self.thing or self.pulled else "cab"


_RECORDS = (
    # 1,450 kg: EPA's trends reports give cars of 1990 to 2007 a test weight of 3,050 to 3,550 lb, which is the curb
    # weight and 300 lb; 3,000 lb (1,360 kg) and a driver.
    ActorRecord(
        id="car", called="a car", learned=True, length_m=4.7, width_m=1.8, height_m=1.5, mass_kg=1450.0,
        axles=Axles(Overhang(0.20, 1.0), Overhang(0.21, 1.2)), driven=True, trailer_m=4.0, category="car",
        drawn_m=(4.8, 2.0),
    ),
    ActorRecord(
        id="suv", called="an SUV", learned=True, length_m=4.8, width_m=1.9, height_m=1.8, mass_kg=1900.0,
        axles=Axles(Overhang(0.19, 1.0), Overhang(0.21, 1.2)), driven=True, trailer_m=5.0, mixed_with="car",
        category="car", symbol="wagon", drawn_m=(4.9, 2.1),
    ),
    ActorRecord(
        id="pickup", called="a pickup truck", learned=True, length_m=5.6, width_m=2.0, height_m=1.8, mass_kg=2100.0,
        axles=Axles(Overhang(0.17, 1.0), Overhang(0.21, 1.4)), driven=True, trailer_m=5.5, category="car",
        symbol="pickup", drawn_m=(5.6, 2.1),
    ),
    ActorRecord(
        id="van", called="a van", learned=True, length_m=5.2, width_m=2.0, height_m=2.0, mass_kg=2000.0,
        axles=Axles(Overhang(0.18, 1.0), Overhang(0.21, 1.4)), driven=True, trailer_m=5.0, mixed_with="car",
        category="van", blueprint="vehicle.mercedes.sprinter", symbol="wagon", drawn_m=(5.1, 2.1),
    ),
    # A straight truck; 9,000 kg: between FHWA's medium (10,001 lb) and heavy (26,001 lb) classes. A long one is a
    # combination on one box: its last axle is the trailer's, whose overhang does not grow with the length.
    ActorRecord(
        id="truck", called="a truck", learned=True, length_m=9.0, width_m=2.5, height_m=3.5, mass_kg=9000.0,
        towed_kg_per_m=900.0, axles=Axles(Overhang(0.15, 1.4), Overhang(0.22, 2.5), 1.0), driven=True, large=True,
        trailer_m=11.0, category="truck", blueprint="vehicle.carlamotors.firetruck", symbol="truck",
        drawn_m=(13.0, 2.7),
    ),
    # A 40 ft transit bus (AASHTO's CITY-BUS); 13,000 kg: curb weights of 26,000 to 29,000 lb, and some passengers.
    ActorRecord(
        id="bus", called="a bus", learned=True, length_m=11.5, width_m=2.55, height_m=3.2, mass_kg=13000.0,
        towed_kg_per_m=900.0, axles=Axles(Overhang(0.22, 2.7), Overhang(0.27, 3.4), 1.0), driven=True, large=True,
        category="bus", blueprint="vehicle.mitsubishi.fusorosa", symbol="bus", drawn_m=(11.0, 2.7),
    ),
    # 280 kg: 200 kg of machine and a rider, as the bicycle has its rider; 250 kg would leave him 50.
    ActorRecord(
        id="motorcycle", called="a motorcycle", learned=True, length_m=2.2, width_m=0.8, height_m=1.4, mass_kg=280.0,
        axles=Axles(Overhang(0.15, 0.4), Overhang(0.17, 0.45)), driven=True, tumbles=True, category="motorbike",
        blueprint="vehicle.yamaha.yzf", symbol="motorcycle", drawn_m=(3.4, 1.5),
    ),
    ActorRecord(
        id="bicycle", called="a bicycle", letter="B", learned=True, length_m=1.8, width_m=0.6, height_m=1.7,
        mass_kg=90.0, axles=Axles(Overhang(0.19, 0.4), Overhang(0.19, 0.4)), exposed=True, tumbles=True,
        keeps_right=True, pace_mps=5.5, category="bicycle", blueprint="vehicle.gazelle.omafiets", symbol="bicycle",
        drawn_m=(3.0, 1.3),
    ),
    ActorRecord(
        id="pedestrian", called="a pedestrian", sort="person", letter="P", learned=True, length_m=0.5, width_m=0.6,
        height_m=1.75, mass_kg=75.0, exposed=True, tumbles=True, pace_mps=1.5, category="pedestrian",
        blueprint="walker.pedestrian.0001", symbol="person", drawn_m=(1.2, 1.2),
    ),
    # 6,000 kg: empty vans of 40 to 53 ft weigh 12,500 to 14,000 lb (FHWA, Comprehensive Truck Size and Weight Limits
    # Study, 2015). The front "axle" is its kingpin.
    ActorRecord(
        id="trailer", called="a trailer", letter="T", learned=True, length_m=12.0, width_m=2.5, height_m=3.5,
        mass_kg=6000.0, axles=Axles(Overhang(0.08, 1.0), Overhang(0.22, 2.8), 1.0), pulled=True, category="trailer",
        also=("semitrailer",), blueprint="static.prop.container", symbol="wagon", drawn_m=(10.0, 2.6),
    ),
    # The mass is for files; in a crash what stands by a road is fixed to the ground.
    ActorRecord(
        id="object", called="an object", sort="thing", letter="O", learned=True, length_m=0.5, width_m=0.5,
        height_m=1.0, mass_kg=100.0, category="obstacle", blueprint="static.prop.barrel", symbol="thing",
        drawn_m=(1.4, 1.4),
    ),
    # 49 CFR 571.500: below 20 mph, a low-speed vehicle below 25. Size and axles of a two-seater (1.67 m of wheelbase);
    # mass with lead batteries and a driver.
    ActorRecord(
        id="golf_cart", called="a golf cart", length_m=2.4, width_m=1.2, height_m=1.8, mass_kg=500.0,
        axles=Axles(Overhang(0.12, 0.4), Overhang(0.18, 0.5), 0.45), max_speed_mps=15.0, max_acceleration_mps2=4.0,
        max_deceleration_mps2=8.0, driven=True, pace_mps=5.4, category="car", symbol="wagon", drawn_m=(3.4, 1.7),
    ),
    # A streetcar of 66 ft by 8 ft as U.S. cities run since 2001, 29 t empty, on two trucks; longer ones are coupled
    # cars. It follows its rails: nobody steers it.
    ActorRecord(
        id="tram", called="a tram", length_m=20.1, width_m=2.46, height_m=3.5, mass_kg=30000.0, towed_kg_per_m=1450.0,
        axles=Axles(Overhang(0.22, 4.4), Overhang(0.22, 4.4)), max_speed_mps=25.0, max_acceleration_mps2=2.0,
        max_deceleration_mps2=4.0, category="tram", also=("train",),
        blueprint="vehicle.mitsubishi.fusorosa", symbol="bus", drawn_m=(20.1, 2.7),
    ),
    # A rental of 1.2 m and 20 kg; width, height and most of the mass are the standing rider's.
    ActorRecord(
        id="e_scooter", called="an e-scooter", letter="B", length_m=1.2, width_m=0.6, height_m=1.9, mass_kg=95.0,
        axles=Axles(Overhang(0.14, 0.3), Overhang(0.16, 0.3), 0.25), max_speed_mps=12.0, max_acceleration_mps2=3.0,
        max_deceleration_mps2=6.0, exposed=True, tumbles=True, keeps_right=True, pace_mps=4.5, category="bicycle",
        blueprint="vehicle.gazelle.omafiets", symbol="bicycle", drawn_m=(2.4, 1.3),
    ),
)  # fmt: skip
ACTORS: dict[str, ActorRecord] = {record.id: record for record in _RECORDS}
"""By id. Overhangs are as on common models: a car of 4.7 m stands on 2.8 m of wheelbase, its center 1.36 m before the
rear axle."""


def actor_kind(kind: str) -> ActorRecord:
    """The record of a kind. Raises KeyError for one that there is not."""
    return ACTORS[kind]


UNNUMBERED = "N"
"""First letter of a vehicle without a number, where the report numbers others: "V2" is the report's own vehicle 2."""


def is_vehicle_id(name: str) -> bool:
    """Whether an id is that of a vehicle, with a number in the report or without one."""
    return name[:1] in ("V", UNNUMBERED)


def kind_of_letter(letter: str) -> str:
    """The kind that an actor is unless more is said, by the letter of its id: the first that has it, else a thing."""
    letter = "V" if letter == UNNUMBERED else letter
    return next((r.id for r in ACTORS.values() if r.letter == letter), next(r.id for r in ACTORS.values() if r.thing))


def learned_actors() -> tuple[str, ...]:
    """Ids of the kinds that the embedded model knows, in the order of its answer schema."""
    return tuple(record.id for record in ACTORS.values() if record.learned)


def mass_kg(kind: str, length_m: float) -> float:
    """The mass of an actor of that length with what it tows."""
    record = ACTORS[kind]
    return record.mass_kg + max(length_m - record.length_m - 2.0, 0.0) * record.towed_kg_per_m
