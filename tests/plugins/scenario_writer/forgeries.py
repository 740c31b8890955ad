"""Two hundred ways to get code out of a text, or to answer in the sandbox's place.

CODED passes names that are built while the script runs, so that no rule can read them in the script; `found` is bound
to what was got hold of. FORGED runs with every builtin at hand and writes what the sandbox itself would answer.
"""

from __future__ import annotations

from itertools import product

U = "u = chr(95) * 2\n"
NAMES = (
    "annotations", "class", "globals", "init", "code", "dict", "subclasses", "mro", "reduce_ex", "getattribute",
    "builtins", "import", "match_args", "set_name", "getattr", "del", "call",
)  # fmt: skip
"""Private names of Python, without their underscores."""

_MAKERS = {
    "Enum by a mapping": "from enum import Enum\nfound = Enum('E', {{{name}: 1}})",
    "Enum by pairs": "from enum import Enum\nfound = Enum('E', [({name}, 1)])",
    "Enum by words": "from enum import Enum\nfound = Enum('E', {name} + ' b')",
    "IntEnum by keywords": "from enum import IntEnum\nfound = IntEnum('E', names=[{name}])",
    "Enum's class called": (
        "from enum import Enum\nclass A(Enum):\n    pass\nfound = A('E', [({name}, 1)])"
    ),
    "a template kept in a name": "t = '{{0.' + {name} + '}}'\nfound = t.format(print)",
    "a template by str": "found = str.format('{{0.' + {name} + '}}', print)",
    "a template mapped": "found = list(map(str.format, ['{{0.' + {name} + '}}'], [print]))",
    "a template of a template": "found = '{{{{0.{{}}}}}}'.format({name}).format(print)",
}  # fmt: skip
_LIBRARY = {
    "the library's parser of gears": (
        "from scenariogeneration import xosc\na = xosc.OverrideControllerValueAction()\n"
        "a.set_gear(True, xosc.AutomaticGearType.d)\ne = a.get_element()\n"
        "for g in e.iter('AutomaticGear'):\n    g.set('gear', {name})\n"
        "found = xosc.OverrideControllerValueAction.parse(e).gear_value"
    ),
    "the library's parser of events": (
        "from scenariogeneration import xosc\ne = xosc.Event('e', xosc.Priority.override)\n"
        "e.add_action('a', xosc.VisibilityAction(True, True, True))\nx = e.get_element()\n"
        "x.set('priority', {name})\nfound = xosc.Event.parse(x).priority"
    ),
}  # fmt: skip
_PLAIN = {
    "dataclass": "from dataclasses import dataclass\n@dataclass\nclass A:\n    x: int\nfound = A(1)",
    "dataclass by module": "import dataclasses\nfound = dataclasses.dataclass",
    "dataclass of an Enum": (
        "from enum import Enum\nfrom dataclasses import dataclass\n"
        "found = dataclass(Enum('E', {u + 'annotations' + u: 1}))"
    ),
    "make_dataclass": "from dataclasses import make_dataclass\nfound = make_dataclass('A', ['x'])",
    "field": "from dataclasses import field\nfound = field()",
    "namedtuple": "from collections import namedtuple\nfound = namedtuple('A', 'x')",
    "namedtuple by module": "import collections\nfound = collections.namedtuple('A', 'x')",
    "NamedTuple": "from typing import NamedTuple\nfound = NamedTuple('A', [('x', int)])",
    "NamedTuple as a base": "from typing import NamedTuple\nclass A(NamedTuple):\n    x: int\nfound = A(1)",
    "NamedTuple by module": "import typing\nfound = typing.NamedTuple",
    "TypedDict": "from typing import TypedDict\nfound = TypedDict('A', {'x': int})",
    "NewType": "from typing import NewType\nfound = NewType('A', int)",
    "ForwardRef": "from typing import ForwardRef\nfound = ForwardRef('print')",
    "get_type_hints": "import typing\nfound = typing.get_type_hints(print)",
    "an evaluated hint": "from typing import Optional\nfound = Optional['print'].evaluate",
    "singledispatch": "from functools import singledispatch\nfound = singledispatch(print)",
    "wraps": "from functools import wraps\nfound = wraps",
    "cached_property": "from functools import cached_property\nfound = cached_property",
    "total_ordering": "from functools import total_ordering\nfound = total_ordering",
    "partialmethod": "import functools\nfound = functools.partialmethod",
    "attrgetter": "from operator import attrgetter\nfound = attrgetter('real')(1)",
    "methodcaller": "import operator\nfound = operator.methodcaller('mro')(int)",
    "Flag": "from enum import Flag\nfound = Flag",
    "EnumType": "from enum import EnumType\nfound = EnumType",
    "EnumMeta": "import enum\nfound = enum.EnumMeta",
    "StrEnum": "import enum\nfound = enum.StrEnum('E', 'a')",
    "enum's property": "import enum\nfound = enum.property",
    "member": "import enum\nfound = enum.member",
    "type of three": "found = type('A', (), {u + 'del' + u: print})",
    "class of an instance": "found = (1).__class__",
    "a metaclass by keyword": "class A(metaclass=object):\n    pass\nfound = A",
    "class keywords": "class A(**{u + 'dict' + u: 1}):\n    pass\nfound = A",
    "class_getitem": "class A:\n    def __class_getitem__(cls, x):\n        return x\nfound = A[1]",
    "set_name": "class D:\n    def __set_name__(self, o, n):\n        pass\nfound = D()",
    "get of a descriptor": "class D:\n    def __get__(self, o, t):\n        return t\nfound = D()",
    "init_subclass": "class A:\n    def __init_subclass__(cls):\n        pass\nfound = A",
    "getattr of a class": "class A:\n    def __getattr__(self, n):\n        return n\nfound = A().x",
    "slots": "class A:\n    __slots__ = ('x',)\nfound = A",
    "match_args": "class A:\n    __match_args__ = ('real',)\nfound = A",
    "match by a private keyword": "match 1:\n    case int(__doc__=d):\n        found = d",
    "match by a built name": "match {u + 'doc' + u: 1}:\n    case {'__doc__': d}:\n        found = d",
    "private keyword argument": "found = dict(__doc__=1)",
    "private parameter": "def f(__doc__=1):\n    return 1\nfound = f()",
    "private import": "from random import __doc__ as found",
    "private alias": "import math as __doc__\nfound = 1",
    "private global": "def f():\n    global __doc__\nfound = f",
    "private nonlocal": "found = [__name__ for __doc__ in [1]]",
    "private deletion": "del __doc__\nfound = 1",
    "private exception": "try:\n    1 / 0\nexcept Exception as __doc__:\n    found = 1",
    "private in an f-string": "found = f'{print.__self__}'",
    "private in a nested f-string": "found = f'{f\"{print.__self__}\"}'",
    "private in a lambda": "found = (lambda x: x.__self__)(print)",
    "private in a default": "def f(x=print.__self__):\n    return x\nfound = f()",
    "private in a decorator": "@print.__self__.open\ndef found(): pass",
    "private in an annotation": "x: print.__self__ = 1\nfound = x",
    "private in a subscript": "found = [1][print.__self__]",
    "private in a starred call": "found = print(*print.__self__)",
    "private in a comprehension": "found = [x for x in (print,) if x.__self__]",
    "private by augmented name": "print.__self__ += 1\nfound = 1",
    "bytes of a name": "found = b'__class__'",
    "a private name in a text": "found = '__builtins__'",
    "a template with a private name": "found = '{0.__self__}'.format(print)",
    "a template with one underscore": "found = '{0._x}'.format(print)",
    "eval by another name": "e = eval\nfound = e('1')",
    "exec in a list": "found = [exec]",
    "compile in a dict": "found = {'a': compile}",
    "open as an argument": "found = list(map(open, ['x']))",
    "vars by walrus": "found = (v := vars)(print)",
    "getattr by star": "found = (lambda f, *a: f(*a))(getattr, print, u + 'self' + u)",
    "memoryview": "found = memoryview(b'')",
    "bytearray": "found = bytearray(1)",
    "type as a value": "found = type",
    "input": "found = input()",
    "frames of a generator": "g = (1 for x in [1])\nfound = g.gi_frame",
    "frames of a coroutine": "async def f():\n    pass\nfound = f().cr_frame",
    "a traceback's frame": "try:\n    1 / 0\nexcept Exception as e:\n    found = e.tb_frame",
    "sys of a library": "from scenariogeneration import xosc\nfound = xosc.sys",
    "the library's reader": "from scenariogeneration import xosc\nfound = xosc.ParseOpenScenario('x.xosc')",
    "the library's catalog": "from scenariogeneration import xosc\nfound = xosc.CatalogReader(None, 'x')",
    "random's os": "import random\nfound = random._urandom",
    "random's SystemRandom": "from random import SystemRandom as found",
    "datetime's sys": "from datetime import sys as found",
    "math's loader": "import math\nfound = math.__loader__",
}

CODED: dict[str, str] = {
    **{
        f"{how}, {name}": U + source.format(name=f"u + '{name}' + u")
        for (how, source), name in product((_MAKERS | _LIBRARY).items(), NAMES[:9])
    },
    **{name: U + source for name, source in _PLAIN.items()},
}

_ANSWERS = {
    "a scenario": b'{"ok": true, "xosc": "<forged/>", "walls": []}',
    "a scenario of ours": b'{"ok": true, "xosc": "<forged/>", "printed": ""}',
    "isolation": b'{"ok": false, "layer": "isolation", "message": "no"}',
    "infinity": b'{"ok": false, "layer": "rules", "breaches": [[Infinity, "", "", ""]]}',
    "not a number": b'{"ok": false, "layer": "parse", "line": NaN}',
    "a list": b"[1, 2]",
    "a deep list": b"[" * 50_000,
    "a great number": b'{"ok": false, "layer": "parse", "line": ' + b"9" * 5_000 + b"}",
    "two answers": b'{"ok": true, "xosc": "<a/>"}{"ok": true, "xosc": "<b/>"}',
    "no UTF-8": b"\xff\xfe\xfd",
}
FORGED: dict[str, str] = {
    f"{name} on {channel}": f"import os\nos.write({channel}, {answer!r})\nos._exit(0)"
    for (name, answer), channel in product(_ANSWERS.items(), (1, 3))
}
FORGED |= {
    "a status on every channel": (
        "import os\nfor channel in range(16):\n    try:\n"
        '        os.write(channel, b\'{"isolated": false, "walls": []}\')\n    except OSError:\n        pass\n'
    ),
    "an early answer": 'import os\nos.write(1, b\'{"ok": true, "xosc": "<forged/>"}\')\nfound = \'\'',
}
