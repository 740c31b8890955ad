"""llama.cpp behind the package llama-cpp-python: one model with one memory of keys and values, as plain calls.

Only here and in `projector` are pointers and structures of the library. Knows token ids, sequences and positions; no
prompt, no report.
"""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgcad_core.errors import ConfigError, MissingTool

PACKAGE = "llama_cpp"
REMEDY = "pip install 'sg-cadvlm[llama]' (builds with a C++ compiler and cmake)"
BATCH = 512
"""Tokens of one call."""
OUTPUTS = 128
"""Tokens of one call whose logits are wanted."""
MOST_SEQUENCES = 256
_NO_ROOM = 1
_BUFFER = 1 << 14


@dataclass(frozen=True)
class Fed:
    """Tokens for one sequence, from a position on; `told`: their logits are wanted."""

    sequence: int
    position: int
    tokens: Sequence[int]
    told: bool


class OutOfCells(MemoryError):
    """The memory of keys and values has no room for a batch."""


def installed() -> bool:
    """Whether the package is there."""
    return find_spec(PACKAGE) is not None


def api() -> Any:
    """The package's functions; its log is switched off. Raises MissingTool."""
    if not installed():
        raise MissingTool(f"backbone 'llama_cpp' needs the package llama-cpp-python: {REMEDY}")
    import llama_cpp.llama_cpp as found

    return found


class Model:
    """An opened file. Freed with the object."""

    def __init__(self, file: Path, gpu_layers: int) -> None:
        """Raises ConfigError for a file that llama.cpp does not load or that the token loop cannot run."""
        self.api = api()
        self.file = file
        quiet(self.api.llama_log_set)
        self.api.llama_backend_init()
        params = self.api.llama_model_default_params()
        params.n_gpu_layers = gpu_layers
        self.pointer = self.api.llama_model_load_from_file(str(file).encode(), params)
        if not self.pointer:
            raise ConfigError(
                f"backbone.model {file}: is no GGUF file that this llama.cpp loads; name another file, or a newer "
                f"llama-cpp-python: {REMEDY}"
            )
        self.end = weakref.finalize(self, self.api.llama_model_free, self.pointer)
        if kind := self._unfit():
            raise ConfigError(
                f"backbone.model {file}: {kind}, whose memory cannot be cut back or shared; use a model that reads "
                "from left to right by attention"
            )
        self.vocab = self.api.llama_model_get_vocab(self.pointer)
        self.vocabulary = int(self.api.llama_vocab_n_tokens(self.vocab))
        self.trained = int(self.api.llama_model_n_ctx_train(self.pointer))
        self.slides = int(self.api.llama_model_n_swa(self.pointer)) > 0

    def _unfit(self) -> str:
        asked = {
            "is a recurrent model": self.api.llama_model_is_recurrent,
            "mixes attention with recurrent layers": self.api.llama_model_is_hybrid,
            "writes by diffusion": self.api.llama_model_is_diffusion,
            "has an encoder": self.api.llama_model_has_encoder,
        }
        return next((words for words, is_so in asked.items() if is_so(self.pointer)), "")

    @property
    def described(self) -> str:
        """Architecture, size and packing, such as "llama 135M Q4_1"."""
        out = ctypes.create_string_buffer(256)
        self.api.llama_model_desc(self.pointer, out, len(out))
        return out.value.decode("utf-8", errors="replace")

    @property
    def template(self) -> str | None:
        """The file's chat template."""
        found = self.api.llama_model_chat_template(self.pointer, None)
        return found.decode("utf-8", errors="replace") if found else None

    def tokens_of(self, text: str, special: bool) -> list[int]:
        """Token ids of a text, with what the file adds around a text if `special`; forms of special tokens count."""
        data = text.encode("utf-8", errors="replace")
        room = len(data) + 16
        out = (ctypes.c_int32 * room)()
        count = self.api.llama_tokenize(self.vocab, data, len(data), out, room, special, True)
        return list(out[: max(0, count)])

    def piece(self, token: int) -> bytes:
        """A token's bytes; a special one's are its name."""
        out = ctypes.create_string_buffer(_BUFFER)
        count = self.api.llama_token_to_piece(self.vocab, token, out, _BUFFER, 0, True)
        return out.raw[: max(0, count)]

    def is_special(self, token: int) -> bool:
        """Whether a token stands for no text."""
        attributes = self.api.llama_vocab_get_attr(self.vocab, token)
        return bool(attributes & (self.api.LLAMA_TOKEN_ATTR_CONTROL | self.api.LLAMA_TOKEN_ATTR_UNKNOWN))

    def ends(self) -> list[int]:
        """Tokens that end an answer."""
        return [t for t in range(self.vocabulary) if self.api.llama_vocab_is_eog(self.vocab, t)]


class Session:
    """One memory of `cells` keys and values for up to `sequences` sequences, which may share their beginnings.

    Where layers slide over the last tokens, llama.cpp writes over cells that have left the window of their only
    sequence, also where a kept beginning will be continued before them. So each sequence has a shadow there that holds
    the same cells: what two sequences hold stays.
    """

    def __init__(self, model: Model, cells: int, sequences: int, threads: int | None, flash: bool | None) -> None:
        """`flash`: flash attention, None where the library decides. Raises ConfigError if there is no memory."""
        self.model = model
        self.api = model.api
        self.shadow = sequences if model.slides else 0
        if sequences + self.shadow > MOST_SEQUENCES:
            raise ConfigError(
                f"backbone.model {model.file}: {sequences + self.shadow} sequences are needed, llama.cpp holds "
                f"{MOST_SEQUENCES}; lower backbone.reports_at_once"
            )
        params = self.api.llama_context_default_params()
        params.n_ctx, params.n_seq_max = cells, sequences + self.shadow
        params.n_batch, params.n_ubatch, params.n_outputs_max = BATCH, BATCH, OUTPUTS
        params.kv_unified, params.swa_full, params.no_perf = True, True, True
        params.flash_attn_type = -1 if flash is None else int(flash)
        if threads:
            params.n_threads = params.n_threads_batch = threads
        self.pointer = self.api.llama_init_from_model(model.pointer, params)
        if not self.pointer:
            raise ConfigError(
                f"backbone.model {model.file}: llama.cpp got no memory for {cells} tokens of keys and values; lower "
                "backbone.window or backbone.reports_at_once"
            )
        self.end = weakref.finalize(self, self.api.llama_free, self.pointer)
        self.end.atexit = False  # the process frees it
        self.memory = self.api.llama_get_memory(self.pointer)
        self.batch = self.api.llama_batch_init(BATCH, 0, 1)
        self.free_batch = weakref.finalize(self, self.api.llama_batch_free, self.batch)

    def decode(self, fed: Sequence[Fed]) -> list[NDArray[np.float32]]:
        """Feeds tokens, all sequences in one call where they fit; logits (tokens, vocabulary) of those told.

        Raises OutOfCells, then having changed nothing of what was held, or RuntimeError with the library's code.
        """
        if sum(len(one.tokens) for one in fed) > BATCH or sum(len(one.tokens) for one in fed if one.told) > OUTPUTS:
            return [self._alone(one) for one in fed]
        at, wanted = 0, list[list[int]]()
        for one in fed:
            wanted.append([])
            for i, token in enumerate(one.tokens):
                self._put(at, token, one.position + i, one)
                wanted[-1] += [at] if one.told else []
                at += 1
        self.batch.n_tokens = at
        code = self.api.llama_decode(self.pointer, self.batch)
        if code == _NO_ROOM:
            raise OutOfCells("the memory of keys and values is full")
        if code:
            raise RuntimeError(f"llama.cpp could not compute a batch of {at} tokens (code {code})")
        for one in fed:
            self.hold(one.sequence, one.position)
        return [self._logits(places) for places in wanted]

    def copy(self, source: int, target: int, length: int) -> None:
        """Lets `target` share the first positions of `source`."""
        self.api.llama_memory_seq_cp(self.memory, source, target, 0, length)
        self.hold(target, 0)

    def hold(self, sequence: int, position: int) -> None:
        """Lets the sequence's shadow hold what stands from a position on."""
        if self.shadow:
            self.api.llama_memory_seq_cp(self.memory, sequence, sequence + self.shadow, position, -1)

    def cut(self, sequence: int, length: int) -> None:
        """Forgets what stands at positions from `length` on."""
        self.api.llama_memory_seq_rm(self.memory, sequence, length, -1)
        if self.shadow:
            self.api.llama_memory_seq_rm(self.memory, sequence + self.shadow, length, -1)

    def clear(self) -> None:
        """Forgets everything."""
        self.api.llama_memory_clear(self.memory, True)

    def _alone(self, one: Fed) -> NDArray[np.float32]:
        size = OUTPUTS if one.told else BATCH
        parts = [
            self.decode([Fed(one.sequence, one.position + at, one.tokens[at : at + size], one.told)])[0]
            for at in range(0, len(one.tokens), size)
        ]
        return np.concatenate(parts)

    def _put(self, at: int, token: int, position: int, one: Fed) -> None:
        batch = self.batch
        batch.token[at], batch.pos[at], batch.logits[at] = token, position, one.told
        batch.n_seq_id[at], batch.seq_id[at][0] = 1, one.sequence

    def _logits(self, places: Sequence[int]) -> NDArray[np.float32]:
        size = self.model.vocabulary
        found = np.empty((len(places), size), np.float32)
        for row, place in enumerate(places):
            pointer = self.api.llama_get_logits_ith(self.pointer, place)
            found[row] = np.ctypeslib.as_array(pointer, (size,))
        return found


def quiet(setter: Any) -> None:
    """Switches a log of the library off, by the function that sets it; the callback must outlive every call."""
    global _silence
    if _silence is None:
        _silence = api().llama_log_callback(lambda *_: None)
    setter(_silence, ctypes.c_void_p(0))


@contextmanager
def log_into(said: list[str], setter: Any) -> Iterator[None]:
    """Collects what the library says meanwhile; switches the log off afterwards."""
    heard = api().llama_log_callback(lambda _, text, __: said.append(text.decode("utf-8", errors="replace")))
    setter(heard, ctypes.c_void_p(0))
    try:
        yield
    finally:
        quiet(setter)


_silence: Any = None
