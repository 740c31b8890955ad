"""Plays an ego's file in esmini's library, with the ego set from outside at every step. One scenario a process.

    python -m research.benchmarks.handover.esmini_library LIBRARY EGO.xosc EGO_NAME POSES.npy OUT.npz

POSES: (n, 4) x, y, heading, speed of the ego's origin every 0.05 s. OUT: `names`, and for each a table of box centers
(m, 4) x, y, heading, speed. Ends with 3 where esmini does not load the file. Knows nothing of cases.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

STEP_S = 0.05
NOT_LOADED = 3
_FLOATS, _INTS = ctypes.c_float, ctypes.c_int


class State(ctypes.Structure):
    """esmini's SE_ScenarioObjectState, as in version 3 of its header."""

    _fields_ = [
        ("id", _INTS), ("model_id", _INTS), ("ctrl_type", _INTS), ("timestamp", ctypes.c_double),
        ("x", ctypes.c_double), ("y", ctypes.c_double), ("z", ctypes.c_double), ("h", ctypes.c_double),
        ("p", ctypes.c_double), ("r", ctypes.c_double), ("roadId", ctypes.c_uint32), ("junctionId", ctypes.c_uint32),
        ("t", ctypes.c_double), ("laneId", _INTS), ("laneOffset", ctypes.c_double), ("s", ctypes.c_double),
        ("speed", ctypes.c_double), ("centerX", ctypes.c_double), ("centerY", ctypes.c_double),
        ("centerZ", ctypes.c_double), ("rest", ctypes.c_double * 16),
    ]  # fmt: skip


def play(library: Path, file: Path, ego: str, poses: np.ndarray) -> dict[str, np.ndarray]:
    """Tables of box centers by entity, until the scenario ends. Raises RuntimeError where it does not load."""
    se = ctypes.CDLL(str(library))
    se.SE_StepDT.argtypes = [ctypes.c_double]
    se.SE_ReportObjectPosXYH.argtypes = [_INTS, *[ctypes.c_double] * 3]
    se.SE_ReportObjectSpeed.argtypes = [_INTS, ctypes.c_double]
    se.SE_GetObjectName.restype = ctypes.c_char_p
    if se.SE_Init(str(file).encode(), 0, 0, 0, 0) != 0:
        raise RuntimeError("esmini does not load the file")
    ids = {se.SE_GetObjectName(se.SE_GetId(k)).decode(): se.SE_GetId(k) for k in range(se.SE_GetNumberOfObjects())}
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in ids}
    for pose in poses:
        x, y, heading, speed = (float(v) for v in pose)
        se.SE_ReportObjectPosXYH(ids[ego], x, y, heading)
        se.SE_ReportObjectSpeed(ids[ego], speed)
        for name, number in ids.items():
            rows[name].append(_center(se, number))
        if se.SE_GetQuitFlag() != 0 or se.SE_StepDT(STEP_S) != 0:
            break
    se.SE_Close()
    return {name: np.array(table) for name, table in rows.items()}


def _center(se: ctypes.CDLL, number: int) -> tuple[float, ...]:
    state = State()
    se.SE_GetObjectState(number, ctypes.byref(state))
    c, s = math.cos(state.h), math.sin(state.h)
    x, y = state.x + c * state.centerX - s * state.centerY, state.y + s * state.centerX + c * state.centerY
    return x, y, state.h, state.speed


def main(arguments: Sequence[str] | None = None) -> int:
    """Play one file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=Path)
    parser.add_argument("file", type=Path)
    parser.add_argument("ego")
    parser.add_argument("poses", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args(arguments)
    try:
        tables = play(options.library, options.file, options.ego, np.load(options.poses))
    except RuntimeError:
        return NOT_LOADED
    np.savez(options.out, names=np.array(list(tables)), **tables)
    return 0


if __name__ == "__main__":
    sys.exit(main())
