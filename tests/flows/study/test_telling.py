"""What the command says of a study."""

from dataclasses import replace

import pytest
import yaml
from typer.testing import CliRunner

from flows.batch.run_batch import Cost
from flows.cli import app
from flows.study.plan import plan
from flows.study.run_study import cost_line
from flows.study_file.spec import load_study
from sgcad_core.errors import ConfigError


@pytest.fixture
def made(tmp_path, config_file, reports):
    """The plan of one arm over one case."""
    config_file()
    file = tmp_path / "kits.yaml"
    file.write_text(yaml.safe_dump({"title": "Kits", "arms": [{"name": "one", "config": "kit.yaml"}]}))
    return plan(load_study(file), tmp_path / "out", cases=[reports(a="")], jobs=2)


def test_orchestration_is_told_a_case_and_as_a_share(made):
    cost = Cost(done=100, elapsed_s=50.0, own_s=4.0, server_s=1.0)
    assert cost_line(made, cost) == (
        "100 cases in 50 s; orchestration 50 ms of processor time a case, 5.0% of the time of 2 cores"
    )
    assert "without the Prefect server's" in cost_line(made, replace(cost, server_s=None))
    assert cost_line(made, Cost(0, 1.25)) == "all cached: 1.2 s"


@pytest.mark.parametrize(
    ("named", "told"),
    [
        ("mini_no_contrast.yaml", "mini_no_contrast: valid; extends mini.yaml; seed 42"),
        ("paper/llama90b_sg_cadvlm", "extends paper/qwen72b_sg_cadvlm.yaml"),
        ("alpha_llama90b", "Llama-3.2-90B; 7 arms; extends alpha_qwen72b.yaml"),
        ("rag_qwen72b/no_rag", "rag_qwen72b-no_rag: valid; extends paper/qwen72b_sg_cadvlm.yaml"),
    ],
)
def test_check_tells_what_a_config_or_study_extends(named, told):
    said = CliRunner().invoke(app, ["check", named])
    assert said.exit_code == 0
    assert told in said.output


def test_check_names_the_arms_of_a_study():
    said = CliRunner().invoke(app, ["check", "refinement"])
    assert said.exit_code == 0
    assert "Refinement, embedded model; 10 arms" in said.output
    assert "max_attempts_10  mini.yaml max_attempts=10" in said.output


def test_a_faulty_study_starts_nothing(tmp_path):
    said = CliRunner().invoke(app, ["study", "refinement", "--out", str(tmp_path / "out"), "--set", "oops=1"])
    assert isinstance(said.exception, ConfigError)
    assert str(said.exception).count("oops: unknown key") == 10
    assert "no cases: give --cases DIR" in str(said.exception)
    assert not (tmp_path / "out").exists()
