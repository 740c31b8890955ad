"""A bare environment that sees the checkout and what it depends on, for packages that are installed into it."""

import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


class Environment:
    """An environment of its own; `install` packages, `run` its programs."""

    def __init__(self, place):
        self.bin = place / "bin"
        venv.create(place)  # pip and setuptools are those that are seen
        (site,) = (place / "lib").glob("python*/site-packages")
        seen = [p for p in map(Path, sys.path) if p.name == "site-packages"]
        (site / "dependencies.pth").write_text("".join(f"{p}\n" for p in [ROOT, *seen]))
        start = f"#!{self.bin / 'python'}\nfrom flows.cli import main\nmain()\n"
        (self.bin / "sgcad").write_text(start)
        (self.bin / "sgcad").chmod(0o755)

    def run(self, program, *words, cwd):
        command = [str(self.bin / program), *map(str, words)]
        given = {"PATH": f"{self.bin}:/usr/bin:/bin", "HOME": str(cwd), "COLUMNS": "200"}
        return subprocess.run(command, cwd=cwd, env=given, capture_output=True, text=True, timeout=600)

    def install(self, *folders, cwd):
        """Without dependencies, which are seen already; as a person would install them."""
        words = [word for folder in folders for word in ("-e", str(folder))]
        done = self.run("python", "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation", *words, cwd=cwd)
        assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    return Environment(tmp_path_factory.mktemp("bare") / "venv")
