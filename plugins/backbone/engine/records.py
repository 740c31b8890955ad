"""What goes into the token loop and what comes out. Knows tensors only: no tokenizer, no prompt format, no pydantic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from plugins.backbone.engine.faults import TooLong
from plugins.backbone.engine.grammar import Grammar


class Policy(Protocol):
    """The decoder's methods that the loop calls; `sgcad_core.interfaces.Decoder` has them."""

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Combine logits (rows, vocabulary); -inf excludes."""

    def draw(self, scores: Any, generator: Any) -> Any:
        """Pick one token a row, (rows,); the loop asks place by place, with random numbers of that place."""

    def reads_prior(self) -> bool:
        """True if `scores` needs the row without context."""


@dataclass(frozen=True, eq=False)
class Picture:
    """One picture, prepared by the model's image processor: tensors by the model's argument names."""

    digest: str
    inputs: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Prompt:
    """Token ids with every placeholder of a picture in place, and the pictures in their order.

    The last id must not belong to a picture: the answer starts behind it.
    """

    ids: Sequence[int]
    pictures: Sequence[Picture] = ()


@dataclass(frozen=True, eq=False)
class Request:
    """One report. `without_context` None: one row is run, and neither contrast nor grounding is possible."""

    with_context: Prompt
    without_context: Prompt | None
    policy: Policy
    grammar: Grammar | None = None
    seed: int = 0
    max_new_tokens: int = 1024
    eos: frozenset[int] = frozenset()
    """Tokens that end an answer where no grammar says when."""
    draft: Sequence[int] = ()
    """The tokens of an earlier answer that this one may largely repeat; changes the speed, never the answer."""
    jump_forward: bool = True
    views: Sequence[Prompt] = ()
    """The evidence with its pictures laid out otherwise: what these rows predict is averaged with the first's."""

    @property
    def prompts(self) -> list[Prompt]:
        """A row each: with context, without it if that is run, then the views."""
        return [prompt for prompt in (self.with_context, self.without_context, *self.views) if prompt is not None]

    def hold_to(self, window: int) -> None:
        """Raises TooLong if the longest prompt and the longest answer exceed a window, in tokens."""
        longest = max(len(prompt.ids) for prompt in self.prompts)
        if longest + self.max_new_tokens > window:
            raise TooLong(
                f"the prompt has {longest} tokens and the answer may have {self.max_new_tokens}, together "
                f"{longest + self.max_new_tokens}; the model's window is {window}"
            )


@dataclass
class Answer:
    """Tokens of an answer, end-of-text left out; log-probabilities of the bare rows, in nats."""

    ids: list[int] = field(default_factory=list)
    with_context: list[float] = field(default_factory=list)
    without_context: list[float] = field(default_factory=list)
    """Empty if the row without context was not run."""
    forced: list[bool] = field(default_factory=list)
    rivals: dict[int, tuple[int, int]] = field(default_factory=dict)
    """Place of a token -> the best token with context and the best one without, where the grammar allows both and they
    differ."""
    states: list[Any] = field(default_factory=list)
    """What the output embedding got of the first row with context before each token, (hidden,) in fp32 on the host;
    empty unless the loop watches them."""
    finished: bool = False
    """False: max_new_tokens was reached, which only happens without a grammar."""
    prompt_tokens: int = 0
    """Tokens of both prompts."""
    reused_tokens: int = 0
    """How many of them came from earlier calls."""
    model_calls: int = 0
    """Forward passes that this report took part in, its prefills included; requests, where a server has the model."""
    seconds: float = 0.0
    notes: list[str] = field(default_factory=list)
    """What the result should say of this answer."""


class Rows(Protocol):
    """What runs rows for the token loop: a model of transformers (`runner.Runner`), or another library's.

    A row has the attributes `prompt`, `length` (tokens that it holds) and `reused` (tokens that came from kept ones).
    """

    calls: int
    """Forward passes so far."""
    states: dict[int, Any]
    """By id of a row that was stepped: the states of its tokens, where the loop watches them."""

    @property
    def window(self) -> int:
        """Tokens of a prompt and its answer together."""

    @property
    def vocabulary(self) -> int:
        """Tokens that a row of logits tells."""

    @property
    def computed_in(self) -> str:
        """Number type of the model's weights."""

    def open(self, prompt: Prompt, behind: Sequence[int] = ()) -> Any:
        """A row for a prompt that holds the prompt and `behind` except the last token."""

    def step(self, chunks: Sequence[tuple[Any, Sequence[int]]]) -> list[Any]:
        """Feeds tokens to all open rows at once; logits (tokens, vocabulary) of each. Lengths stay as they are."""

    def keep(self, row: Any, behind: Sequence[int]) -> None:
        """Keeps the row's prompt and the tokens fed after it for a prompt that continues them."""

    def close(self, row: Any) -> None:
        """Ends a row."""

    def forget(self) -> None:
        """Discards every kept beginning."""

    def clear(self, row: Any) -> None:
        """Sees to it that what a row holds, which may be NaN, reaches no other row."""

    def reset(self) -> None:
        """Discards every row and every kept beginning."""


class Loop(Protocol):
    """What answers requests: the token loop of a model in this process, or a server's model verified token by token."""

    window: int
    """Tokens of a prompt and its answer together."""
    ended: bool

    @property
    def computed_in(self) -> str:
        """Number type of the model's weights, or whose model it is."""

    def generate(self, request: Request) -> Answer:
        """Answers one request; blocks."""

    def end(self) -> None:
        """Frees what it holds."""
