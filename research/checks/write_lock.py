"""Writes deploy/requirements.lock: what the image installs, with the digest of every file (`make lock`).

    pip install --no-deps --require-hashes -r deploy/requirements.lock

The versions are those of deploy/constraints.txt; the digests are what the package index tells of the files that pip
would take on this platform (the image's: Linux on x86-64, Python 3.11). torch is left out: which build of it is wanted
depends on the card, so the Dockerfile installs it first, by version.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sgcad_core import settings
from sgcad_core.errors import MissingTool

DEPLOY = settings.ROOT / "deploy"
CONSTRAINTS, LOCK = DEPLOY / "constraints.txt", DEPLOY / "requirements.lock"
OF_THE_CARD = {"torch", "accelerate", "bitsandbytes", "setuptools", "pip"}
OF_TESTS = {
    "boto3", "execnet", "grimp", "hypothesis", "import-linter", "iniconfig", "lxml-stubs", "moto", "mypy",
    "mypy_extensions", "peft", "py-partiql-parser", "pytest", "pytest-xdist", "responses", "ruff", "s3transfer",
    "types-psutil", "types-pyyaml", "xmltodict",
}  # fmt: skip
LEFT_OUT = OF_THE_CARD | OF_TESTS
"""What goes by the card or the environment, and what only tests need."""


def lock(constraints: Path = CONSTRAINTS) -> str:
    """The lock file's text. Raises MissingTool with what pip says."""
    lines = [line for line in constraints.read_text(encoding="utf-8").splitlines() if "==" in line]
    wanted = [line for line in lines if line.split("==")[0].lower() not in LEFT_OUT]
    with tempfile.TemporaryDirectory(prefix="sgcad-lock-") as place:
        asked, report = Path(place) / "asked.txt", Path(place) / "report.json"
        asked.write_text("\n".join(wanted) + "\n", encoding="utf-8")
        command = [
            sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--ignore-installed", "--no-deps",
            "--disable-pip-version-check", "--report", str(report), "-r", str(asked),
        ]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - our own interpreter
        if done.returncode:
            raise MissingTool(f"pip cannot find every version of {constraints}:\n{done.stderr[-2000:]}")
        found = json.loads(report.read_text(encoding="utf-8"))["install"]
    told = sorted((_entry(one) for one in found), key=str.lower)
    head = "# Written by `make lock` from deploy/constraints.txt; torch is installed before it, by version.\n"
    return head + "\n".join(told) + "\n"


def _entry(one: dict[str, Any]) -> str:
    about = one["metadata"]
    digests = one["download_info"]["archive_info"]["hashes"]
    return f"{about['name']}=={about['version']} --hash=sha256:{digests['sha256']}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the lock file and print its place."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args(
        arguments
    )
    LOCK.write_text(lock(), encoding="utf-8")
    sys.stdout.write(f"{LOCK}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
