"""transformers' `AutoProcessor` for the embedded model: `import plugins.backbone.mini.processor`, then load it like any
other.

    import plugins.backbone.mini.processor
    from transformers import AutoModelForImageTextToText, AutoProcessor

    processor = AutoProcessor.from_pretrained("plugins/backbone/mini/weights")
    model = AutoModelForImageTextToText.from_pretrained("plugins/backbone/mini/weights")
    inputs = processor(text=[narrative + "<|vision_start|><|image_pad|><|vision_end|><|road|>"], images=[drawing])
    logits = model(**inputs).logits

The model was trained on the values of its answers only, so `generate` must be held to the grammar of the answers
(`prefix_allowed_tokens_fn`, or backbone `hf_vision`, which does it); free text from it is no JSON. The stock
processor of the architecture wants a video processor, three channels and torchvision; this one turns a drawing
upright and looks at it with the eye that the model was trained with. The product itself does not use this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch
from PIL import Image
from transformers import AutoProcessor, BatchFeature, PreTrainedTokenizerFast, Qwen2_5_VLConfig

from plugins.backbone.mini import patch_convnet
from plugins.backbone.mini.drawing_view import IMAGE


class MiniProcessor:
    """Narratives and drawings to what `generate` takes."""

    def __init__(self, tokenizer: PreTrainedTokenizerFast, sight: patch_convnet.Sight) -> None:
        self.tokenizer, self.sight = tokenizer, sight
        self.image_token = IMAGE

    @classmethod
    def from_pretrained(cls, folder: str | Path, **_: Any) -> MiniProcessor:
        """The processor of a folder of weights; options that only other processors know are passed over."""
        return cls(
            PreTrainedTokenizerFast.from_pretrained(folder, local_files_only=True), patch_convnet.load(Path(folder))
        )

    def __call__(
        self, text: str | Sequence[str], images: Image.Image | Sequence[Image.Image] | None = None, **_: Any
    ) -> BatchFeature:
        """Tokens padded on the left, one `<|image_pad|>` in the texts for each drawing, in order.

        Raises ValueError where texts name more or fewer drawings than are given.
        """
        texts = [text] if isinstance(text, str) else list(text)
        drawings = [] if images is None else [images] if isinstance(images, Image.Image) else list(images)
        if (named := sum(t.count(IMAGE) for t in texts)) != len(drawings):
            raise ValueError(f"the texts name {named} pictures ({IMAGE}), {len(drawings)} are given; give one for each")
        seen = [self.sight.patches(image) for image in drawings]
        counts = iter([grid[0] * grid[1] // 4 for _, grid in seen])
        whole = ["".join(p + IMAGE * next(counts) for p in t.split(IMAGE)[:-1]) + t.split(IMAGE)[-1] for t in texts]
        found = dict(self.tokenizer(whole, padding=True, return_tensors="pt", return_token_type_ids=False))
        found["mm_token_type_ids"] = (found["input_ids"] == self.tokenizer.convert_tokens_to_ids(IMAGE)).int()
        if seen:
            found["pixel_values"] = torch.cat([patches for patches, _ in seen])
            found["image_grid_thw"] = torch.tensor([[1, *grid] for _, grid in seen])
        return BatchFeature(found)

    def apply_chat_template(self, conversation: Sequence[dict[str, Any]], **_: Any) -> BatchFeature:
        """A conversation whose content parts are {"type": "text", "text"} or {"type": "image", "image"}."""
        parts = [part for turn in conversation for part in turn["content"] if isinstance(part, dict)]
        images = [part["image"] for part in parts if part.get("type") == "image"]
        return self(self.tokenizer.apply_chat_template(conversation, tokenize=False), images)

    def decode(self, tokens: Any, skip_special_tokens: bool = True) -> str:
        """Tokens to text."""
        return str(self.tokenizer.decode(tokens, skip_special_tokens=skip_special_tokens))


AutoProcessor.register(Qwen2_5_VLConfig, MiniProcessor, exist_ok=True)
