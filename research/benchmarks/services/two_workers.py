"""How much faster two workers do a study than one.

    python -m research.benchmarks.services.two_workers                     # stages wait for a model's server: 1.8 \
        times is wanted
    python -m research.benchmarks.services.two_workers --config template.yaml      # cores are the limit: no slower \
        is wanted

Starts Prefect's server, then one worker, then two, each with a network share's stand-in (a folder), and a chat
server of its own that takes `--delay` seconds an answer over real HTTP. A worker does one shard at a time, a
shard one case at a time (`--jobs`). The clock runs from the study's start, workers up, to the last case at home.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import yaml

from research.benchmarks.services.load import free_port, served
from sgcad_core import settings

ROOT = settings.ROOT
REPORT = ROOT / "docs" / "demo" / "left-turn-at-signal"
"""The report that configs/scripted.yaml holds answers for."""
PATIENCE_S = 300.0


class SlowModel(ThreadingHTTPServer):
    """A chat server that thinks for a while and knows one report's road and scenario."""

    daemon_threads = True

    def __init__(self, delay_s: float) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.delay_s = delay_s
        raw = yaml.safe_load((settings.CONFIGS / "scripted.yaml").read_text(encoding="utf-8"))
        self.known = {a["stage"]: json.dumps(a["answer"]) for a in raw["backbone"]["answers"]}
        self.asked = 0

    @property
    def url(self) -> str:
        """What backbone.base_url has to be."""
        return f"http://127.0.0.1:{self.server_port}/v1"


class _Handler(BaseHTTPRequestHandler):
    server: SlowModel

    def do_POST(self) -> None:
        """One chat completion."""
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.asked += 1
        time.sleep(self.server.delay_s)
        schema = json.dumps(body.get("response_format", {}))
        answer = self.server.known["scenario" if '"contacts"' in schema else "road"]
        content = {"choices": [{"message": {"content": answer}, "finish_reason": "stop"}], "usage": {}}
        data = json.dumps(content).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *args: Any) -> None:
        """Nothing on stderr."""


@contextmanager
def slow_model(delay_s: float) -> Iterator[SlowModel]:
    """A slow chat server while the block lasts."""
    server = SlowModel(delay_s)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()


# ------------------------------------------------------------------ one measurement
def seconds_with(workers: int, options: argparse.Namespace, url: str, place: Path) -> float:
    """Wall seconds of the study with so many workers; they are ready when the clock starts."""
    with ExitStack() as stack:
        for number in range(workers):
            stack.enter_context(worker(place, f"w{workers}-{number}"))
        words = [str(write_study(options, url, place, workers)), str(place / "cases"), str(place / f"out{workers}")]
        command = [
            sys.executable,
            "-m",
            "research.benchmarks.services.two_workers",
            "--inside",
            *words,
            f"file://{place}/share{workers}",
        ]
        command += ["--shards", str(options.shards), "--jobs", str(options.jobs)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)  # noqa: S603 - our own module
    if done.returncode:
        raise RuntimeError(f"the study with {workers} worker(s) failed: {done.stderr[-3000:]}")
    seconds, cases = done.stdout.split()[-2:]
    if int(cases) != options.cases:
        raise RuntimeError(f"{cases} of {options.cases} cases came home: {done.stderr[-2000:]}")
    return float(seconds)


def write_study(options: argparse.Namespace, url: str, place: Path, workers: int) -> Path:
    """A study of one arm; a name for each measurement, since a share belongs to one study."""
    model = [f"backbone.base_url={url}", "road_writer.form=layout"] if options.config == "openai.yaml" else []
    arm = {"name": "arm", "config": options.config, "set": [*model, "tracker=none"]}
    file = place / f"hosts{workers}.yaml"
    file.write_text(yaml.safe_dump({"title": "hosts", "arms": [arm]}))
    return file


@contextmanager
def worker(place: Path, name: str) -> Iterator[None]:
    """A Prefect worker with a temporary folder of its own, ready for work."""
    home = place / name
    home.mkdir()
    port = free_port()
    environment = {"TMPDIR": str(home), "PREFECT_WORKER_WEBSERVER_HOST": "127.0.0.1",
                   "PREFECT_WORKER_WEBSERVER_PORT": str(port), "PREFECT_WORKER_QUERY_SECONDS": "1",
                   "PYTHONPATH": str(ROOT)}  # fmt: skip
    command = [sys.executable, "-m", "prefect", "worker", "start", "--pool", "sgcad", "--type", "process",
               "--limit", "1", "--name", name, "--with-healthcheck", "--install-policy", "never"]  # fmt: skip
    with served(command, f"http://127.0.0.1:{port}/health", environment, home / "worker.log"):
        yield


def inside(words: Sequence[str], shards: int, jobs: int) -> None:
    """The process that starts the study: prints how long it took and how many cases were generated."""
    study, cases, out, address = words
    settings.quiet_libraries()
    from flows.deploy.shards import study_on_hosts
    from flows.study.plan import plan
    from flows.study.watch_shards import Hosts
    from flows.study_file.spec import load_study

    made = plan(load_study(Path(study)), Path(out), cases=[Path(cases)])
    statuses: list[str] = []
    started = time.perf_counter()
    study_on_hosts(
        made,
        Hosts(address, shards=shards, jobs=jobs, start_s=PATIENCE_S),
        lambda job, ending, untracked: statuses.append(ending.result["status"]),
    )
    sys.stdout.write(f"{time.perf_counter() - started} {statuses.count('generated')}\n")


def compare(options: argparse.Namespace, place: Path) -> str:
    """Both measurements on one server, as a sentence."""
    port = free_port()
    os.environ.update(PREFECT_API_URL=f"http://127.0.0.1:{port}/api", PREFECT_HOME=str(place / "prefect"))
    command = [sys.executable, "-m", "prefect", "server", "start", "--port", str(port), "--no-ui"]
    with (
        served(command, f"http://127.0.0.1:{port}/api/health", {}, place / "server.log"),
        slow_model(options.delay) as model,
    ):
        for words in (["work-pool", "create", "sgcad", "--type", "process"],
                      ["deploy", "-n", "shard", "--prefect-file", str(ROOT / "deploy" / "prefect.yaml")]):  # fmt: skip
            prefect = [sys.executable, "-m", "prefect", "--no-prompt", *words]
            subprocess.run(prefect, cwd=ROOT, check=True, capture_output=True)  # noqa: S603 - ours
        one, two = (seconds_with(count, options, model.url, place) for count in (1, 2))
        asked = model.asked
    return (
        f"{options.config}, {options.cases} cases in {options.shards} shards, {options.jobs} at a time, "
        f"{options.delay:g} s an answer ({asked} answers), {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}:\n"
        f"one worker {one:.1f} s, two workers {two:.1f} s: {one / two:.2f} times as fast"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", default="openai.yaml")
    parser.add_argument("--cases", type=int, default=48)
    parser.add_argument("--shards", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--delay", type=float, default=1.0, help="seconds an answer takes")
    parser.add_argument("--inside", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.inside:
        inside(options.inside, options.shards, options.jobs)
        return
    with tempfile.TemporaryDirectory(prefix="sgcad-hosts-") as folder:
        for number in range(options.cases):
            shutil.copytree(REPORT, Path(folder) / "cases" / f"{number:04d}")
        sys.stdout.write(compare(options, Path(folder)) + "\n")


if __name__ == "__main__":
    main()
