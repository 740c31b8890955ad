"""`make demo`: turns the bundled reports into scenarios under the default config and prints the next steps.

python -m flows.demo [OUT]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from flows.batch import progress_bar, run_batch, summary
from flows.batch.plan_batch import Batch, batch_of
from flows.batch.tracking import track_rest
from flows.case import case_in_words
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import cases_in
from flows.cli import DEFAULT_OUT
from flows.command_end import guarded
from flows.terminal import escape_plain
from sgcad_core import settings

REPORTS = settings.ROOT / "docs" / "demo"


def main(arguments: Sequence[str] = ()) -> int:
    """Run the demo; its exit code."""
    out = Path(arguments[0]) if arguments else DEFAULT_OUT / "demo"
    config = settings.default_config()
    batch = batch_of(cases_in([REPORTS]), [Path(config)], out)
    _say(f"Reads {len(batch.cases)} crash reports in {_shown(REPORTS)} and writes a road, a scenario and its replay")
    _say(f"for each, with configs/{config}.")
    tally = summary.Tally(batch)
    with progress_bar.batch_progress(tally) as watch:
        run_batch.evaluate_alone(batch, watch.ended, on_step=watch.step)
    track_rest.start(batch.out, batch.configs)
    for line in [*met(tally), *ending(batch)]:
        _say(line)
    return tally.exit_code()


def met(tally: summary.Tally) -> list[str]:
    """One line per case: its first contact, or why there is no scenario."""
    results = sorted((ending.result for _, ending in tally.endings), key=lambda result: str(result["case"]))
    return [
        f"{result['case']}: {case_in_words.contact(result) if result['status'] == 'generated' else result['reason']}"
        for result in results
    ]


def ending(batch: Batch) -> list[str]:
    """Lines with the pictures, a page to open, and two commands to continue with."""
    places = [CaseFolder(batch.out, config.name, case.id).path for config in batch.configs for case in batch.cases]
    pictures = [place / "picture.png" for place in places if (place / "picture.png").is_file()]
    page = next((place / "player.html" for place in places if (place / "player.html").is_file()), None)
    return [
        "",
        "Pictures of the three crashes:",
        *(f"  {_shown(picture)}" for picture in pictures),
        *([f"Moving, in a browser: {_shown(page)}"] if page else []),
        "",
        "Next:",
        "  . .venv/bin/activate && sgcad run my-report.txt        # a report of your own",
        f"  .venv/bin/sgcad explain {_shown(places[0])}   # what was read, sentence by sentence",
    ]


def _shown(path: Path) -> str:
    """The path relative to the current folder, if it lies below it."""
    here = Path.cwd()
    return escape_plain(str(path.relative_to(here) if path.is_relative_to(here) else path))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    guarded(lambda: sys.exit(main(sys.argv[1:])))
