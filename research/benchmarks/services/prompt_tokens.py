"""What a case's prompts and answers cost in tokens, by stage and attempt.

    python -m research.benchmarks.scenes.recorded --out RUNS
    python -m research.benchmarks.services.prompt_tokens RUNS --tokenizer Qwen/Qwen2.5-VL-7B-Instruct

Counts the texts that finished cases keep with the tokenizer of a model, a folder or an id: a prompt is the attempt's
prompt.txt (instructions, roads, findings) and the case's report.txt, which the model sees with it. Pictures, chat
templates and schemas are not counted.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from plugins.backbone.hf_load import load_tokenizer
from research.benchmarks.written_files import written_files

Counts = Mapping[tuple[str, str], Sequence[int]]
"""Tokens of each text, by stage ("road, first attempt") and what it is ("prompt", "answer")."""
LIMIT = 3000
"""Tokens of a prompt without pictures that are wanted at most."""


def counts(runs: Path, count: Callable[[str], int]) -> Counts:
    """The tokens of all prompts and answers below a folder."""
    found: dict[tuple[str, str], list[int]] = defaultdict(list)
    for file in written_files(runs, "attempts/*/*.txt"):
        stage, _, number = file.parent.name.partition("-")
        which = "first attempt" if int(number) == 1 else "further attempts"
        if file.stem in ("prompt", "answer"):
            tokens = count(file.read_text(encoding="utf-8"))
            report = file.parents[2] / "report.txt"
            if file.stem == "prompt" and report.is_file():
                tokens += count(report.read_text(encoding="utf-8"))
            found[f"{stage}, {which}", file.stem].append(tokens)
    return found


def table(found: Counts) -> Iterator[str]:
    """Rows in Markdown."""
    yield "| stage | text | n | median | largest |"
    yield "|---|---|---|---|---|"
    for (stage, what), tokens in sorted(found.items(), reverse=True):
        yield f"| {stage} | {what} | {len(tokens)} | {statistics.median(tokens):.0f} | {max(tokens)} |"
    prompts = [tokens for (_, what), some in found.items() if what == "prompt" for tokens in some]
    yield f"\n{sum(tokens <= LIMIT for tokens in prompts)} of {len(prompts)} prompts have at most {LIMIT:,} tokens."


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 if there is no text to count."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("runs", type=Path, help="the folder given to --out")
    known.add_argument("--tokenizer", required=True, help="a model's tokenizer: a folder or an id")
    told = known.parse_args(arguments)
    tokenizer, _ = load_tokenizer(told.tokenizer, "--tokenizer")
    found = counts(told.runs, lambda text: len(tokenizer(text, add_special_tokens=False)["input_ids"]))
    if not found:
        sys.stderr.write(f"{told.runs}: no attempts/*/prompt.txt below it; give the folder of finished cases\n")
        return 1
    sys.stdout.write("\n".join(table(found)) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
