"""Can a text that a model learned from be drawn out of its weights? Prints the longest run that comes back.

    python -m research.benchmarks.decoding.memorized ROWS.jsonl --model plugins/backbone/mini/weights [--count 100]
    python -m research.benchmarks.decoding.memorized ROWS.jsonl --model package:NAME/FILE.gguf [--adapter FOLDER] \
        [--count 100]

ROWS is what was trained on (`research.rows.partial_labels.load`). Each text is cut at several places; the model goes on
freely, without a grammar, greedily and sampled, and what it writes is searched for in all texts (after Carlini et al.
2021, "Extracting training data from large language models", with the prefix known to the attacker). What it copies from
the beginning that it was given is no secret and does not count; a language model without its adapter shows how much of
the rest is phrases that are easy to guess. Exits with 1 where a run of --limit characters or more comes back. What
the product draws is narrower still: its grammar knows a gist's words only.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import torch

from plugins.backbone import hf_gguf, hf_load
from research.model.tokens import Coder, load_tokenizer
from research.rows.partial_labels import load

LIMIT = 40
"""Characters in a row that do not come by chance."""
CUTS = (0.2, 0.5, 0.8)
NEW_TOKENS = 60
COPIED = 12
"""Characters in a row that also stand in the beginning were copied from it."""


class Speaker(NamedTuple):
    """A model, and how texts become its tokens and back."""

    model: Any
    ids: Callable[[str], list[int]]
    text: Callable[[Any], str]


def embedded(folder: Path) -> Speaker:
    """The embedded model from a folder of weights."""
    from transformers import Qwen2_5_VLForConditionalGeneration  # takes seconds

    model = Qwen2_5_VLForConditionalGeneration.from_pretrained(folder, dtype=torch.float32, local_files_only=True)
    coder = Coder(load_tokenizer(folder))
    return Speaker(model, coder.text, lambda ids: coder.tokenizer.decode(ids, skip_special_tokens=True))


def language_model(name: str, adapter: str | None) -> Speaker:
    """A text model, with an adapter or without."""
    place = str(hf_gguf.unpacked(name)) if hf_gguf.is_gguf(name) else name
    loaded = hf_load.load(place, None, {"dtype": "native"}, "cpu", "none", adapter)
    tokenizer = loaded.tokenizer
    return Speaker(
        loaded.model,
        lambda text: tokenizer(text, add_special_tokens=False)["input_ids"],
        lambda ids: tokenizer.decode(ids, skip_special_tokens=True),
    )


def longest_run(drawn: str, texts: str, atleast: int = 8) -> str:
    """The longest piece of a drawn text that stands in `texts`; "" where none of `atleast` characters does."""
    found = ""
    for begin in range(len(drawn)):
        size = max(len(found) + 1, atleast)
        while begin + size <= len(drawn) and drawn[begin : begin + size] in texts:
            found = drawn[begin : begin + size]
            size += 1
    return found


def not_copied(drawn: str, begun: str) -> list[str]:
    """What is left of a drawn text without the stretches that stand in its beginning too."""
    found, left, at = [], "", 0
    while at < len(drawn):
        size = COPIED
        while at + size <= len(drawn) and drawn[at : at + size] in begun:
            size += 1
        if size > COPIED:
            found, left, at = [*found, left], "", at + size - 1
        else:
            left, at = left + drawn[at], at + 1
    return [piece for piece in [*found, left] if piece]


@torch.no_grad()
def drawn(speaker: Speaker, texts: Sequence[str], seed: int = 0) -> list[str]:
    """What a model writes behind the beginnings of texts by itself, greedily and sampled at temperature 1."""
    torch.manual_seed(seed)
    found = []
    for text in texts:
        ids = speaker.ids(text)
        for cut in CUTS:
            begun = torch.tensor([ids[: max(1, int(len(ids) * cut))]])
            for sampled in (False, True):
                how = {"do_sample": True, "top_k": 0} if sampled else {"do_sample": False}
                out = speaker.model.generate(
                    begun, attention_mask=torch.ones_like(begun), max_new_tokens=NEW_TOKENS, pad_token_id=0, **how
                )
                found += not_copied(speaker.text(out[0, begun.shape[1] :]), speaker.text(begun[0]))
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", type=Path)
    parser.add_argument("--model", default="plugins/backbone/mini/weights")
    parser.add_argument("--adapter", help="folder of a LoRA adapter of that model")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--limit", type=int, default=LIMIT)
    args = parser.parse_args(arguments)
    texts = [told.text for told in load(args.rows)]
    joined = "\n".join(texts)
    plain = args.adapter or hf_gguf.is_gguf(args.model)
    speaker = language_model(args.model, args.adapter) if plain else embedded(Path(args.model))
    runs = [longest_run(one, joined) for one in drawn(speaker, texts[: args.count])]
    longest = max(runs, key=len, default="")
    print(f"{len(runs)} pieces drawn, the longest run has {len(longest)} characters: {longest!r}")  # noqa: T201
    sys.exit(len(longest) >= args.limit)


if __name__ == "__main__":
    main()
