"""The decoders against their published formulas, worked out in numpy or by hand."""

from __future__ import annotations

import io

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from plugins.decoder.adacad import AdaCad, jensen_shannon
from plugins.decoder.base import sample
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.nucleus import Nucleus
from plugins.decoder.plausible import Plausible
from plugins.decoder.vcd import Vcd, kept_signal
from sgcad_core.case.records import Context, Diagram
from sgcad_core.errors import PluginFault

torch.set_num_threads(1)
VOCABULARY = 17


def rows(seed: int, count: int = 3) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    made = 4 * torch.randn(2, count, VOCABULARY, generator=generator)
    return made[0], made[1]


def diagram() -> Diagram:
    pixels = np.zeros((40, 60, 3), np.uint8)
    pixels[10:30, 20:40] = (255, 128, 0)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="PNG")
    return Diagram(png=out.getvalue(), width_px=60, height_px=40)


@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.3, 0.7, 2.0]))
@settings(max_examples=40, deadline=None)
def test_cad_distribution_is_the_published_product_of_powers(seed: int, alpha: float) -> None:
    with_context, without_context = rows(seed)
    p, q = with_context.double().softmax(-1).numpy(), without_context.double().softmax(-1).numpy()
    expected = p * (p / q) ** alpha
    expected /= expected.sum(-1, keepdims=True)
    got = Cad(alpha=alpha).scores(with_context, without_context).softmax(-1).numpy()
    np.testing.assert_allclose(got, expected, atol=1e-5)


def test_alpha_zero_is_greedy() -> None:
    with_context, without_context = rows(1)
    assert torch.equal(Cad(alpha=0.0).scores(with_context, without_context), Greedy().scores(with_context, None))
    assert not Cad(alpha=0.0).reads_prior()
    assert Cad(alpha=0.1).reads_prior()


@given(st.integers(0, 10_000), st.floats(0.01, 0.9))
@settings(max_examples=40, deadline=None)
def test_plausibility_keeps_exactly_the_head_of_the_evidence_row(seed: int, beta: float) -> None:
    with_context, without_context = rows(seed)
    p = with_context.double().softmax(-1)
    edge = (p / p.amax(-1, keepdim=True) - beta).abs() < 1e-6
    head = p >= beta * p.amax(-1, keepdim=True)
    for scores in (
        Cad(alpha=0.7, beta=beta).scores(with_context, without_context),
        Plausible(beta=beta).scores(with_context, None),
    ):
        assert bool(((scores > float("-inf")) == head)[~edge].all())


def test_plausibility_stops_a_token_that_only_the_prior_dislikes() -> None:
    with_context = torch.tensor([[5.0, 1.0, 0.0]])
    without_context = torch.tensor([[5.0, 1.0, -20.0]])
    assert int(Cad(alpha=0.7).scores(with_context, without_context).argmax()) == 2
    assert int(Cad(alpha=0.7, beta=0.1).scores(with_context, without_context).argmax()) == 0


def test_adacad_divergence_matches_the_definition_and_its_bounds() -> None:
    with_context, without_context = rows(5)
    p, q = with_context.double().softmax(-1).numpy(), without_context.double().softmax(-1).numpy()
    m = (p + q) / 2
    expected = 0.5 * (p * np.log2(p / m)).sum(-1) + 0.5 * (q * np.log2(q / m)).sum(-1)
    np.testing.assert_allclose(jensen_shannon(with_context, without_context)[:, 0].numpy(), expected, atol=1e-6)
    apart = torch.tensor([[100.0, 0.0]]), torch.tensor([[0.0, 100.0]])
    assert float(jensen_shannon(*apart)) == pytest.approx(1.0, abs=1e-6)


def test_adacad_is_cad_with_alpha_equal_to_the_divergence() -> None:
    with_context, without_context = rows(6, count=1)
    alpha = float(jensen_shannon(with_context, without_context))
    same = Cad(alpha=alpha).scores(with_context, without_context)
    assert torch.allclose(AdaCad().scores(with_context, without_context), same, atol=1e-5)
    assert torch.allclose(AdaCad().scores(with_context, with_context), with_context)


def test_adacad_survives_tokens_of_probability_zero() -> None:
    with_context = torch.tensor([[1.0, float("-inf"), 0.0]])
    without_context = torch.tensor([[0.0, 1.0, float("-inf")]])
    assert bool(jensen_shannon(with_context, without_context).isfinite().all())


def test_top_p_draws_only_from_the_smallest_set_that_reaches_the_mass() -> None:
    scores = torch.log(torch.tensor([[0.5, 0.3, 0.15, 0.05]])).repeat(4000, 1)
    drawn = sample(scores, 1.0, 0.75, torch.Generator().manual_seed(0))
    assert set(drawn.tolist()) == {0, 1}
    assert float((drawn == 0).float().mean()) == pytest.approx(0.5 / 0.8, abs=0.03)


def test_top_p_keeps_the_best_token_even_if_it_alone_exceeds_the_mass() -> None:
    scores = torch.log(torch.tensor([[0.9, 0.1]])).repeat(50, 1)
    assert set(sample(scores, 1.0, 0.1, torch.Generator().manual_seed(0)).tolist()) == {0}


def test_excluded_tokens_are_never_drawn() -> None:
    scores = torch.zeros(500, 4)
    scores[:, 2] = float("-inf")
    assert 2 not in Nucleus(temperature=2.0, top_p=1.0).draw(scores, torch.Generator().manual_seed(1)).tolist()


def test_the_same_seed_draws_the_same_tokens() -> None:
    scores, _ = rows(7, count=20)
    decoder = Nucleus(temperature=1.0, top_p=0.95)
    drawn = [decoder.draw(scores, torch.Generator().manual_seed(seed)).tolist() for seed in (3, 3, 4)]
    assert drawn[0] == drawn[1] != drawn[2]


def test_temperature_zero_takes_the_best_token() -> None:
    scores, _ = rows(8)
    for decoder in (Greedy(), Cad(), AdaCad(), Plausible(), Vcd(), Nucleus(temperature=0.0)):
        assert torch.equal(decoder.draw(scores, torch.Generator()), scores.argmax(-1))


def test_first_attempts_may_have_a_temperature_of_their_own() -> None:
    decoder = Cad(alpha=0.3, temperature=0.4, first_temperature=0.0)
    assert decoder.at(1) == Cad(alpha=0.3, temperature=0.0, first_temperature=0.0)
    assert decoder.at(2) is decoder
    for plain in (Cad(temperature=0.4), Greedy()):
        assert plain.at(1) is plain


def test_every_attempt_after_the_second_may_be_warmer() -> None:
    decoder = Nucleus(temperature=0.3, first_temperature=0.0, warming=0.1)
    assert [round(decoder.at(n).temperature, 9) for n in (1, 2, 3, 10)] == [0.0, 0.3, 0.4, 1.1]
    assert [round(Cad(temperature=0.2, warming=0.5).at(n).temperature, 9) for n in (1, 2, 4)] == [0.2, 0.2, 1.2]


def test_vcd_noises_the_diagram_and_keeps_the_narrative() -> None:
    context = Context(narrative="V1 struck V2.", diagrams=(diagram(),))
    noised = Vcd().contrast_context(context)
    assert noised is not None
    assert noised.narrative == context.narrative
    assert noised.diagrams[0].png != context.diagrams[0].png
    assert (noised.diagrams[0].width_px, noised.diagrams[0].height_px) == (60, 40)
    assert noised == Vcd().contrast_context(context)


def test_vcd_noise_grows_with_the_step() -> None:
    clean = np.asarray(Image.open(io.BytesIO(diagram().png)), dtype=float)
    context = Context(narrative="", diagrams=(diagram(),))
    faults = []
    for step in (1, 300, 999):
        noised = Vcd(noise_step=step).contrast_context(context)
        assert noised is not None
        faults.append(np.abs(np.asarray(Image.open(io.BytesIO(noised.diagrams[0].png)), dtype=float) - clean).mean())
    assert faults[0] < 3 < faults[1] < faults[2]
    assert kept_signal(1) > 0.999
    assert kept_signal(1000) < 0.1


def test_a_contrast_without_the_second_row_is_an_error_that_says_so() -> None:
    with pytest.raises(PluginFault, match="needs the row without context"):
        Cad(alpha=0.7).scores(torch.zeros(1, 3), None)
