"""Makes, body words and well-known models of the U.S. fleet, and the kind of vehicle they mean.

General knowledge, no report. Knows no sentence.
"""

from __future__ import annotations

import re

from sgcad_core.specs import ActorKind

COLORS = (
    "red", "blue", "white", "black", "silver", "gray", "grey", "green", "gold", "tan", "brown", "maroon", "beige",
    "yellow",
    "orange", "purple", "burgundy", "dark", "light", "teal", "bronze", "cream",
)  # fmt: skip

_MAKE_NAMES = (
    "Acura", "Audi", "BMW", "Buick", "Cadillac", "Chevrolet", "Chrysler", "Daewoo", "Datsun", "Dodge", "Eagle",
    "Ferrari", "Fiat",
    "Ford", "Freightliner", "Geo", "GMC", "Harley-Davidson", "Harley Davidson", "Harley", "Hino", "Honda", "Hummer",
    "Hyundai",
    "Infiniti", "Isuzu", "Jaguar", "Jeep", "Kawasaki", "Kenworth", "Kia", "Land Rover", "Lexus", "Lincoln", "Mack",
    "Mazda",
    "Mercury", "Mini Cooper", "Mitsubishi", "Nissan", "Oldsmobile", "Peterbilt", "Plymouth", "Pontiac", "Porsche",
    "Ram",
    "Range Rover", "Saab", "Saturn", "Scion", "Sterling", "Subaru", "Suzuki", "Tesla", "Thomas", "Toyota", "Triumph",
    "Volkswagen",
    "Volvo", "Western Star", "Yamaha", "Blue Bird", "Bluebird", "Ducati", "AMC", "Rover", "Utilimaster", "Genesis",
)  # fmt: skip
MAKES: dict[str, str] = {name.lower(): name for name in _MAKE_NAMES} | {
    "chevy": "Chevrolet", "chevorlet": "Chevrolet", "chevolet": "Chevrolet", "chrevolet": "Chevrolet", "cheverolet":
    "Chevrolet",
    "vw": "Volkswagen", "volkswagon": "Volkswagen", "olds": "Oldsmobile", "mercedes-benz": "Mercedes", "mercedes benz":
    "Mercedes",
    "mercedes": "Mercedes", "caddy": "Cadillac", "infinity": "Infiniti", "hundai": "Hyundai", "hyndai": "Hyundai",
    "mitsubushi": "Mitsubishi", "toyta": "Toyota", "nisan": "Nissan", "pontaic": "Pontiac", "international":
    "International",
    "infinti": "Infiniti", "suburu": "Subaru", "freighliner": "Freightliner",
}  # fmt: skip
"""Lower-case spelling -> make."""

BODY_WORDS: dict[str, ActorKind] = {
    "pickup truck": "pickup", "pickup": "pickup", "extended cab pickup": "pickup", "crew cab pickup": "pickup",
    "sport utility vehicle": "suv", "sports utility vehicle": "suv", "sport utility": "suv", "utility vehicle": "suv",
    "suv": "suv",
    "minivan": "van", "mini-van": "van", "mini van": "van", "cargo van": "van", "conversion van": "van",
    "passenger van": "van",
    "van": "van",
    "tractor-trailer": "truck", "tractor trailer": "truck", "semi-truck": "truck", "semi truck": "truck",
    "semi-tractor": "truck",
    "semi": "truck", "truck tractor": "truck", "truck-tractor": "truck", "tractor": "truck", "box truck": "truck",
    "straight truck": "truck", "dump truck": "truck", "garbage truck": "truck", "tow truck": "truck", "flatbed":
    "truck",
    "cement truck": "truck", "delivery truck": "truck", "fire truck": "truck", "big rig": "truck", "truck": "truck",
    "18-wheeler": "truck", "concrete mixer": "truck", "tanker": "truck",
    "school bus": "bus", "transit bus": "bus", "bus": "bus",
    "motorcycle": "motorcycle", "motorbike": "motorcycle", "moped": "motorcycle", "scooter": "motorcycle",
    "sedan": "car", "coupe": "car", "hatchback": "car", "station wagon": "car", "wagon": "car", "convertible": "car",
    "car": "car",
    "taxicab": "car", "taxi": "car", "cab": "car", "passenger car": "car", "limousine": "car",
}  # fmt: skip
"""Lower-case body word -> kind."""

_MAKE_KIND: dict[str, ActorKind] = {
    "freightliner": "truck", "kenworth": "truck", "mack": "truck", "peterbilt": "truck", "international": "truck",
    "hino": "truck",
    "sterling": "truck", "western star": "truck", "kawasaki": "motorcycle", "yamaha": "motorcycle", "harley":
    "motorcycle",
    "harley-davidson": "motorcycle", "ducati": "motorcycle", "triumph": "motorcycle", "bluebird": "bus", "blue bird":
    "bus",
    "thomas": "bus", "jeep": "suv", "hummer": "suv", "land rover": "suv", "range rover": "suv", "ram": "pickup",
}  # fmt: skip
_MODEL_KIND: dict[ActorKind, tuple[str, ...]] = {
    "suv": (
        "explorer", "expedition", "escape", "excursion", "bronco", "blazer", "trailblazer", "tahoe", "suburban",
        "yukon", "jimmy",
        "envoy", "durango", "4runner", "rav4", "rav-4", "highlander", "sequoia", "land cruiser", "pathfinder",
        "xterra", "murano",
        "cr-v", "crv", "pilot", "passport", "element", "mdx", "rx300", "rx 300", "rx330", "rx", "gx", "tribute",
        "rodeo", "trooper",
        "mountaineer", "navigator", "aviator", "escalade", "rendezvous", "aztek", "santa fe", "tucson", "sportage",
        "sorento",
        "forester", "montero", "outlander", "grand vitara", "vitara", "sidekick", "tracker", "vue", "equinox",
        "bravada", "qx4",
        "fx35", "x5", "x3", "ml320", "ml350", "xc90", "grand cherokee", "cherokee", "wrangler", "liberty", "touareg",
        "freestyle",
    ),
    "pickup": (
        "f150", "f-150", "f250", "f-250", "f350", "f-350", "ranger", "silverado", "s10", "s-10", "colorado", "sierra",
        "sonoma",
        "canyon", "dakota", "ram", "tacoma", "tundra", "frontier", "titan", "t100", "c10", "c1500", "k1500", "k3500",
        "k2500",
        "c2500", "ridgeline", "avalanche", "b2300", "b2300", "b3000", "hardbody", "sport trac",
    ),
    "van": (
        "caravan", "grand caravan", "voyager", "town and country", "windstar", "freestar", "aerostar", "sienna",
        "previa", "odyssey",
        "quest", "villager", "astro", "safari", "venture", "montana", "trans sport", "silhouette", "mpv", "sedona",
        "express",
        "savana", "econoline", "e-150", "e150", "e-250", "e250", "e-350", "e350", "ram van", "lumina apv", "uplander",
        "g10", "g20",
    ),
    "truck": ("f650", "f-650", "f750", "f-750", "379", "4300", "4700", "w900", "columbia", "cascadia", "century class"),
    "motorcycle": ("ninja", "gold wing", "goldwing", "shadow", "sportster", "cbr", "gsxr", "gsx-r", "vulcan",
    "hayabusa"),
}  # fmt: skip


def kind_of(words: str, model: str | None) -> tuple[ActorKind, bool]:
    """Kind of vehicle from its description, and whether a body word states it."""
    text = words.lower()
    for body in sorted(BODY_WORDS, key=len, reverse=True):
        if re.search(rf"(?<![\w-]){re.escape(body)}(?![\w-])", text):
            if BODY_WORDS[body] == "truck" and body == "truck" and _by_model(text, model) == "pickup":
                return "pickup", True
            return BODY_WORDS[body], True
    return _by_model(text, model) or _by_make(text) or "car", False


def _by_model(text: str, model: str | None) -> ActorKind | None:
    name = (model or "").lower()
    for kind, models in _MODEL_KIND.items():
        if any(
            name == m or name.startswith(m + " ") or re.search(rf"(?<![\w-]){re.escape(m)}(?![\w-])", text)
            for m in models
        ):
            return kind
    return None


def _by_make(text: str) -> ActorKind | None:
    return next((k for make, k in _MAKE_KIND.items() if re.search(rf"\b{make}\b", text)), None)
