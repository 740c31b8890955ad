"""Prompts with pictures for GGUF files: the row with evidence shows the drawings, the row without it is text.

A marker stands in the rendered conversation for each picture; the projector's library spells what stands there. In the
token ids a picture is a run of holes. Knows no weights.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

from plugins.backbone.engine.records import Picture, Prompt
from plugins.backbone.hf_prompt import AroundPrompter
from plugins.backbone.llama.projector import MARKER, Bitmap, Projector, Shown
from plugins.backbone.prompt import Parts
from sgcad_core.case.records import Diagram
from sgcad_core.errors import ConfigError
from sgcad_core.system.pictures import opened

HOLE = -1
"""The token id in a picture's place."""


@dataclass(frozen=True)
class Span:
    """A picture in a prompt: its tokens from `start` to before `end`, which take up `positions` positions."""

    start: int
    end: int
    picture: Picture

    @property
    def shown(self) -> Shown:
        """The library's picture."""
        found: Shown = self.picture.inputs["shown"]
        return found

    @property
    def saved(self) -> int:
        """Tokens beyond its positions: families with positions in two dimensions count the longer side."""
        return self.end - self.start - self.shown.positions


def spans(prompt: Prompt) -> list[Span]:
    """The pictures of a prompt with their places."""
    ids, found, at = list(prompt.ids), list[Span](), 0
    for picture in prompt.pictures:
        start = ids.index(HOLE, at)
        at = start + picture.inputs["shown"].tokens
        found.append(Span(start, at, picture))
    return found


@dataclass
class GgufPrompts(AroundPrompter):
    """Writes prompts: those without diagrams as text, the others with the projector's pieces. Shows one view."""

    projector: Projector

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the result; no diagram is left out."""
        return self.words.notes[:-1]

    def prompt(self, parts: Parts, view: int = 0) -> Prompt:
        """Token ids with holes, and pictures. Raises ConfigError if the template drops a picture."""
        if not parts.diagrams:
            return self.words.prompt(parts, view)
        text = self.words.text(parts, len(parts.diagrams))
        if (shown := text.count(MARKER)) != len(parts.diagrams):
            raise ConfigError(
                f"the chat template of {self.projector.model.file.name} shows {shown} of {len(parts.diagrams)} "
                "pictures; use another file of the model, or report_reader.use_diagrams: false"
            )
        pieces = self.projector.pieces(text, self.words.begins(text), [_bitmap(one) for one in parts.diagrams])
        return _joined(pieces)


def _joined(pieces: Sequence[list[int] | Shown]) -> Prompt:
    ids, pictures = list[int](), list[Picture]()
    for piece in pieces:
        if isinstance(piece, Shown):
            named = f"{piece.digest} {piece.tokens} {len(pictures)}"  # some families number their pictures
            pictures.append(Picture(hashlib.sha256(named.encode()).hexdigest(), {"shown": piece}))
            ids += [HOLE] * piece.tokens
        else:
            ids += piece
    return Prompt(ids, pictures)


def _bitmap(diagram: Diagram) -> Bitmap:
    with opened(diagram.png) as picture:
        plain = picture.convert("RGB")
        return Bitmap(hashlib.sha256(diagram.png).hexdigest(), *plain.size, plain.tobytes())
