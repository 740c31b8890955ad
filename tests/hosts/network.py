"""Hosts as network namespaces: each with its own address, host name, temporary folder and a link that can be cut.

    with Network(folder) as net:                      # 10.77.0.1 is the hub, workers are .2, .3, ...
        process = net.start("a", ["dask", "worker", ...], environment)
        net.cut("a"); net.mend("a"); net.kill(process)

Needs root and iproute2. Everything it made is gone at the end, whatever happened.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import psutil

HUB = "10.77.0.1"


class Network:
    """A hub and workers on one bridge inside the hub's namespace."""

    def __init__(self, folder: Path, workers: Sequence[str] = ("a", "b")) -> None:
        self.folder, self.workers = folder, workers
        self.mark = f"sg{os.getpid()}"
        self.processes: list[subprocess.Popen[bytes]] = []

    def space(self, host: str) -> str:
        """A host's namespace."""
        return f"{self.mark}{host}"

    def __enter__(self) -> Network:
        try:
            self._lay()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _lay(self) -> None:
        hub = self.space("hub")
        for host in ("hub", *self.workers):
            ip("netns", "add", self.space(host))
            ip("-n", self.space(host), "link", "set", "lo", "up")
        ip("-n", hub, "link", "add", "bridge", "type", "bridge")
        ip("-n", hub, "address", "add", f"{HUB}/24", "dev", "bridge")
        ip("-n", hub, "link", "set", "bridge", "up")
        for number, host in enumerate(self.workers, 2):
            ip("-n", hub, "link", "add", f"to-{host}", "type", "veth", "peer", "eth0", "netns", self.space(host))
            ip("-n", hub, "link", "set", f"to-{host}", "master", "bridge", "up")
            ip("-n", self.space(host), "address", "add", f"10.77.0.{number}/24", "dev", "eth0")
            ip("-n", self.space(host), "link", "set", "eth0", "up")

    def __exit__(self, *fault: object) -> None:
        for process in reversed(self.processes):
            self.end(process)
        for host in (*self.workers, "hub"):
            subprocess.run(["ip", "netns", "delete", self.space(host)], capture_output=True, check=False)

    def start(
        self, host: str, command: Sequence[str], environment: Mapping[str, str], user: str = ""
    ) -> subprocess.Popen[bytes]:
        """Start a program on a host, its words in <folder>/<host>/<program>.log."""
        home = self.folder / host
        (home / "tmp").mkdir(parents=True, exist_ok=True)
        own = {"HOME": str(home), "TMPDIR": str(home / "tmp"), "PREFECT_HOME": str(home / "prefect")}
        become = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"] if user else []
        inside = ["unshare", "--uts", "sh", "-c", f'hostname {host} && exec "$@"', "sh", *become, *command]
        with (home / f"{Path(command[0]).name}-{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                ["ip", "netns", "exec", self.space(host), *inside],
                env={**os.environ, **own, **environment},
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                cwd=environment.get("PWD"),
            )
        self.processes.append(process)
        return process

    def cut(self, host: str) -> None:
        """Pull a worker's cable."""
        ip("-n", self.space("hub"), "link", "set", f"to-{host}", "down")

    def mend(self, host: str) -> None:
        """Put the cable back."""
        ip("-n", self.space("hub"), "link", "set", f"to-{host}", "up")

    def kill(self, process: subprocess.Popen[bytes]) -> None:
        """A host's power goes: the process and all that came from it, kill -9."""
        for one in _family(process.pid):
            with contextlib.suppress(psutil.NoSuchProcess):
                one.kill()
        process.wait()

    def end(self, process: subprocess.Popen[bytes]) -> None:
        """End a service in order, and what is left of it after ten seconds at once."""
        family = list(_family(process.pid))
        if process.poll() is None:
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(10)
        for one in family:
            with contextlib.suppress(psutil.NoSuchProcess):
                one.kill()


def _family(pid: int) -> Iterator[psutil.Process]:
    with contextlib.suppress(psutil.NoSuchProcess):
        parent = psutil.Process(pid)
        yield from [parent, *parent.children(recursive=True)]


def ip(*words: str) -> None:
    """iproute2's command. Raises CalledProcessError with its words on stderr."""
    subprocess.run(["ip", *words], check=True, stderr=sys.stderr)


def postgres_programs() -> Path | None:
    """Where Debian puts initdb and postgres; None if they are not installed."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    return found[-1].parent if found else None


def missing() -> str:
    """Why this cannot run here; empty if it can."""
    if sys.platform != "linux":
        return "network namespaces are Linux's"
    if os.geteuid() != 0:
        return "needs root, for network namespaces: sudo make test-hosts"
    for program, package in (("ip", "iproute2"), ("unshare", "util-linux"), ("setpriv", "util-linux")):
        if shutil.which(program) is None:
            return f"{program} is not installed: apt-get install {package}"
    if postgres_programs() is None:
        return "PostgreSQL is not installed: apt-get install postgresql"
    probe = f"sg{os.getpid()}probe"
    tried = subprocess.run(["ip", "netns", "add", probe], capture_output=True, text=True, check=False)
    subprocess.run(["ip", "netns", "delete", probe], capture_output=True, check=False)
    return f"no network namespace can be made: {tried.stderr.strip()}" if tried.returncode else ""
