"""A projector file (mmproj) behind llama.cpp's library for pictures (mtmd): from pixels to vectors that a model reads.

Only here and in `library` are pointers and structures. The library cuts and spells a picture as each family wants it;
pictures are encoded once while they are asked for again. Knows no report.
"""

from __future__ import annotations

import ctypes
import weakref
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plugins.backbone.llama.library import BATCH, REMEDY, Model, OutOfCells, Session, log_into
from sgcad_core.errors import ConfigError, MissingTool

MARKER = "<__picture__>"
"""Stands in a prompt's text where a picture is shown."""
_KEPT = 8
_TEXT = 0


@dataclass(frozen=True)
class Bitmap:
    """A picture's pixels, RGB row by row."""

    digest: str
    width: int
    height: int
    pixels: bytes


class Shown:
    """A picture, or a tile of one, as the library spells it: `tokens` cells that take up `positions` positions."""

    def __init__(self, api: Any, pointer: Any) -> None:
        self.pointer = api.mtmd_input_chunk_copy(pointer)
        self.tokens = int(api.mtmd_input_chunk_get_n_tokens(self.pointer))
        self.positions = int(api.mtmd_input_chunk_get_n_pos(self.pointer))
        self.digest = (api.mtmd_input_chunk_get_id(self.pointer) or b"").decode()
        self.end = weakref.finalize(self, api.mtmd_input_chunk_free, self.pointer)
        self.end.atexit = False


class Projector:
    """An opened projector that belongs to a model. Freed with the object."""

    def __init__(self, model: Model, file: Path, gpu_layers: int, threads: int | None, flash: bool | None) -> None:
        """Raises ConfigError for a file that is no projector of pictures for this model, MissingTool for no mtmd."""
        self.api = _api()
        self.model, self.file = model, file
        params = self.api.mtmd_context_params_default()
        params.use_gpu, params.print_timings, params.warmup = bool(gpu_layers), False, False
        params.media_marker = MARKER.encode()
        params.flash_attn_type = -1 if flash is None else int(flash)
        if threads:
            params.n_threads = threads
        said: list[str] = []
        with log_into(said, self.api.mtmd_helper_log_set):
            self.pointer = self.api.mtmd_init_from_file(str(file).encode(), model.pointer, params)
        if not self.pointer:
            raise ConfigError(
                f"backbone.projector {file}: llama.cpp does not open it for {model.file.name}: {_last(said)}; name the "
                "mmproj file that was published with the model, or set backbone.projector to null"
            )
        self.end = weakref.finalize(self, self.api.mtmd_free, self.pointer)
        self.end.atexit = False
        if not self.api.mtmd_support_vision(self.pointer):
            raise ConfigError(f"backbone.projector {file}: knows sound and no pictures; name another mmproj file")
        self.width = int(model.api.llama_model_n_embd_inp(model.pointer))
        self.kept: OrderedDict[str, Any] = OrderedDict()

    def pieces(self, text: str, special: bool, bitmaps: Sequence[Bitmap]) -> list[list[int] | Shown]:
        """A prompt's tokens and pictures in their order; `special`: with what the file adds before a text.

        Raises ConfigError for a picture that the library cannot cut to the family's sizes.
        """
        data = text.encode("utf-8", errors="replace")
        asked = self.api.mtmd_input_text(data, len(data), special, True)
        made = [self._bitmap(bitmap) for bitmap in bitmaps]
        chunks = self.api.mtmd_input_chunks_init()
        try:
            handles = (ctypes.c_void_p * len(made))(*made)
            code = self.api.mtmd_tokenize(self.pointer, chunks, ctypes.byref(asked), handles, len(made))
            if code:
                sizes = ", ".join(f"{bitmap.width} x {bitmap.height}" for bitmap in bitmaps)
                raise ConfigError(
                    f"backbone.projector {self.file}: pictures of {sizes} pixels cannot be prepared (code {code}); "
                    "use larger pictures, or report_reader.use_diagrams: false"
                )
            return [self._piece(chunks, i) for i in range(self.api.mtmd_input_chunks_size(chunks))]
        finally:
            self.api.mtmd_input_chunks_free(chunks)
            for handle in made:
                self.api.mtmd_bitmap_free(handle)

    def show(self, session: Session, shown: Shown, digest: str, sequence: int, position: int) -> None:
        """Feeds a picture to a sequence from a position on. Raises OutOfCells, RuntimeError or ConfigError."""
        if shown.tokens > BATCH and self.api.mtmd_decode_use_non_causal(self.pointer, shown.pointer):
            raise ConfigError(
                f"backbone.projector {self.file}: a picture takes {shown.tokens} tokens that see each other, {BATCH} "
                "at most can be computed together; use a smaller picture, or backbone hf_vision"
            )
        code = self.api.mtmd_helper_decode_image_chunk(
            self.pointer,
            session.pointer,
            shown.pointer,
            self._encoded(shown, digest),
            position,
            sequence,
            BATCH,
            ctypes.byref(ctypes.c_int32(0)),
            self.api.mtmd_helper_post_decode_callback(0),
            None,
        )
        if code == 1:
            raise OutOfCells("the memory of keys and values is full")
        if code:
            raise RuntimeError(f"llama.cpp could not compute a picture of {shown.tokens} tokens (code {code})")
        session.hold(sequence, position)

    def _encoded(self, shown: Shown, digest: str) -> Any:
        """Vectors (tokens, width) of a picture, kept by its digest."""
        if digest not in self.kept:
            if self.api.mtmd_encode_chunk(self.pointer, shown.pointer):
                raise RuntimeError(f"llama.cpp could not encode a picture of {shown.tokens} tokens")
            size = shown.tokens * self.width
            found = (ctypes.c_float * size)()
            ctypes.memmove(found, self.api.mtmd_get_output_embd(self.pointer), ctypes.sizeof(found))
            self.kept[digest] = found
            if len(self.kept) > _KEPT:
                self.kept.popitem(last=False)
        return self.kept[digest]

    def _bitmap(self, bitmap: Bitmap) -> Any:
        pixels = (ctypes.c_uint8 * len(bitmap.pixels)).from_buffer_copy(bitmap.pixels)
        found = self.api.mtmd_bitmap_init(bitmap.width, bitmap.height, pixels)
        self.api.mtmd_bitmap_set_id(found, bitmap.digest.encode())
        return found

    def _piece(self, chunks: Any, at: int) -> list[int] | Shown:
        chunk = self.api.mtmd_input_chunks_get(chunks, at)
        if self.api.mtmd_input_chunk_get_type(chunk) != _TEXT:
            return Shown(self.api, chunk)
        count = ctypes.c_size_t(0)
        tokens = self.api.mtmd_input_chunk_get_tokens_text(chunk, ctypes.byref(count))
        return [int(tokens[i]) for i in range(count.value)]


def _api() -> Any:
    try:
        import llama_cpp.mtmd_cpp as found
    except (ImportError, OSError, FileNotFoundError) as fault:
        raise MissingTool(
            f"backbone.projector needs llama-cpp-python with its library for pictures (mtmd): {fault}; {REMEDY}"
        ) from fault
    return found


def _last(said: Sequence[str]) -> str:
    """What the library said last, in one line."""
    told = [" ".join(line.split()) for line in said if "rror" in line or "mismatch" in line or "fail" in line.lower()]
    return (told[-1] if told else "it gives no reason")[:300]
