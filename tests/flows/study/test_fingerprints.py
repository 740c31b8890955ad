"""What every bundled config and study means, as fingerprints: an edited base changes all that extend it.

A fingerprint that differs means that finished results of that config are done again. If that is meant, write the new
one down in fingerprints.yaml.
"""

import hashlib
import json
from pathlib import Path

import yaml

from flows.study.plan import arms_of
from flows.study_file.spec import load_study
from sgcad_core import settings
from sgcad_core.config import load

FILE = Path(__file__).parent / "fingerprints.yaml"
STUDIES = settings.CONFIGS / "studies"


def fingerprint(told):
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:12]


def meant(config):
    """All that results depend on in a config."""
    return {key: value for key, value in config.raw.items() if key != "tracker"}


def of_study(file):
    study = load_study(file)
    configs = arms_of(study, Path())
    return fingerprint({arm.name: meant(config) for arm, config in zip(study.arms, configs, strict=True)})


def test_no_bundled_config_has_come_to_mean_something_else():
    found = {}
    for file in sorted(settings.CONFIGS.rglob("*.yaml")):
        name = str(file.relative_to(settings.CONFIGS))
        found[name] = of_study(file) if file.parent == STUDIES else fingerprint(meant(load(file)))
    assert found == yaml.safe_load(FILE.read_text())
