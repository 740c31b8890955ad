"""The rules for a script's source: imports from a list, no private names, no access to frames or files.

Reads syntax only; `isolation` does not rely on it. Runs in the sandbox's process, since parsing hostile text can itself
kill an interpreter. Knows no model.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

MAX_SOURCE = 60_000
MAX_NODES = 30_000
ANY = frozenset({"*"})
"""Every public name of a module."""
MODULES: Mapping[str, frozenset[str]] = {
    "scenariogeneration": frozenset({"xosc", "prettyprint"}),
    "scenariogeneration.xosc": ANY,
    "math": ANY,
    "random": frozenset({"random", "uniform", "randint", "choice", "gauss", "seed", "Random"}),
    "itertools": ANY,
    "datetime": frozenset({"datetime", "date", "time", "timedelta", "timezone", "UTC"}),
    "enum": frozenset({"Enum", "IntEnum", "auto"}),
    "collections": frozenset({"defaultdict", "OrderedDict", "Counter", "deque"}),
    "functools": frozenset({"partial", "reduce", "lru_cache", "cache"}),
    "typing": frozenset({
        "Any", "Callable", "Dict", "Final", "Iterable", "Iterator", "List", "Literal", "Optional", "Sequence", "Set",
        "Tuple", "Type", "Union",
    }),
    "__future__": frozenset({"annotations"}),
}  # fmt: skip
BUILTINS = frozenset((  # noqa: SIM905 - thirty lines as a list
    "ArithmeticError AssertionError AttributeError Exception IndexError KeyError LookupError NameError "
    "NotImplementedError OverflowError RuntimeError StopIteration TypeError ValueError ZeroDivisionError "
    "False None True NotImplemented Ellipsis "
    "abs all any bool callable chr classmethod dict divmod enumerate filter float frozenset hash int isinstance "
    "issubclass iter len list map max min next object ord pow print property range repr reversed round set slice "
    "sorted staticmethod str sum super tuple zip"
).split())  # fmt: skip
_METHODS = frozenset({"__init__", "__repr__", "__str__", "__eq__", "__post_init__", "__name__"})
_FORBIDDEN = frozenset((  # noqa: SIM905 - as above
    "os sys builtins inspect importlib subprocess shutil ctypes threading codecs pathlib pickle "
    "marshal socket multiprocessing asyncio runpy "
    "eval exec compile open input breakpoint globals locals vars dir getattr setattr delattr exit quit "
    "memoryview bytearray "
    "gi_frame gi_code gi_yieldfrom cr_frame cr_code cr_await ag_frame ag_code tb_frame tb_next tb_lasti f_back "
    "f_globals f_locals f_builtins f_code co_code co_consts func_globals func_code mro with_traceback format_map"
).split())  # fmt: skip
_REFUSED_NODES: Mapping[str, str] = dict.fromkeys(
    ("AsyncFunctionDef", "Await", "AsyncFor", "AsyncWith"), "async code is not run"
) | dict.fromkeys(("Interactive", "Expression", "FunctionType"), "only a module is run")
_ALLOWED_NODES = frozenset((  # noqa: SIM905 - as above
    "Module FunctionDef ClassDef Return Delete Assign AugAssign AnnAssign For While If With Match Raise Try TryStar "
    "Assert Import ImportFrom Global Nonlocal Expr Pass Break Continue "
    "BoolOp NamedExpr BinOp UnaryOp Lambda IfExp Dict Set ListComp SetComp DictComp GeneratorExp Yield YieldFrom "
    "Compare Call FormattedValue JoinedStr Constant Attribute Subscript Starred Name List Tuple Slice "
    "Load Store Del And Or Add Sub Mult MatMult Div Mod Pow LShift RShift BitOr BitXor BitAnd FloorDiv Invert Not "
    "UAdd USub Eq NotEq Lt LtE Gt GtE Is IsNot In NotIn comprehension ExceptHandler arguments arg keyword alias "
    "withitem match_case MatchValue MatchSingleton MatchSequence MatchMapping MatchClass MatchStar MatchAs MatchOr "
    "TypeIgnore"
).split())  # fmt: skip
"""Syntax by name: what a later Python adds is refused until somebody has looked at it."""
_PRIVATE_IN_TEXT = re.compile(rf"__\w+__|\{{[^{{}}]*\.(?:_|(?:{'|'.join(sorted({*_FORBIDDEN, 'format'}))})\b)")
"""Private names, and templates that read a forbidden attribute when they are formatted."""


class Breach(NamedTuple):
    """A breach of the rules and its place."""

    line: int
    what: str
    value: str
    remedy: str


def parsed(source: str) -> ast.Module:
    """The script's syntax tree. Raises SyntaxError (also where it is too long), ValueError, MemoryError."""
    if len(source) > MAX_SOURCE:
        raise SyntaxError(f"the script has {len(source)} characters, at most {MAX_SOURCE} are read")
    if "\0" in source:
        raise SyntaxError("the script holds a null character")
    return ast.parse(source, "<scenario>")


def breaches(tree: ast.Module) -> list[Breach]:
    """Every breach of the rules, in the script's order; a script without any may run."""
    nodes = list(ast.walk(tree))
    if len(nodes) > MAX_NODES:
        return [Breach(1, "the script is too large", f"{len(nodes)} syntax nodes", f"stay below {MAX_NODES}")]
    found = [breach for node in nodes for breach in _of(node)]
    return sorted(set(found))


def _of(node: ast.AST) -> Iterator[Breach]:
    line = getattr(node, "lineno", 1)
    if isinstance(node, ast.Import | ast.ImportFrom | ast.alias):
        yield from () if isinstance(node, ast.alias) else _imports(node)
        return
    if type(node).__name__ in _REFUSED_NODES:
        yield Breach(line, _REFUSED_NODES[type(node).__name__], type(node).__name__, "write plain functions")
    elif type(node).__name__ not in _ALLOWED_NODES:
        yield Breach(line, "this syntax is not known here", type(node).__name__, "write it in a simpler way")
    if isinstance(node, ast.Constant):
        if isinstance(node.value, str | bytes) and _PRIVATE_IN_TEXT.search(_text(node.value)):
            yield Breach(line, "a text names something private", _text(node.value)[:60], "leave it out")
        return
    if isinstance(node, ast.Attribute) and node.attr == "format" and not isinstance(node.value, ast.Constant):
        yield Breach(line, "only a written-out text is formatted", "format", "use an f-string")
    if isinstance(node, ast.MatchClass) and "format" in node.kwd_attrs:  # reads the attribute as a dot would
        yield Breach(line, "only a written-out text is formatted", "format", "use an f-string")
    own = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"
    for name in _identifiers(node):
        if name in _FORBIDDEN:
            yield Breach(line, "this name is not available", name, _REMEDIES.get(name, "do without it"))
        elif name.startswith("_") and name not in _METHODS and set(name) != {"_"} and not _own(name, own):
            yield Breach(line, "names that begin with an underscore are not available", name, "use public names")


def _own(name: str, of_self: bool) -> bool:
    """Whether it is a private attribute of the script's own object."""
    return of_self and not name.startswith("__")


def _text(value: str | bytes) -> str:
    return value if isinstance(value, str) else value.decode("latin-1")


def _identifiers(node: ast.AST) -> Iterator[str]:
    """All names in a node's own fields: variables, attributes, arguments, patterns."""
    for field, value in ast.iter_fields(node):
        if isinstance(value, str) and field != "type_comment":
            yield value
        elif isinstance(value, list):
            yield from (item for item in value if isinstance(item, str))


def _imports(node: ast.Import | ast.ImportFrom) -> Iterator[Breach]:
    if isinstance(node, ast.ImportFrom):
        module = node.module or "."
        if node.level or module not in MODULES:
            yield _unavailable(node.lineno, "." * node.level + module)
            return
        for name in node.names:
            if not _importable(module, name.name):
                yield Breach(node.lineno, f"{module} has no such name here", name.name, _offer(module))
    else:
        yield from (_unavailable(node.lineno, n.name) for n in node.names if n.name not in MODULES)
    for name in node.names:
        if (name.asname or "").startswith("_") and name.asname != "_":
            yield Breach(node.lineno, "names that begin with an underscore are not available", str(name.asname), "")


def _importable(module: str, name: str) -> bool:
    allowed = MODULES[module]
    return name in allowed or (allowed is ANY and (name == "*" or not name.startswith("_")))


def _unavailable(line: int, module: str) -> Breach:
    remedy = _REMEDIES.get(module.split(".")[-1], f"import only {', '.join(m for m in MODULES if m[0] != '_')}")
    return Breach(line, "this module is not available", module, remedy)


def _offer(module: str) -> str:
    allowed = MODULES[module]
    return "use a public name" if allowed is ANY else f"one of {', '.join(sorted(allowed))}"


_REMEDIES = {
    "os": "write no files: bind the finished xosc.Scenario to the name `scenario`",
    "open": "write no files: bind the finished xosc.Scenario to the name `scenario`",
    "numpy": "use math and lists",
    "dataclasses": "write a class with __init__",
    "xodr": "the road network is written already: refer to road.xodr",
    "getattr": "name the attribute outright",
}
