"""The encoder of numbered reports in torch, as it is taught; read by `sgcad_core.reading.second_reader.encoder_reader`.

One pass over a report's tokens serves all its questions; see there for the architecture. A second head tells hidden
words (Devlin et al. 2019, "BERT"); it is taught beside the answers and is not kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from sgcad_core.reading.second_reader.encoder_reader import WHOLE_MARK
from sgcad_core.reading.second_reader.encoder_tokens import FIRST_VEHICLE, FIRST_WAY, LONGEST, SENTENCES, VEHICLES

UNSEEN = ("mlm", "mlm_bias")
"""Names of the head that is not kept."""


class Size(NamedTuple):
    """Of a net."""

    width: int = 128
    layers: int = 3
    heads: int = 4
    drop: float = 0.1


class Batch(NamedTuple):
    """Reports side by side, (reports, tokens), and the vehicles that are asked about: (asked,) report and number."""

    ids: Tensor
    subjects: Tensor
    sentences: Tensor
    keep: Tensor
    """Whether there is a token."""
    report: Tensor
    vehicle: Tensor


class EncoderNet(nn.Module):
    """Tokens of some reports -> what is said of each vehicle, by kind of question -> scores of its answers."""

    def __init__(self, words: int, answers: Mapping[str, int], size: Size) -> None:
        super().__init__()
        wide, kinds = size.width, tuple(answers)
        self.kinds, self.heads = kinds, size.heads
        self.emb, self.pos, self.sent = (nn.Embedding(n, wide) for n in (words, LONGEST, SENTENCES))
        self.subj, self.query_veh = (nn.Linear(wide, wide, bias=False) for _ in range(2))
        self.conv = nn.Conv1d(wide, wide, 3, padding=1)
        self.layers = nn.ModuleList(Layer(size) for _ in range(size.layers))
        self.norm = nn.LayerNorm(wide)
        self.k, self.v = nn.Linear(wide, wide), nn.Linear(wide, wide)
        self.mark_k, self.mark_v = nn.Embedding(WHOLE_MARK + 1, wide), nn.Embedding(WHOLE_MARK + 1, wide)
        self.query = nn.Embedding(len(kinds), wide)
        self.up = nn.ModuleDict({kind: nn.Linear((1 + (kind == "turned")) * wide, wide) for kind in kinds})
        self.down = nn.ModuleDict({kind: nn.Linear(wide, answers[kind]) for kind in kinds})
        self.mlm, self.mlm_bias = nn.Linear(wide, wide), nn.Parameter(torch.zeros(words))
        self.drop = nn.Dropout(size.drop)
        for table, by in ((self.emb, 0.1), (self.pos, 0.05), (self.sent, 0.05), (self.mark_k, 0.3), (self.mark_v, 0.1)):
            nn.init.normal_(table.weight, std=by)

    def vehicles(self, layer: nn.Linear) -> Tensor:
        """(vehicles + 1, width) what a layer makes of the words that name vehicles; zeros for none."""
        return functional.pad(layer(self.emb.weight[FIRST_VEHICLE:FIRST_WAY]), (0, 0, 1, 0))

    def encoded(self, of: Batch) -> Tensor:
        """(reports, tokens, width)."""
        x = self.emb(of.ids) + self.pos.weight[: of.ids.shape[1]] + self.sent(of.sentences)
        x = self.drop(x + self.vehicles(self.subj)[of.subjects]) * of.keep[..., None]
        x = x + _gelu(self.conv(x.transpose(1, 2)).transpose(1, 2))
        for layer in self.layers:
            x = layer(x, of.keep[:, None, None, :])
        return self.norm(x)  # type: ignore[no-any-return]

    def pooled(self, seen: Tensor, of: Batch) -> Tensor:
        """(asked, kinds, width) what is said of each vehicle that is asked about."""
        marked = marks(of)
        key = self._by_head(self.k(seen)[of.report] + self.mark_k(marked))
        value = self._by_head(self.v(seen)[of.report] + self.mark_v(marked))
        query = self._by_head(self.query.weight + self.vehicles(self.query_veh)[of.vehicle][:, None])
        found = functional.scaled_dot_product_attention(query, key, value, of.keep[of.report][:, None, None, :])
        return found.transpose(1, 2).flatten(2)

    def _by_head(self, x: Tensor) -> Tensor:
        heads: Tensor = x.unflatten(-1, (self.heads, -1))
        return heads.transpose(1, 2)

    def scores(self, kind: str, gathered: Tensor) -> Tensor:
        """(questions, answers)."""
        return self.down[kind](self.drop(_gelu(self.up[kind](gathered))))  # type: ignore[no-any-return]

    def words(self, seen: Tensor) -> Tensor:
        """(tokens, words) scores of the words that may stand there."""
        return functional.linear(_gelu(self.mlm(seen)), self.emb.weight, self.mlm_bias)


class Layer(nn.Module):
    """One layer of the encoder."""

    def __init__(self, size: Size) -> None:
        super().__init__()
        wide, self.heads = size.width, size.heads
        self.n1, self.n2 = nn.LayerNorm(wide), nn.LayerNorm(wide)
        self.qkv, self.out = nn.Linear(wide, 3 * wide), nn.Linear(wide, wide)
        self.up, self.down = nn.Linear(wide, 2 * wide), nn.Linear(2 * wide, wide)

    def forward(self, x: Tensor, keep: Tensor) -> Tensor:
        """(reports, tokens, width) with what each token takes from the others."""
        parts = self.qkv(self.n1(x)).unflatten(-1, (3, self.heads, -1)).permute(2, 0, 3, 1, 4)
        mixed = functional.scaled_dot_product_attention(parts[0], parts[1], parts[2], keep)
        x = x + self.out(mixed.transpose(1, 2).flatten(2))
        return x + self.down(_gelu(self.up(self.n2(x))))  # type: ignore[no-any-return]


def marks(of: Batch) -> Tensor:
    """(asked, tokens) as `encoder_reader.marks` has them."""
    ids, subjects, me = of.ids[of.report], of.subjects[of.report], of.vehicle[:, None]
    names = (ids >= FIRST_VEHICLE) & (ids < FIRST_VEHICLE + VEHICLES)
    own = torch.where(ids == FIRST_VEHICLE + me - 1, 1, torch.where(names, 2, 0))
    about = torch.where(subjects == me, 1, torch.where(subjects > 0, 2, 0))
    return torch.where(me > 0, 3 * own + about, WHOLE_MARK)


def _gelu(x: Tensor) -> Tensor:
    return functional.gelu(x, approximate="tanh")
