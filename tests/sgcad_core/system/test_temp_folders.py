"""A killed process leaves its folder, and the next one removes it; nobody's folder is removed while he lives."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from filelock import FileLock

from sgcad_core.system import temp_folders


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """A temporary folder of this test's own."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    yield tmp_path
    tempfile.tempdir = None


def killed(code):
    """Run code that kills its own process."""
    imports = "import os\nfrom pathlib import Path\nfrom sgcad_core.system import temp_folders"
    told = f"{imports}\n{code}\n    os.kill(os.getpid(), 9)"
    assert subprocess.run([sys.executable, "-c", told], check=False).returncode == -9


def test_a_folder_vanishes_with_its_block(place):
    with temp_folders.temp_folder("test") as folder:
        (folder / "file").write_text("x")
        assert folder.parent.parent == place
        assert folder.stat().st_mode & 0o777 == 0o700
    assert not list(place.iterdir())


def test_a_process_that_ends_at_once_removes_its_own_folders_alone(place):
    code = "from sgcad_core.system.temp_folders import *\nimport os\n"
    code += "with temp_folder('test'):\n    if os.fork() == 0:\n        remove_own_folders(); os._exit(0)\n"
    code += "    os.wait(); print(len(leftover_folders()), len(os.listdir(os.environ['TMPDIR'])), flush=True)\n"
    code += "    remove_own_folders(); os._exit(0)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["0", "1"]  # a forked child owns none of them
    assert not list(place.iterdir())


def test_a_folder_may_be_locked_by_who_uses_it():
    with temp_folders.temp_folder("test") as folder, FileLock(folder / "lock", blocking=False) as held:
        assert held.is_locked


def test_what_a_killed_process_left_is_found_and_removed(place):
    killed('with temp_folders.temp_folder("test") as folder:\n    (folder / "file").write_text("x")')
    assert [p.parent for p in temp_folders.leftover_folders()] == [place]
    assert temp_folders.remove_leftover_folders() == 1
    assert not list(place.iterdir())


def test_a_living_process_keeps_its_folder():
    with temp_folders.temp_folder("test") as folder:
        assert temp_folders.leftover_folders() == []
        assert temp_folders.remove_leftover_folders() == 0
        assert folder.is_dir()


def test_nothing_that_only_begins_like_ours_is_removed(place):
    (place / f"{temp_folders.PREFIX}mine").mkdir()
    (place / "elsewhere").mkdir()
    (place / f"{temp_folders.PREFIX}test-abcdefgh").symlink_to(place / "elsewhere")
    (place / f"{temp_folders.PREFIX}test-abcdefgi").write_text("a file")
    assert temp_folders.remove_leftover_folders() == 0
    assert len(list(place.iterdir())) == 4


def test_a_folder_beside_its_target_takes_its_place_or_vanishes(place):
    target = place / "index"
    with pytest.raises(ZeroDivisionError), temp_folders.folder_beside(target):
        raise ZeroDivisionError
    with temp_folders.folder_beside(target) as partial:
        (partial / "file").write_text("whole")
        partial.rename(target)
    assert [p.name for p in place.iterdir()] == ["index"]


def test_what_was_killed_beside_a_target_goes_with_the_next_try(place):
    opened = f"with temp_folders.folder_beside(Path({str(place / 'index')!r})) as folder:"
    killed(f"{opened}\n    (folder / 'file').write_text('half')")
    assert len(list(place.iterdir())) == 1
    with temp_folders.folder_beside(place / "index") as one, temp_folders.folder_beside(place / "index") as other:
        assert set(place.iterdir()) == {one.parent, other.parent}


def test_no_lock_stays_open(place):
    before = len(os.listdir("/proc/self/fd")) if Path("/proc/self/fd").is_dir() else 0
    for _ in range(3):
        with temp_folders.temp_folder("test"):
            temp_folders.leftover_folders()
    after = len(os.listdir("/proc/self/fd")) if Path("/proc/self/fd").is_dir() else 0
    assert after == before
