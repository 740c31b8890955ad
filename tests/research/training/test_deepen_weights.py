"""A deeper model out of a trained one answers as that one did."""

import pytest
import torch

from plugins.backbone.mini.patch_convnet import Eye
from research.generator.report import make_report
from research.model.batch import Batch
from research.model.model import Forward, make_config, make_model
from research.model.tokens import Coder, train_tokenizer
from research.rows.collate import collate
from research.rows.report_rows import training_row
from research.rows.row_stream import drawing
from research.training.deepen_weights import BLOCKS, deepened, places
from tests.research.reports import text_report


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(100)))


def model_of(coder: Coder, layers: int, blocks: int = 1) -> Forward:
    config = make_config(len(coder.tokenizer), coder.special, "tiny")
    config.vision_config.depth = blocks
    config.vision_config.fullatt_block_indexes = list(range(blocks))
    config.text_config.num_hidden_layers = layers
    config.text_config.layer_types = ["full_attention"] * layers
    torch.manual_seed(layers)
    model = make_model(config).eval()
    for weight in model.parameters():
        torch.nn.init.normal_(weight, std=0.1) if weight.ndim > 1 else weight.data.add_(0.1 * torch.randn_like(weight))
    torch.manual_seed(0)
    return Forward(model, Eye().eval())


def batch_of(coder: Coder) -> Batch:
    reports = [make_report(seed, length=0.2, modes={"both": 1.0}) for seed in range(2)]
    return collate([training_row(coder, report, drawing(report)) for report in reports], coder)


@pytest.mark.parametrize(("old", "new"), [(2, 2), (2, 3), (2, 5), (3, 4), (1, 2)])
def test_a_deepened_model_answers_as_the_one_it_grew_from(coder: Coder, old: int, new: int) -> None:
    small, large = model_of(coder, old), model_of(coder, new)
    grown = deepened(dict(small.model.named_parameters()), new)
    assert grown.keys() == dict(large.model.named_parameters()).keys()
    large.model.load_state_dict(grown, strict=False)
    batch = batch_of(coder)
    with torch.no_grad():
        assert (small.hidden(batch) - large.hidden(batch)).abs().max() < 1e-4


@pytest.mark.parametrize(("old", "new"), [(1, 2), (2, 3), (2, 4)])
def test_a_deepened_tower_sees_what_the_one_saw_that_it_grew_from(coder: Coder, old: int, new: int) -> None:
    small, large = model_of(coder, 2, old), model_of(coder, 2, new)
    grown = deepened(dict(small.model.named_parameters()), new, BLOCKS)
    assert grown.keys() == dict(large.model.named_parameters()).keys()
    large.model.load_state_dict(grown, strict=False)
    batch = batch_of(coder)
    with torch.no_grad():
        assert small.seen(batch).abs().max() > 0.1
        assert (small.seen(batch) - large.seen(batch)).abs().max() < 1e-4


def test_new_layers_learn_from_the_first_step(coder: Coder) -> None:
    small, large = model_of(coder, 2), model_of(coder, 3)
    large.model.load_state_dict(deepened(dict(small.model.named_parameters()), 3), strict=False)
    loss, _ = large.loss(batch_of(coder))
    loss.backward()
    new = large.text.layers[1]
    for weight in (new.self_attn.o_proj.weight, new.mlp.down_proj.weight):
        assert not weight.detach().any()
        assert weight.grad.abs().max() > 0


@pytest.mark.parametrize(("old", "new"), [(6, 8), (8, 10), (10, 12), (12, 14), (14, 16), (12, 16)])
def test_growing_leaves_tags_and_pointers_at_their_old_layers(coder: Coder, old: int, new: int) -> None:
    middle, grown = (model_of(coder, layers).middle for layers in (old, new))
    stand = places(old, new)
    assert stand[middle - 1] == grown - 1  # the last before sentences are asked
    assert stand[middle] == grown  # the first behind it, whose attention points


def test_a_model_does_not_shrink(coder: Coder) -> None:
    with pytest.raises(ValueError, match=r"3 layers .* cannot begin a model of 2"):
        deepened(dict(model_of(coder, 3).model.named_parameters()), 2)
