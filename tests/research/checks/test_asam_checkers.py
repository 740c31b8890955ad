"""ASAM's own checkers over the files of the bundled reports, in their own environment."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VENV = ROOT / ".venv-qc"


@pytest.fixture(scope="module")
def checkers():
    """The interpreter of .venv-qc; made where make and the package index are at hand, else the test says so."""
    python = VENV / "bin" / "python"
    if not (VENV / ".ready").exists():
        if shutil.which("make") is None:
            pytest.skip("make is not installed, so .venv-qc cannot be made")
        made = subprocess.run(["make", ".venv-qc/.ready"], cwd=ROOT, capture_output=True, text=True)
        if made.returncode:
            pytest.skip(f"ASAM's checkers cannot be installed here: {made.stderr.strip().splitlines()[-1][:200]}")
    return python


@pytest.mark.slow
def test_asams_checkers_pass_what_the_bundled_reports_become(checkers, tmp_path):
    code = "from flows.cli import main; main()"
    given = ["evaluate", "docs/demo", "--config", "configs/template.yaml", "--out", str(tmp_path)]
    subprocess.run([sys.executable, "-c", code, *given], cwd=ROOT, check=True, capture_output=True, timeout=600)
    assert list(tmp_path.rglob("scenario.xosc")), "nothing was written"
    judged = subprocess.run(
        [checkers, "research/checks/asam_checkers.py", str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert judged.returncode == 0, judged.stdout + judged.stderr
