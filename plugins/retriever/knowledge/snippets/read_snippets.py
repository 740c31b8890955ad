"""Runnable snippets on scenariogeneration as chunks: the source of functions that the tests execute.

Scenario functions return an `xosc` object, road functions an `xodr.OpenDrive`. Knows no database.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

from plugins.retriever.knowledge.chunk import Chunk, Task


def snippet_functions() -> dict[str, tuple[Callable[[], Any], tuple[Task, ...]]]:
    """name -> (function without arguments, stages it serves); imports scenariogeneration."""
    from plugins.retriever.knowledge.snippets import road_snippets, scenario_snippets

    modules: dict[Task, ModuleType] = {"scenario": scenario_snippets, "road": road_snippets}
    return {
        name: (item, (task,))
        for task, module in modules.items()
        for name, item in vars(module).items()
        if inspect.isfunction(item) and item.__module__ == module.__name__ and not name.startswith("_")
    }


def snippet_chunks() -> Iterator[Chunk]:
    """One chunk a function: what it does, its keywords (the docstring's rest) and its body."""
    for name, (function, tasks) in snippet_functions().items():
        title, _, keywords = (inspect.getdoc(function) or name).partition("\n\n")
        module = "xosc" if "scenario" in tasks else "xodr"
        text = f"# {title}\nfrom scenariogeneration import {module}\n\n{_body(function)}"
        yield Chunk(
            id=f"snippet/{name}", kind="snippet", tasks=tasks, title=title, text=text,
            keywords=" ".join(keywords.split()), source="sg-cadvlm",
        )  # fmt: skip


def _body(function: Callable[[], Any]) -> str:
    """The lines behind the docstring, as a script rather than a function."""
    source = inspect.getsource(function)
    body = textwrap.dedent(source.split('"""', 2)[2].strip("\n")).strip()
    return re.sub(r"^return ", "result = ", body, flags=re.MULTILINE)
