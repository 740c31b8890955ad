"""A server's model in the place of the engine's token loop: the same requests, the same answers, other work.

Knows the tokenizer, from which prompts and grammar are made here, and the server's protocol.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plugins.backbone import hf_gguf
from plugins.backbone.engine.grammar import GrammarCompiler
from plugins.backbone.engine.records import Answer, Request
from plugins.backbone.hf_load import Loaded, load_tokenizer
from plugins.backbone.hf_prompt import Prompter, TextOnly
from plugins.backbone.hf_run import RunningModel, end_tokens
from plugins.backbone.server.http import ServerHttp
from plugins.backbone.server.llama_cpp import LlamaCpp
from plugins.backbone.server.pictures import ShownPrompts
from plugins.backbone.server.protocol import Offer, Speaker
from plugins.backbone.server.sglang import SgLang
from plugins.backbone.server.verify import Count, Verifier
from plugins.backbone.server.vllm import Vllm
from sgcad_core.errors import ConfigError

_SAMPLE = '{"legs":[{"bearing":"NE","lanes_in":2}]} V1 (a 2009 Ford) went 35 mph; caf\u00e9, 12 \u00b0C.\n'
"""A text in which tokenizers of different models differ."""
_UNBOUNDED = 1 << 30
"""The window of a server that tells none: it will refuse what is too long."""


@dataclass(frozen=True)
class Tops:
    """How large a top k is asked for: first, and at most where that does not decide (None: the server's limit)."""

    first: int
    most: int | None


class ServerLoop:
    """Answers the engine's requests through a server."""

    ended = False

    def __init__(self, http: ServerHttp, offer: Offer, verifier: Verifier, spells_alike: bool) -> None:
        """`spells_alike`: the server has spelled a sample as the tokenizer here; False where it does not tell."""
        self.spells_alike = spells_alike
        self.http = http
        self.offer = offer
        self.verifier = verifier
        self.window = offer.window or _UNBOUNDED

    @property
    def computed_in(self) -> str:
        """Whose model it is: the number type is the server's secret."""
        return f"the server's own precision by {self.offer.model}"

    def generate(self, request: Request) -> Answer:
        """Answers one request, every token decided here. Raises the engine's faults or the server's errors."""
        request.hold_to(self.window)
        before = self.http.sent
        answer, count = self.verifier.answer(request)
        answer.prompt_tokens = sum(len(prompt.ids) for prompt in request.prompts)
        answer.model_calls = self.http.sent - before
        answer.notes += told(count, len(answer.ids), self.verifier)
        return answer

    def offered(self, protocol: str, contrasts: bool, cuts: bool) -> tuple[str, ...]:
        """The server in words. `contrasts`: the decoder reads both rows; `cuts`: it has a plausibility mask (beta)."""
        verifier, offer = self.verifier, self.offer
        window = f"a window of {offer.window} tokens" if offer.window else "no window told"
        spelled = "spells a sample as the tokenizer here" if self.spells_alike else "has no page to compare by"
        lines = [
            f"server: {offer.model} at {self.http.base_url} ({protocol}), {window}; it {spelled}",
            f"server: log-probabilities of a given text, top {verifier.top} asked, at most {verifier.most} of "
            f"{verifier.vocabulary}",
        ]
        if contrasts and not cuts and verifier.most < verifier.vocabulary:
            lines.append(
                f"server: tokens outside the top {verifier.most} cannot be excluded without beta; results count such "
                "tokens: set decoder.beta=0.1, or let the server give more (vLLM: --max-logprobs)"
            )
        return tuple(lines)

    def end(self) -> None:
        """Closes the connections."""
        self.ended = True
        self.http.client.close()


def start(
    http: ServerHttp, protocol: str, model: str, tokenizer: str, tops: Tops, draft_tokens: int, pictures: bool = False
) -> RunningModel:
    """Asks the server what it has and makes ready to answer. Raises ConfigError, MissingTool or ServerSilent."""
    speaker = _speaker(http, protocol, model)
    offer = speaker.offer()
    place = str(hf_gguf.unpacked(tokenizer)) if hf_gguf.is_gguf(tokenizer) else tokenizer
    spells, template = load_tokenizer(place, "backbone.tokenizer")
    eos = frozenset(end_tokens(_generation_config(place), spells))
    size = max(len(spells), _config_vocabulary(place))
    maker = GrammarCompiler(spells, size, sorted(eos))
    alike = check_tokenizer(speaker, spells, tokenizer, http.base_url)
    most = tops.most if offer.most is None else min(offer.most, tops.most or offer.most)
    verifier = Verifier(speaker, max(size, maker.tokens.vocab_size), tops.first, most, draft_tokens)
    words = Prompter(Loaded(None, spells, template, None), TextOnly())
    prompter = ShownPrompts(words, speaker.shown) if pictures and isinstance(speaker, Vllm) else words
    return RunningModel(ServerLoop(http, offer, verifier, alike), prompter, maker, eos, f"{model} at {http.base_url}")


def check_tokenizer(speaker: Speaker, tokenizer: Any, name: str, server: str) -> bool:
    """True if the server's tokens of a sample are the tokenizer's, False if it does not tell. Raises ConfigError."""
    own, theirs = tokenizer(_SAMPLE, add_special_tokens=False)["input_ids"], speaker.spelled(_SAMPLE)
    if theirs is not None and theirs != own:
        first = next((i for i in range(len(own)) if own[: i + 1] != theirs[: i + 1]), len(own))
        raise ConfigError(
            f"backbone.tokenizer {name} is not the tokenizer of the server at {server}: a sample of {len(own)} tokens "
            f"differs from token {first} on ({own[first : first + 3]} here, {theirs[first : first + 3]} there); name "
            "the folder or file of the served model"
        )
    return theirs is not None


def told(count: Count, tokens: int, verifier: Verifier) -> list[str]:
    """Notes for the result: the work, and the places where the top k was too small."""
    notes = [
        f"verified in {count.rounds} rounds with {count.drafts} drafts: {count.disagreements} drafted tokens of "
        f"{tokens} replaced"
    ]
    if count.widened:
        notes.append(f"top {verifier.top} did not decide {count.widened} of {tokens} tokens: asked again")
    if count.open:
        notes.append(
            f"{count.open} of {tokens} tokens are right only if no token outside the top {verifier.most} would have "
            "won: set decoder.beta (0.1), or let the server give more (vLLM: --max-logprobs)"
        )
    return notes


def _speaker(http: ServerHttp, protocol: str, model: str) -> Speaker:
    if protocol == "vllm":
        return Vllm(http, model)
    if protocol == "sglang":
        return SgLang(http, model)
    return LlamaCpp(http, model)


def _generation_config(place: str) -> Any:
    import transformers as tf

    try:
        return tf.GenerationConfig.from_pretrained(place)
    except (OSError, ValueError):
        return None


def _config_vocabulary(place: str) -> int:
    """Rows of the model's output embedding by its config.json; 0 without one."""
    import transformers as tf

    if not (Path(place) / "config.json").is_file():
        return 0
    try:
        config = tf.AutoConfig.from_pretrained(place)
    except (OSError, ValueError):
        return 0
    return int(getattr(config.get_text_config(), "vocab_size", 0) or 0)
