"""A program that takes esmini's options and behaves as the file beside it says: writes a log, talks, dies, hangs."""

from __future__ import annotations

import os
import stat
import sys
from itertools import chain
from pathlib import Path

HEAD = "esmini GIT REV: 1\nesmini GIT TAG: v3\nScenario File Name: scenario.xosc\nNumber of Vehicles: 2\n"
COLUMNS = (
    "Entity_Name [-]", "Entity_ID [-]", "bb_x [m]", "bb_y [m]", "World_Position_X [m]", "World_Position_Y [m]",
    "World_Heading_Angle [rad]",
)  # fmt: skip


def log(*bodies, steps=60, columns=COLUMNS, dt_s=0.05):
    """A log of bodies (name, x, y, heading, speed, box center ahead) that drive straight on east."""
    head = ["Index [-]", "TimeStamp [s]", *(f"#{n} {c}" for n in range(1, len(bodies) + 1) for c in columns)]
    lines = [HEAD + ", ".join(head) + ", "]
    for k in range(steps):
        values = {
            n: [name, n, ahead, 0.0, x + speed * k * dt_s, y, heading]
            for n, (name, x, y, heading, speed, ahead) in enumerate(bodies)
        }
        lines.append(", ".join(map(str, [k, f"{k * dt_s:f}", *chain(*values.values())])) + ", ")
    return "\n".join(lines) + "\n"


def make(folder: Path, content: str | None, says: str = "", then: str = "") -> Path:
    """An executable that writes `content` where it is told to log, says something and then runs a statement."""
    binary = folder / "esmini"
    body = (
        f"#!{sys.executable} -S\nimport os, signal, sys, time\n"
        f"place = sys.argv[sys.argv.index('--csv_logger') + 1]\ncontent = {content!r}\n"
        "assert '--headless' in sys.argv and os.path.exists('scenario.xosc') and os.path.exists('road.xodr')\n"
        f"if content is not None: open(place, 'w').write(content)\nprint({says!r}, flush=True)\n{then}\n"
    )
    binary.write_text(body)
    os.chmod(binary, stat.S_IRWXU)
    return binary
