"""Scripts beside an ego's file that start it in esmini and in CARLA's scenario_runner. Knows their options only."""

from __future__ import annotations

FILE, CARLA_FILE = "ego.xosc", "ego_carla.xosc"
ESMINI, CARLA = "run_esmini.sh", "run_carla.py"

RUN_ESMINI = """\
#!/bin/sh
# Plays ego.xosc in esmini; further arguments go to esmini.
#   ESMINI=/path/to/esmini   the binary, else `esmini` on PATH
#   EGO=...                  who drives the ego: InteractiveController (arrow keys, default), UDPDriverController,
#                            ExternalController (your program, through esmini's library), ACCController ...
cd "$(dirname "$0")" || exit 1
driven=ego_driven.xosc
sed "s/value=\\"ExternalController\\"/value=\\"${EGO:-InteractiveController}\\"/" ego.xosc > "$driven" || exit 1
if [ $# -eq 0 ]; then set -- --window 60 60 1024 576; fi
if ! command -v "${ESMINI:-esmini}" > /dev/null; then
  echo "${ESMINI:-esmini}: no esmini there; name its binary: ESMINI=/path/to/esmini $0" >&2
  exit 127
fi
exec "${ESMINI:-esmini}" --osc "$driven" "$@"
"""

RUN_CARLA = '''\
"""Runs ego_carla.xosc in CARLA's scenario_runner, which waits for a driver of the ego.

    SCENARIO_RUNNER_ROOT=/path/to/scenario_runner python run_carla.py [options of scenario_runner.py]

A CARLA server must run. Start your stack, or scenario_runner's manual_control.py, on the vehicle {ego!r} (role_name).
"""

import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
root = os.environ.get("SCENARIO_RUNNER_ROOT", "")
runner = pathlib.Path(root) / "scenario_runner.py"
if not root or not runner.is_file():
    sys.exit(f"SCENARIO_RUNNER_ROOT={{root!r}}: no scenario_runner.py there; name CARLA's scenario_runner folder")
options = sys.argv[1:] or ["--sync", "--output"]
sys.exit(subprocess.call([sys.executable, str(runner), "--openscenario", str(HERE / "ego_carla.xosc"), *options]))
'''


def run_carla(ego: str) -> str:
    """The script that starts scenario_runner."""
    return RUN_CARLA.format(ego=ego)
