"""A flow and a task that do nothing themselves, in a module that workers import."""

from __future__ import annotations

from collections.abc import Callable

from prefect import flow, task
from prefect.cache_policies import NO_CACHE

_work: list[Callable[[], None]] = []


@task(cache_policy=NO_CACHE, persist_result=False)
def nothing(number: int) -> int:
    """The number."""
    return number


@flow(name="empty", persist_result=False)
def empty() -> None:
    """Do what `run` was given."""
    do()


def do() -> None:
    """The body of the flow, which is pickled by value."""
    _work.pop()()


def run(work: Callable[[], None]) -> None:
    """Do something inside a flow run."""
    _work.append(work)
    empty()
