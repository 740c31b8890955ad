"""GRD, COIECD, CoCoA and the gated contrast: their formulas and what must hold of any two rows."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.decoder.base import entropy, log_rows
from plugins.decoder.cad import Cad
from plugins.decoder.cocoa import Cocoa
from plugins.decoder.coiecd import Coiecd
from plugins.decoder.gated import Gated
from plugins.decoder.grd import Grd
from sgcad_core.errors import PluginFault
from tests.plugins.decoder.test_formulas import rows

SEEDS = st.integers(0, 10_000)
EVERY = [Grd(), Coiecd(), Cocoa(), Gated()]


def pair(evidence: list[float], prior: list[float]) -> tuple[torch.Tensor, torch.Tensor]:
    return torch.tensor([evidence]).log(), torch.tensor([prior]).log()


@pytest.mark.parametrize("decoder", EVERY, ids=lambda d: type(d).__name__)
@given(SEEDS, st.floats(-50, 50))
@settings(max_examples=25, deadline=None)
def test_a_constant_in_a_row_changes_no_choice(decoder, seed: int, shift: float) -> None:
    """Log-probabilities differ from logits by one constant a row."""
    c, q = rows(seed)
    torch.testing.assert_close(
        decoder.scores(c, q).log_softmax(-1), decoder.scores(c + shift, q - shift).log_softmax(-1), atol=1e-3, rtol=1e-3
    )


@pytest.mark.parametrize("decoder", EVERY, ids=lambda d: type(d).__name__)
@given(SEEDS)
@settings(max_examples=25, deadline=None)
def test_rows_that_agree_are_left_as_they_are(decoder, seed: int) -> None:
    c, _ = rows(seed)
    torch.testing.assert_close(decoder.scores(c, c).softmax(-1), c.softmax(-1), atol=1e-4, rtol=1e-4)


@pytest.mark.parametrize("decoder", EVERY, ids=lambda d: type(d).__name__)
def test_rows_are_decoded_by_themselves_and_impossible_tokens_give_no_nan(decoder) -> None:
    c, q = rows(7)
    c[0, 3] = q[1, 4] = c[2, 5] = q[2, 5] = float("-inf")
    together = decoder.scores(c, q)
    assert not together.isnan().any()
    torch.testing.assert_close(together[1:2], decoder.scores(c[1:2], q[1:2]))


@pytest.mark.parametrize("decoder", [Grd(), Coiecd(), Cocoa(), Gated()], ids=lambda d: type(d).__name__)
def test_the_second_row_must_be_there(decoder) -> None:
    with pytest.raises(PluginFault, match="needs the row without context"):
        decoder.scores(rows(1)[0], None)


# ------------------------------------------------------------------ GRD
@given(SEEDS, st.floats(0.05, 1.0))
@settings(max_examples=60, deadline=None)
def test_grd_takes_the_priors_token_only_where_it_is_sure_and_surer(seed: int, depth: float) -> None:
    c, q = rows(seed)
    log_c, log_q = log_rows(c, q)
    got = Grd(depth=depth).scores(c, q)
    for n in range(len(c)):
        i, j = int(c[n].argmax()), int(q[n].argmax())
        sure = bool(log_q[n, j].exp() > 0.5) and bool(entropy(log_q[n : n + 1]) < entropy(log_c[n : n + 1]))
        if i == j or not sure:
            torch.testing.assert_close(got[n], log_c[n])
        else:
            assert got[n, j] > got[n, i]


def test_grd_at_depth_zero_stands_at_the_point_of_reversal() -> None:
    c, q = pair([0.4, 0.35, 0.25], [0.05, 0.9, 0.05])
    got = Grd(depth=0.0).scores(c, q)[0]
    assert got[0] == pytest.approx(float(got[1]), abs=1e-5)


def test_grd_follows_an_evidence_that_is_surer_than_the_prior() -> None:
    c, q = pair([0.95, 0.03, 0.02], [0.1, 0.6, 0.3])
    assert Grd().scores(c, q).argmax() == 0


# ------------------------------------------------------------------ COIECD
@given(SEEDS, st.floats(0.0, 2.0), st.floats(1.5, 50.0))
@settings(max_examples=40, deadline=None)
def test_coiecd_is_the_published_piecewise_contrast(seed: int, alpha: float, ratio: float) -> None:
    c, q = rows(seed)
    log_c, log_q = (row.double().log_softmax(-1).numpy() for row in (c, q))
    surprise = -log_c + (np.exp(log_q) * log_q).sum(-1, keepdims=True)
    r = np.exp(surprise) / np.exp(surprise).sum(-1, keepdims=True)
    low, high = r.min(-1, keepdims=True) * ratio, r.max(-1, keepdims=True) / ratio
    below = r < low
    usual = (~below | (below.sum(-1, keepdims=True) == 1)) & (r <= high)
    expected = np.where(usual, log_q, log_c) + alpha * (log_c - log_q)
    clear = (np.abs(np.log(r / low)) > 1e-3) & (np.abs(np.log(r / high)) > 1e-3)
    got = Coiecd(alpha=alpha, ratio=ratio).scores(c, q).numpy()
    if clear.all():
        np.testing.assert_allclose(got, expected, atol=1e-3)


# ------------------------------------------------------------------ CoCoA
@given(SEEDS, st.floats(0.0, 20.0))
@settings(max_examples=40, deadline=None)
def test_cocoa_lies_between_both_rows(seed: int, gamma: float) -> None:
    c, q = rows(seed)
    log_c, log_q = log_rows(c, q)
    got = Cocoa(gamma=gamma).scores(c, q)
    assert (got <= torch.maximum(log_c, log_q) + 1e-4).all()
    assert (got >= torch.minimum(log_c, log_q) - 1e-4).all()
    share = Cocoa(gamma=gamma).share(log_c, log_q)
    assert ((share >= 0.1) & (share <= 0.9)).all()


def test_cocoa_gives_a_surer_evidence_the_larger_share() -> None:
    sure, unsure = pair([0.98, 0.01, 0.01], [0.3, 0.4, 0.3]), pair([0.4, 0.3, 0.3], [0.01, 0.98, 0.01])
    assert Cocoa().share(*log_rows(*sure)) > 0.5 > Cocoa().share(*log_rows(*unsure))


def test_cocoa_without_gamma_is_half_each() -> None:
    c, q = rows(3)
    torch.testing.assert_close(Cocoa(gamma=0.0).scores(c, q), sum(log_rows(c, q)) / 2)


# ------------------------------------------------------------------ gated contrast
@given(SEEDS, st.floats(0.05, 1.0))
@settings(max_examples=40, deadline=None)
def test_the_gate_contrasts_unsure_rows_alone(seed: int, sure: float) -> None:
    c, q = rows(seed)
    got, cad = Gated(sure=sure, alpha=0.7).scores(c, q), Cad(alpha=0.7).scores(c, q)
    needed = Gated(sure=sure).open(c)[:, 0]
    assert torch.equal(needed, c.softmax(-1).amax(-1) < sure)
    torch.testing.assert_close(got[needed], cad[needed])
    torch.testing.assert_close(got[~needed], c[~needed])
