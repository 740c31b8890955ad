"""How each family spells a picture in its prompt: what its chat template writes for it, and what then stands there.

The same text as the family's own processor of transformers makes, without that processor: joint processors ask for
torchvision where a family also knows videos. Knows no prompt and no pixel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from plugins.backbone.engine.records import Picture

Speller = Callable[[str, int, Picture], str]
"""From the placeholder's text, how many the picture takes, and the picture, to the text in its place."""


@dataclass(frozen=True)
class Spelling:
    """`shown`: the token that a chat template writes for a picture (None: the placeholder itself)."""

    shown: str | None
    spell: Speller


def spelling_of(config: Any, tokenizer: Any) -> Spelling:
    """The spelling of a model's family, by its configuration."""
    vision = getattr(config, "vision_config", None)
    if config.model_type == "gemma3":
        begin, end = (
            str(getattr(tokenizer, name, None) or usual)
            for name, usual in (("boi_token", "<start_of_image>"), ("eoi_token", "<end_of_image>"))
        )
        return Spelling(begin, _framed(f"\n\n{begin}", f"{end}\n\n"))
    if config.model_type == "internvl":
        begin, end = (str(getattr(tokenizer, f"{w}_image_token", None) or u) for w, u in _INTERNVL.items())
        return Spelling(None, _framed(begin, end))
    if config.model_type == "aya_vision":
        return Spelling("<image>", _tiles)
    if vision is not None and getattr(vision, "model_type", "") == "pixtral":
        return Spelling(None, _rows(int(vision.patch_size) * int(getattr(config, "spatial_merge_size", 1))))
    return Spelling(None, lambda image, count, _: image * count)


_INTERNVL = {"start": "<img>", "end": "</img>"}


def _framed(before: str, behind: str) -> Speller:
    return lambda image, count, _: f"{before}{image * count}{behind}"


def _rows(side: int) -> Speller:
    """Pixtral and Mistral 3: a break behind every row, an end behind the last. `side`: pixels of one placeholder."""

    def spell(image: str, count: int, picture: Picture) -> str:
        height, width = (int(n) for n in picture.inputs["image_sizes"][0])
        return "[IMG_BREAK]".join([image * (width // side)] * (height // side)) + "[IMG_END]"

    return spell


def _tiles(image: str, count: int, picture: Picture) -> str:
    """Aya Vision: numbered tiles, the whole picture last."""
    tiles = len(picture.inputs["pixel_values"])
    each = image * (count // tiles)
    parts = "".join(f"TILE_{i}{each}" for i in range(1, tiles))
    return f"<|START_OF_IMG|>{parts}TILE_GLOBAL{each}<|END_OF_IMG|>"
