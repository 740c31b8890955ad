"""The model and its training: the fast forward is transformers' own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file, save_file

from plugins.backbone.mini.patch_convnet import Eye
from plugins.precision import native_dtype
from research.generator.report import make_report
from research.model.decode import Answerer
from research.model.model import Forward, make_config, make_model
from research.model.tokens import Coder, train_tokenizer
from research.rows.collate import collate
from research.rows.report_rows import evidence, training_row
from research.rows.row_stream import STAGES, WORDS, Feed, Place, drawing
from research.training.checkpoint import HEADS
from research.training.deepen_weights import deepened
from research.training.muon_adamw import orthogonal
from research.training.train import EYES, Trainer, schedule
from research.training.train_options import CHOICES, parse
from sgcad_core import settings
from tests.research.reports import text_report
from tests.research.trainings import options

torch.set_num_threads(1)


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(200)))


@pytest.fixture(scope="module")
def forward(coder: Coder) -> Forward:
    torch.manual_seed(0)
    model = make_model(make_config(len(coder.tokenizer), coder.special, "tiny")).eval()
    for weight in model.parameters():
        torch.nn.init.normal_(weight, std=0.1) if weight.ndim > 1 else weight.data.add_(0.1 * torch.randn_like(weight))
    return Forward(model, Eye().eval())


def test_the_fast_forward_is_transformers_own(coder: Coder, forward: Forward) -> None:
    reports = [make_report(seed, length=0.2, modes={mode: 1.0}) for seed, mode in enumerate(("both", "text", "image"))]
    rows = [training_row(coder, report, drawing(report)) for report in reports]
    with torch.no_grad():
        mine = forward.hidden(collate(rows, coder))
        for found, row in zip(mine, rows, strict=True):
            ids = torch.tensor([row.ids])
            extra = {}
            if row.sheet is not None:
                patches = forward.eye.patches(torch.from_numpy(row.sheet)[None])[0]
                extra = {
                    "pixel_values": patches, "image_grid_thw": torch.tensor([[1, *row.grid]]),
                    "mm_token_type_ids": (ids == forward.model.config.image_token_id).int(),
                }  # fmt: skip
            forward.model.model.rope_deltas = None
            theirs = forward.model.model(input_ids=ids, **extra).last_hidden_state[0]
            assert (found[: len(row.ids)] - theirs).abs().max() < 1e-4


def test_free_running_answers_are_the_argmax_of_the_full_forward(coder: Coder, forward: Forward) -> None:
    report = make_report(5, length=0.2, modes={"both": 1.0})
    image = drawing(report)
    road, behavior = Answerer(forward, coder).answer([evidence(coder, report.narrative, image)])[0]
    if "refuse" in road or behavior is None:
        pytest.skip("this random model refuses")
    made = make_report(5, length=0.2, modes={"both": 1.0})
    made.road, made.behavior = road, behavior
    row = training_row(coder, made, image)
    batch = collate([row], coder)
    with torch.no_grad():
        hidden = forward.hidden(batch).view(-1, forward.model.config.text_config.hidden_size)[batch.picks]
        logits = hidden @ forward.model.lm_head.weight.T
    chosen = logits[torch.arange(len(batch.wanted)), batch.wanted]
    assert torch.isfinite(chosen).all()
    first = logits[0]
    options = [coder.piece(text)[0] for text in ('{"legs":[{"bearing":', '{"refuse":')]
    assert int(batch.wanted[0]) == max(options, key=lambda i: float(first[i]))


def test_a_narrower_softmax_keeps_the_ranking(coder: Coder, forward: Forward) -> None:
    report = text_report(1, length=0.1)
    batch = collate([training_row(coder, report, None)], coder)
    everything = torch.arange(len(coder.tokenizer))
    with torch.no_grad():
        assert torch.allclose(forward.loss(batch)[0], forward.loss(batch, everything)[0], atol=1e-5)


def test_newton_schulz_makes_matrices_orthogonal() -> None:
    torch.manual_seed(0)
    given = torch.randn(3, 16, 40)
    for dtype in (torch.bfloat16, torch.float32):
        spread = torch.linalg.svdvals(orthogonal(given, dtype).float())
        assert 0.5 < spread.min() <= spread.max() < 1.4


@pytest.mark.parametrize(("bf16", "amx"), [(False, False), (True, False), (False, True)])
def test_a_dtype_is_native_where_there_are_instructions_for_it(
    monkeypatch: pytest.MonkeyPatch, bf16: bool, amx: bool
) -> None:
    monkeypatch.setattr(torch.cpu, "_is_avx512_bf16_supported", lambda: bf16)
    monkeypatch.setattr(torch.cpu, "_is_amx_tile_supported", lambda: amx)
    assert native_dtype("cpu") == (torch.bfloat16 if bf16 or amx else torch.float32)
    monkeypatch.setattr(torch.cuda, "is_bf16_supported", lambda including_emulation: bf16 or including_emulation)
    assert native_dtype("cuda:0") == (torch.bfloat16 if bf16 else torch.float32)
    assert native_dtype("mps") == torch.bfloat16


@pytest.mark.parametrize("dtype", ["float32", "bfloat16"])
def test_the_arithmetic_may_be_told(tmp_path: Path, dtype: str) -> None:
    trainer = Trainer(parse([*options(tmp_path, 1), "--dtype", dtype]))
    assert trainer.forward.dtype == trainer.eye.across.weight.dtype == getattr(torch, dtype)
    assert all(master.dtype == torch.float32 for master in trainer.optimizer.master.values())


def test_mostly_narratives_are_shown_when_words_are_trained() -> None:
    assert set(CHOICES["stage"]) == {"auto", *STAGES}
    assert sum(WORDS.values()) == pytest.approx(100)
    modes = [make_report(seed, length=0.0, modes=STAGES["words"]).mode for seed in range(200)]
    assert 0.5 < modes.count("text") / len(modes) < 0.8
    assert {"both", "image", "none"} < set(modes)


@pytest.mark.parametrize("told", [("--dtype", "bf16"), ("--stage", "word")])
def test_what_no_training_knows_is_refused_at_once(told: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse(list(told))
    assert f"argument {told[0]}: invalid choice: '{told[1]}'" in capsys.readouterr().err


def test_a_folder_of_another_depth_is_not_resumed(tmp_path: Path) -> None:
    trainer = Trainer(parse(options(tmp_path, 1)))
    trainer.save()
    state = torch.load(tmp_path / "state.pt", weights_only=True)
    state["optimizer"]["master"].popitem()
    torch.save(state, tmp_path / "state.pt")
    with pytest.raises(ValueError, match=r"state\.pt is of a model with other layers or heads: .* --start .*export"):
        Trainer(parse(options(tmp_path, 1)))


def test_heads_of_other_tags_begin_anew_where_weights_do_not(tmp_path: Path) -> None:
    trainer = Trainer(parse(options(tmp_path / "old", 1)))
    trainer.save()
    export = tmp_path / "old" / "export"
    heads = load_file(export / HEADS)
    moved = {key.replace("phrase.", "item."): value + 1 for key, value in heads.items()}
    save_file(moved | {"picture.weight": heads["picture.weight"][:-1]}, export / HEADS)
    begun = Trainer(parse([*options(tmp_path / "new", 1), "--start", str(export)])).optimizer.master
    old = trainer.optimizer.master
    assert torch.equal(begun["heads.sentence.bias"], (heads["sentence.bias"] + 1).float())
    for fresh in ("heads.phrase.weight", "heads.phrase.bias", "heads.picture.weight"):
        assert torch.equal(begun[fresh], old[fresh])
    name = next(key for key in old if key.endswith("up_proj.weight"))
    assert torch.equal(begun[name], old[name].bfloat16().float())


def test_the_learning_rate_decays_to_a_fiftieth() -> None:
    assert schedule(0.2) == 1.0
    assert schedule(0.7) == pytest.approx(0.51, abs=0.01)
    assert schedule(1.0) == pytest.approx(0.02)
    assert schedule(0.6, hold=0.6) == pytest.approx(1.0)


def test_a_run_of_seconds_learns_and_leaves_a_loadable_export(tmp_path: Path) -> None:
    from transformers import AutoModelForImageTextToText, AutoTokenizer

    trainer = Trainer(parse(options(tmp_path, 6)))
    rows = [training_row(trainer.coder, text_report(seed, length=0.0), None) for seed in range(6)]
    batch = collate(rows, trainer.coder)
    with torch.no_grad():
        before = float(trainer.forward.loss(batch)[0])
    trainer.run()
    with torch.no_grad():
        assert float(trainer.forward.loss(batch)[0]) < before - 0.5
    model = AutoModelForImageTextToText.from_pretrained(tmp_path / "export")
    assert model.config.model_type == "qwen2_5_vl"
    assert len(AutoTokenizer.from_pretrained(tmp_path / "export")) == model.config.text_config.vocab_size
    json.loads((tmp_path / "export" / "preprocessor_config.json").read_text())


@pytest.mark.slow
def test_a_run_can_begin_with_exported_weights(tmp_path: Path) -> None:
    Trainer(parse(options(tmp_path / "first", 2))).run()
    second = Trainer(parse([*options(tmp_path / "second", 2), "--start", str(tmp_path / "first" / "export")]))
    first = torch.load(tmp_path / "first" / "state.pt", weights_only=True)["optimizer"]["master"]
    for key, value in first.items():
        assert torch.allclose(value, second.optimizer.master[key], atol=0.01 * float(value.abs().max()) + 1e-6), key


@pytest.mark.slow
def test_the_eyes_of_other_weights_come_whole(tmp_path: Path) -> None:
    for name in ("first", "second"):
        Trainer(parse(options(tmp_path / name, 1))).run()
    first, second = (tmp_path / name / "export" for name in ("first", "second"))
    _deeper(first)
    third = Trainer(parse([*options(tmp_path / "third", 1), "--start", str(first), "--eyes", str(second)]))
    want = torch.load(tmp_path / "second" / "state.pt", weights_only=True)["optimizer"]["master"]
    for key in (key for key in want if key.startswith(EYES)):
        assert torch.allclose(third.optimizer.master[key], want[key], atol=0.01 * float(want[key].abs().max()) + 1e-6)


def _deeper(folder: Path) -> None:
    """An export whose vision tower has a block more."""
    config = json.loads((folder / "config.json").read_text())
    config["vision_config"] |= {"depth": 2, "fullatt_block_indexes": [0, 1]}
    (folder / "config.json").write_text(json.dumps(config))
    weights = load_file(folder / "model.safetensors")
    save_file(deepened(weights, 2, "visual.blocks."), folder / "model.safetensors", metadata={"format": "pt"})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "still", "moved"),
    [
        (["--fixed-eyes", "1"], ("eye.", "model.visual."), "model.language_model.layers.0.mlp.up_proj.weight"),
        (["--stage", "pictures"], ("model.language_model.layers.",), "model.visual.blocks.0.mlp.up_proj.weight"),
    ],
)
def test_two_ranks_leave_what_is_not_trained_as_it_is(
    tmp_path: Path, how: list[str], still: tuple[str, ...], moved: str
) -> None:
    told = options(tmp_path, 2)
    told[told.index("--ranks") + 1] = "2"
    begun = Trainer(parse(options(tmp_path, 0)))  # the same seed, so the same weights to begin with
    before = {name: master.detach().clone() for name, master in begun.optimizer.master.items()}
    command = [sys.executable, "-m", "research.training.train", *told, *how]
    subprocess.run(command, cwd=settings.ROOT, check=True, capture_output=True, timeout=200)
    after = torch.load(tmp_path / "state.pt", weights_only=True)["optimizer"]["master"]
    fixed = {name for name in before if name.startswith(still)}
    assert len(fixed) > 20
    assert all(torch.equal(after[name], before[name]) for name in fixed)
    assert not torch.equal(after[moved], before[moved])


@pytest.mark.slow
def test_a_dead_worker_is_told_at_once() -> None:
    made = Feed(str(settings.ROOT / "plugins" / "backbone" / "mini" / "weights"), 1, Place(0))
    for worker in made.workers:
        worker.kill()
    with pytest.raises(RuntimeError, match=r"has ended \(exit code -9\).*call again"):
        next(made.pools(lambda: 0.0))
