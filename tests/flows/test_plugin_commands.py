"""`sgcad plugins list` and other quick commands import no plugin's package and survive a broken one."""

import os
import subprocess
import sys

import pytest

from tests.effort import spread

HEAVY = ("torch", "transformers", "mlflow", "prefect", "lancedb", "scipy", "scenariogeneration", "libsumo")
PLUGINS = ("plugins", "numpy", "sgcad_core.interfaces")
WATCHED = """
import atexit, sys
from flows import cli
sys.argv = ["sgcad", *{words}]
atexit.register(lambda: print("IMPORTED", [m for m in {modules} if m in sys.modules]))
cli.app()
"""


def imported(*words, modules=HEAVY):
    code = WATCHED.format(words=list(words), modules=modules)
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()[-1]


@pytest.mark.parametrize("words", [("--help",), ("plugins", "list")])
def test_help_and_list_import_no_plugin(words):
    assert imported(*words, modules=HEAVY + PLUGINS) == "IMPORTED []"


@pytest.mark.parametrize("config", spread(["fused", "template", "mini"], 3))
def test_a_check_imports_nothing_heavy(config):
    assert imported("check", config) == "IMPORTED []"


# ------------------------------------------------------------------ broken packages
def distribution(folder, name, points, metadata=b"Metadata-Version: 2.1\nName: %s\nVersion: 1.0\n"):
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_bytes(metadata % name.encode() if b"%s" in metadata else metadata)
    (info / "entry_points.txt").write_bytes(points)


def package(folder, name, text):
    (folder / name).mkdir()
    (folder / name / "__init__.py").write_text(f"open({str(folder / 'imported')!r}, 'w')\n{text}\n")
    (folder / name / "inner.py").write_text("class Plug: ...\n")


@pytest.fixture
def broken(tmp_path):
    """Installs packages that are broken in every way."""
    package(tmp_path, "raising", "raise ValueError('no')")
    package(tmp_path, "leaving", "import sys; sys.exit(7)")
    distribution(tmp_path, "raising", b"[sgcad.decoder]\nraising = raising.inner:Plug\n")
    distribution(tmp_path, "leaving", b"[sgcad.decoder]\nleaving = leaving.inner:Plug\n")
    distribution(tmp_path, "classless", b"[sgcad.decoder]\nclassless = raising.inner:Gone\nnowhere = no_such:X\n")
    distribution(tmp_path, "valueless", b"[sgcad.decoder]\nvalueless = no module at all\n")
    distribution(tmp_path, "nameless", b"[sgcad.decoder]\nnameless = raising.inner:Plug\n", b"\xff\xfe\x00")
    distribution(tmp_path, "unparsed", b"[sgcad.decoder]\nminus = minus:Plug\nbytes = bytes_:Plug\n")
    (tmp_path / "minus.py").write_text(f"x = {'-' * 200_000}1\n")
    (tmp_path / "bytes_.py").write_bytes(b"\xff\x00")
    distribution(tmp_path, "long", b"[sgcad.decoder]\n%s = raising.inner:Plug\n" % (b"x" * 200_000))
    distribution(tmp_path, "escaping", b"[sgcad.decoder]\n\x1b[31mred = raising.inner:Plug\n")
    return tmp_path


def damage(folder):
    """Installs packages whose entry points cannot be read; pydantic itself does not start beside them."""
    distribution(folder, "binary", b"[sgcad.decoder]\n\xff\xfe\x00 = raising:X\n")
    distribution(folder, "equalless", b"[sgcad.decoder]\nno equals sign\n")


def sgcad(place, *words):
    paths = os.pathsep.join([str(place), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": paths, "COLUMNS": "400"}
    command = [sys.executable, "-m", "flows.cli", *words]
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def test_a_broken_package_is_one_line_of_the_list(broken):
    damage(broken)
    ended = sgcad(broken, "plugins", "list")
    assert ended.returncode == 0, ended.stderr
    assert not (broken / "imported").exists()
    lines = ended.stdout.splitlines()
    for name in ("raising", "leaving", "nameless", "red", "xxxxx"):
        assert len([line for line in lines if line.startswith("│ decoder") and f"{name} " in line]) == 1, name
    for said in (
        "decoder/classless is registered by classless: raising.inner:Gone, which does not exist",
        "decoder/nowhere is registered by classless: no_such:X, which does not exist",
        "decoder/minus is registered by unparsed: minus:Plug, which is no Python that can be parsed (",
        "decoder/bytes is registered by unparsed: bytes_:Plug, which cannot be read ('utf-8' codec",
        "decoder/valueless is registered by valueless: no module at all, which does not exist",
        "binary: its entry points cannot be read ('utf-8' codec can't decode byte 0xff",
        "equalless: its entry points cannot be read (",
    ):
        assert len([line for line in lines if said in line]) == 1, said
    assert "\x1b" not in ended.stdout
    assert len(ended.stdout) < 100_000


@pytest.mark.parametrize(("name", "said"), [("raising", "ValueError: no"), ("leaving", "SystemExit: 7")])
def test_a_package_that_fails_while_it_is_imported_is_named_where_it_is_used(broken, name, said):
    ended = sgcad(broken, "plugins", "show", name)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"sgcad: error: decoder '{name}' ({name}.inner:Plug) fails while it is imported: ")
    assert said in ended.stderr


def test_a_damaged_package_is_named_by_commands_that_cannot_work_beside_it(tmp_path):
    damage(tmp_path)
    ended = sgcad(tmp_path, "check", "mini")
    assert ended.returncode == 1
    assert "binary: its entry points cannot be read" in ended.stderr.splitlines()[-1]
