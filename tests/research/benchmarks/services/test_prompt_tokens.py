"""Tokens of prompts and answers, counted in the folders of finished cases."""

from pathlib import Path

from research.benchmarks.services.prompt_tokens import counts, main, table
from sgcad_core.settings import ROOT

WEIGHTS = ROOT / "plugins" / "backbone" / "mini" / "weights"


def finished(folder: Path) -> Path:
    for attempt, prompt in {"road-01": "a b c", "road-02": "a b c d", "scenario-01": "a"}.items():
        place = folder / "config" / "case" / "attempts" / attempt
        place.mkdir(parents=True)
        (place / "prompt.txt").write_text(prompt)
        (place / "answer.txt").write_text("x y")
        (place / "findings.txt").write_text("is no text of a model")
    (folder / "config" / "case" / "report.txt").write_text("it was told")
    return folder


def test_texts_are_counted_by_stage_and_attempt_with_the_report(tmp_path):
    found = counts(finished(tmp_path), lambda text: len(text.split()))
    assert found == {
        ("road, first attempt", "prompt"): [3 + 3], ("road, first attempt", "answer"): [2],
        ("road, further attempts", "prompt"): [4 + 3], ("road, further attempts", "answer"): [2],
        ("scenario, first attempt", "prompt"): [1 + 3], ("scenario, first attempt", "answer"): [2],
    }  # fmt: skip


def test_the_table_says_how_many_prompts_are_within_the_limit():
    *_, last = table({("road, first attempt", "prompt"): [3000, 3001], ("road, first attempt", "answer"): [9000]})
    assert last == "\n1 of 2 prompts have at most 3,000 tokens."


def test_the_command_counts_with_a_models_tokenizer_or_says_what_is_missing(tmp_path, capsys):
    assert main([str(tmp_path), "--tokenizer", str(WEIGHTS)]) == 1
    assert "no attempts/*/prompt.txt below it" in capsys.readouterr().err
    assert main([str(finished(tmp_path)), "--tokenizer", str(WEIGHTS)]) == 0
    assert "3 of 3 prompts have at most 3,000 tokens." in capsys.readouterr().out
