"""A training log is imported as it stands, and a training is followed to its end."""

import pytest

from research.training import training_flow
from research.training.training_flow import Training, Watched, held_out, options
from sgcad_core.errors import BadInput


def write(folder, text):
    folder.mkdir(exist_ok=True)
    (folder / "log.jsonl").write_text(text)
    return Training(folder, folder / "mlflow.db")


def test_a_line_that_is_still_being_written_waits_for_the_next_look(tmp_path):
    made = write(tmp_path / "mini", '{"step": 20, "loss": 0.5}\n{"step": 40, "lo')
    assert made.lines() == [{"step": 20, "loss": 0.5}]


@pytest.mark.parametrize(
    ("text", "said"), [("{oops}\n", "line 1 is no JSON"), ('{"step": 1}\n[]\n', "line 2 is no object")]
)
def test_a_broken_line_is_named(tmp_path, text, said):
    with pytest.raises(BadInput, match=rf"log.jsonl: {said}.*remove that line"):
        write(tmp_path / "mini", text).lines()


def test_a_folder_without_a_log_is_named_and_ends_with_code_2(tmp_path, capsys):
    assert training_flow.main(["import", str(tmp_path / "nowhere")]) == 2
    assert "nowhere/log.jsonl: cannot be read" in capsys.readouterr().err


def test_a_trainers_arguments_are_parameters():
    asked = ["--max-steps", "2", "--size=tiny", "--quick", "--seed", "1", "--last"]
    assert options(asked) == {"max_steps": "2", "size": "tiny", "quick": "true", "seed": "1", "last": "true"}
    assert options([]) == {}


def test_held_out_figures_are_shares_by_source_and_field():
    figures = {"text": {"ALL": [0.9, 100], "lanes": [0.8, 10]}, "refusals": {"recall": 0.5}}
    assert held_out(figures) == {
        "held_out_text_ALL": 0.9, "held_out_text_lanes": 0.8, "held_out_refusals_recall": 0.5
    }  # fmt: skip


def test_a_trainer_is_looked_at_while_it_runs_and_at_its_end(tmp_path, monkeypatch):
    """The stand-in trainer goes on only when it has been looked at, so no clock decides."""
    seen = tmp_path / "seen"
    code = (
        "import json, pathlib, sys, time; out = pathlib.Path(sys.argv[sys.argv.index('--out') + 1])\n"
        "(out / 'log.jsonl').write_text(json.dumps({'step': 20}) + '\\n')\n"
        f"while not pathlib.Path({str(seen)!r}).exists(): time.sleep(0.01)\n"
        "(out / 'log.jsonl').open('a').write(json.dumps({'step': 40}) + '\\n'); sys.exit(3)\n"
    )
    monkeypatch.setattr(training_flow, "TRAINER", ("-c", code))
    looks = []

    def log(self):
        looks.append(len(self.lines()))
        seen.touch()
        return 0

    monkeypatch.setattr(Training, "log", log)
    assert Watched(Training(tmp_path / "mini"), every_s=0.01).run() == 3
    assert looks[0] == 1
    assert looks[-1] == 2


@pytest.mark.slow
def test_a_short_training_is_in_mlflow_when_its_flow_ends(tmp_path):
    import mlflow

    from research.training.training_flow import train

    small = "--size tiny --workers 0 --ranks 1 --texts 100 --tokens 600 --total-steps 40 --max-steps 20 --budget 1000"
    database = tmp_path / "mlflow.db"
    assert train(str(tmp_path / "mini"), small.split(), str(database), every_s=600.0) == 20
    assert (tmp_path / "mini" / "export" / "model.safetensors").is_file()
    (line,) = [line for line in Training(tmp_path / "mini").lines() if "step" in line]
    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{database}")
    experiment = client.get_experiment_by_name("mini")
    (run,) = client.search_runs([experiment.experiment_id], "params.size = 'tiny' and params.max_steps = '20'")
    assert run.data.metrics["loss"] == pytest.approx(line["loss"])
    assert run.info.status == "FINISHED"


def test_a_trainer_that_fails_fails_the_flow(tmp_path, monkeypatch):
    from research.training.training_flow import train

    monkeypatch.setattr(training_flow, "TRAINER", ("-c", "raise SystemExit(5)"))
    with pytest.raises(RuntimeError, match=r"training\.train ended with code 5"):
        train(str(tmp_path / "mini"), [], str(tmp_path / "mlflow.db"))
