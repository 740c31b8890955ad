"""A Prefect server that lasts as long as one command, if the user has named none.

Prefect would start one itself, but late (after its import), in the command's process group (Ctrl-C would end it before
the flow's state is written) and as an orphan after a kill -9. This server starts first, has a session of its own and
ends when the command's end of its standard input closes, for any reason.

    python -m flows.server <file descriptor of a bound socket>        # the server process
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager

from sgcad_core import settings
from sgcad_core.errors import MissingTool, SgcadError

START_S = 180.0
"""Time limit of the start; the first one makes the database: 14 s on two idle cores, a minute on busy ones."""
STOP_S = 15.0
"""Time limit of writing the last states."""

BULK = {
    "PREFECT_SERVER_SERVICES_TASK_RUN_RECORDER_BATCH_SIZE": "50",
    "PREFECT_SERVER_SERVICES_TASK_RUN_RECORDER_READ_BATCH_SIZE": "50",
    "PREFECT_SERVER_SERVICES_TASK_RUN_RECORDER_FLUSH_INTERVAL": "1",
}
"""States of task runs are written in bulk, within a second: a case has ten of them. `make up` sets this too."""
LEAN = BULK | {
    "PREFECT__SERVER_EPHEMERAL": "1",
    "PREFECT_SERVER_SERVICES_EVENT_PERSISTER_ENABLED": "false",
    "PREFECT_SERVER_SERVICES_TRIGGERS_ENABLED": "false",
}
"""Automations and the event feed need a server that stays. The user's own settings win.

`python -m research.benchmarks.services.load` prints what a case takes of this server, of one that `make up` starts, and
of a plain one.
"""


class ServerLost(MissingTool):
    """The command's own server ended while it was needed; `how` describes its end."""

    def __init__(self, how: str) -> None:
        self.how = f"Prefect's server {how}"
        super().__init__(f"{self.how}; finished cases are kept, run the same command again to go on")


class Server:
    """A server process; `wait` until it answers."""

    def __init__(self) -> None:
        with socket.socket() as bound:
            bound.bind(("127.0.0.1", 0))
            self.address = f"http://127.0.0.1:{bound.getsockname()[1]}/api"
            with settings.starting(sys.executable):
                self.process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
                    [sys.executable, "-m", "flows.server", str(bound.fileno())],
                    stdin=subprocess.PIPE,
                    pass_fds=[bound.fileno()],
                    start_new_session=True,
                    env=LEAN | settings.subprocess_environment(),
                )

    def wait(self) -> None:
        """Return when the server answers. Raises MissingTool if it never does, ServerLost if it was killed."""
        deadline = time.monotonic() + START_S
        while self.process.poll() is None and time.monotonic() < deadline:
            if answers(self.address):
                return
            time.sleep(0.05)
        if (self.process.poll() or 0) < 0:
            raise ServerLost(self.ended())
        ended = self.ended() or f"silent for {START_S:g} s"
        raise MissingTool(
            f"Prefect's server does not start ({ended}); look at its messages above, at PREFECT_HOME (can it be "
            "written?), or name a running server: export PREFECT_API_URL=http://.../api"
        )

    def ended(self) -> str:
        """Description of the process's end; empty while it runs."""
        if (code := self.process.poll()) is None:
            return ""
        return f"was killed by signal {-code}" if code < 0 else f"ended with code {code}"

    def stop(self) -> None:
        """End the process."""
        self.process.terminate()
        try:
            self.process.wait(STOP_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def answers(url: str) -> bool:
    """Whether a Prefect API answers at a URL such as http://127.0.0.1:4200/api."""
    try:
        with urllib.request.urlopen(f"{url.rstrip('/')}/health", timeout=5):  # noqa: S310 - an address the user gave
            return True
    except urllib.error.HTTPError as fault:
        return fault.code in (401, 403)  # there, and wants a key that Prefect's own client has
    except (OSError, ValueError):
        return False


@contextmanager
def prefect_server() -> Iterator[Server | None]:
    """Name a fresh server to Prefect while the block lasts; None if the user has named one that answers.

    Enter it before prefect is imported. Call `wait` on the server before the first flow. Raises MissingTool
    if the user's server does not answer or Prefect's folder cannot be written, ServerLost where the block fails because
    that server has ended.
    """
    if url := settings.prefect_url():
        if not answers(url):
            raise MissingTool(
                f"PREFECT_API_URL names {url}, where no Prefect server answers: start it (`prefect server start`), or "
                "unset the variable (and the active profile's) to have one for each command"
            )
        yield None
        return
    settings.writable_prefect_home()
    server = Server()
    settings.use_prefect_url(server.address)
    try:
        yield server
    except SgcadError:
        raise
    except Exception as fault:
        if how := server.ended():
            raise ServerLost(how) from fault
        raise
    finally:
        settings.use_prefect_url("")
        server.stop()


def _serve(descriptor: int) -> None:
    """Serve on a bound socket until standard input closes."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    settings.quiet_libraries()
    import uvicorn
    from prefect.server.api.server import create_app

    config = uvicorn.Config(create_app, factory=True, log_level="error", lifespan="on")
    uvicorn.Server(config).run(sockets=[socket.socket(fileno=descriptor)])


def _end_with_parent() -> None:
    while os.read(0, 4096):  # no buffered read: the lock that it holds would abort a server that ends by itself
        pass
    os._exit(0)


if __name__ == "__main__":
    _serve(int(sys.argv[1]))
