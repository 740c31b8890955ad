"""Threads of the desk: pages and changes have their own, so that slow changes hold no page, and a late page is told of.

A thread that hangs cannot be ended; it stays one of its kind's threads until it returns.
"""

from __future__ import annotations

import functools
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Any

import anyio
from anyio import CapacityLimiter, to_thread
from starlette.requests import Request
from starlette.responses import Response

PAGE_S = 20.0
"""Longest time for a page, waiting for a thread included."""


class PageLate(Exception):
    """A page was not ready in time."""


@dataclass(frozen=True)
class Threads:
    """Threads of one desk by kind."""

    pages: CapacityLimiter = field(default_factory=lambda: CapacityLimiter(16))
    changes: CapacityLimiter = field(default_factory=lambda: CapacityLimiter(16))


def timed(page: Callable[..., Response]) -> Callable[..., Awaitable[Response]]:
    """A page's function, called in a thread of the desk; raises PageLate after PAGE_S."""

    @functools.wraps(page)
    async def within(request: Request, **values: Any) -> Response:
        threads: Threads = request.app.state.desk.threads
        call = functools.partial(page, request, **values)
        with anyio.move_on_after(PAGE_S):
            return await to_thread.run_sync(call, abandon_on_cancel=True, limiter=threads.pages)
        raise PageLate(f"This page was not ready within {PAGE_S:g} s. The desk is busy, or a file of the case is odd.")

    return within
