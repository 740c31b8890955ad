"""Pictures through a server: the server renders a conversation with its pictures into tokens and features, once.

Every draft and every score sends both back with the tokens behind them, so token numbers are never spelled again and
the contrast is as exact as with text. Diagrams go out as data URLs. Knows vLLM's content of messages; no weights.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from plugins.backbone.engine.records import Prompt
from plugins.backbone.hf_prompt import AroundPrompter
from plugins.backbone.prompt import Parts
from plugins.backbone.server.http import data_url

_KEPT = 8
Content = list[dict[str, Any]]


class Shown(list[int]):
    """Token ids of a rendered prompt, and the features that the server wants back with them."""

    def __init__(self, ids: Sequence[int], features: Any) -> None:
        super().__init__(ids)
        self.features = features


@dataclass
class ShownPrompts(AroundPrompter):
    """Writes prompts: those without diagrams here, the others by the server (`render`)."""

    render: Callable[[Content], Shown]
    kept: OrderedDict[str, Shown] = field(default_factory=OrderedDict)
    lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def notes(self) -> tuple[str, ...]:
        """Nothing is left out."""
        return ()

    def prompt(self, parts: Parts, view: int = 0) -> Prompt:
        """Token ids of a row; rendered once while it is asked for again."""
        if not parts.diagrams:
            return self.words.prompt(parts, view)
        content = self._content(parts)
        with self.lock:
            key = repr(content)
            if key not in self.kept:
                self.kept[key] = self.render(content)
                if len(self.kept) > _KEPT:
                    self.kept.popitem(last=False)
            return Prompt(self.kept[key])

    def _content(self, parts: Parts) -> Content:
        pictures = iter(parts.diagrams)
        blocks = self.words.blocks(parts, len(parts.diagrams))
        return [
            {"type": "image_url", "image_url": {"url": data_url(next(pictures).png)}}
            if block is None
            else {"type": "text", "text": block}
            for block in blocks
        ]


def sampling(limit: int, more: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters of a request that writes greedily."""
    return {"max_tokens": limit, "temperature": 0, **more}
