"""What Prefect's form shows of each deployed flow, and what its server accepts."""

import importlib

import pytest
import yaml
from prefect.utilities.callables import parameter_schema
from prefect.utilities.schema_tools.validation import validate

from sgcad_core import settings

DEPLOYED = {
    d["name"]: d
    for d in yaml.safe_load((settings.ROOT / "deploy" / "prefect.yaml").read_text())["deployments"]
    if not d["name"].startswith("shard")
}


def schema(name):
    """The schema that the server stores for a deployment."""
    module, _, flow = DEPLOYED[name]["entrypoint"].rpartition(".")
    return parameter_schema(getattr(importlib.import_module(module), flow).fn).model_dump_for_openapi()


def choices(about):
    """Every listed value in a parameter's schema."""
    if isinstance(about, dict):
        return set(about.get("enum", [])).union(*map(choices, about.values()))
    return set().union(*map(choices, about)) if isinstance(about, list) else set()


@pytest.mark.parametrize("name", DEPLOYED)
def test_every_parameter_says_what_it_is(name):
    found = schema(name)["properties"]
    assert found
    assert [p for p, about in found.items() if len(about.get("description", "")) < 10] == []


@pytest.mark.parametrize("name", DEPLOYED)
def test_what_a_deployment_sets_is_accepted(name):
    validate(DEPLOYED[name].get("parameters", {}), schema(name), raise_on_error=True, ignore_required=True)


def test_configs_studies_and_embedders_are_offered():
    assert {"fused.yaml", "template.yaml", "paper/tbg.yaml"} <= choices(schema("inbox")["properties"]["config"])
    for name in ("nightly", "evaluate"):
        assert "fused.yaml" in choices(schema(name)["properties"]["configs"])
    assert "alpha.yaml" in choices(schema("study")["properties"]["file"])
    assert "minilm" in choices(schema("reindex")["properties"]["embedder"])


@pytest.mark.parametrize(
    ("name", "values", "fine"),
    [
        ("inbox", {"config": "/home/me/mine.yaml"}, True),
        ("inbox", {"config": "baselines/osm_direct", "jobs": None}, True),
        ("inbox", {"config": 3}, False),
        ("inbox", {"settle_s": -1}, False),
        ("inbox", {"jobs": 0}, False),
        ("study", {"file": "mine/study.yaml", "cases": ["a", "b"]}, True),
        ("study", {}, False),
        ("nightly", {"tolerance": 2}, False),
        ("reindex", {"embedder": "word2vec"}, False),
    ],
)
def test_other_files_are_accepted_and_what_is_out_of_bounds_is_not(name, values, fine):
    assert bool(validate(values, schema(name))) is not fine
