"""A study file: arms, listed or crossed, over a set of cases.

    title: Alpha sensitivity
    extends: OTHER.yaml                 # optional: another study, of which this one is the differences
    config: paper/mini_sg_cadvlm.yaml   # of every arm that names none (optional)
    reference: alpha_0.7                # the arm that others are compared with (optional)
    arms:                               # an explicit list ...
      - {name: greedy, set: {decoder: greedy}, label: Greedy, published: multimodal_only_qwen72b}
    cross:                              # ... and/or a cross product; names come from the values
      over: {decoder.alpha: [0, 0.3, 0.7], seed: [0, 1]}
    cases: [my-cases]                   # optional folders; --cases on the command line wins
    truth: my-truth                     # optional; --truth wins

Knows YAML and the names of arms; builds no config.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from flows.case_files.find_cases import safe_id
from flows.study_file import cross_product, study_base
from sgcad_core import config_extends, settings
from sgcad_core.config_faults import unknown_name
from sgcad_core.errors import ConfigError
from sgcad_core.near_names import did_you_mean
from sgcad_core.system.yaml_faults import YAML_FAULTS

STUDIES = settings.CONFIGS / "studies"
FOLDERS = (STUDIES, settings.CONFIGS)
EXPECTED = "with `title` and `arms` or `cross`"
MAX_ARMS = 500
"""More is a slip of the pen: a cross product grows fast."""


Overrides = Annotated[tuple[str, ...], BeforeValidator(cross_product.overrides_in)]
"""Overrides as on the command line, `key=value` each, or a mapping of them."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Arm(_Part):
    """One column of a study: a config with overrides, under a name of its own."""

    name: str = Field(min_length=1)
    config: str = Field(min_length=1)
    set: Overrides = ()
    label: str = ""
    """How tables call it; the name if empty."""
    published: str | None = None
    """Row of the published figures that stands beside it."""
    factors: dict[str, Any] = Field(default_factory=dict, exclude=True)
    """Key -> value of what a cross product varied; for a listed arm, what its author says that it varies."""


class Cross(_Part):
    """A cross product: every combination of the values is an arm. The key `config` varies the config itself."""

    config: str = ""
    over: dict[str, tuple[Any, ...]] = Field(min_length=1)
    set: Overrides = ()
    """Overrides of every arm, before its own values."""
    published: dict[str, str] = Field(default_factory=dict)
    """Name of an arm -> row of the published figures that stands beside it."""

    @model_validator(mode="after")
    def _can_be_spread(self) -> Self:
        if not self.config and "config" not in self.over:
            raise ValueError("config: missing; name one, or vary it: over: {config: [a.yaml, b.yaml]}")
        if (count := math.prod(map(len, self.over.values()))) > MAX_ARMS:
            raise ValueError(f"{count} arms; at most {MAX_ARMS}: cross fewer values, or make it several studies")
        return self

    def arms(self) -> tuple[Arm, ...]:
        """All combinations, the last key changing fastest."""
        return tuple(
            Arm(
                name=(name := cross_product.name_of(factors)),
                config=str(factors.get("config", self.config)),
                set=(*self.set, *cross_product.overrides_of(factors)),
                label=cross_product.label_of(factors),
                published=self.published.get(name),
                factors=factors,
            )
            for factors in cross_product.combinations(self.over)
        )


class _File(_Part):
    """The file's own shape."""

    title: str = Field(min_length=1)
    config: str = ""
    """Of arms and of a cross product that name none; they hold it by now."""
    reference: str | None = None
    arms: tuple[Arm, ...] = ()
    cross: Cross | None = None
    cases: tuple[Path, ...] = ()
    truth: Path | None = None


@dataclass(frozen=True)
class Study:
    """A study file as read, put on its base, its cross product spread out."""

    name: str
    file: Path
    title: str
    arms: tuple[Arm, ...]
    reference: str | None = None
    cases: tuple[Path, ...] = ()
    truth: Path | None = None
    faults: tuple[str, ...] = ()
    """What is wrong with the file itself; told together with what is wrong with its arms."""
    extends: str = ""
    """The study that this one is written against."""

    def arm(self, name: str) -> Arm:
        """The arm of this name. Raises ConfigError naming those there are."""
        names = [arm.name for arm in self.arms]
        if name not in names:
            raise ConfigError(
                f"study {self.name}: no arm {name!r}.{did_you_mean(name, names)} Arms: {', '.join(names)}"
            )
        return self.arms[names.index(name)]


def load_study(path: Path | str) -> Study:
    """Read a study; its faults stand in it. Raises ConfigError where so little is right that no arm can be told."""
    file = find_study(Path(path))
    raw, base = config_extends.written_out(file, EXPECTED, FOLDERS, study_base.merged)
    study_base.give_config(raw)
    parsed, faults = _parsed(raw)
    if parsed is None:
        raise ConfigError(fault_lines(file, faults))
    arms = (*parsed.arms, *(parsed.cross.arms() if parsed.cross else ()))
    faults += _faults(parsed, arms)
    return Study(
        safe_id(file.stem), file, parsed.title, arms, parsed.reference, parsed.cases, parsed.truth, tuple(faults),
        base.name if base else "",
    )  # fmt: skip


def study_in(path: Path) -> Path | None:
    """The file, if it is a study's: it has arms or a cross product, or is a name under configs/studies/ only."""
    inside = [folder / f"{path}{end}" for folder in (settings.CONFIGS, STUDIES) for end in ("", ".yaml")]
    for file in (path, *inside):
        if file.is_file():
            return file if is_study(file) else None
    return None


def is_study(file: Path) -> bool:
    """Whether a YAML, or the base that it extends, has arms or a cross product."""
    raw = _looked_into(file)
    base = config_extends.base_of(file, raw.get(config_extends.KEY), FOLDERS)
    return bool({"arms", "cross"} & {*raw, *(_looked_into(base) if base else ())})


def _looked_into(file: Path) -> dict[str, Any]:
    try:
        raw = yaml.safe_load(file.read_text(encoding="utf-8"))
    except (*YAML_FAULTS, OSError):
        return {}
    return raw if isinstance(raw, dict) else {}


def fault_lines(file: Path, faults: list[str] | tuple[str, ...]) -> str:
    """All faults of a study, one a line."""
    return "\n".join([f"{file}: {len(faults)} fault(s)", *(f"  {line}" for f in faults for line in f.splitlines())])


def find_study(path: Path) -> Path:
    """The file that a path or a name under configs/studies/ means. Raises ConfigError naming the ones there are."""
    for file in (path, STUDIES / path, STUDIES / f"{path}.yaml"):
        if file.is_file():
            return file
    known = sorted(f.stem for f in STUDIES.glob("*.yaml"))
    raise ConfigError(f"{path}: no such study.{did_you_mean(path.stem, known)} In configs/studies/: {', '.join(known)}")


def _parsed(raw: dict[str, Any]) -> tuple[_File | None, list[str]]:
    """The file's content and its faults; unknown keys are told and left out, so that the rest can be checked too."""
    try:
        return _File.model_validate(raw), []
    except ValidationError as fault:
        errors = fault.errors(include_url=False)
    faults = [_line(e) for e in errors]
    for error in errors:
        if error["type"] == "extra_forbidden":
            _drop(raw, error["loc"])
    try:
        return _File.model_validate(raw), faults
    except ValidationError:
        return None, faults


def _line(error: Any) -> str:
    place = ".".join(str(p) for p in error["loc"])
    if error["type"] == "extra_forbidden":
        parts: dict[str, type[_Part]] = {"arms": Arm, "cross": Cross} if len(error["loc"]) > 1 else {}
        part = parts.get(str(error["loc"][0]), _File)
        return f"{place}: {unknown_name('key', str(error['loc'][-1]), list(part.model_fields))}"
    return f"{place}: {error['msg']} (found {error['input']!r})"


def _drop(raw: Any, place: tuple[Any, ...]) -> None:
    for step in place[:-1]:
        raw = raw[step]
    raw.pop(place[-1], None)


def _faults(parsed: _File, arms: tuple[Arm, ...]) -> list[str]:
    """What pydantic cannot see: names, the reference, an empty study."""
    faults = [] if arms else ["no arm: give `arms` (a list) or `cross` (`config` and `over`)"]
    twice = [name for name, n in Counter(arm.name.casefold() for arm in arms).items() if n > 1]
    faults += [f"arm {name!r} stands twice and would share a folder: give each a name of its own" for name in twice]
    for arm in arms:
        if arm.name != safe_id(arm.name) or arm.name.startswith("-"):
            faults.append(f"arm {arm.name!r} cannot be a folder's name; such as {safe_id(arm.name.lstrip('-'))!r} can")
    if parsed.reference is not None and parsed.reference not in {arm.name for arm in arms}:
        names = ", ".join(arm.name for arm in arms)
        faults.append(f"reference: no arm is called {parsed.reference!r}; there are: {names}")
    if parsed.cross:
        faults += [f"cross.over.{key}: no values; give a list" for key, v in parsed.cross.over.items() if not v]
        known = [arm.name for arm in arms]
        lost = [name for name in parsed.cross.published if name not in known]
        faults += [f"cross.published.{name}: no arm is called so.{did_you_mean(name, known)}" for name in lost]
    return faults
