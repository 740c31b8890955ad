"""A case to run, as values that can be pickled, and its run in whatever process takes it.

`prepare_process` is a worker process's start: its end follows its parent's, and Ctrl-C is for the parent.
"""

from __future__ import annotations

import faulthandler
import json
import multiprocessing
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from flows.case.run_case import Ending, run_case
from flows.case.steps import AT_ONCE, StepCalls
from flows.case_files.find_cases import Case
from flows.case_files.step_keys import StepKeys
from sgcad_core.config import Config, build
from sgcad_core.system.parent_end import end_with_parent

Detail = Literal["stage", "case"]
"""What Prefect is shown: a task a step (`stage`), or one task a case."""
CASE_LIMIT_S = 600.0
"""Time limit of a case in a worker process, which is then ended: the case fails."""

OnStep = Callable[[str, str], None]
"""Called with job and step when a step begins, such as "road[2]", from any thread; may raise to end the case."""
watching: ContextVar[OnStep | None] = ContextVar("watching", default=None)
"""What is told of the steps in this process."""
_configs: dict[str, Config] = {}
_building = threading.Lock()


@dataclass(frozen=True)
class Order:
    """One case of one config."""

    raw: dict[str, Any]
    name: str
    case: Case
    out: Path
    digest: str
    keys: StepKeys | None = None
    shelf: Path | str | None = None
    """Where results of steps are kept for other configs: a folder, or an address (flows/batch/remote/store.py)."""
    detail: Detail = "stage"
    asks_model: bool = False
    tagged: bool = False
    """Whether steps have tags, whose limits a server that stays keeps."""

    @property
    def job(self) -> str:
        """<config>/<case>."""
        return f"{self.name}/{self.case.id}"


def know(config: Config) -> None:
    """Let this process run orders of a config without building it again, with the model that it has loaded."""
    _configs[config_key(config.raw, config.name)] = config


def config_of(order: Order) -> Config:
    """The config of an order, built once a process."""
    key = config_key(order.raw, order.name)
    with _building:  # the threads of a worker share one model
        if key not in _configs:
            _configs[key] = build(order.raw, order.name, order.name)
        return _configs[key]


def config_key(raw: dict[str, Any], name: str) -> str:
    """What tells a config from others in this process."""
    return f"{name} {json.dumps(raw, sort_keys=True, default=str)}"


def run_order(order: Order, calls: StepCalls = AT_ONCE, alone: bool | None = None) -> Ending:
    """Run an order in this process. Raises MissingTool, ConfigError.

    `alone`: the process has no other case and is ended by a case that takes too long; None: as `is_worker` says.
    """
    watch = watching.get()
    tell = {"tell": partial(watch, order.job)} if watch else {}
    with _limited(is_worker() if alone is None else alone):
        config = config_of(order)
        return run_case(config, order.case, order.out, order.digest, calls, keys=order.keys, **tell)


def is_worker() -> bool:
    """Whether this is the main thread of a worker process, which has one case at a time."""
    main = threading.current_thread() is threading.main_thread()
    return main and multiprocessing.parent_process() is not None


@contextmanager
def _limited(alone: bool) -> Iterator[None]:
    """End a worker process in which the block lasts too long, even where a library holds the interpreter."""
    if not alone:
        yield
        return
    faulthandler.dump_traceback_later(CASE_LIMIT_S, exit=True)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def prepare_process() -> None:
    """Start a worker process: no Ctrl-C, an end with its parent, and what every case imports."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    import flows.case.chain  # noqa: F401 - the imports of a first case
