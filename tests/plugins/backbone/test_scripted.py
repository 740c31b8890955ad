"""The scripted backbone: order, conditions, files and its errors."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from pydantic import ValidationError

from plugins.backbone.scripted import Scripted, question_digest
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from sgcad_core.case.records import Context, Query, Stage
from sgcad_core.errors import ConfigError, InvalidOutput

CONTEXT = Context(narrative="V1 struck V2 at an intersection.")


def ask(backbone: Scripted, case: str = "c1", stage: Stage = "road", attempt: int = 1) -> str:
    query = Query(task="Describe the road.", case=case, stage=stage, attempt=attempt)
    return backbone.generate(CONTEXT, query, Greedy()).text


def test_answers_without_conditions_come_in_order() -> None:
    backbone = Scripted(answers=("first", {"a": [1, 2]}))
    assert [ask(backbone), ask(backbone)] == ["first", '{"a":[1,2]}']


def test_an_empty_script_names_what_it_was_asked() -> None:
    backbone = Scripted(answers=("only",))
    ask(backbone)
    with pytest.raises(InvalidOutput, match="case 'c9', stage scenario, attempt 3: its 1 answers"):
        ask(backbone, "c9", "scenario", 3)


def test_a_condition_wins_over_order_and_does_not_wear_out() -> None:
    backbone = Scripted(
        answers=(
            "plain",
            {"attempt": 2, "answer": "second attempt"},
            {"stage": "scenario", "case": "c1", "answer": {"x": 1}},
            {"narrative": "no such words", "answer": "never"},
        )
    )
    assert ask(backbone, attempt=2) == "second attempt"
    assert ask(backbone, attempt=2) == "second attempt"
    assert ask(backbone, stage="scenario") == '{"x":1}'
    assert ask(backbone) == "plain"


def test_words_of_the_narrative_and_the_task_are_conditions() -> None:
    backbone = Scripted(answers=({"narrative": "struck V2", "task": "road", "answer": "found"},))
    assert ask(backbone) == "found"


def test_yaml_and_json_lines_files_read_alike(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("- {attempt: 1, answer: {lanes: 2}}\n- text\n")
    (tmp_path / "a.jsonl").write_text('{"attempt": 1, "answer": {"lanes": 2}}\n"text"\n')
    for name in ("a.yaml", "a.jsonl"):
        backbone = Scripted(file=tmp_path / name)
        assert json.loads(ask(backbone)) == {"lanes": 2}
        assert ask(backbone, attempt=2) == "text"


def test_a_refusal_in_the_script_finishes_as_refused() -> None:
    backbone = Scripted(answers=({"answer": {"refuse": "no layout", "missing": ["lanes"]}},))
    assert backbone.generate(CONTEXT, Query(task=""), Greedy()).finish == "refused"


def test_threads_share_one_order_and_no_answer_is_given_twice() -> None:
    backbone = Scripted(answers=tuple(str(i) for i in range(200)))
    with ThreadPoolExecutor(8) as pool:
        got = list(pool.map(lambda _: ask(backbone), range(200)))
    assert sorted(got, key=int) == [str(i) for i in range(200)]


def test_a_script_without_answers_is_refused_at_once() -> None:
    with pytest.raises(ValidationError, match="needs `answers` or `file`"):
        Scripted()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.yaml", "answer: 1", "expected a list of answers, found dict"),
        ("a.jsonl", "{", "cannot be read"),
        ("a.yaml", "- {answer: 1, wheather: dry}", "answer 1: .*wheather"),
    ],
)
def test_a_broken_script_names_the_file_and_the_fault(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(ConfigError, match=f"(?s)a\\.{name.split('.')[1]}.*{message}"):
        ask(Scripted(file=tmp_path / name))


def test_a_missing_script_is_a_config_error(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.yaml: cannot be read"):
        ask(Scripted(file=tmp_path / "none.yaml"))


def test_a_contrastive_decoder_is_refused() -> None:
    with pytest.raises(ConfigError, match="Cad needs logits; the scripted backbone gives none"):
        Scripted(answers=("a",)).generate(CONTEXT, Query(task=""), Cad())


def test_a_folder_of_dialogues_answers_by_case_stage_and_attempt(tmp_path):
    (tmp_path / "a.yaml").write_text("- {case: c1, road: [{a: 1}], scenario: [{a: 2}, {a: 3}]}\n")
    (tmp_path / "b.yaml").write_text("- {case: c2, about: plain, road: [{a: 4}]}\n")
    backbone = Scripted(file=tmp_path)

    def said(case, stage, attempt):
        query = Query(task="t", case=case, stage=stage, attempt=attempt)
        return backbone.generate(Context(narrative=""), query, Greedy()).text

    assert [said("c1", "scenario", n) for n in (1, 2, 3)] == ['{"a":2}', '{"a":3}', '{"a":3}']
    assert (said("c1", "road", 2), said("c2", "road", 1)) == ('{"a":1}', '{"a":4}')


def test_answers_to_another_question_are_refused(tmp_path):
    query = Query(task="t", case="c1", stage="road")
    (tmp_path / "a.yaml").write_text("- {case: c1, road: [{a: 1}]}\n")
    (tmp_path / "asked.yaml").write_text(f"c1: {{road: {question_digest(query)}}}\n")
    backbone = Scripted(file=tmp_path)
    assert backbone.generate(Context(narrative=""), query, Greedy()).text == '{"a":1}'
    changed = query.model_copy(update={"answer_schema": {"type": "object"}})
    with pytest.raises(ConfigError, match="has changed since its answers were recorded"):
        backbone.generate(Context(narrative=""), changed, Greedy())


def test_a_broken_file_of_digests_is_named(tmp_path):
    (tmp_path / "asked.yaml").write_text("c1: 5\n")
    (tmp_path / "a.yaml").write_text("- {case: c1, road: [{a: 1}]}\n")
    with pytest.raises(ConfigError, match=r"asked\.yaml"):
        Scripted(file=tmp_path).generate(Context(narrative=""), Query(task="t", case="c1", stage="road"), Greedy())
