"""The key-value cache of the loop: one slot for each row, filled to the row's own length.

Storage is (slot, position, head, channel): a row's tokens are written at their own positions, rows of different lengths
share one batch, a row is removed by freeing its slot, and rejected tokens are overwritten. Positions behind a row's
length are masked and never read. Knows no model; the models of transformers write through the interface `Cache`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor
from transformers.cache_utils import Cache, CacheLayerMixin

Saved = list[tuple[Tensor, Tensor] | None]
"""A stretch of a row's keys and values by layer, each (positions, heads, channels)."""

_GROWTH = 256


@dataclass
class Window:
    """The part that the next forward pass reads and writes: `count` slots from `first`, `keys` positions of each."""

    first: int = 0
    count: int = 1
    keys: int = 0
    start: int = 0
    places: Tensor = field(default_factory=lambda: torch.zeros(0, dtype=torch.long))
    """Flat place slot * capacity + position of every new token, (count * new tokens,)."""
    moved: dict[torch.device, Tensor] = field(default_factory=dict)

    def places_on(self, device: torch.device) -> Tensor:
        """`places` on a layer's device: with device_map, layers lie on several."""
        if device not in self.moved:
            self.moved[device] = self.places.to(device)
        return self.moved[device]


class SlotLayer(CacheLayerMixin):  # type: ignore[misc]
    """One layer of self-attention."""

    is_sliding = False

    def __init__(self, cache: SlotCache) -> None:
        super().__init__()
        self.cache = cache
        self.stored: tuple[Tensor, Tensor] | None = None

    def lazy_initialization(self, key_states: Tensor, value_states: Tensor) -> None:
        """Allocates zeros: positions never written are multiplied by a weight of 0 and must be finite."""
        shape = (self.cache.slots, self.cache.capacity)
        self.keys, self.values = self.stored = (_room(key_states, shape), _room(value_states, shape))
        self.is_initialized = True

    def update(self, key_states: Tensor, value_states: Tensor, *args: Any, **kwargs: Any) -> tuple[Tensor, Tensor]:
        """Writes (rows, heads, new tokens, channels) at the window's places; returns the window's keys and values."""
        if self.stored is None:
            self.lazy_initialization(key_states, value_states)
        assert self.stored is not None  # noqa: S101 -- for the type checker
        window = self.cache.window
        for room, new in zip(self.stored, (key_states, value_states), strict=True):
            flat = room.view(-1, *room.shape[2:])
            flat.index_copy_(0, window.places_on(room.device), new.transpose(1, 2).reshape(-1, *room.shape[2:]))
        rows = slice(window.first, window.first + window.count)
        self.keys, self.values = (room[rows, : window.keys].transpose(1, 2) for room in self.stored)
        return self.keys, self.values

    def resize(self, slots: int, capacity: int) -> None:
        """Moves the stored keys and values into larger storage."""
        if self.stored is not None:
            self.stored = (_grown(self.stored[0], slots, capacity), _grown(self.stored[1], slots, capacity))

    def get_seq_length(self) -> int:
        """Tokens before the window's new ones; only a prefill, one row at a time, may ask."""
        return self.cache.window.start

    def get_mask_sizes(self, query_length: int) -> tuple[int, int]:
        """Keys that the new tokens see, and the first of them."""
        return self.cache.window.keys, 0

    def get_max_length(self) -> int:
        """No limit: the storage grows."""
        return -1

    get_max_cache_shape = get_max_length
    """The name of the same in transformers before 5.3."""


class CrossLayer(SlotLayer):
    """One layer that attends to pictures' states instead of to the text before (Mllama).

    A step shows as many positions as the longest of its rows has: the model's mask is that long.
    """

    def __init__(self, cache: SlotCache) -> None:
        super().__init__(cache)
        self.lengths: dict[int, int] = {}
        """Positions by slot."""

    def lazy_initialization(self, key_states: Tensor, value_states: Tensor) -> None:
        """Allocates as many positions as the picture has."""
        shape = (self.cache.slots, key_states.shape[2])
        self.stored = (_room(key_states, shape), _room(value_states, shape))
        self.is_initialized = True
        self._expose()

    def update(self, key_states: Tensor, value_states: Tensor, *args: Any, **kwargs: Any) -> tuple[Tensor, Tensor]:
        """Stores one row's picture and returns its keys and values unchanged."""
        if self.stored is None:
            self.lazy_initialization(key_states, value_states)
        assert self.stored is not None  # noqa: S101 -- for the type checker
        length = key_states.shape[2]
        if length > self.stored[0].shape[1]:
            self.stored = (_grown(self.stored[0], 0, length), _grown(self.stored[1], 0, length))
        self.lengths[self.cache.window.first] = length
        for room, new in zip(self.stored, (key_states, value_states), strict=True):
            room[self.cache.window.first] = 0
            room[self.cache.window.first, :length] = new[0].transpose(0, 1)
        return key_states, value_states

    def resize(self, slots: int, capacity: int) -> None:
        """More slots; the positions stay."""
        super().resize(slots, 0)

    def show(self) -> None:
        """Sets `keys` and `values`, which Mllama reads directly, to the window's rows."""
        if self.stored is not None:
            self._expose()

    def _expose(self) -> None:
        assert self.stored is not None  # noqa: S101 -- for the type checker
        window = self.cache.window
        rows = range(window.first, window.first + window.count)
        shown = max((self.lengths.get(slot, 0) for slot in rows), default=0) or self.stored[0].shape[1]
        self.keys, self.values = (room[rows.start : rows.stop, :shown].transpose(1, 2) for room in self.stored)


class SlotCache(Cache):  # type: ignore[misc]
    """All layers; `cross` names those that attend to pictures."""

    def __init__(self, layers: int, cross: Iterable[int] = ()) -> None:
        self.slots = 2
        self.capacity = _GROWTH
        self.window = Window()
        cross = set(cross)
        super().__init__(layers=[CrossLayer(self) if i in cross else SlotLayer(self) for i in range(layers)])

    def look_at(self, window: Window) -> None:
        """Sets the window of the next forward pass."""
        self.window = window
        for layer in self.layers:
            if isinstance(layer, CrossLayer):
                layer.show()

    def ensure(self, slots: int, capacity: int) -> None:
        """Makes room for that many rows and positions; grows by doubling, so rarely."""
        if slots <= self.slots and capacity <= self.capacity:
            return
        self.slots = max(self.slots, slots if slots <= self.slots else max(slots, 2 * self.slots))
        self.capacity = max(self.capacity, -(-capacity // _GROWTH) * _GROWTH)
        for layer in self.layers:
            layer.resize(self.slots, self.capacity)

    def move(self, source: int, target: int, length: int) -> None:
        """Copies a row's first positions to another slot."""
        for layer in self.layers:
            for room in layer.stored or ():
                used = slice(None) if isinstance(layer, CrossLayer) else slice(length)
                room[target, used] = room[source, used]
            if isinstance(layer, CrossLayer):
                layer.lengths[target] = layer.lengths.get(source, 0)

    def clear(self, slot: int) -> None:
        """Sets a slot that may hold NaN to zero: a weight of 0 times NaN is NaN."""
        for layer in self.layers:
            for room in layer.stored or ():
                room[slot] = 0

    def save(self, slot: int, length: int) -> Saved:
        """A copy of a row's first positions; pictures' layers are None, since every prefill fills them."""
        return [
            None
            if isinstance(layer, CrossLayer) or layer.stored is None
            else (layer.stored[0][slot, :length].clone(), layer.stored[1][slot, :length].clone())
            for layer in self.layers
        ]

    def load(self, slot: int, saved: Saved, length: int) -> None:
        """Writes the first positions of a copy made by `save` into a slot."""
        for layer, kept in zip(self.layers, saved, strict=True):
            if kept is None:
                continue
            if layer.stored is None:
                layer.lazy_initialization(*(part.transpose(0, 1)[None] for part in kept))
            for room, part in zip(layer.stored, kept, strict=True):
                room[slot, :length] = part[:length]


def _room(states: Tensor, shape: tuple[int, int]) -> Tensor:
    """Zeros (slots, positions, heads, channels) like states (rows, heads, tokens, channels)."""
    return states.new_zeros(*shape, states.shape[1], states.shape[3])


def _grown(room: Tensor, slots: int, capacity: int) -> Tensor:
    grown = room.new_zeros(max(slots, room.shape[0]), max(capacity, room.shape[1]), *room.shape[2:])
    grown[: room.shape[0], : room.shape[1]] = room
    return grown
