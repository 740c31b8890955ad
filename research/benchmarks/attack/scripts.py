"""Programs over the whole grammar of Python that try to get at attributes, frames, globals, files and the environment.

What the rules let pass runs in the sandbox; it may find nothing. Each program binds what it got hold of to `found` and
prints it.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from pathlib import Path

NAME = "sandbox scripts"
SECRET = "the-secret-of-a-file-outside"  # noqa: S105 - bait, not a secret
_TARGETS = (
    "format",
    "format_map",
    "gi_frame",
    "f_globals",
    "f_back",
    "f_builtins",
    "gi_code",
    "cr_frame",
    "tb_frame",
    "__class__",
    "__globals__",
    "__builtins__",
    "__dict__",
    "__subclasses__",
    "__init__",
    "__self__",
    "__module__",
    "__loader__",
    "__closure__",
    "__code__",
    "mro",
    "__mro__",
    "environ",
    "os",
    "sys",
    "_os",
    "__import__",
    "func_globals",
    "func",
    "modules",
    "with_traceback",
    "__traceback__",
    "__context__",
    "__getattribute__",
    "__reduce_ex__",
    "__format__",
    "__spec__",
)
_OBJECTS = (
    "str",
    "'a'",
    "''",
    "1",
    "()",
    "print",
    "(lambda: 0)",
    "(i for i in [1])",
    "xosc",
    "xosc.Scenario",
    "math",
    "random.Random",
    "functools.partial(print)",
    "functools.reduce",
    "itertools.count()",
    "collections.Counter",
    "enum.Enum",
    "typing.Any",
    "datetime.datetime",
    "object()",
    "object",
    "Exception()",
    "super",
    "property(print)",
    "slice(1)",
    "int.real",
    "len",
    "found0",
    "xosc.Position",
    "str.join",
    "'x'.join",
)
_READS = (
    "{o}.{t}",
    "({o}).{t}",
    "getattr({o}, '{t}')",
    "'{{0.{t}}}'.format({o})",
    "'{{.{t}}}'.format({o})",
    "f'{{({o}).{t}}}'",
    "str.format('{{0.{t}}}', {o})",
    "list(map(str.format, ['{{0.{t}}}'], [{o}]))",
    "f'{{{o}!r:{{str}}}}'",
    "[x.{t} for x in [{o}]]",
    "{{x.{t}: 1 for x in [{o}]}}",
    "(lambda x: x.{t})({o})",
    "(y := {o}).{t}",
    "{o}.{t}()",
    "{o}['{t}']",
    "[*{o}]",
    "{{**{o}}}",
    "print(*[{o}], sep='')",
    "vars({o})['{t}']",
    "type({o})",
    "dict({t}={o})",
    "sorted([{o}], key=lambda v: v.{t})",
    "max([{o}], key=str.{t})",
    "functools.partial(str.{t}, '{{0}}')({o})",
    "functools.reduce(lambda a, b: a.{t}, [{o}, 1])",
    "(yield_ for yield_ in [{o}])",
    "not {o}.{t}",
    "-{o}.{t}",
    "{o}.{t} if {o} else 0",
    "{o}.{t} < 1",
    "{o}.{t} and 1",
    "'%({t})s' % {o}",
    "'{t}'.join([{o}])",
    "b'{t}'.decode()",
    "object.__getattribute__({o}, '{t}')",
    "property(lambda s: s.{t}).fget({o})",
    "typing.get_type_hints({o})",
    "chr(95) + chr(95) + '{t}'",
    "(chr(123) + '0.{t}' + chr(125)).format({o})",
    "str.__dict__",
    "open('{f}').read()",
    "enum.Enum('E', '{t}')",
    "collections.namedtuple('A', '{t}')",
    "collections.defaultdict({o}.{t})",
    "random.Random({o}).{t}",
    "itertools.starmap(str.{t}, [('{{0}}', {o})])",
    "xosc.{t}",
    "math.{t}",
)
_MATCHES = (
    "case {c}({t}=found): pass",
    "case [{c}({t}=found)]: pass",
    "case {{'a': {c}({t}=found)}}: pass",
    "case {c}() as found: pass",
    "case [*found]: pass",
    "case {{**found}}: pass",
    "case {c}({t}=found) | {c}({t}=found): pass",
    "case found: pass",
    "case {c}(found): pass",
    "case str.{t}: found = 1",
    "case {c}({t}={c}({u}=found)): pass",
    "case found if found.{t}: pass",
)
_CLASSES = ("str", "object", "int", "type", "Exception", "xosc.Scenario", "list", "math", "tuple", "bool")
_SHELLS = (
    "found = {e}",
    "found: str = {e}",
    "found: {e} = 1",
    "found = 0\nfound += {e}",
    "for found in [{e}]: pass",
    "for {e} in [1]: pass",
    "while True:\n    found = {e}\n    break",
    "if {e}: found = 1",
    "with {e} as found: pass",
    "try:\n    raise ValueError({e})\nexcept ValueError as fault:\n    found = fault.args",
    "try:\n    {e}\nexcept* Exception as found:\n    found = found.{t}",
    "try:\n    {e}\nfinally:\n    found = 1",
    "def g(x={e}):\n    return x\nfound = g()",
    "def g() -> {e}:\n    yield {e}\nfound = [*g()]",
    "def g(*, {t}=1):\n    return {t}\nfound = g()",
    "def {t}():\n    return {e}\nfound = {t}()",
    "@{e}\ndef g(): pass\nfound = g",
    "@(lambda f: {e})\nclass A: pass\nfound = A",
    "class A({e}): pass\nfound = A",
    "class A(metaclass={e}): pass\nfound = A",
    "class A:\n    {t} = {e}\nfound = A.{t}",
    "class A({t}=1): pass\nfound = A",
    "class A:\n    def __init__(self):\n        self.{t} = {e}\nfound = A().{t}",
    "class A:\n    def __init__(self):\n        self.x = self.{t}\nfound = A().x",
    "class A:\n    def __eq__(self, other):\n        return other.{t}\nfound = A() == {o}",
    "class A(str):\n    pass\nfound = A.{t}",
    "class A(enum.Enum):\n    {t} = {e}\nfound = A",
    "del {o}.{t}\nfound = 1",
    "assert not {e}, 'x'\nfound = 1",
    "global found\nfound = {e}",
    "from typing import {t}\nfound = {t}",
    "found = [{e} for _ in [1]]",
    "def g():\n    global found\n    found = {e}\ng()",
    "def g():\n    x = 0\n    def h():\n        nonlocal x\n        x = {e}\n    h()\n    return x\nfound = g()",
    "import {t}\nfound = {t}",
    "from math import {t} as found",
    "import math.{t} as found",
    "from . import {t} as found",
    "async def g():\n    return {e}\nfound = g()",
    "found = lambda: {e}\nfound = found()",
    "found, *rest = [{e}, 1]",
    "match {o}:\n    {m}",
    "match [{o}]:\n    {m}",
    "match {{'a': {o}}}:\n    {m}",
    "type A = {e}\nfound = A",
    "x = y = found = {e}",
    "def g[T: {e}](): pass\nfound = g",
    "found = (await_ for await_ in {e})",
    "found = {o}[{e}:{e}]",
    "{o}[0] = {e}\nfound = {o}",
    "{o}.{t} = 1\nfound = 1",
    "found = f'{{{e}}}'",
    "found = f'{{{e}=}}'",
    "found = f'{{{o}:{{{e}}}}}'",
    "return {e}",
)
_HEAD = (
    "import math, random, itertools, datetime, enum, collections, functools, typing\n"
    "from scenariogeneration import xosc\n"
)
_GOT = re.compile(
    r"<frame|<code object|method '(?:format|format_map)'|<built-in method format"
    r"|<built-in function (?:open|eval|exec|getattr|__import__)"
    r"|_Environ|module '(?:os|sys|posix|builtins|importlib|subprocess|inspect)'"
    r"|<slot wrapper '(?!__init__)|'__builtins__'|<attribute '__|" + SECRET
)


def inputs(rng: random.Random, folder: Path) -> Iterator[str]:
    """Programs; each goes one to three steps."""
    (bait := folder / "bait.txt").write_text(SECRET, encoding="utf-8")
    while True:
        body = "\n".join(_step(rng, str(bait), k) for k in range(rng.randrange(1, 4)))
        yield f"{_HEAD}{body}\nprint('got', repr(found))\n"


def _step(rng: random.Random, bait: str, number: int) -> str:
    def filled(pattern: str, **more: str) -> str:
        words = {
            "t": rng.choice(_TARGETS), "u": rng.choice(_TARGETS), "o": rng.choice(_OBJECTS), "c": rng.choice(_CLASSES),
            "f": bait, **more,
        }  # fmt: skip
        return pattern.format(**words)

    expression = filled(rng.choice(_READS))
    if rng.random() < 0.3:
        expression = filled(rng.choice(_READS), o=f"({expression})")
    shell = filled(rng.choice(_SHELLS), e=expression, m=filled(rng.choice(_MATCHES)))
    lines = "\n".join(f"    {line}" for line in shell.splitlines())
    return f"found = 'nothing'\ntry:\n{lines}\nexcept Exception:\n    pass\nfound{number} = found"


def feed(item: str) -> None:
    """Check and run a program. Raises AssertionError where it got hold of something."""
    from plugins.scenario_writer.sandbox.script_rules import breaches, parsed
    from plugins.scenario_writer.sandbox.script_runner import Limits, run_script

    try:
        if breaches(parsed(item)):
            return
    except SyntaxError:
        return
    ran = run_script(item, Limits(cpu_s=1, wall_s=10.0, memory_mb=300))
    told = f"{ran.printed} {ran.fault.message if ran.fault else ''}"
    assert not _GOT.search(told), f"{told[:200]} by {item[len(_HEAD) :]!r}"  # noqa: S101 - what is looked for
    assert not ran.xosc, "a scenario of nothing"  # noqa: S101 - as above
