"""What a plugin does wrong ends its case at the first attempt, as that plugin's fault."""

from typing import Any, ClassVar

import pytest
import torch

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from plugins.backbone.hf_vision import HfVision
from sgcad_core import interfaces
from sgcad_core.case.records import Passage, Query
from sgcad_core.config import load
from sgcad_core.errors import InvalidOutput, MissingTool, Refused
from tests.plugins.backbone import folders


class Wrong:
    """Does `way` and counts its calls; joined with a kind below."""

    calls: ClassVar[list[str]] = []

    def wrong(self):
        self.calls.append(type(self).__name__)
        if isinstance(self.way, BaseException):
            raise self.way
        return self.way


class WrongReader(Wrong, interfaces.ReportReader):
    way: Any

    def read(self, source):
        return self.wrong()


class WrongRetriever(Wrong, interfaces.Retriever):
    way: Any

    def retrieve(self, text, task):
        return self.wrong()


class WrongRoad(Wrong, interfaces.RoadWriter):
    asks_model: ClassVar[bool] = True
    way: Any

    def write(self, context, passages, findings, ask, attempt):
        return self.wrong()


class WrongScenario(Wrong, interfaces.ScenarioWriter):
    asks_model: ClassVar[bool] = True
    way: Any

    def write(self, context, passages, findings, ask, attempt, network):
        return self.wrong()


class WrongValidator(Wrong, interfaces.Validator):
    stage: ClassVar[str] = "road"
    way: Any

    def findings(self, artifact, evidence):
        return self.wrong()


class WrongSimulator(Wrong, interfaces.Simulator):
    way: Any

    def execute(self, scenario, network):
        return self.wrong()


class WrongBackbone(Wrong, interfaces.Backbone):
    gives_logits: ClassVar[bool] = True
    way: Any

    def generate(self, context, query, decoder, seed=0):
        return self.wrong()


class WrongDecoder(Wrong, interfaces.Decoder):
    """Scores that `way` makes of the right ones."""

    needs_prior: ClassVar[bool] = False
    way: Any

    def scores(self, with_context, without_context):
        self.calls.append("WrongDecoder")
        return self.way(with_context)


class WrongDraw(Wrong, interfaces.Decoder):
    needs_prior: ClassVar[bool] = False
    way: Any

    def scores(self, with_context, without_context):
        return with_context

    def draw(self, scores, generator):
        return self.wrong()


KINDS = {
    "report_reader": (WrongReader, "read", "CrashReport", ["a text"]),
    "retriever": (WrongRetriever, "retrieve", "tuple[Passage, ...]", [[], ("text",), "text"]),
    "road_writer": (WrongRoad, "write", "RoadNetwork", ["<net/>"]),
    "scenario_writer": (WrongScenario, "write", "Scenario", ["<OpenSCENARIO/>"]),
    "validators": (WrongValidator, "findings", "list[Finding]", [["too short"], (), True]),
    "simulator": (WrongSimulator, "execute", "Execution", [{}]),
    "backbone": (WrongBackbone, "generate", "Generation", ["ok"]),
}
RAISED = [ValueError("odd"), IndexError("odd"), RuntimeError("odd"), OSError("odd"), SystemExit("odd")]
WAYS = [(kind, way) for kind, (*_, wrong) in KINDS.items() for way in (None, *wrong, *RAISED)]


@pytest.fixture
def run(tmp_path, config_file, reports):
    """Runs one report, a model asked for its road, with plugins in the place of the config's."""
    Wrong.calls.clear()

    def go(**plugins):
        script = {"name": "scripted", "answers": ["ok"] * 10}
        config = load(config_file(road_writer="testkit_asking", decoder="greedy", backbone=script))
        out = tmp_path / "out"
        ending = run_case(config.model_copy(update=plugins), Case(reports(c1="") / "c1", "c1"), out, "d1")
        return ending, out / "kit" / "c1"

    return go


def told(ended):
    ending, folder = ended
    assert ending.result["status"] == "failed"
    assert "Traceback" in (folder / "error.txt").read_text()
    assert len(Wrong.calls) == 1
    return ending.result["reason"]


@pytest.mark.parametrize(("kind", "way"), WAYS, ids=lambda value: value if isinstance(value, str) else repr(value))
def test_a_wrong_plugin_is_asked_once_and_named(run, kind, way):
    cls, method, expected, _ = KINDS[kind]
    wrong = cls(way=way)
    reason = told(run(**{kind: (wrong,) if kind == "validators" else wrong}))
    assert reason.startswith(f"{cls.kind} '{cls.__name__}' ({__name__}:{cls.__name__}): {method} ")
    assert "docs/plugins.md" in reason
    raised = isinstance(way, BaseException)
    assert f"raised {type(way).__name__}: odd;" in reason if raised else f", expected {expected};" in reason


SCORES = {
    "shape": (lambda rows: rows[0], "scores are torch.float32 (300,) on cpu, expected float logits (1, 300)"),
    "whole numbers": (lambda rows: rows.long(), "scores are torch.int64 (1, 300) on cpu, expected float logits"),
    "truths": (lambda rows: rows > 0, "scores are torch.bool (1, 300) on cpu, expected float logits"),
    "another device": (lambda rows: rows.to("meta"), "(1, 300) on meta, expected float logits (1, 300) on cpu"),
    "no tensor": (lambda rows: rows.numpy(), r"scores are ndarray, expected float logits"),
    "nothing": (lambda rows: None, "scores are None, expected float logits"),
    "not a number": (lambda rows: rows * float("nan"), "scores are NaN or inf"),
    "one not a number": (lambda rows: rows.index_fill(1, torch.tensor([7]), float("nan")), "scores are NaN or inf"),
    "raises": (lambda rows: rows[:, 400], "scores raised IndexError: index 400 is out of bounds"),
}


@pytest.fixture(scope="module")
def backbone(tmp_path_factory):
    folder = folders.save("text_only", tmp_path_factory.mktemp("model"))
    return HfVision(model=str(folder), device="cpu", dtype="float32", max_new_tokens=8)


@pytest.mark.parametrize("how", list(SCORES))
def test_a_wrong_decoder_is_asked_once_and_named(run, backbone, how):
    way, said = SCORES[how]
    reason = told(run(backbone=backbone, decoder=WrongDecoder(way=way)))
    assert reason.startswith(f"decoder 'WrongDecoder' ({__name__}:WrongDecoder): ")
    assert said in reason


@pytest.mark.parametrize("drawn", [torch.tensor([0.5]), torch.tensor([999]), 7, ValueError("odd")], ids=repr)
def test_a_wrong_draw_is_asked_once_and_named(run, backbone, drawn):
    assert told(run(backbone=backbone, decoder=WrongDraw(way=drawn))).startswith("decoder 'WrongDraw' ")


def test_an_installed_plugin_is_told_by_its_name(run, reports, config_file, tmp_path):
    ending = run_case(load(config_file()), Case(reports(c2="RAISE") / "c2", "c2"), tmp_path / "out", "d1")
    assert ending.result["reason"].startswith(
        "road_writer 'testkit' (sgcad_testkit:KitRoad): write raised ZeroDivisionError: a bug in a plugin; "
    )


def test_the_fault_is_that_of_the_inner_plugin(run):
    """A backbone that fails inside a writer's question is not the writer's fault."""
    assert told(run(backbone=WrongBackbone(way=ValueError("odd")))).startswith("backbone 'WrongBackbone' ")


def test_a_writer_without_a_model_that_asks_one_is_at_fault(run):
    class Undeclared(interfaces.RoadWriter):
        asks_model: ClassVar[bool] = False

        def write(self, context, passages, findings, ask, attempt):
            return ask(context, Query(task="Draw the road."))

    assert "set asks_model = True and name a backbone" in run(road_writer=Undeclared())[0].result["reason"]


def test_what_an_interface_allows_to_raise_keeps_its_meaning(run):
    assert run(road_writer=WrongRoad(way=InvalidOutput("no")))[0].result["status"] == "exhausted"
    assert len(Wrong.calls) == 10


def test_a_refusal_and_a_missing_tool_keep_their_meaning(run):
    assert run(road_writer=WrongRoad(way=Refused("no")))[0].result["status"] == "refused"
    with pytest.raises(MissingTool):
        WrongSimulator(way=MissingTool("no")).execute(None, None)


def test_passages_of_the_right_kind_pass():
    passages = (Passage(id="a", kind="doc", text="t"),)
    assert WrongRetriever(way=passages).retrieve("", "road") == passages
