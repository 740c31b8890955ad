"""The config of a study's arm: its YAML under the arm's overrides. STUDY/ARM names it wherever a config is named.

    load_config("template.yaml")                 # a YAML
    load_config("baselines/osm_direct")          # the arm osm_direct of configs/studies/baselines.yaml

Knows configs and study files; plans nothing.
"""

from __future__ import annotations

from pathlib import Path

from flows.case_files.find_cases import safe_id
from flows.study_file.spec import Arm, Study, is_study, load_study, study_in
from sgcad_core.config import Config, load
from sgcad_core.errors import ConfigError


def load_config(path: Path | str, overrides: tuple[str, ...] = ()) -> Config:
    """A checked Config from a YAML, or from a study's arm as STUDY/ARM. Raises ConfigError with every fault."""
    place = Path(path)
    study_file = None if place.is_file() or place.parent == Path() else study_in(place.parent)
    if study_file is None:
        return load(place, overrides)
    study = load_study(study_file)
    arm = study.arm(place.name)
    try:
        config = config_of(study, arm, after=overrides)
    except ConfigError as fault:
        raise ConfigError(f"{study.file}: arm {arm.name!r}: {fault}") from fault
    return config.model_copy(update={"name": safe_id(f"{study.name}-{place.name}"), "extends": arm.config})


def config_of(study: Study, arm: Arm, before: tuple[str, ...] = (), after: tuple[str, ...] = ()) -> Config:
    """An arm's config, with overrides before and after its own. Raises ConfigError."""
    beside = study.file.parent / arm.config
    file = beside if beside.is_file() and not is_study(beside) else arm.config
    return load(file, (*before, *arm.set, *after))
