"""One YAML = one experiment: parsed, put on its base, overridden, checked whole before anything starts.

Flat: one mapping a plugin, its `name` and its fields. A YAML may be the differences to another (`extends`): what is
checked, kept and fingerprinted is the whole. Knows the registry; no plugin, no flow.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, cast

import yaml
from pydantic import ConfigDict, Field, ValidationError

from sgcad_core import config_extends, config_faults, settings
from sgcad_core.case.density import NO_TRAFFIC
from sgcad_core.case.records import Record
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import (
    Backbone,
    Decoder,
    Driver,
    Plugin,
    ReportReader,
    Retriever,
    RoadWriter,
    ScenarioWriter,
    Simulator,
    Tracker,
    Validator,
)
from sgcad_core.kinds import CrashRole
from sgcad_core.near_names import did_you_mean
from sgcad_core.records.second_reader import LEARNED
from sgcad_core.registry import plugin_class
from sgcad_core.system.yaml_faults import YAML_FAULTS

SINGLE = ("report_reader", "retriever", "backbone", "decoder", "road_writer", "scenario_writer", "simulator", "tracker")
SCALARS = ("seed", "max_attempts", "show_findings", "hold_findings", "second_opinion", "ego", "traffic")
OPTIONAL = {"backbone", "decoder"}


class DriverEntry(Record):
    """A driver with the words that chose it; `label` names its results."""

    label: str
    driver: Driver
    raw: dict[str, Any]


class DriveStage(Record):
    """The stage `drive`: who is put into the crash that was written, in whose place."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    drivers: tuple[DriverEntry, ...] = Field(min_length=1)
    roles: tuple[CrashRole, ...] = ("initiator", "responder")
    role_of: Mapping[str, CrashRole] = {}
    """A person's word on who has which role, by actor; holds for every case."""
    release_s: float = Field(4.0, ge=0, le=30)


class Config(Record):
    """An experiment, ready to run: plugins are built, nothing heavy is loaded."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    name: str
    seed: int = Field(42, ge=0)
    max_attempts: int = Field(10, ge=1, le=10)
    show_findings: bool = True
    """Findings stand in the next attempt's prompt; false for models too small to read them."""
    hold_findings: bool = False
    """What findings tell exactly (a maneuver, a number of lanes), further attempts' grammar does not let differ."""
    second_opinion: str = Field("", pattern=r"^[\w-]*$")
    """"whole": the model is asked for road and behavior; "learned": the reader that learned where the rules err; else
    configs/prompts/<second_opinion>.md, with which the model is asked for the crash's gist. Where one is surer than the
    rules they give way, field by field. Empty: the rules alone read the narrative."""
    ego: str = Field("responder", pattern=r"^[\w-]+$")
    """The vehicle of ego.xosc that a stack is to drive: a role (responder, initiator, bystander) or an actor's id;
    none: no such file."""
    traffic: Literal["none", "light", "dense"] = "none"
    """Background vehicles around the crash: 5 (light) or 20 (dense) per kilometre and lane, drawn with `seed`."""
    report_reader: ReportReader
    retriever: Retriever
    backbone: Backbone | None = None
    decoder: Decoder | None = None
    road_writer: RoadWriter
    scenario_writer: ScenarioWriter
    validators: tuple[Validator, ...] = ()
    simulator: Simulator
    drive: DriveStage | None = None
    """Drivers into whose hands the generated scenarios are given."""
    judge: Simulator | None = None
    """A second simulator, whose playing of the generated scenarios is compared with ours."""
    tracker: Tracker
    raw: dict[str, Any] = Field(repr=False)
    """The mapping it was built from, written out, for logs, digests and worker processes."""
    extends: str = ""
    """The base that its YAML is written against, for people; of no effect."""

    def validators_of(self, stage: str) -> tuple[Validator, ...]:
        """Validators of one stage, or of both, in the order of the YAML."""
        return tuple(v for v in self.validators if v.stage in (stage, "both"))


def load(path: Path | str, overrides: tuple[str, ...] = ()) -> Config:
    """Read a YAML and `key=value` overrides into a checked Config. Raises ConfigError with every fault."""
    file = _find(Path(path))
    raw, base = config_extends.written_out(file, "of plugin kinds", (settings.CONFIGS,))
    for text in overrides:
        _override(raw, text)
    config = build(raw, name_of(file), f"{file} (extends {base})" if base else str(file))
    return config.model_copy(update={"extends": str(_inside(base))}) if base else config


def name_of(file: Path) -> str:
    """The config's name in runs/: its path under configs/ without suffix, "/" as "-"; else ConfigError."""
    name = "-".join(_inside(file).with_suffix("").parts)
    if name.startswith(".") or not name.isprintable():
        raise ConfigError(f"{file}: its results go to a folder of its name: begin the name with a letter")
    return name


def _inside(file: Path) -> Path:
    """The path under configs/; of a file elsewhere its name."""
    file = file.resolve()
    return file.relative_to(settings.CONFIGS) if file.is_relative_to(settings.CONFIGS) else Path(file.name)


def build(raw: dict[str, Any], name: str, where: str) -> Config:
    """Build a Config from a mapping. Raises ConfigError listing every fault with its key path."""
    faults: list[str] = []
    fields: dict[str, Any] = {k: raw[k] for k in SCALARS if k in raw}
    known = {*SINGLE, "judge", "drive", "validators", *SCALARS}
    faults += [_unknown(str(key), known) for key in raw if key not in known]
    for kind in SINGLE:
        if raw.get(kind) is None:
            if kind not in OPTIONAL:
                faults.append(f"{kind}: missing; give it a `name`")
        else:
            fields[kind] = _plugin(kind, raw[kind], kind, faults)
    if raw.get("judge") is not None:
        fields["judge"] = _plugin("simulator", raw["judge"], "judge", faults)
    if raw.get("drive") is not None:
        fields["drive"] = _drive(raw["drive"], faults)
    validators = raw.get("validators") or []
    if not isinstance(validators, list):
        faults.append(f"validators: expected a list, found {validators!r}")
        validators = []
    fields["validators"] = tuple(_plugin("validator", v, f"validators[{i}]", faults) for i, v in enumerate(validators))
    if not faults:
        faults += _pairing(fields, raw)
    config = None
    if not faults:
        try:
            config = Config(name=name, raw=raw, **fields)
        except ValidationError as fault:
            faults += config_faults.fault_lines("", fault, Config)
    if config is None:
        raise ConfigError("\n".join([f"{where}: {len(faults)} fault(s)", *(f"  {f}" for f in faults)]))
    return config


def _unknown(key: str, known: set[str]) -> str:
    if key == config_extends.KEY:
        return f"{key}: names a base in a YAML only: it is read before --set, which cannot change it"
    return f"{key}: {config_faults.unknown_name('key', key, sorted({*known, config_extends.KEY}))}"


def _plugin(kind: str, entry: Any, path: str, faults: list[str]) -> Plugin | None:
    if isinstance(entry, str):
        entry = {"name": entry}
    if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
        faults.append(f"{path}: expected a mapping with a `name`, found {entry!r}")
        return None
    try:
        found = plugin_class(kind, entry["name"])
    except ConfigError as fault:
        faults.append(f"{path}: {fault}")
        return None
    try:
        return found(**{str(k): v for k, v in entry.items() if k != "name"})
    except ValidationError as fault:
        faults += config_faults.fault_lines(path, fault, found)
    return None


def driver_entry(entry: Any) -> DriverEntry:
    """A driver of its name, or of a mapping with name and fields (`label` names its results). Raises ConfigError."""
    faults: list[str] = []
    found = _driver(entry, "driver", faults)
    if found is None:
        raise ConfigError("\n".join(faults))
    return found


def _driver(entry: Any, path: str, faults: list[str]) -> DriverEntry | None:
    raw = {"name": entry} if isinstance(entry, str) else dict(entry) if isinstance(entry, dict) else entry
    given = raw.pop("label", None) if isinstance(raw, dict) else None
    driver = _plugin("driver", raw, path, faults)
    if driver is None:
        return None
    told = [str(v) for v in raw.values() if isinstance(v, str | int | float)]
    label = re.sub(r"[^A-Za-z0-9_.=-]+", "_", str(given or "-".join(told)))[:60].strip(".") or raw["name"]
    return DriverEntry(label=label, driver=cast("Driver", driver), raw=raw)


def _drive(entry: Any, faults: list[str]) -> DriveStage | None:
    """The stage `drive`: a mapping with `drivers` (one or a list), or just those."""
    raw = dict(entry) if isinstance(entry, dict) and "drivers" in entry else {"drivers": entry}
    named = raw.pop("drivers")
    named = named if isinstance(named, list) else [named]
    drivers = [_driver(e, f"drive.drivers[{i}]", faults) for i, e in enumerate(named)]
    if None in drivers:
        return None
    try:
        return DriveStage(drivers=tuple(cast("list[DriverEntry]", drivers)), **raw)
    except ValidationError as fault:
        faults += config_faults.fault_lines("drive", fault, DriveStage)
    return None


def _pairing(fields: dict[str, Any], raw: dict[str, Any]) -> list[str]:
    """Refuse combinations that cannot work, before any weights load."""
    faults = []
    backbone = cast("Backbone | None", fields.get("backbone"))
    decoder = cast("Decoder | None", fields.get("decoder"))
    asking = [k for k in ("road_writer", "scenario_writer") if fields[k].asks_model]
    asking += ["second_opinion"] if fields.get("second_opinion", "") not in ("", LEARNED) else []
    if asking and backbone is None:
        faults.append(f"backbone: missing, but {' and '.join(asking)} ask a model")
    if asking and decoder is None:
        faults.append("decoder: missing; use `decoder: {name: greedy}`")
    if decoder and backbone is None and not asking:
        faults.append(
            f"decoder: {_name(raw['decoder'])!r} would decode nothing: road_writer {_name(raw['road_writer'])!r} and "
            f"scenario_writer {_name(raw['scenario_writer'])!r} ask no model; leave it out, or choose a config with a "
            "backbone, such as mini.yaml"
        )
    if raw.get("traffic", NO_TRAFFIC) != NO_TRAFFIC and not cast("Simulator", fields["simulator"]).drives_traffic:
        faults.append(
            f"traffic: simulator {_name(raw['simulator'])!r} drives no traffic; take simulator 'libsumo', or "
            "traffic: none"
        )
    if backbone and decoder and decoder.needs_prior and not backbone.gives_logits:
        faults.append(
            f"decoder {_name(raw['decoder'])!r} needs logits; backbone {_name(raw['backbone'])!r} gives none; "
            "use decoder 'greedy', or a backbone that gives them, such as 'hf_vision', or 'openai_server' behind vLLM"
        )
    return faults


def _name(entry: Any) -> str:
    return str(entry["name"] if isinstance(entry, dict) else entry)


def _find(path: Path) -> Path:
    for file in (path, settings.CONFIGS / path, settings.CONFIGS / f"{path}.yaml"):
        if file.is_file():
            return file
    found = sorted(f.relative_to(settings.CONFIGS) for f in settings.CONFIGS.rglob("*.yaml"))
    known = {str(f.with_suffix("")): str(f) for f in found if f.parts[0] != "studies"}
    meant = did_you_mean(str(path.with_suffix("")), known)
    raise ConfigError(f"{path}: no such config.{meant} In configs/: {', '.join(known.values())}")


def _override(raw: dict[str, Any], text: str) -> None:
    """Apply one `decoder.alpha=0.3`; values are YAML."""
    key, found, value = text.partition("=")
    if not found or not key:
        raise ConfigError(f"--set {text!r}: expected key=value, such as decoder.alpha=0.3")
    *parents, last = key.split(".")
    place = raw
    for parent in parents:
        if isinstance(place.get(parent), str):
            place[parent] = {"name": place[parent]}
        place = place.setdefault(parent, {})
        if not isinstance(place, dict):
            raise ConfigError(f"--set {text!r}: {parent!r} is no mapping")
    try:
        place[last] = yaml.safe_load(value)
    except YAML_FAULTS as fault:
        raise ConfigError(f"--set {text!r}: the value is no YAML: {fault}") from fault
