"""What the sandbox costs: wall and processor time of a script, against the same script in this process.

python -m benchmarks.sandbox [--runs 20]
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import statistics
import sys
import time

from plugins.scenario_writer.sandbox.outside import run_script
from sgcad_core import settings


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20)
    runs = parser.parse_args().runs
    text = (settings.PROMPTS / "code.md").read_text(encoding="utf-8")
    script = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    plain = _in_process(script, runs)
    run_script(script)  # the first reads the disk
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = [run_script(script) for _ in range(runs)]
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    computed = (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / runs
    walls, wall = ran[-1].walls, sorted(r.seconds for r in ran)
    sys.stdout.write(
        f"{runs} scripts, walls {', '.join(walls)}, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n"
        f"overhead: median {1000 * (statistics.median(wall) - plain):.0f} ms, worst {1000 * (wall[-1] - plain):.0f} ms "
        f"wall; {1000 * computed:.0f} ms of processor time a script; the script itself {1000 * plain:.1f} ms\n"
    )


def _in_process(script: str, runs: int) -> float:
    """Median seconds of our own example script without a sandbox."""
    code, seconds = compile(script, "<example>", "exec"), []
    for _ in range(runs):
        started = time.perf_counter()
        exec(code, {"__name__": "example"})  # noqa: S102 - our own prompt's example, no model's
        seconds.append(time.perf_counter() - started)
    return statistics.median(seconds)


if __name__ == "__main__":
    main()
