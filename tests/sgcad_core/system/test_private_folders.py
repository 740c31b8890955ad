"""Folders of results open as far as the folder around them, and never to others."""

import stat
import subprocess
import sys

import pytest

from sgcad_core.system.private_folders import open_as_parent


@pytest.mark.parametrize(
    ("around", "made"), [(0o700, 0o700), (0o755, 0o750), (0o770, 0o770), (0o777, 0o770), (0o500, 0o700)]
)
def test_a_folder_opens_as_the_one_around_it_but_not_to_others(tmp_path, around, made):
    (folder := tmp_path / "runs" / "case").mkdir(parents=True, mode=0o700)
    folder.parent.chmod(around)
    open_as_parent(folder)
    assert stat.S_IMODE(folder.stat().st_mode) == made


@pytest.mark.parametrize(("umask", "made"), [(0o022, 0o640), (0o002, 0o660), (0o077, 0o600)])
def test_files_go_by_the_users_umask_without_others(tmp_path, umask, made):
    code = f"import os; os.umask({umask}); from sgcad_core.system.private_folders import deny_others; deny_others()"
    code += f"; open({str(tmp_path / 'made')!r}, 'w').close()"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert stat.S_IMODE((tmp_path / "made").stat().st_mode) == made
