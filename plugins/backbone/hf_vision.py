"""Any image-text-to-text model of transformers: Qwen2.5-VL, Qwen3-VL, Llama-3.2-Vision, LLaVA, Idefics3, ...

Loads at the first question, then answers many threads through one token loop (`plugins.backbone.engine`).
Text models work too; they see no diagrams. Needs no torchvision.
"""

from __future__ import annotations

import hashlib
import threading
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import Field, PrivateAttr, model_validator

from plugins.backbone import hf_gguf, hf_machine, hf_run
from plugins.backbone.prompt import EarlierAnswers, Parts, parts
from sgcad_core import settings
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.interfaces import Backbone, Decoder

_WHOLE_BYTES = 1 << 24
"""Files up to this size are read whole for the fingerprint; of larger ones this many bytes of either end."""
BYTES = {"float32": 4.0, "bfloat16": 2.0, "float16": 2.0, "native": 2.0, "auto": 2.0}
QUANTIZED = {"int8": 1.1, "int4": 0.62, "fp8": 1.1}
"""Bytes a parameter; what is kept in 16 bits (embeddings, norms, the vision tower) adds to a byte and a half byte."""


class HfVision(Backbone):
    """Runs a local image-text model of transformers; it gives logits, so it works with every decoder.

    revision is the version of a model named by its hub id. quantization packs plain weights (int8 and int4 by
    bitsandbytes, fp8 on cards that compute in it) and stays none for weights stored packed (AWQ, GPTQ, FP8).
    attn_implementation is transformers' own option, max_new_tokens is the limit of one answer.
    """

    gives_logits: ClassVar[bool] = True
    version: ClassVar[str] = "3"
    model: str = Field(
        min_length=1, description="folder or .gguf file (also from the project's root), package:NAME/FILE.gguf, or id"
    )
    revision: str | None = None
    adapter: str | None = Field(
        None, min_length=1, description="folder of a LoRA adapter as PEFT writes it, merged into the weights"
    )
    device: str = Field("auto", description="auto, cpu, cuda:0, ...; device_map goes first")
    device_map: str | dict[str, int | str] | None = Field(None, description="spread over devices; needs accelerate")
    dtype: Literal["auto", "native", "float32", "bfloat16", "float16"] = Field(
        "auto", description="auto: as stored; native: bfloat16 where the device has instructions for it, else float32"
    )
    quantization: Literal["none", "int8", "int4", "fp8"] = "none"
    attn_implementation: Literal["sdpa", "eager"] = "sdpa"
    max_new_tokens: int = Field(2048, ge=1)
    reports_at_once: int = Field(8, ge=1, le=256, description="reports in one batch; halved when memory runs out")
    prefix_cache_mb: int = Field(1024, ge=0, description="kept beginnings of prompts; 0 = none")
    truncate: bool = Field(False, description="cut a narrative that does not fit in the model's window")
    pictures_first: bool = Field(True, description="diagrams before the narrative")
    views: int = Field(
        1, ge=1, le=5, description="layouts of the diagrams read side by side, their predictions averaged"
    )
    always_ground: bool = Field(False, description="run the row without context for decoders that do not need it too")

    _lock: threading.Lock = PrivateAttr(default_factory=threading.Lock)
    _running: hf_run.RunningModel | None = PrivateAttr(default=None)
    _stamp: str | None = PrivateAttr(default=None)
    _answers: EarlierAnswers = PrivateAttr(default_factory=EarlierAnswers)

    @property
    def stamp(self) -> str:
        """Fingerprint of the folder of weights (empty for an id, whose revision is a field), and of the adapter's."""
        with self._lock:
            if self._stamp is None:
                own = hf_gguf.digest(self.model) if hf_gguf.is_gguf(self.model) else folder_stamp(self.model)
                self._stamp = f"{own}+{folder_stamp(self.adapter)}" if self.adapter else own
            return self._stamp

    @model_validator(mode="before")
    @classmethod
    def _only_what_the_loop_can(cls, given: Any) -> Any:
        """Names the reason where transformers has a setting that the token loop cannot follow."""
        if isinstance(given, dict) and "tp_plan" in given:
            raise ValueError(
                "tp_plan: transformers' tensor parallelism is one process a card, the token loop is one process; use "
                "device_map auto (layers over cards), a worker for each group of cards (docs/scale.md), or a server "
                "that splits tensors (vLLM --tensor-parallel-size) by backbone openai_server"
            )
        if isinstance(given, dict) and "flash" in str(given.get("attn_implementation", "")):
            raise ValueError(
                f"attn_implementation {given['attn_implementation']}: rows of one batch have lengths of their own, "
                "which takes masks that flash attention 2 and 3 do not know; use sdpa, which takes torch's flash "
                "kernel where a prompt is read from its beginning"
            )
        return given

    @model_validator(mode="after")
    def _adapter_needs_plain_weights(self) -> HfVision:
        if self.adapter and self.quantization != "none":
            raise ValueError(f"adapter is merged into plain weights: set quantization none, not {self.quantization}")
        return self

    def load(self) -> None:
        """Imports the libraries and loads the weights now instead of at the first question."""
        self._loaded()

    def offers(self, decoder: Decoder) -> tuple[str, ...]:
        """What this machine lacks for the model: weights, packages. Raises ConfigError for a family that cannot run."""
        return hf_machine.lacks(self.model, self.revision, self.device_map, self.quantization)

    def weights_gb(self) -> float | None:
        """Memory of the weights, decimal GB, by the folder's files, else by the number of parameters in the name."""
        place = Path(self.model)
        folder = place if place.is_dir() else settings.ROOT / self.model
        return weights_gb(folder, self.model, self.dtype, self.quantization)

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Answers a query; blocks until the token loop has finished the answer.

        Raises InvalidOutput (nothing valid fits, or the model gave NaN), BadInput (the prompt exceeds the
        window), ConfigError or MissingTool (the model cannot be loaded or batched).
        """
        running = self._loaded()
        return hf_run.answered(
            running,
            self._answers,
            context,
            query,
            self._contrasted(context, query, decoder),
            policy=decoder,
            seed=seed,
            max_new_tokens=self.max_new_tokens,
            truncate=self.truncate,
            views=self.views,
        )

    def _contrasted(self, context: Context, query: Query, decoder: Decoder) -> Parts | None:
        if not (decoder.reads_prior() or self.always_ground):
            return None
        return parts(decoder.contrast_context(context), query)

    def _loaded(self) -> hf_run.RunningModel:
        stamp = self.stamp
        with self._lock:
            if self._running is None or self._running.engine.ended:
                self._running = None  # a loop that has ended holds its model no longer
                self._running = hf_run.shared_model(
                    stamp,
                    str(hf_gguf.unpacked(self.model)) if hf_gguf.is_gguf(self.model) else self.model,
                    self.revision,
                    hf_run.options(self.dtype, self.attn_implementation, self.device_map),
                    device=self.device,
                    quantization=self.quantization,
                    reports_at_once=self.reports_at_once,
                    prefix_bytes=self.prefix_cache_mb << 20,
                    pictures_first=self.pictures_first,
                    adapter=self.adapter,
                )
            return self._running


def folder_stamp(model: str) -> str:
    """A digest of the files of a model folder except its notes (*.md); "" if there is no such folder."""
    folder = next((p for p in (Path(model), settings.ROOT / model) if p.is_dir()), None)
    found = hashlib.sha256()
    for file in sorted(folder.iterdir()) if folder else ():
        if file.is_file() and file.suffix != ".md":
            size = file.stat().st_size
            found.update(f"{file.name} {size}\0".encode())
            with file.open("rb") as opened:
                found.update(opened.read(_WHOLE_BYTES))
                opened.seek(max(0, size - _WHOLE_BYTES))
                found.update(opened.read())
    return found.hexdigest()[:16] if folder else ""


def weights_gb(folder: Path, name: str, dtype: str, quantization: str) -> float | None:
    """Decimal gigabytes of weights in memory; None if neither the folder nor the name gives them.

    The files of a folder are taken to be stored in 16 bits unless the weights are loaded as stored ("auto").
    """
    per_parameter = QUANTIZED.get(quantization, BYTES.get(dtype, 2.0))
    stored = sum(file.stat().st_size for file in folder.glob("*.safetensors")) if folder.is_dir() else 0
    if stored:
        as_stored = dtype == "auto" and quantization == "none"
        return stored / 1e9 * (1.0 if as_stored else per_parameter / 2.0)
    billions = hf_machine.billions_in(Path(name).name)
    return billions * per_parameter if billions else None
