"""The recorded dialogues through the whole chain: how many attempts each takes, and what its account says.

Reports and answers (tests/recorded) are made up by hand, so no figure here is one of a model: they show that the chain
takes right answers, and that its findings lead from a wrong one to a right one without contradicting each other.

    python -m research.benchmarks.scenes.recorded [NAMES ...] [--out FOLDER] [--keep]
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, ClassVar

import yaml
from pydantic import PrivateAttr

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case, cases_in
from plugins.backbone.scripted import ASKED, Scripted, question_digest
from sgcad_core import config as configs
from sgcad_core.asking.repairs import exclude
from sgcad_core.case.records import Context, Finding, Generation, Query
from sgcad_core.config import Config
from sgcad_core.findings import HARD, SOFT
from sgcad_core.interfaces import Backbone, Decoder
from sgcad_core.settings import CONFIGS, ROOT

REPORTS = ROOT / "tests" / "recorded" / "reports"
MOST_ATTEMPTS = 3


@dataclass(frozen=True)
class Row:
    """What became of one dialogue."""

    case: str
    status: str
    road: int
    scenario: int
    verdict: str
    told: int
    has: int
    contradictions: int
    why: str

    @property
    def passes(self) -> bool:
        """Generated within the attempts, everything told is there, and no finding excludes another."""
        quick = max(self.road, self.scenario) <= MOST_ATTEMPTS
        return self.status == "generated" and quick and self.verdict == "whole" and not self.contradictions

    def line(self) -> str:
        """A row of the table in Markdown."""
        mark = "yes" if self.passes else "**no**"
        told = f"{self.has} of {self.told}"
        cells = self.case, self.road, self.scenario, self.status, told, self.verdict, self.contradictions, mark
        return f"| {' | '.join(map(str, cells))} |" + (f" {self.why}" if self.why else "")


class Recorder(Backbone):
    """Answers whatever it is asked, and notes the digest of each question."""

    gives_logits: ClassVar[bool] = False
    file: Path
    _noted: dict[str, dict[str, str]] = PrivateAttr(default_factory=dict)

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """The recorded answer to another question as well."""
        self._noted.setdefault(query.case, {})[query.stage or ""] = question_digest(query)
        return Generation(text=self._script.answer(context, query))

    @cached_property
    def _script(self) -> Scripted:
        return Scripted(file=self.file)

    @property
    def noted(self) -> dict[str, dict[str, str]]:
        """By case and stage."""
        return {case: dict(sorted(stages.items())) for case, stages in sorted(self._noted.items())}


def recorded_config(keep: bool = False) -> Config:
    """configs/recorded.yaml without a tracker; `keep`: questions are noted instead of compared."""
    raw = configs.load(CONFIGS / "recorded.yaml").raw | {"tracker": {"name": "none"}}
    config = configs.build(raw, "recorded", "recorded.yaml")
    if not keep or not isinstance(config.backbone, Scripted) or config.backbone.file is None:
        return config
    return config.model_copy(update={"backbone": Recorder(file=config.backbone.file)})


def row_of(config: Config, case: Case, out: Path) -> Row:
    """One dialogue through the chain."""
    ending = run_case(config, case, out, "recorded")
    result: dict[str, Any] = ending.result
    account, attempts = result["account"], result["attempts"]
    lacks = [item["text"] for item in account["items"] if item["kind"] in ("lacks", "unread", "contradicts", "guessed")]
    why = result["reason"] if result["status"] != "generated" else "; ".join(lacks)
    return Row(
        case=case.id, status=result["status"], road=attempts["road"], scenario=attempts["scenario"],
        verdict=account["verdict"], told=account["told"], has=account["has"],
        contradictions=sum(1 for _ in contradictions(out / config.name / case.id)), why=why,
    )  # fmt: skip


def contradictions(folder: Path) -> Iterator[tuple[Finding, Finding]]:
    """Pairs of findings of one stage, of all its attempts, of which no answer satisfies both."""
    for stage in ("road", "scenario"):
        files = sorted(folder.glob(f"attempts/{stage}-*/findings.json"))
        every = [f for file in files for f in yaml.safe_load(file.read_text(encoding="utf-8"))]
        found = [Finding.model_validate(f) for f in every]
        asked = [f for f in found if f.severity in (*HARD, *SOFT)]
        yield from ((a, b) for a, b in combinations(asked, 2) if exclude(a, b))


def main(argv: Sequence[str] | None = None) -> int:
    """Print the table; 1 if a dialogue does not pass."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("names", nargs="*", help="dialogues; without: all")
    parser.add_argument("--out", type=Path, help="keep the results here")
    parser.add_argument(
        "--keep", action="store_true", help="write down what is asked now as what the answers belong to"
    )
    options = parser.parse_args(argv)
    cases = [case for case in cases_in([REPORTS]) if not options.names or case.id in options.names]
    config = recorded_config(options.keep)
    print(  # noqa: T201 - a command prints
        "| dialogue | road attempts | scenario attempts | ended | told and there | verdict | contradictions | passes |"
    )
    print("|---|---|---|---|---|---|---|---|")  # noqa: T201 - a command prints
    with tempfile.TemporaryDirectory() as folder:
        rows = [_told(row_of(config, case, options.out or Path(folder))) for case in cases]
    print(f"\n{sum(row.passes for row in rows)} of {len(rows)} pass")  # noqa: T201 - a command prints
    if options.keep and isinstance(config.backbone, Recorder) and config.backbone.file:
        _keep(config.backbone.file / ASKED, config.backbone.noted)
    return 0 if all(row.passes for row in rows) else 1


def _told(row: Row) -> Row:
    print(row.line(), flush=True)  # noqa: T201 - a command prints
    return row


def _keep(file: Path, noted: dict[str, dict[str, str]]) -> None:
    known = yaml.safe_load(file.read_text(encoding="utf-8")) if file.is_file() else {}
    head = "# What each stage was asked when its answers were written: digests of prompt and schema.\n"
    file.write_text(head + yaml.safe_dump({**(known or {}), **noted}), encoding="utf-8")


if __name__ == "__main__":
    raise SystemExit(main())
