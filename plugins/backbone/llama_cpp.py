"""A GGUF file run by llama.cpp in this process: contrast on a laptop's processor, weights kept as they are packed.

The token loop, the grammar and the decoders are those of `hf_vision`; only the rows are llama.cpp's. Diagrams are shown
where `projector` names the model's file for pictures. Loads at the first question.
"""

from __future__ import annotations

import threading
from typing import ClassVar

from pydantic import Field, PrivateAttr, field_validator

from plugins.backbone import hf_gguf, hf_run
from plugins.backbone.prompt import EarlierAnswers, Parts, parts
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Backbone, Decoder


class LlamaCpp(Backbone):
    """Runs a GGUF file by llama.cpp; it gives logits, so it works with every decoder.

    projector is the file for pictures (mmproj) that was published with the model; null: diagrams are left out.
    max_new_tokens is the limit of one answer, gpu_layers how many layers go to a graphics card (-1: all).
    """

    gives_logits: ClassVar[bool] = True
    model: str = Field(
        min_length=1,
        description="a .gguf file (also from the project's root), package:NAME/FILE.gguf, or hub:OWNER/NAME/FILE.gguf",
    )
    projector: str | None = Field(None, description="the model's mmproj file, named as `model` is; null: text only")
    pictures_first: bool = Field(True, description="false: the narrative first")
    window: int = Field(8192, ge=256, description="tokens of a prompt and its answer; memory grows with it")
    max_new_tokens: int = Field(2048, ge=1)
    reports_at_once: int = Field(1, ge=1, le=64, description="reports in one batch; halved when memory runs out")
    threads: int | None = Field(None, ge=1, description="null: as llama.cpp decides")
    gpu_layers: int = Field(0, ge=-1)
    flash_attention: bool | None = Field(None, description="null: as llama.cpp decides")
    truncate: bool = Field(False, description="cut a narrative that does not fit in the window")
    always_ground: bool = Field(False, description="run the row without context for decoders that do not need it too")

    _lock: threading.Lock = PrivateAttr(default_factory=threading.Lock)
    _running: hf_run.RunningModel | None = PrivateAttr(default=None)
    _answers: EarlierAnswers = PrivateAttr(default_factory=EarlierAnswers)

    @field_validator("model", "projector")
    @classmethod
    def _names_a_file(cls, name: str | None) -> str | None:
        if name is not None and not hf_gguf.is_gguf(name):
            raise ValueError(f"{name!r} names no .gguf file; folders and ids of transformers run by backbone hf_vision")
        return name

    @property
    def stamp(self) -> str:
        """Fingerprint of the files; empty where the model's is not there."""
        found = hf_gguf.digest(self.model)
        return found + hf_gguf.digest(self.projector) if found and self.projector else found

    def load(self) -> None:
        """Opens the file now instead of at the first question."""
        self._started()

    def offers(self, decoder: Decoder) -> tuple[str, ...]:
        """What this machine lacks for the file, else memory and seconds to expect. Raises ConfigError for no file."""
        from plugins.backbone.llama import machine

        if lines := machine.lacks(self.model, self.projector):
            return lines
        rows = 1 + (decoder.reads_prior() or self.always_ground)
        told = machine.expectation(self.model, self.window, self.reports_at_once, rows, self.gpu_layers)
        return (*told, *machine.pictures(self.model, self.projector))

    def weights_gb(self) -> float | None:
        """Memory of packed weights, keys and values, decimal GB."""
        from plugins.backbone.llama import machine

        return machine.weights_gb(self.model, self.projector, self.window, self.reports_at_once)

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Answers a query; blocks until the token loop has finished the answer.

        Raises InvalidOutput (nothing valid fits), BadInput (the prompt exceeds the window), ConfigError or MissingTool
        (a file cannot be opened, or the decoder contrasts pictures and no projector is named).
        """
        running = self._started()
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
        )

    def _contrasted(self, context: Context, query: Query, decoder: Decoder) -> Parts | None:
        if not (decoder.reads_prior() or self.always_ground):
            return None
        other = decoder.contrast_context(context)
        if other is not None and other.narrative == context.narrative and not self.projector:
            raise ConfigError(
                f"decoder {type(decoder).__name__} contrasts pictures, which backbone 'llama_cpp' does not show "
                "without backbone.projector; name the model's mmproj file, or use decoder 'cad'"
            )
        return parts(other, query)

    def _started(self) -> hf_run.RunningModel:
        from plugins.backbone.llama import run

        fields = run.Fields(
            self.window,
            self.reports_at_once,
            self.threads,
            self.gpu_layers,
            self.flash_attention,
            self.projector,
            self.pictures_first,
        )
        with self._lock:
            if self._running is None or self._running.engine.ended:
                self._running = None
                self._running = run.shared(self.model, self.stamp, fields)
            return self._running
