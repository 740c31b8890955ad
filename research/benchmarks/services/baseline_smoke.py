"""Does every baseline of the paper end with a status where its model cannot run? A transcript stands in for the model.

    python -m research.benchmarks.services.baseline_smoke CASES [--out runs-stand-in] [STUDY/ARM ...]

Runs the arms of the paper's studies that ask a large model on every case, with answers written by hand in the model's
place and nothing retrieved. It proves the path from report to folder; what is answered has nothing to do with the
report, so no figure of accuracy may be taken from it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT))

from flows.batch.find_cases import Case, cases_in  # noqa: E402
from flows.case.chain import run_case  # noqa: E402
from flows.study.arm_config import load_config  # noqa: E402
from flows.study.spec import load_study  # noqa: E402
from sgcad_core import settings  # noqa: E402
from sgcad_core.config import build  # noqa: E402
from tests import transcripts, transcripts_rivals  # noqa: E402

ANSWERS = {
    "plain_xml": transcripts.GOOD,
    "omnitester": transcripts_rivals.OMNI_GOOD,
    "text2scenario": transcripts_rivals.T2S_GOOD,
}


STUDIES = tuple(
    f"{kind}_{backbone}" for kind in ("baselines", "components", "rag") for backbone in ("qwen72b", "llama90b")
)


def stood_in(name: str) -> dict[str, Any] | None:
    """An arm's config with a transcript in its model's place; None where it asks none."""
    raw = dict(load_config(name).raw)
    writer = raw["road_writer"]
    if "backbone" not in raw:
        return None
    raw |= {"backbone": {"name": "scripted", "answers": ANSWERS[writer["name"]]}, "decoder": "greedy"}
    kept = {k: v for k, v in writer.items() if k != "folder"}
    return raw | {"road_writer": kept, "retriever": "none", "tracker": "none"}


def statuses(name: str, raw: dict[str, Any], cases: list[Case], out: Path) -> str:
    """One line: how many cases ended how."""
    config = build(raw, f"stand-in-{name.replace('/', '-')}", name)
    started = time.perf_counter()
    ends = Counter(run_case(config, case, out, "stand-in").result["status"] for case in cases)
    told = ", ".join(f"{count} {status}" for status, count in sorted(ends.items()))
    return f"{name:36s} {told} in {time.perf_counter() - started:.0f} s"


def main() -> None:
    """Print a line a config."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path)
    parser.add_argument("configs", nargs="*", help="such as baselines_qwen72b/omnitester; default: all")
    parser.add_argument("--out", type=Path, default=Path("runs-stand-in"))
    asked = parser.parse_args()
    settings.quiet_libraries()
    cases = list(cases_in([asked.cases]))
    arms = [f"{study}/{arm.name}" for study in STUDIES for arm in load_study(study).arms]
    for name in asked.configs or arms:
        if raw := stood_in(name):
            sys.stdout.write(statuses(name, raw, cases, asked.out) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
