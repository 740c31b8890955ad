"""Paths and environment variables; the only module that reads or writes os.environ.

`quiet_libraries()` must run before prefect, mlflow or transformers is imported.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from sgcad_core.errors import MissingTool

ROOT = Path(__file__).resolve().parent.parent
CONFIGS = ROOT / "configs"
PROMPTS = CONFIGS / "prompts"

_QUIET = {
    "PREFECT_LOGGING_LEVEL": "WARNING",
    "PREFECT_SERVER_LOGGING_LEVEL": "CRITICAL",
    "PREFECT_SERVER_ANALYTICS_ENABLED": "false",
    "DO_NOT_TRACK": "1",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "3",  # its own 7 report a missing server after four minutes
    "MLFLOW_HTTP_REQUEST_TIMEOUT": "30",
    "MLFLOW_SUPPRESS_PRINTING_URL_TO_STDOUT": "true",  # standard output is for the answer
    "TOKENIZERS_PARALLELISM": "false",
}


def quiet_libraries() -> None:
    """Set the libraries' switches that the user has not set."""
    for name, value in _QUIET.items():
        os.environ.setdefault(name, value)


def default_config() -> str:
    """The config of commands that are given none."""
    return environment("SGCAD_CONFIG") or "fused.yaml"


def configs_or_default(configs: Sequence[str | Path] | None) -> list[Path]:
    """The configs that a command is given, else the default one."""
    return [Path(config) for config in configs or [default_config()]]


def environment(name: str) -> str:
    """A variable that a config names, such as an API key's; empty if it is not set."""
    return os.environ.get(name, "")


def cache_home() -> Path:
    """Where what can be made again is kept, such as weights unpacked from a package."""
    return Path(environment("XDG_CACHE_HOME") or _home() / ".cache") / "sg-cadvlm"


def prefect_home() -> Path:
    """The folder of Prefect's database and profiles."""
    return Path(environment("PREFECT_HOME") or _home() / ".prefect")


def _home() -> Path:
    try:
        return Path.home()
    except RuntimeError as fault:
        raise MissingTool("no home folder is known for this user: set the variable HOME to one") from fault


def writable_prefect_home() -> Path:
    """Prefect's folder, made if it is not there. Raises MissingTool where it cannot be made or written."""
    home = prefect_home()
    named = environment("PREFECT_HOME")
    if not named and not home.parent.is_dir():
        raise MissingTool(
            f"your home folder {home.parent} does not exist, and Prefect keeps its database in it: set the variable "
            "HOME to a folder that is there, or PREFECT_HOME to one that may be made"
        )
    try:
        home.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(prefix=".sgcad-", dir=home):
            pass
    except OSError as fault:
        raise MissingTool(
            f"{home}, where Prefect keeps its database ({'PREFECT_HOME' if named else 'below HOME'}), cannot be "
            f"written ({fault.strerror or fault}): set the variable PREFECT_HOME to a folder that can"
        ) from fault
    return home


def prefect_url() -> str:
    """The Prefect server that the user has named, by variable or active profile; empty if none is."""
    if url := environment("PREFECT_API_URL"):
        return url
    file = Path(environment("PREFECT_PROFILES_PATH") or prefect_home() / "profiles.toml")
    try:
        profiles = tomllib.loads(file.read_text())
    except (OSError, ValueError):
        return ""
    active = profiles.get("profiles", {}).get(environment("PREFECT_PROFILE") or profiles.get("active", ""), {})
    return str(active.get("PREFECT_API_URL", ""))


def use_prefect_url(url: str) -> None:
    """Name the server for everything started from here; before prefect is imported. Empty: name none."""
    if url:
        os.environ["PREFECT_API_URL"] = url
    else:
        os.environ.pop("PREFECT_API_URL", None)


def sumo_home() -> Path:
    """Root of the SUMO that the eclipse-sumo wheel brings (or of SUMO_HOME)."""
    spec = importlib.util.find_spec("sumo")
    if spec and spec.submodule_search_locations:
        return Path(next(iter(spec.submodule_search_locations)))
    if home := os.environ.get("SUMO_HOME"):
        return Path(home)
    raise MissingTool("SUMO is not installed: `pip install eclipse-sumo libsumo`, or set SUMO_HOME")


def netconvert() -> Path:
    """SUMO's network compiler; the binary itself, since the console script costs 0.2 s more."""
    binary = sumo_home() / "bin" / "netconvert"
    if not binary.exists():
        raise MissingTool(f"{binary} does not exist: `pip install --force-reinstall eclipse-sumo`")
    return binary


def program(name: str, path: str, variable: str, source: str) -> Path:
    """A user's program: where a config names it, else the variable, else PATH. Raises MissingTool saying all three."""
    named = path or os.environ.get(variable, "")
    found = shutil.which(str(Path(named).expanduser()) if named else name)
    if found:
        return Path(found).resolve()
    what = f"{named!r} is no program that can be run" if named else f"there is no {name!r} on PATH"
    raise MissingTool(f"{what}: name the {name} binary by `path` or by the variable {variable} (get it from {source})")


def plain_environment() -> dict[str, str]:
    """The environment of a third-party program: paths, no keys."""
    return {name: os.environ[name] for name in ("PATH", "HOME", "LANG", "LD_LIBRARY_PATH") if name in os.environ}


@contextmanager
def starting(program: str) -> Iterator[None]:
    """Around the start of a process. Raises MissingTool where the program cannot be started at all."""
    try:
        yield
    except OSError as fault:
        raise MissingTool(
            f"{program} cannot be started ({fault.strerror or fault}): look whether it is there and may be run, and "
            "whether memory and processes are left (`ulimit -u`); an environment that was moved: `make setup` anew"
        ) from fault


def subprocess_environment() -> dict[str, str]:
    """The environment for SUMO's programs; networks with a place on the globe need SUMO's table of projections."""
    home = sumo_home()
    return {"PROJ_LIB": str(home / "data" / "proj"), **os.environ, "SUMO_HOME": str(home)}
