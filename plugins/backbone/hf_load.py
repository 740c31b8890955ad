"""Loads a model of transformers with its tokenizer and image processor; its errors name the remedy.

Only the PIL image processors are used, so torchvision is never needed: the joint processors require it for videos.
Knows no prompt and no decoder.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import torch
import transformers as tf
from PIL import Image
from safetensors import SafetensorError, safe_open

from plugins.backbone import hf_adapter
from plugins.backbone.engine import packing
from plugins.backbone.engine.supported import refusal
from sgcad_core import settings
from sgcad_core.entry_points import catalogue
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.system.digest import file_sha256

HEADS_FILE = "told.safetensors"
Prepare = Callable[[Image.Image, int], Mapping[str, Any]]
"""Turns a picture in one of its views (0: unchanged) into tensors by the model's argument names; the processor may add
other values."""

SMALL_PARAMETERS = 100_000_000
"""A model on the processor with fewer computes with one thread."""


@dataclass(frozen=True)
class Loaded:
    """A model ready to run. `prepare` is None for a model that sees no pictures."""

    model: Any
    tokenizer: Any
    template: str | None
    prepare: Prepare | None
    evidence_heads: Mapping[str, torch.Tensor] = field(default_factory=dict)
    """Heads (hidden + 1,) by the names of fields ("legs.lanes_in"), the constant last: the log-odds that the evidence
    tells the value of such a field, from the state before its first token. Empty for a model that has none."""


def load(
    name: str,
    revision: str | None,
    options: Mapping[str, Any],
    device: str,
    quantization: str,
    adapter: str | None = None,
) -> Loaded:
    """Loads from a folder (relative ones also from the project's root) or by id.

    `options` go to from_pretrained; `adapter` is a folder that is merged into the weights. Raises ConfigError or
    MissingTool with the remedy.
    """
    tf.utils.logging.disable_progress_bar()
    place = _place(name)
    config = config_of(name, place, revision)
    tokenizer = _tokenizer(place, revision)
    prepare = _prepare(place, revision) if hasattr(config, "vision_config") else None
    if adapter:
        hf_adapter.folder_of(adapter)
    if lines := packing.stored_lacks(name, place, quantization):
        raise MissingTool("; ".join(lines))
    kind = tf.AutoModelForImageTextToText if hasattr(config, "vision_config") else tf.AutoModelForCausalLM
    if quantization == "fp8" and not options.get("device_map"):
        options = {**options, "device_map": {"": _device(device)}}
    model = _model(kind, place, revision, _with_dtype(options, device), quantization)
    if adapter:
        model = hf_adapter.merged(model, adapter)
    if not options.get("device_map") and quantization == "none":
        model = model.to(_device(device))
    model.eval()
    if _is_small(model):
        torch.set_num_threads(1)
    return Loaded(model, tokenizer, _template(tokenizer, place, revision), prepare, _evidence_heads(place, model))


def _is_small(model: Any) -> bool:
    """Whether threads that share its small steps would wait for each other: on a busy machine they cost three times the
    time, since those that are ready spin until the last one gets a core."""
    weights = list(model.parameters())
    on_cpu = all(w.device.type == "cpu" for w in weights)
    return on_cpu and sum(w.numel() for w in weights) < SMALL_PARAMETERS


def load_tokenizer(name: str, field: str) -> tuple[Any, str | None]:
    """A model's tokenizer and chat template without its weights. Raises ConfigError naming the config's field."""
    place = _place(name)
    tokenizer = _tokenizer(place, None, field)
    return tokenizer, _template(tokenizer, place, None)


def check_outputs(name: str, model: Any, tokenizer: Any) -> None:
    """Raises ConfigError if an answer may need a token that the model has no output for.

    Special tokens that are only read, such as the picture's of Llama 3.2 Vision, may lie behind the outputs as long as
    they have an embedding.
    """
    outputs, inputs = (
        int(part().weight.shape[0]) for part in (model.get_output_embeddings, model.get_input_embeddings)
    )
    special = {token for token, one in tokenizer.added_tokens_decoder.items() if one.special and token < inputs}
    beyond = sorted(t for t in tokenizer.get_vocab().values() if t >= outputs and t not in special)
    if beyond:
        raise ConfigError(
            f"backbone.model {name}: its tokenizer has {beyond[-1] + 1} tokens, the model {outputs} outputs: "
            f"{len(beyond)} tokens cannot be written; put the model's own tokenizer beside the weights, or give the "
            f"model their outputs (resize_token_embeddings({beyond[-1] + 1})) and train them"
        )


def _with_dtype(options: Mapping[str, Any], device: str) -> dict[str, Any]:
    """The options with a dtype of torch in place of "native"."""
    if options.get("dtype") != "native":
        return dict(options)
    from plugins.precision import native_dtype

    return {**options, "dtype": native_dtype(_device("auto" if options.get("device_map") else device).type)}


def _place(name: str) -> str:
    own = settings.ROOT / name
    return str(own) if own.is_dir() and not Path(name).is_dir() else name


def _device(name: str) -> torch.device:
    if name == "auto":
        name = "cuda" if torch.cuda.is_available() else "cpu"
    try:
        return torch.device(name)
    except RuntimeError as fault:
        raise ConfigError(f"backbone.device {name!r} is unknown to torch: {fault}; use auto, cpu or cuda:0") from fault


def _tokenizer(place: str, revision: str | None, field: str = "backbone.model") -> Any:
    try:
        found = tf.AutoTokenizer.from_pretrained(place, revision=revision)
    except (OSError, ValueError, ImportError) as fault:
        raise _not_loaded(place, fault, field) from fault
    if not getattr(found, "is_fast", False):
        raise ConfigError(
            f"{field} {place}: its tokenizer {type(found).__name__} is no fast tokenizer, which the grammar "
            "needs; use a model that has tokenizer.json"
        )
    return found


def config_of(name: str, place: str, revision: str | None) -> Any:
    """The model's configuration. Raises ConfigError for a family that cannot be run, before any weight is read."""
    try:
        config = tf.AutoConfig.from_pretrained(place, revision=revision)
    except (OSError, ValueError, ImportError, KeyError) as fault:
        raise _not_loaded(place, fault) from fault
    if reason := refusal(config):
        raise ConfigError(f"backbone.model {name}: {reason}")
    if hasattr(config, "vision_config") and type(config) not in tf.AutoModelForImageTextToText._model_mapping:
        raise ConfigError(
            f"backbone.model {name}: transformers {tf.__version__} has no image-text-to-text model of type "
            f"{config.model_type}; use another family"
        )
    return config


def _model(kind: Any, place: str, revision: str | None, options: dict[str, Any], quantization: str) -> Any:
    if quantization != "none":
        options |= {"quantization_config": _quantization(quantization)}
    if options.get("device_map"):
        _need("accelerate", "backbone.device_map")
    try:
        return kind.from_pretrained(place, revision=revision, **options)
    except (OSError, ValueError, ImportError, KeyError) as fault:
        raise _not_loaded(place, fault) from fault


def _evidence_heads(place: str, model: Any) -> dict[str, torch.Tensor]:
    """The evidence heads beside a folder's weights; empty if there are none."""
    file = Path(place) / HEADS_FILE
    if not file.is_file():
        return {}
    size = model.get_output_embeddings().weight.shape[1] + 1
    remedy = "fit the heads again for these weights or take the file away"
    try:
        with safe_open(file, "pt") as opened:
            made_for = (opened.metadata() or {}).get("model", "")
            heads = {name: opened.get_tensor(name).float() for name in opened.keys()}  # noqa: SIM118 - is no mapping
    except (SafetensorError, OSError) as fault:
        raise ConfigError(f"{file}: is no file of safetensors: {fault}; {remedy}") from fault
    if wrong := sorted(name for name, head in heads.items() if head.shape != (size,)):
        raise ConfigError(f"{file}: {', '.join(wrong)}: a head of this model has {size} numbers; {remedy}")
    if made_for and made_for != _digest(file.with_name("model.safetensors")):
        raise ConfigError(f"{file}: its heads were fitted on other weights than those beside it; {remedy}")
    return heads


def _digest(file: Path) -> str:
    return file_sha256(file) if file.is_file() else ""


def _quantization(name: str) -> Any:
    """transformers' own configuration. Raises MissingTool for packages and cards that are not here."""
    if lines := packing.lacks(name):
        raise MissingTool("; ".join(lines))
    if name == "fp8":
        return tf.FineGrainedFP8Config()
    if name == "int8":
        return tf.BitsAndBytesConfig(load_in_8bit=True)
    return tf.BitsAndBytesConfig(load_in_4bit=True, bnb_4bit_compute_dtype=torch.bfloat16, bnb_4bit_quant_type="nf4")


def _need(package: str, field: str) -> None:
    from importlib.util import find_spec

    if find_spec(package) is None:
        raise MissingTool(f"{field} needs the package {package!r}: pip install 'sg-cadvlm[gpu]', or leave {field} out")


def _not_loaded(place: str, fault: Exception, field: str = "backbone.model") -> ConfigError:
    said = " ".join(str(fault).split())[:400]
    return ConfigError(
        f"{field} {place} cannot be loaded: {said}; give a folder with config.json, weights and tokenizer, "
        "or an id that `hf download` has fetched"
    )


# ------------------------------------------------------------------ pictures and chat template
def _prepare(place: str, revision: str | None) -> Prepare:
    if own := catalogue("image_processor").get(_own_kind(place)):
        return _own(own, Path(place))
    try:
        processor = tf.AutoImageProcessor.from_pretrained(place, revision=revision, backend="pil")
    except (OSError, ValueError, ImportError) as fault:
        if "torchvision" in str(fault):
            raise ConfigError(
                f"backbone.model {place}: its image processor exists for torchvision only; use a family of "
                "docs/families.md that passes"
            ) from fault
        raise _not_loaded(place, fault) from fault
    if type(processor).__name__.startswith(("Idefics3", "SmolVLM")):
        return lambda picture, view: processor(
            [[shifted_view(picture, view)]], return_tensors="pt", return_row_col_info=True
        )
    return lambda picture, view: processor([shifted_view(picture, view)], return_tensors="pt")


def shifted_view(picture: Image.Image, view: int) -> Image.Image:
    """The picture on a slightly larger white sheet, at another place in every view; view 0 is the picture itself."""
    if not view:
        return picture
    room_x, room_y = (round(side * 0.04 * (1 + view // 4)) for side in picture.size)
    sheet = Image.new("RGB", (picture.width + 2 * room_x, picture.height + 2 * room_y), "white")
    right, low = view % 2, view // 2 % 2
    sheet.paste(picture, (2 * room_x * right, 2 * room_y * low))
    return sheet


def _own_kind(place: str) -> str:
    file = Path(place) / "preprocessor_config.json"
    if not file.is_file():
        return ""
    try:
        return str(json.loads(file.read_text(encoding="utf-8")).get("image_processor_type", ""))
    except ValueError as fault:
        raise ConfigError(f"{file}: is no JSON: {fault}") from fault


def _own(point: EntryPoint, folder: Path) -> Prepare:
    """The picture preparation of a package for this model, such as the embedded one: `load(folder).patches(...)`."""
    try:
        sight = point.load()(folder)
    except FileNotFoundError as fault:
        raise ConfigError(f"backbone.model {fault}") from fault

    def prepare(picture: Image.Image, view: int) -> Mapping[str, Any]:
        patches, grid = sight.patches(picture, view)
        return {"pixel_values": patches, "image_grid_thw": torch.tensor([[1, *grid]])}

    return prepare


def _template(tokenizer: Any, place: str, revision: str | None) -> str | None:
    """The chat template: the tokenizer's, or that of a processor saved with one of its own."""
    if tokenizer.chat_template:
        return str(tokenizer.chat_template)
    try:
        known, _ = tf.ProcessorMixin.get_processor_dict(place, revision=revision)
    except (OSError, ValueError):
        return None
    found = known.get("chat_template")
    return str(found) if found else None
