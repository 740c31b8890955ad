"""The tokenizer: a byte-fallback BPE in which constant JSON fragments and values are single tokens.

Numbers split into at most two digits and every pair of digits is a token, so that a speed is copied as one
token. Trained on the generator's narratives only. Knows no model.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from functools import cache, cached_property
from pathlib import Path
from random import Random

from tokenizers import AddedToken, Regex, Tokenizer, decoders, models, pre_tokenizers, trainers
from transformers import PreTrainedTokenizerFast

from plugins.backbone.mini.drawing_view import IMAGE as IMAGE
from research.model import answer_grammar

PAD, END, ROAD, SCENARIO = "<|pad|>", "<|im_end|>", "<|road|>", "<|scenario|>"
VISION_START, VISION_END, VIDEO = "<|vision_start|>", "<|vision_end|>", "<|video_pad|>"
SPECIAL = (PAD, END, ROAD, SCENARIO, VISION_START, VISION_END, IMAGE, VIDEO)
SPLIT = r"\d{1,2}| ?[A-Za-z]+| ?[^\sA-Za-z\d]+|\s+"
VOCABULARY = 2048

_SPARE = re.compile(
    r"\s(?:a|an|the|its|his|her|own|of|in|at|to|and|then|also|had|that|which|turn(?:ing)?(?!s?[\s-]+lane)|lanes?|road|roadway|"
    r"street|highway|side|direction|travel|traveling|approach)(?![A-Za-z'-]|\.[a-z])"
)
"""A word without which its sentence tells the same, to who knows how such sentences go."""

CHAT_TEMPLATE = """\
{%- set ns = namespace(task='') -%}
{%- for message in messages -%}
{%- if message['content'] is string -%}
{%- if '<|road|>' in message['content'] -%}{%- set ns.task = message['content'] -%}
{%- else -%}{{ message['content'] | trim }}{%- endif -%}
{%- else -%}
{%- for item in message['content'] -%}
{%- if item['type'] == 'text' -%}
{%- if '<|road|>' in item['text'] -%}{%- set ns.task = item['text'] -%}
{%- elif not item['text'].startswith('Your previous answer was:') -%}{{ item['text'] | trim }}{%- endif -%}
{%- endif -%}
{%- endfor -%}
{%- for item in message['content'] -%}
{%- if item['type'] == 'image' -%}<|vision_start|><|image_pad|><|vision_end|>{%- endif -%}
{%- endfor -%}
{%- endif -%}
{%- endfor -%}
{{ ns.task | trim }}"""
"""Evidence first, then the task token; a repair text is passed over, since the model never saw one."""


def fragments() -> list[str]:
    """Every piece of JSON that a walk can write, longest first: the tokens that the answers are made of."""
    found: set[str] = set()
    roads = tuple(
        f"{c}{suffix}" for c in answer_grammar.COMPASS for suffix in ("", "_outer", "_access_left", "_access_right")
    )
    walks = [answer_grammar.road_walk(), answer_grammar.behavior_walk(answer_grammar.quoted(roads))]
    for walk in walks:
        for refuse in (False, True):
            found |= _seen(
                answer_grammar.road_walk() if walk is walks[0] else answer_grammar.behavior_walk(roads), refuse
            )
    kept = [f for f in found if not f.replace(".", "").isdigit() and f not in (",", "}", "]}")]
    return sorted(kept, key=lambda f: (-len(f), f))


def _seen(walk: answer_grammar.Walk, refuse: bool) -> set[str]:
    """Options and forced texts along the longest way through a walk."""
    found: set[str] = set()
    sent: str | None = None
    while True:
        try:
            step = walk.send(sent)
        except StopIteration:
            return found
        if isinstance(step, answer_grammar.Force):
            found.add(step.text)
            sent = None
        else:
            found |= set(step.options)
            sent = _longest_way(step, refuse)


def _longest_way(pick: answer_grammar.Pick, refuse: bool) -> str:
    if pick.path[-1] == "refuse":
        return pick.options[int(refuse)]
    return pick.options[0]


def train_tokenizer(texts: Iterable[str]) -> PreTrainedTokenizerFast:
    """Learn the merges from narratives and add the fragments."""
    fixed = fragments()
    tokenizer = Tokenizer(models.BPE(byte_fallback=False))
    tokenizer.pre_tokenizer = pre_tokenizers.Sequence(
        [
            pre_tokenizers.Split(Regex(SPLIT), "isolated"),
            pre_tokenizers.ByteLevel(add_prefix_space=False, use_regex=False),
        ]
    )
    tokenizer.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=VOCABULARY - len(fixed),
        special_tokens=list(SPECIAL),
        show_progress=False,
        min_frequency=2,
        initial_alphabet=pre_tokenizers.ByteLevel.alphabet(),
    )
    tokenizer.train_from_iterator(_with_numbers(texts), trainer)
    tokenizer.add_tokens([AddedToken(text, normalized=False, special=False) for text in fixed])
    return wrap(tokenizer)


def _with_numbers(texts: Iterable[str]) -> Iterator[str]:
    pairs = " ".join(f"{n:02d}" for n in range(100))
    yield from [pairs] * 3000
    yield from texts


def wrap(tokenizer: Tokenizer) -> PreTrainedTokenizerFast:
    """As transformers loads it."""
    return PreTrainedTokenizerFast(
        tokenizer_object=tokenizer,
        pad_token=PAD,
        eos_token=END,
        chat_template=CHAT_TEMPLATE,
        clean_up_tokenization_spaces=False,
        model_max_length=2048,
        padding_side="left",
        additional_special_tokens=[t for t in SPECIAL if t not in (PAD, END)],
    )


class Coder:
    """Pieces of text to token ids, remembered; the same ids as the tokenizer gives to the joined text."""

    def __init__(self, tokenizer: PreTrainedTokenizerFast) -> None:
        self.tokenizer = tokenizer
        self.raw = tokenizer.backend_tokenizer
        self.special = {name: tokenizer.convert_tokens_to_ids(name) for name in SPECIAL}
        self.piece = cache(self._piece)

    def _piece(self, text: str) -> tuple[int, ...]:
        return tuple(self.raw.encode(text, add_special_tokens=False).ids)

    def text(self, text: str) -> list[int]:
        """Ids of a narrative; words that look like special tokens are kept as text."""
        return list(self.raw.encode(text.replace("<|", "< |"), add_special_tokens=False).ids)

    def worn(self, text: str, broken: float, dropped: float, rng: Random) -> tuple[list[int], list[int]]:
        """Ids of a narrative without special tokens as a careless copy has it, and the letter behind each (of the first
        parts of a broken token its first letter).

        Of its tokens the share `broken` (0 to 1) is broken into what they were merged from, so that forms of a word
        that never trained are read by their parts (after Provilkov et al. 2020, "BPE-Dropout", from the finished token
        downwards so that a seed gives one result). Of the words that can be spared the share `dropped` is left out, so
        that what is left of an idiom tells it ("making a left" without its turn).
        """
        found = self.raw.encode(text, add_special_tokens=False)
        ids: list[int] = []
        ends: list[int] = []
        gap = 0
        for token, (start, end) in zip(found.ids, found.offsets, strict=True):
            if start >= gap and (spare := _SPARE.match(text, start)) and rng.random() < dropped:
                gap = spare.end()
            if end <= gap:
                continue
            parts = self._parts(token, broken, rng)
            ids += parts
            ends += [start + 1] * (len(parts) - 1) + [end]
        return ids, ends

    def _parts(self, token: int, share: float, rng: Random) -> list[int]:
        if token not in self._halves or rng.random() >= share:
            return [token]
        return [part for half in self._halves[token] for part in self._parts(half, share, rng)]

    @cached_property
    def _halves(self) -> dict[int, tuple[int, int]]:
        """Both tokens that each merged token of letters came from; pairs of digits are copied whole and stay so."""
        ids: dict[str, int] = self.raw.get_vocab()
        found: dict[int, tuple[int, int]] = {}
        for left, right in json.loads(self.raw.to_str())["model"]["merges"]:
            if not any(letter.isdigit() for letter in left + right):
                found.setdefault(ids[left + right], (ids[left], ids[right]))
        return found


def load_tokenizer(folder: Path) -> PreTrainedTokenizerFast:
    """The tokenizer in a folder."""
    return PreTrainedTokenizerFast.from_pretrained(folder, local_files_only=True)


def describe(tokenizer: PreTrainedTokenizerFast) -> str:
    """Vocabulary size and number of fragments, as JSON for a log."""
    return json.dumps({"vocabulary": len(tokenizer), "fragments": len(fragments())})
