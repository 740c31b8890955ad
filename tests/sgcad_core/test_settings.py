"""Folders that variables name."""

import pytest

from sgcad_core import settings
from sgcad_core.errors import MissingTool


def test_prefects_folder_is_made_for_its_user_alone(monkeypatch, tmp_path):
    monkeypatch.setenv("PREFECT_HOME", str(tmp_path / "a" / "b"))
    assert settings.writable_prefect_home() == tmp_path / "a" / "b"
    assert (tmp_path / "a" / "b").stat().st_mode & 0o777 == 0o700
    assert list((tmp_path / "a" / "b").iterdir()) == []


@pytest.mark.parametrize("variable", ["PREFECT_HOME", "HOME"])
def test_a_folder_of_prefects_that_cannot_be_written_is_named_with_its_variable(monkeypatch, variable):
    monkeypatch.delenv("PREFECT_HOME", raising=False)
    monkeypatch.setenv(variable, "/proc")
    with pytest.raises(
        MissingTool, match=rf"/proc.*{variable}\), cannot be written \(.*: set the variable PREFECT_HOME"
    ):
        settings.writable_prefect_home()


def test_a_user_without_a_home_is_told_which_variable_to_set(monkeypatch):
    monkeypatch.delenv("PREFECT_HOME", raising=False)
    monkeypatch.setattr("os.path.expanduser", lambda path: path)  # no HOME, and no entry among the system's users
    with pytest.raises(MissingTool, match="no home folder is known for this user: set the variable HOME"):
        settings.prefect_home()
