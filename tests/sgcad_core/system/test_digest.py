"""SHA-256 of files."""

from pathlib import Path

import pytest

from sgcad_core.system.digest import file_sha256


def test_of_known_content(tmp_path: Path) -> None:
    file = tmp_path / "abc"
    file.write_bytes(b"abc")
    assert file_sha256(file) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"  # FIPS 180-2, B.1


def test_of_no_file(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="absent"):
        file_sha256(tmp_path / "absent")
