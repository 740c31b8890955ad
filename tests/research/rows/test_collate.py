"""A batch carries the labels of its rows."""

import pytest
import torch

from research.generator import phrase_notes
from research.generator.report import Report
from research.model.batch import Taggers
from research.model.tokens import Coder, train_tokenizer
from research.rows.collate import collate
from research.rows.report_rows import training_row
from tests.research.reports import text_report


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(200)))


def with_lists(count: int, held_out: bool = False) -> list[Report]:
    """The first reports without a drawing that list lanes."""
    found: list[Report] = []
    seed = 0
    while len(found) < count:
        report = text_report(seed, held_out, length=0.2)
        found += [report] * bool(items_of(report))
        seed += 1
    return found


def items_of(report: Report) -> list[tuple[int, int, str, int]]:
    """Items of lists of lanes: (end, leg, use, lanes)."""
    found = [(end, dict(n.split("=") for n in some)) for end, some in report.notes if some[0].startswith("leg=")]
    return [(end, int(told["leg"]), told["use"], int(told["lanes"])) for end, told in found]


def test_a_batch_carries_the_notes_of_its_rows_and_heads_learn_them(coder: Coder) -> None:
    rows = [training_row(coder, report, None) for report in with_lists(4)]
    batch = collate(rows, coder)
    assert batch.phrases.tolist() == [i * batch.ids.shape[1] + at for i, row in enumerate(rows) for at, _ in row.notes]
    assert all(batch.noted.sum(dim=1) > 0)
    torch.manual_seed(0)
    heads = Taggers(16, 5, phrase_notes.ASKED, 7)
    states = torch.randn(len(batch.phrases), 16)
    before = float(heads.phrases(states, batch.noted).detach())
    step = torch.optim.Adam(heads.parameters(), lr=0.05)
    for _ in range(60):
        step.zero_grad()
        heads.phrases(states, batch.noted).backward()
        step.step()
    assert float(heads.phrases(states, batch.noted).detach()) < 0.5 * before
    assert float(heads.phrases(states[:0], batch.noted[:0]).detach()) == 0
