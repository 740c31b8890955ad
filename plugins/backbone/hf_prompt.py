"""From the parts of a prompt to token ids with every picture's placeholders in place.

Uses the model's chat template if it has one, else plain text. Special tokens in a report are split, so that no
narrative can end its own message. Knows of the model only the sizes of its pictures.
"""

from __future__ import annotations

import hashlib
import io
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import torch
from PIL import Image

from plugins.backbone.engine.records import Picture, Prompt
from plugins.backbone.hf_load import Loaded
from plugins.backbone.hf_placeholders import spelling_of
from plugins.backbone.prompt import Parts
from sgcad_core.case.records import Diagram
from sgcad_core.errors import ConfigError
from sgcad_core.system.pictures import opened

_KEPT_PICTURES = 64
_GAP = "\n\n"
Turn = tuple[str, list[str | None]]
"""The role, and the texts and pictures (None) in their order."""


class Pictured(Protocol):
    """What prompts need of a model's family."""

    image_token: int | None

    def tokens_of(self, picture: Picture) -> int:
        """How many placeholder tokens the picture takes."""


class TextOnly:
    """A family whose prompts hold no pictures."""

    image_token: int | None = None

    def tokens_of(self, picture: Picture) -> int:
        """None: no picture is shown."""
        return 0


class Prompter:
    """Writes prompts for one loaded model."""

    def __init__(
        self, loaded: Loaded, family: Pictured, pictures_first: bool = True, marker: str | None = None
    ) -> None:
        """`marker`: a text that stands for each picture in `text`, for a caller who puts the pictures in its place."""
        self.loaded = loaded
        self.family = family
        self.pictures_first = pictures_first
        self.tokenizer = loaded.tokenizer
        special = {t.content for t in self.tokenizer.added_tokens_decoder.values() if t.special}
        self.specials = sorted(special | ({marker} if marker else set()), key=len, reverse=True)
        self.marker = marker
        self.image_text = self.tokenizer.convert_ids_to_tokens(family.image_token) if loaded.prepare else None
        self.spelling = spelling_of(loaded.model.config, self.tokenizer) if loaded.prepare else None
        placeholder = (self.spelling.shown if self.spelling else None) or self.image_text
        self.shown = self.tokenizer.convert_tokens_to_ids(placeholder) if placeholder else None
        self.shown_text = placeholder or marker
        self.kept: OrderedDict[str, Picture] = OrderedDict()
        self.lock, self.tokenizing = threading.Lock(), threading.Lock()
        self.layouts: dict[str, tuple[int, int]] = {}

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the result: what the model's prompts leave out."""
        found = [] if self.loaded.template else ["the model has no chat template: its prompt is plain text"]
        found += [] if self.loaded.prepare else ["the model is shown no pictures: diagrams are left out"]
        return tuple(found)

    def prompt(self, parts: Parts, view: int = 0) -> Prompt:
        """Token ids and pictures in one of their views. Raises ConfigError if the template drops a picture."""
        pictures = [self.picture(diagram, view) for diagram in parts.diagrams] if self.loaded.prepare else []
        ids = self.spelled(parts, len(pictures))
        shown = ids.count(self.shown) if self.shown is not None else 0
        if shown != len(pictures):
            raise ConfigError(
                f"the chat template shows {shown} of {len(pictures)} pictures (placeholder {self.shown_text!r}); "
                "use a model whose template knows content of type image"
            )
        return Prompt(self._expanded(ids, pictures), pictures)

    def turn(self, blocks: list[str | None], pictures: list[Picture]) -> list[int]:
        """Token ids of one user's turn whose pictures (None among the blocks) are prepared."""
        return self._expanded(self._ids(self._rendered([("user", blocks)])), pictures)

    # ------------------------------------------------------------------ text
    def spelled(self, parts: Parts, pictures: int) -> list[int]:
        """Token ids with one placeholder for each picture."""
        return self._ids(self.text(parts, pictures))

    def text(self, parts: Parts, pictures: int) -> str:
        """The whole prompt as text, with a placeholder or the marker for each picture."""
        return self._templated(parts, pictures) if self.loaded.template else self._plain(parts, pictures)

    def blocks(self, parts: Parts, pictures: int) -> list[str | None]:
        """Texts and, as None, pictures in the prompt's order; a gap behind every text but the last."""
        shared = [parts.task, *map(self._defused, parts.passages)]
        narrative: list[str | None] = [self._defused(parts.narrative)] if parts.narrative else []
        shown: list[str | None] = [None] * pictures
        evidence = shown + narrative if self.pictures_first else narrative + shown
        repair: list[str | None] = [self._defused(parts.repair)] if parts.repair else []
        found = [_GAP.join(text for text in shared if text) or None, *evidence, *repair]
        if found[0] is None:
            found = found[1:]
        last = max((i for i, block in enumerate(found) if block is not None), default=-1)
        return [block + _GAP if block is not None and i != last else block for i, block in enumerate(found)]

    def _templated(self, parts: Parts, pictures: int) -> str:
        if parts.previous and (text := self._in_turns(parts, pictures)):
            return text
        return self._rendered([("user", self.blocks(parts, pictures))])

    def _in_turns(self, parts: Parts, pictures: int) -> str | None:
        """The first question, its answer, then the findings: everything up to them was read before.

        None where the template does not keep the first question as it was (the embedded model's, for one).
        """
        asked: Turn = ("user", self.blocks(replace(parts, repair=""), pictures))
        findings = self._defused(parts.repair.replace(parts.previous, "(the answer above)", 1))
        first = self._rendered([asked])
        whole = self._rendered([asked, ("assistant", [self._defused(parts.previous)]), ("user", [findings])])
        return whole if whole.startswith(first + self._defused(parts.previous)) else None

    def _rendered(self, turns: Sequence[Turn]) -> str:
        try:
            text = self._applied([{"role": role, "content": _content(blocks, self.marker)} for role, blocks in turns])
            if "{'type':" not in text:
                return text
        except TypeError:  # a template for texts only joins contents as strings
            pass
        return self._applied([{"role": role, "content": self._joined(blocks)} for role, blocks in turns])

    def _applied(self, messages: list[dict[str, Any]]) -> str:
        text: str = self.tokenizer.apply_chat_template(
            messages,
            chat_template=self.loaded.template,
            tokenize=False,
            add_generation_prompt=True,
            enable_thinking=False,
        )
        return thought(text)

    def _joined(self, blocks: list[str | None]) -> str:
        return "".join(self.shown_text or "" if block is None else block for block in blocks)

    def _plain(self, parts: Parts, pictures: int) -> str:
        return f"{self._joined(self.blocks(parts, pictures)).rstrip()}{_GAP}Answer:\n"

    def _defused(self, text: str) -> str:
        """The text with a space in every special token."""
        for special in self.specials:
            if len(special) > 1:
                text = text.replace(special, f"{special[0]} {special[1:]}")
        return text

    def _ids(self, text: str) -> list[int]:
        return self._tokenized(text, add=self.begins(text))

    def begins(self, text: str) -> bool:
        """Whether the tokenizer is to add its own beginning to a prompt: the text does not have it."""
        begun = bool(self.tokenizer.bos_token) and text.startswith(self.tokenizer.bos_token)
        return not begun and not self._closes()

    def _closes(self) -> bool:
        """True if the tokenizer adds an end token after a text: then no special tokens may be added."""
        probe = self._tokenized("a", add=True)
        return bool(probe) and probe[-1] == self.tokenizer.eos_token_id

    def _tokenized(self, text: str, add: bool) -> list[int]:
        """Token ids of a text; under a lock, since a fast tokenizer is one mutable object."""
        with self.tokenizing:
            found: list[int] = self.tokenizer(text, add_special_tokens=add)["input_ids"]
        return found

    # ------------------------------------------------------------------ pictures
    def picture(self, diagram: Diagram, view: int = 0) -> Picture:
        """A diagram prepared for the model, once for each view."""
        digest = hashlib.sha256(diagram.png + bytes([view] * bool(view))).hexdigest()
        with self.lock:
            if digest not in self.kept:
                self.kept[digest] = self._prepared(diagram, digest, view)
                if len(self.kept) > _KEPT_PICTURES:
                    self.kept.popitem(last=False)
            return self.kept[digest]

    def _prepared(self, diagram: Diagram, digest: str, view: int) -> Picture:
        assert self.loaded.prepare is not None  # noqa: S101 -- asked by the caller
        with opened(diagram.png) as picture:
            found = dict(self.loaded.prepare(picture.convert("RGB"), view))
        if "rows" in found:
            self.layouts[digest] = (int(found["rows"][0][0]), int(found["cols"][0][0]))
        layout = ("rows", "cols", "num_tiles")
        if isinstance(found.get("image_sizes"), list):
            found["image_sizes"] = torch.tensor(found["image_sizes"])
        tensors = {k: v for k, v in found.items() if isinstance(v, torch.Tensor) and k not in layout}
        return Picture(digest, tensors)

    def _expanded(self, ids: list[int], pictures: list[Picture]) -> list[int]:
        """Each placeholder as many times as its picture has features, or as its grid of tiles is spelled."""
        found: list[int] = []
        left = iter(pictures)
        for token in ids:
            found += self._placeholders(next(left)) if token == self.shown and pictures else [token]
        return found

    def _placeholders(self, picture: Picture) -> list[int]:
        count = self.family.tokens_of(picture)
        assert self.spelling is not None  # noqa: S101 -- there are pictures
        if picture.digest not in self.layouts:
            return self._tokenized(self.spelling.spell(str(self.image_text), count, picture), add=False)
        rows, columns = self.layouts[picture.digest]
        text = tiled(rows, columns, str(self.image_text) * (count // (rows * columns + 1)))
        return self._tokenized(text, add=False)


@dataclass
class AroundPrompter:
    """A writer of prompts with pictures: those without diagrams are the prompter's own."""

    words: Prompter

    @property
    def loaded(self) -> Loaded:
        """The tokenizer and template."""
        return self.words.loaded

    @property
    def specials(self) -> list[str]:
        """The tokenizer's special tokens, and the marker of pictures if there is one."""
        return self.words.specials


def thought(text: str) -> str:
    """A prompt whose template has opened a block of thoughts, with the block closed: the answer begins behind it."""
    return f"{text.rstrip()}\n\n</think>\n\n" if text.rstrip().endswith("<think>") else text


def _content(blocks: Sequence[str | None], marker: str | None) -> list[dict[str, str]]:
    shown = {"type": "text", "text": marker} if marker else {"type": "image"}
    return [dict(shown) if block is None else {"type": "text", "text": block} for block in blocks]


def tiled(rows: int, columns: int, tile: str) -> str:
    """Idefics3's and SmolVLM's spelling of a picture cut into tiles, the whole picture last."""
    fence = "<fake_token_around_image>"
    parts = "".join(
        "".join(f"{fence}<row_{r + 1}_col_{c + 1}>{tile}" for c in range(columns)) + "\n" for r in range(rows)
    )
    return f"{parts}{chr(10) if rows else ''}{fence}<global-img>{tile}{fence}"


def check_diagram() -> Diagram:
    """A small drawing for the start-up self-check: two crossing roads."""
    picture = Image.new("RGB", (96, 96), "white")
    for i in range(96):
        for place in ((i, 44), (i, 52), (44, i), (52, i)):
            picture.putpixel(place, (0, 0, 0))
    out = io.BytesIO()
    picture.save(out, format="PNG")
    return Diagram(png=out.getvalue(), width_px=96, height_px=96)
