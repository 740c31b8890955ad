"""The project's modules as syntax trees, for tests that look through all of them."""

import ast
from functools import cache
from pathlib import Path


@cache
def tree(file: Path) -> ast.Module:
    """A module's syntax tree, parsed once for all tests of a process; not to be changed."""
    return ast.parse(file.read_text(encoding="utf-8"))
