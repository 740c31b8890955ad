"""The beginning of a GGUF file: its description and the sizes of its tensors, read without any package.

Layout: "GGUF", version, counts of tensors and of described keys, the keys with typed values, the tensors' names and
shapes (the format's specification in ggml's repository, docs/gguf.md). Reads no weights.
"""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from sgcad_core.errors import ConfigError

_MAGIC = b"GGUF"
_SCALARS = {0: "<B", 1: "<b", 2: "<H", 3: "<h", 4: "<I", 5: "<i", 6: "<f", 7: "<?", 10: "<Q", 11: "<q", 12: "<d"}
_TEXT, _LIST = 8, 9
_MOST = 1 << 24
"""Entries or bytes beyond which a header is called damaged."""
_PART = re.compile(r"-\d{5}-of-(\d{5})\.gguf$")
_KEPT_LIST = 4096
"""Longer lists (vocabularies) are passed over and told by their length."""


@dataclass(frozen=True)
class Header:
    """What a file says of itself. `size`: bytes of all its parts; `shapes`: sizes of the tensors of this part."""

    architecture: str
    told: dict[str, Any]
    shapes: dict[str, tuple[int, ...]]
    size: int

    @property
    def parameters(self) -> int:
        """Numbers in the tensors of this part."""
        return sum(math.prod(shape) for shape in self.shapes.values())

    def number(self, name: str, default: int = 0) -> int:
        """A number of the architecture; of a list over layers the largest."""
        found = self.told.get(f"{self.architecture}.{name}", default)
        return int(max(found)) if isinstance(found, list) else int(found)

    @property
    def cell_bytes(self) -> int:
        """Bytes of keys and values of one token in all layers, in 16 bits."""
        heads = max(1, self.number("attention.head_count", 1))
        width = self.number("embedding_length") // heads
        layers, key_heads = (
            self.number("block_count"),
            self.told.get(f"{self.architecture}.attention.head_count_kv", heads),
        )
        total = sum(key_heads) if isinstance(key_heads, list) else int(key_heads) * layers
        sides = self.number("attention.key_length", width) + self.number("attention.value_length", width)
        return 2 * total * sides


def read(file: Path) -> Header:
    """The header of a file. Raises ConfigError if it is none."""
    try:
        with file.open("rb") as opened:
            return _read(opened, sum(part.stat().st_size for part in parts(file)))
    except (OSError, struct.error, UnicodeDecodeError, ValueError) as fault:
        raise ConfigError(f"{file}: is no GGUF file: {fault}; fetch it again") from fault


def parts(file: Path) -> list[Path]:
    """The files of a model that is cut into parts; the file itself where it is whole."""
    if not (found := _PART.search(file.name)):
        return [file]
    return sorted(file.parent.glob(f"{file.name[: found.start()]}-*-of-{found[1]}.gguf"))


def _read(opened: BinaryIO, size: int) -> Header:
    if opened.read(4) != _MAGIC:
        raise ValueError("it does not begin with GGUF")
    (version,) = _take(opened, "<I")
    if version < 2:
        raise ValueError(f"version {version} is too old")
    tensors, keys = _take(opened, "<QQ")
    if max(tensors, keys) > _MOST:
        raise ValueError(f"it claims {tensors} tensors and {keys} keys")
    told = {_text(opened): _value(opened, _take(opened, "<I")[0]) for _ in range(keys)}
    shapes = dict(_tensor(opened) for _ in range(tensors))
    return Header(str(told.get("general.architecture", "")), told, shapes, size)


def _take(opened: BinaryIO, form: str) -> tuple[Any, ...]:
    return struct.unpack(form, opened.read(struct.calcsize(form)))


def _text(opened: BinaryIO) -> str:
    (length,) = _take(opened, "<Q")
    if length > _MOST:
        raise ValueError(f"a text of {length} bytes")
    return opened.read(length).decode("utf-8")


def _value(opened: BinaryIO, kind: int) -> Any:
    if kind == _TEXT:
        return _text(opened)
    if kind == _LIST:
        inner, count = _take(opened, "<IQ")
        if count > _MOST:
            raise ValueError(f"a list of {count} entries")
        found = [_value(opened, inner) for _ in range(count)]
        return found if count <= _KEPT_LIST else count
    if kind not in _SCALARS:
        raise ValueError(f"a value of the unknown kind {kind}")
    return _take(opened, _SCALARS[kind])[0]


def _tensor(opened: BinaryIO) -> tuple[str, tuple[int, ...]]:
    """Name and shape of the tensor whose entry comes next."""
    name = _text(opened)
    (dimensions,) = _take(opened, "<I")
    if dimensions > 8:
        raise ValueError(f"a tensor of {dimensions} dimensions")
    shape = _take(opened, f"<{dimensions}Q")
    _take(opened, "<IQ")
    return name, shape
