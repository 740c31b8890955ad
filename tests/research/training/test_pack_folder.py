"""Packing a training folder: small flat files that come back whole."""

from pathlib import Path

import pytest

from research.training.pack_folder import PART, pack, unpack


def run_folder(folder: Path) -> Path:
    (folder / "tokenizer").mkdir(parents=True)
    (folder / "tokenizer" / "tokenizer.json").write_text("{}")
    (folder / "state.pt").write_bytes(bytes(range(256)) * (2 * PART // 256 + 7))
    (folder / "log.jsonl").write_text('{"step": 1}\n')
    return folder


def test_a_packed_run_comes_back_whole(tmp_path: Path) -> None:
    run = run_folder(tmp_path / "run")
    files = pack(run, tmp_path / "packed")
    assert len(files) <= 8
    assert max(file.stat().st_size for file in files) <= PART
    unpack(tmp_path / "packed", tmp_path / "again")
    for name in ("state.pt", "log.jsonl", "tokenizer/tokenizer.json"):
        assert (tmp_path / "again" / name).read_bytes() == (run / name).read_bytes()


def test_a_missing_part_is_named(tmp_path: Path) -> None:
    pack(run_folder(tmp_path / "run"), tmp_path / "packed")
    (tmp_path / "packed" / "state.pt.1").unlink()
    with pytest.raises(FileNotFoundError, match="copy all of them"):
        unpack(tmp_path / "packed", tmp_path / "again")
