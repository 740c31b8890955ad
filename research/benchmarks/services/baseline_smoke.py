"""Does every baseline of the paper end with a status where its model cannot run? A transcript stands in for the model.

    python -m research.benchmarks.services.baseline_smoke CASES [--out runs-stand-in] [CONFIG ...]

Runs the configs of configs/paper that ask a large model on every case, with answers written by hand in the model's
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

from flows.case.run_case import run_case  # noqa: E402
from flows.case_files.find_cases import Case, cases_in  # noqa: E402
from sgcad_core import settings  # noqa: E402
from sgcad_core.config import build, load  # noqa: E402
from tests import transcripts, transcripts_rivals  # noqa: E402

ANSWERS = {
    "plain_xml": transcripts.GOOD,
    "omnitester": transcripts_rivals.OMNI_GOOD,
    "text2scenario": transcripts_rivals.T2S_GOOD,
}


def stood_in(file: Path) -> dict[str, Any] | None:
    """A config with a transcript in its model's place; None where it asks none or one that runs anywhere."""
    raw = dict(load(file).raw)
    writer = raw["road_writer"]
    if raw.get("backbone", {}).get("model", "plugins/backbone/mini/weights") == "plugins/backbone/mini/weights":
        return None
    raw |= {"backbone": {"name": "scripted", "answers": ANSWERS[writer["name"]]}, "decoder": "greedy"}
    kept = {k: v for k, v in writer.items() if k != "folder"}
    return raw | {"road_writer": kept, "retriever": "none", "tracker": "none"}


def statuses(file: Path, raw: dict[str, Any], cases: list[Case], out: Path) -> str:
    """One line: how many cases ended how."""
    config = build(raw, f"stand-in-{file.stem}", str(file))
    started = time.perf_counter()
    ends = Counter(run_case(config, case, out, "stand-in").result["status"] for case in cases)
    told = ", ".join(f"{count} {status}" for status, count in sorted(ends.items()))
    return f"{file.stem:32s} {told} in {time.perf_counter() - started:.0f} s"


def main() -> None:
    """Print a line a config."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path)
    parser.add_argument("configs", nargs="*", help="names such as qwen72b_omnitester; default: all")
    parser.add_argument("--out", type=Path, default=Path("runs-stand-in"))
    asked = parser.parse_args()
    settings.quiet_libraries()
    cases = list(cases_in([asked.cases]))
    for file in sorted((settings.CONFIGS / "paper").glob("*.yaml")):
        if (raw := stood_in(file)) and (not asked.configs or file.stem in asked.configs):
            sys.stdout.write(statuses(file, raw, cases, asked.out) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
