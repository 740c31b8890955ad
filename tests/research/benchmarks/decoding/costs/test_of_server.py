"""What contrast costs a server: both ways are asked, and the costs are those of the process that is named."""

import os
from pathlib import Path

import pytest

from research.benchmarks.decoding.costs import of_server
from research.benchmarks.decoding.served import serving
from research.benchmarks.decoding.served_model import ServedModel
from research.benchmarks.decoding.server_contrast import random_model


@pytest.mark.slow
def test_every_arm_has_answers_tokens_and_a_ratio(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = random_model(tmp_path)
    with serving(ServedModel(folder, window=8192), "served") as url:
        of_server.main(
            ["--base-url", url, "--protocol", "vllm", "--tokenizer", str(folder), "--process", str(os.getpid()),
             "--answers", "1"]
        )  # fmt: skip
    lines = capsys.readouterr().out.strip().splitlines()[2:]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    assert [row[:2] for row in rows] == [["alpha 0.3, beta 0.1", "1"], ["alpha 0.7, beta 0.1", "1"]]
    for _, _, tokens, requests, whole, each in rows:
        assert float(tokens) > 5
        assert float(requests) >= 2
        assert float(whole) > 0.5
        assert float(each) > 0.5
