"""A model behind vLLM, SGLang or llama.cpp's server, with every decoder: contrast by draft and verify.

The server writes, both rows score what it wrote, and the decoder here decides every token (`server/verify.py`).
Prompts and grammar are made with the model's own tokenizer, which must be at hand. Pictures are sent on demand, as data
URLs (`server/pictures.py`). Knows no weights.
"""

from __future__ import annotations

import threading
from typing import ClassVar, Literal

from pydantic import Field, PrivateAttr, model_validator

from plugins.backbone import hf_run
from plugins.backbone.prompt import Parts, parts
from plugins.backbone.server.http import ServerHttp
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Backbone, Decoder


class OpenAIServer(Backbone):
    """Decodes with the log-probabilities that a server gives of a text, so every decoder works as it does in process.

    model is the server's name of the model, max_new_tokens the limit of one answer, timeout_s the longest wait for a
    reply, retries the further tries after a fault that may pass.
    """

    gives_logits: ClassVar[bool] = True
    protocol: Literal["vllm", "sglang", "llama_cpp"] = Field("vllm", description="which server it is")
    base_url: str = Field("http://localhost:8000", description="host and port of the server, with or without /v1")
    model: str = Field(min_length=1)
    tokenizer: str = Field(
        min_length=1,
        description="the served model's tokenizer: a folder, an id, a .gguf file or package:NAME/FILE.gguf; no weights "
        "of it are loaded",
    )
    api_key_env: str = Field("OPENAI_API_KEY", description="environment variable that holds the key; unset = no key")
    max_new_tokens: int = Field(2048, ge=1)
    top_logprobs: int = Field(20, ge=1, description="most likely tokens that are asked for at each place")
    most_logprobs: int | None = Field(
        None, ge=1, description="and at most, where these do not decide; null: the server's limit"
    )
    draft_tokens: int = Field(128, ge=1, le=4096, description="longest draft between two checks")
    pictures: bool = Field(
        False, description="send diagrams; vLLM only, started with VLLM_ENABLE_SCALE_OUT_ENDPOINTS=1"
    )
    truncate: bool = Field(False, description="cut a narrative that does not fit in the model's window")
    always_ground: bool = Field(False, description="score the row without context for decoders that do not need it too")
    timeout_s: float = Field(300.0, gt=0)
    retries: int = Field(2, ge=0, le=10, description="tries of one question beside the first; a step is repeated too")
    backoff_s: float = Field(1.0, gt=0, description="first wait between tries; doubles")

    _lock: threading.Lock = PrivateAttr(default_factory=threading.Lock)
    _running: hf_run.RunningModel | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _pictures_need_vllm(self) -> OpenAIServer:
        if self.pictures and self.protocol != "vllm":
            raise ValueError(
                f"pictures: protocol {self.protocol} takes no tokens with pictures; set protocol vllm, or leave "
                "pictures out"
            )
        return self

    def load(self) -> None:
        """Asks the server what it has, and reads the tokenizer."""
        self._started()

    def offers(self, decoder: Decoder) -> tuple[str, ...]:
        """Asks the server once what it has."""
        from plugins.backbone.server.loop import ServerLoop

        loop = self.model_copy(update={"retries": 0})._started().engine
        assert isinstance(loop, ServerLoop)  # noqa: S101 -- made by `_started`
        return loop.offered(self.protocol, decoder.reads_prior(), float(getattr(decoder, "beta", 0.0)) > 0.0)

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Answers a query.

        Raises InvalidOutput (nothing valid fits), BadInput (the prompt exceeds the window), ConfigError (the server
        lacks what contrast needs, or rejects a request) or ServerSilent (it gives no answer).
        """
        running = self._started()
        call = hf_run.Call(
            with_context=parts(context, query),
            without_context=self._contrasted(context, query, decoder),
            schema=query.answer_schema,
            policy=decoder,
            seed=seed,
            max_new_tokens=self.max_new_tokens,
            draft=(),
            truncate=self.truncate,
        )
        return running.answer(call)[0]

    def prompt(self, known: Parts) -> list[int]:
        """Token ids of a row's prompt as the server gets them."""
        return list(self._started().prompter.prompt(known).ids)

    def _contrasted(self, context: Context, query: Query, decoder: Decoder) -> Parts | None:
        if not (decoder.reads_prior() or self.always_ground):
            return None
        other = decoder.contrast_context(context)
        if other is not None and other.narrative == context.narrative and not self.pictures:
            raise ConfigError(
                f"decoder {type(decoder).__name__} contrasts pictures, which backbone 'openai_server' does not send; "
                "set backbone.pictures (vLLM), use decoder 'cad', or backbone 'hf_vision'"
            )
        return parts(other, query)

    def _started(self) -> hf_run.RunningModel:
        from plugins.backbone.server import loop

        with self._lock:
            if self._running is None:
                self._running = loop.start(
                    self._http(),
                    self.protocol,
                    self.model,
                    self.tokenizer,
                    loop.Tops(self.top_logprobs, self.most_logprobs),
                    self.draft_tokens,
                    self.pictures,
                )
            return self._running

    def _http(self) -> ServerHttp:
        remedies = {
            403: f"use a key that may call {self.model!r}",
            404: f"mend backbone.base_url or backbone.model, or set backbone.protocol (it is {self.protocol})",
            413: "the prompt is too long for the server",
            400: "shorten the prompt, lower backbone.max_new_tokens or backbone.top_logprobs",
        }
        root = self.base_url.rstrip("/").removesuffix("/v1")
        return ServerHttp(root, self.api_key_env, self.timeout_s, self.retries, self.backoff_s, remedies)
