"""The properties of a model's architecture that the loop needs: positions, pictures, rows that may share a batch.

Two families cover the image-text models of transformers: models that put a picture's features in place of placeholder
tokens (Qwen-VL with three-dimensional positions, LLaVA, Idefics3, ... and plain text models), and Mllama, which attends
to pictures in layers of its own. Knows no cache and no decoder.
"""

from __future__ import annotations

import inspect
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any
from weakref import WeakKeyDictionary

import torch
from torch import Tensor

from plugins.backbone.engine import supported
from plugins.backbone.engine.records import Picture, Prompt

_KEPT_PICTURES = 64
_WHOLE_PICTURES = ("gemma3",)
Positions = Tensor
"""(dimensions, tokens): one dimension, or time, height and width (M-RoPE)."""


class Family(ABC):
    """One kind of architecture; the kept picture features are its only state."""

    cross_layers: Sequence[int] = ()
    dimensions = 1
    kinds_argument: str | None = None
    """The model's argument that says which tokens are a picture's, where its whole forward pass needs it."""
    whole_pictures = False
    """Whether the tokens of a picture see each other in both directions (Gemma 3)."""

    def __init__(self, model: Any) -> None:
        self.model = model
        config = model.config
        self.image_token = getattr(config, "image_token_id", getattr(config, "image_token_index", None))
        self.kept: OrderedDict[str, Any] = OrderedDict()
        self.lock = threading.Lock()

    @abstractmethod
    def encode(self, picture: Picture) -> Any:
        """The picture's features; slow, so called through `features`."""

    @abstractmethod
    def tokens_of(self, picture: Picture) -> int:
        """How many placeholder tokens the picture takes."""

    @abstractmethod
    def prefill_inputs(self, prompt: Prompt, start: int, end: int) -> dict[str, Any]:
        """The model's arguments about pictures for a prefill of prompt.ids[start:end]."""

    def step_inputs(self, prompts: Sequence[Prompt], tokens: int) -> dict[str, Any]:
        """The model's arguments about pictures for a step of several rows, `tokens` new ones each."""
        return {}

    def positions(self, prompt: Prompt) -> tuple[Positions, int]:
        """Positions of the prompt's tokens, and that of the first token behind it."""
        return torch.arange(len(prompt.ids))[None], len(prompt.ids)

    def lane(self, prompt: Prompt) -> str:
        """Name of the prompt's lane; rows of the same lane may share a batch even if lanes are separate."""
        return "pictures" if prompt.pictures else "text"

    def salt(self, prompt: Prompt) -> tuple[str, ...]:
        """Digests of all that a prompt's keys and values depend on besides the tokens before."""
        return ()

    def features(self, picture: Picture) -> Any:
        """The picture's features, encoded once. Thread-safe: every thread that writes a prompt counts them."""
        with self.lock, torch.inference_mode():
            if picture.digest not in self.kept:
                self.kept[picture.digest] = self.encode(picture)
                if len(self.kept) > _KEPT_PICTURES:
                    self.kept.popitem(last=False)
            self.kept.move_to_end(picture.digest)
            return self.kept[picture.digest]

    def spans(self, prompt: Prompt) -> list[tuple[int, int]]:
        """First and last-but-one place of each picture's placeholders. Raises ValueError if they do not match."""
        places = [i for i, token in enumerate(prompt.ids) if token == self.image_token] if prompt.pictures else []
        found, used = [], 0
        for picture in prompt.pictures:
            mine = places[used : used + self.tokens_of(picture)]
            if len(mine) < self.tokens_of(picture):
                break
            found.append((mine[0], mine[-1] + 1))
            used += len(mine)
        if used != len(places) or len(found) != len(prompt.pictures):
            raise ValueError(
                f"the prompt has {len(places)} picture tokens, its {len(prompt.pictures)} pictures need "
                f"{sum(self.tokens_of(p) for p in prompt.pictures)}"
            )
        return found

    def to_model(self, inputs: dict[str, Any]) -> dict[str, Any]:
        """Tensors on the model's device, floats in its precision."""
        model = self.model
        return {
            name: value.to(model.device, model.dtype if value.is_floating_point() else value.dtype)
            if isinstance(value, Tensor)
            else value
            for name, value in inputs.items()
        }


class InlineFamily(Family):
    """Pictures in the text: placeholder tokens whose embeddings are replaced."""

    def __init__(self, model: Any) -> None:
        super().__init__(model)
        self.core = getattr(model, "model", model)
        self.mrope = hasattr(self.core, "get_rope_index")
        self.dimensions = 3 if self.mrope else 1
        self.whole_pictures = model.config.model_type in _WHOLE_PICTURES
        self.kinds_argument = "mm_token_type_ids" if self.mrope else "token_type_ids" if self.whole_pictures else None
        encoder = getattr(self.core, "get_image_features", None)
        self.encoder_arguments = set(inspect.signature(encoder).parameters) if encoder else set()
        self.takes_features = "mm_encoder_outputs" in inspect.signature(self.core.forward).parameters

    def encode(self, picture: Picture) -> Any:
        """transformers' own features of one picture, without what only training needs."""
        inputs = {k: v for k, v in picture.inputs.items() if k in self.encoder_arguments}
        found = self.core.get_image_features(**self.to_model(inputs), return_dict=True)
        if not hasattr(found, "pooler_output"):  # transformers before 5.23
            return SimpleNamespace(pooler_output=list(found))
        kept = {k: getattr(found, k) for k in ("pooler_output", "deepstack_features") if hasattr(found, k)}
        return SimpleNamespace(**kept)

    def tokens_of(self, picture: Picture) -> int:
        """One placeholder a feature vector."""
        return sum(part.shape[0] for part in self.features(picture).pooler_output)

    def prefill_inputs(self, prompt: Prompt, start: int, end: int) -> dict[str, Any]:
        """Features of the pictures that lie within the stretch (the pictures, where the model takes no features)."""
        spans = self.spans(prompt)
        inside = [p for p, (a, b) in zip(prompt.pictures, spans, strict=True) if a >= start and b <= end]
        if not inside:
            return {}
        if not self.takes_features:
            return self.to_model(forward_inputs(inside))
        return {"mm_encoder_outputs": {"image": _join_features([self.features(p) for p in inside])}}

    def positions(self, prompt: Prompt) -> tuple[Positions, int]:
        """Three dimensions by the model's own rule, but never through its shared rope_deltas."""
        if not self.mrope:
            return super().positions(prompt)
        if not prompt.pictures:
            return torch.arange(len(prompt.ids)).expand(3, -1), len(prompt.ids)
        ids = torch.tensor([list(prompt.ids)])
        grids = torch.cat([p.inputs["image_grid_thw"] for p in prompt.pictures])
        kinds = ids.eq(self.image_token or 0).int()
        found, _ = self.core.get_rope_index(ids, mm_token_type_ids=kinds, image_grid_thw=grids.cpu())
        return found[:, 0], int(found.max()) + 1


class CrossAttentionFamily(Family):
    """Mllama: the text attends to the whole picture in layers of its own.

    A row without a picture skips those layers, so it never shares a batch with a row that has one.
    """

    def __init__(self, model: Any) -> None:
        super().__init__(model)
        self.cross_layers = tuple(model.config.text_config.cross_attention_layers)
        self.seen: WeakKeyDictionary[Prompt, Tensor] = WeakKeyDictionary()

    def encode(self, picture: Picture) -> Any:
        """States to attend to, (tiles * patches, channels)."""
        core = self.model.model
        names = ("pixel_values", "aspect_ratio_ids", "aspect_ratio_mask")
        found = core.vision_model(**self.to_model({k: picture.inputs[k] for k in names})).last_hidden_state
        return core.multi_modal_projector(found).reshape(-1, found.shape[-2], core.hidden_size)

    def tokens_of(self, picture: Picture) -> int:
        """One placeholder a picture."""
        return 1

    def prefill_inputs(self, prompt: Prompt, start: int, end: int) -> dict[str, Any]:
        """States of all pictures, and which token sees which tile."""
        if not prompt.pictures:
            return {}
        states = torch.cat([self.features(p) for p in prompt.pictures]).flatten(0, 1)[None]
        mask = self.visible(prompt)[start:end]
        return {"cross_attention_states": states, "cross_attention_mask": mask[None].to(self.model.device)}

    def step_inputs(self, prompts: Sequence[Prompt], tokens: int) -> dict[str, Any]:
        """What the last prompt token sees, for every token behind it."""
        if not any(p.pictures for p in prompts):
            return {}
        last = [self.visible(p)[-1] for p in prompts]
        shown = max(m.shape[0] for m in last)
        rows = torch.stack([torch.cat([m, m.new_zeros(shown - m.shape[0], m.shape[1])]) for m in last])
        mask = rows[:, None].expand(-1, tokens, -1, -1)
        return {"cross_attention_mask": mask.to(self.model.device)}

    def visible(self, prompt: Prompt) -> Tensor:
        """(tokens, pictures, tiles), 1 where a token sees a tile: those behind the picture, up to the next one."""
        if prompt not in self.seen:
            self.seen[prompt] = self._visible(prompt)
        return self.seen[prompt]

    def _visible(self, prompt: Prompt) -> Tensor:
        tiles = self.model.config.vision_config.max_num_tiles
        found = torch.zeros(len(prompt.ids), len(prompt.pictures), tiles, dtype=torch.long)
        for i, (start, end) in enumerate(_visible_spans(self.spans(prompt), len(prompt.ids))):
            used = int(prompt.pictures[i].inputs["aspect_ratio_mask"].sum())
            found[start:end, i, :used] = 1
        return found

    def salt(self, prompt: Prompt) -> tuple[str, ...]:
        """Every token's values depend on every picture."""
        return tuple(p.digest for p in prompt.pictures)


def forward_inputs(pictures: Sequence[Picture]) -> dict[str, Any]:
    """The image processor's tensors of several pictures as the model's forward takes them."""
    if not pictures:
        return {}
    listed = "image_sizes" in pictures[0].inputs  # LLaVA-NeXT: the first dimension is the pictures
    return {
        name: torch.cat([p.inputs[name] for p in pictures], dim=1 if _batched(name, value) and not listed else 0)
        for name, value in pictures[0].inputs.items()
    }


def _batched(name: str, value: Tensor) -> bool:
    """True if the first dimension is the batch and the second the pictures (Idefics3, Mllama)."""
    return {"pixel_values": 5, "pixel_attention_mask": 4}.get(name, 0) <= value.ndim and name in (
        "pixel_values", "pixel_attention_mask", "aspect_ratio_ids", "aspect_ratio_mask"
    )  # fmt: skip


def family_of(model: Any) -> Family:
    """The family of a model. Raises TooLong for layers whose state is no list of keys and values."""
    supported.check(model.config)
    return CrossAttentionFamily(model) if model.config.model_type == "mllama" else InlineFamily(model)


def _visible_spans(spans: Sequence[tuple[int, int]], length: int) -> list[tuple[int, int]]:
    """Each picture is seen up to the next one; pictures side by side share the text behind them."""
    ends = [*(start for start, _ in spans[1:]), length][: len(spans)]
    for i in range(len(spans) - 2, -1, -1):
        if spans[i][1] == spans[i + 1][0]:
            ends[i] = ends[i + 1]
    return [(start, end) for (start, _), end in zip(spans, ends, strict=True)]


def _join_features(found: Sequence[Any]) -> Any:
    """Features of several pictures as transformers would have given them at once."""
    whole = all(isinstance(one.pooler_output, Tensor) for one in found)
    parts = [part for one in found for part in one.pooler_output]
    joined = SimpleNamespace(pooler_output=torch.stack(parts) if whole else parts)
    if hasattr(found[0], "deepstack_features"):
        layers = zip(*(one.deepstack_features for one in found), strict=True)
        joined.deepstack_features = [[part for one in layer for part in one] for layer in layers]
    return joined
