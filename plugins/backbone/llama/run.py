"""An opened GGUF file with its token loop, prompt writer and grammar; backbones of one process share it."""

from __future__ import annotations

import threading
import weakref
from dataclasses import dataclass
from weakref import WeakValueDictionary

from plugins.backbone import hf_gguf
from plugins.backbone.engine.loop import Engine
from plugins.backbone.hf_load import Loaded
from plugins.backbone.hf_prompt import Prompter, TextOnly
from plugins.backbone.hf_run import RunningModel
from plugins.backbone.llama.library import Model, Session
from plugins.backbone.llama.pictures import GgufPrompts
from plugins.backbone.llama.projector import MARKER, Projector
from plugins.backbone.llama.rows import LlamaRows, cells, sequences
from plugins.backbone.llama.words import GgufWords, compiler
from sgcad_core.errors import ConfigError


@dataclass(frozen=True)
class Fields:
    """What loading depends on beside the file; see `LlamaCpp`."""

    window: int
    reports_at_once: int
    threads: int | None
    gpu_layers: int
    flash: bool | None
    projector: str | None
    pictures_first: bool


_RUNNING: WeakValueDictionary[str, RunningModel] = WeakValueDictionary()
_LOCK = threading.Lock()


def shared(name: str, stamp: str, fields: Fields) -> RunningModel:
    """The file that runs already under the same fields, or a newly opened one. Raises ConfigError or MissingTool."""
    key = repr((name, stamp, fields))
    with _LOCK:
        running = _RUNNING.get(key)
        if running is None or running.engine.ended:
            running = _RUNNING[key] = start(name, fields)
            weakref.finalize(running, running.engine.end)
        return running


def start(name: str, fields: Fields) -> RunningModel:
    """Opens a file and starts its loop. Raises ConfigError or MissingTool with the remedy."""
    model = Model(hf_gguf.file_of(name), fields.gpu_layers)
    words = GgufWords(model)
    eos = model.ends()
    if not eos:
        raise ConfigError(f"backbone.model {name}: the file names no token that ends an answer; use another file")
    window, reports = min(fields.window, model.trained), fields.reports_at_once
    projector = _projector(model, fields)
    session = Session(model, cells(window, reports), sequences(reports), fields.threads, fields.flash)
    rows = LlamaRows.of(session, window, reports, projector)
    marker = MARKER if projector else None
    words_of = Prompter(Loaded(None, words, model.template, None), TextOnly(), fields.pictures_first, marker)
    prompter = GgufPrompts(words_of, projector) if projector else words_of
    engine = Engine(rows, fields.reports_at_once)
    return RunningModel(engine, prompter, compiler(words, eos), frozenset(eos), name)


def _projector(model: Model, fields: Fields) -> Projector | None:
    if fields.projector is None:
        return None
    file = hf_gguf.file_of(fields.projector, "projector")
    return Projector(model, file, fields.gpu_layers, fields.threads, fields.flash)
