"""Over two hundred ways to get code or a private name out of a text, and some to answer in the sandbox's place.

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
    # ---- what compiles source or runs text, by ways around its name
    "dataclass through typing": "import typing\nfound = typing.dataclass_transform",
    "dataclass of crafted annotations": (
        "from dataclasses import dataclass\nclass A:\n    pass\nA.x: 'print()'\nfound = dataclass(A)"
    ),
    "make_dataclass of a built field": "import dataclasses\nfound = dataclasses.make_dataclass('A', [u + 'x' + u])",
    "namedtuple of a built field": (
        "from collections import namedtuple\nfound = namedtuple('A', [u + 'x' + u], rename=True)"
    ),
    "namedtuple by star": "from collections import *\nfound = namedtuple('A', 'x')",
    "NamedTuple by star": "from typing import *\nfound = NamedTuple('A', [('x', int)])",
    "Enum by star": "from enum import *\nfound = Enum('A', {u + 'x' + u: 1})",
    "Enum by its type": "from enum import Enum\nclass A(Enum):\n    pass\nfound = A.mro()",
    "Enum by start": "from enum import Enum\nfound = Enum('A', 'x y', start=1)",
    "Enum by type": "from enum import Enum\nfound = Enum('A', 'x y', type=int)",
    "Enum by module": "from enum import Enum\nfound = Enum('A', 'x', module='os')",
    "Enum by qualname": "from enum import Enum\nfound = Enum('A', 'x', qualname='os.x')",
    "Enum by boundary": "from enum import Enum\nfound = Enum('A', 'x', boundary=None)",
    "Enum by partial": (
        "from enum import Enum\nfrom functools import partial\nfound = partial(Enum, 'A')({u + 'x' + u: 1})"
    ),
    "Enum by reduce": "from enum import Enum\nfrom functools import reduce\nfound = reduce(Enum, ['A', [(u, 1)]])",
    "Enum by starmap": (
        "from enum import Enum\nfrom itertools import starmap\nfound = list(starmap(Enum, [('A', [(u, 1)])]))"
    ),
    "Enum by map": "from enum import Enum\nfound = list(map(Enum, ['A'], [[(u, 1)]]))",
    "Enum by star-arguments": "from enum import Enum\nfound = Enum(*['A', [(u, 1)]])",
    "Enum by keyword arguments": "from enum import Enum\nfound = Enum(**{'value': 'A', 'names': [u]})",
    "a method of an Enum's type": "from enum import Enum\nfound = Enum.create('A')",
    "an Enum's missing": (
        "from enum import Enum\nclass A(Enum):\n    def _missing_(cls, v):\n        return v\nfound = A(1)"
    ),
    "an Enum's next value": (
        "from enum import Enum, auto\nclass A(Enum):\n    def _generate_next_value_(n, s, c, l):\n        return n\n"
        "    x = auto()\nfound = A.x.value"
    ),
    "TypeVar by star": "from typing import *\nfound = TypeVar('T')",
    "a hint's own evaluation": "from typing import List\nfound = List['print()'].evaluate()",
    "a hint's module": "from typing import Callable\nfound = Callable.sys",
    "an annotation that is read back": "def f(x: 'print()'):\n    pass\nfound = f.__annotations__",
    "Template": "from string import Template\nfound = Template('$x')",
    "Formatter": "import string\nfound = string.Formatter().format('{0}', print)",
    "literal_eval": "from ast import literal_eval\nfound = literal_eval('1')",
    "timeit": "import timeit\nfound = timeit.timeit('1', number=1)",
    "doctest": "import doctest\nfound = doctest.run_docstring_examples(print, {})",
    "pdb": "import pdb\nfound = pdb.run('1')",
    "cProfile": "import cProfile\nfound = cProfile.run('1')",
    "trace": "import trace\nfound = trace.Trace().run('1')",
    "types.FunctionType": "from types import FunctionType\nfound = FunctionType",
    "types.CodeType": "import types\nfound = types.CodeType",
    "types.new_class": "import types\nfound = types.new_class('A')",
    "copyreg": "import copyreg\nfound = copyreg",
    "a lazy import": "found = [__import__ for x in [1]][0]('os')",
    "an import by partial": "from functools import partial\nfound = partial(__import__, 'os')()",
    "a library's own import": "from scenariogeneration import xosc\nfound = xosc.importlib",
    "a library's enumeration by a name": "from scenariogeneration import xosc\nfound = xosc.Priority(u + 'class' + u)",
    # ---- templates
    "a template with a frame": "g = (1 for x in [1])\nfound = '{0.gi_frame}'.format(g)",
    "a template with a frame's globals": "g = (1 for x in [1])\nfound = '{0.gi_frame.f_globals}'.format(g)",
    "a template with a frame's builtins": "g = (1 for x in [1])\nfound = '{x.gi_frame.f_builtins[open]}'.format(x=g)",
    "a template with code": "g = (1 for x in [1])\nfound = '{.gi_code.co_consts}'.format(g)",
    "a template in a format's width": "found = '{0:{1.__class__}}'.format(1, 2)",
    "a template with a conversion": "found = '{0.__class__!r}'.format(1)",
    "a template with an index": "found = '{0[__builtins__]}'.format({u + 'builtins' + u: 1})",
    "a template by partial": (
        "from functools import partial\nfound = partial(str.format, '{0.' + u + 'class' + u + '}')(1)"
    ),
    "a template by format_map": "found = str.format_map('{x}', {'x': 1})",
    "a template by modulo": "found = '%(__class__)s' % {u + 'class' + u: 1}",
    "a template of one's own kind": ("class T(str):\n    pass\nfound = T('{0.' + u + 'class' + u + '}').format(1)"),
    "a template by super": (
        "class T(str):\n    def go(self, x):\n        return super().format(x)\n"
        "found = T('{0.' + u + 'class' + u + '}').go(1)"
    ),
    "the builtin format": "found = format(1, 'd')",
    "an f-string of a frame": "g = (1 for x in [1])\nfound = f'{g.gi_frame}'",
    # ---- descriptors and attributes
    "set of a descriptor": "class D:\n    def __set__(self, o, v):\n        pass\nfound = D()",
    "delete of a descriptor": "class D:\n    def __delete__(self, o):\n        pass\nfound = D()",
    "a property's getter": "class A:\n    x = property(lambda self: 1)\nfound = A.x.fget.__globals__",
    "a property's setter on a class": "class A:\n    x = property(lambda self: 1)\nfound = A.x.__set__",
    "a class method's function": "class A:\n    f = classmethod(print)\nfound = A.f.__func__",
    "a bound method's self": "found = [].append.__self__",
    "a super's own class": "class A:\n    def __init__(self):\n        self.c = super().__thisclass__\nfound = A().c",
    "the class cell": "class A:\n    def f(self):\n        return __class__\nfound = A().f()",
    "getattribute of a class": "class A:\n    def __getattribute__(self, n):\n        return n\nfound = A().x",
    "setattr of a class": "class A:\n    def __setattr__(self, n, v):\n        pass\nfound = A()",
    "call of a class": "class A:\n    def __call__(self):\n        return 1\nfound = A()()",
    "instancecheck": "class A:\n    def __instancecheck__(self, x):\n        return True\nfound = A()",
    "subclasshook": "class A:\n    def __subclasshook__(cls, x):\n        return True\nfound = A",
    "mro_entries": "class A:\n    def __mro_entries__(self, b):\n        return b\nfound = A()",
    "reduce": "class A:\n    def __reduce__(self):\n        return print, ()\nfound = A()",
    "prepare": "class A:\n    def __prepare__(n, b):\n        return {}\nfound = A",
    "missing of a dict": "class A(dict):\n    def __missing__(self, k):\n        return k\nfound = A()[1]",
    "iter of a class": "class A:\n    def __iter__(self):\n        return iter([])\nfound = A()",
    "enter of a class": "class A:\n    def __enter__(self):\n        return self\nfound = A()",
    "index of a class": "class A:\n    def __index__(self):\n        return 1\nfound = A()",
    "a cache's function": "from functools import cache\nfound = cache(len).__wrapped__",
    "a partial's state": "from functools import partial\nfound = partial(print).__setstate__",
    "a default dict's factory": "from collections import defaultdict\nfound = defaultdict(eval)",
    "a weak reference": "import weakref\nfound = weakref.ref(print)",
    "an exception's context": "try:\n    1 / 0\nexcept Exception as e:\n    found = e.__context__",
    "an exception's notes": "try:\n    1 / 0\nexcept Exception as e:\n    e.add_note('x')\n    found = e.__notes__",
    "an exception group": "try:\n    1 / 0\nexcept* Exception as e:\n    found = e.__traceback__",
    "a name of an AttributeError": "try:\n    print.x\nexcept AttributeError as e:\n    found = e.obj.__self__",
    "a generator's sender": "def g():\n    x = yield 1\n    yield x.__class__\ni = g()\nnext(i)\nfound = i.send(1)",
    # ---- names that are built
    "a name by chr": "found = {chr(95) * 2 + 'builtins' + chr(95) * 2: 1}['__builtins__']",
    "a name by bytes": "found = bytes([95, 95]).decode()",
    "a name by join": "found = getattr(print, ''.join(map(chr, [95, 95, 115])))",
    "a name by replace": "found = vars(print)['xx'.replace('x', chr(95))]",
    "a name by slicing": "found = globals()[repr(print)[0:2]]",
    "a name by normal forms": "found = print.\uff3f\uff3fself\uff3f\uff3f",
    "a wide letter": "found = \uff45val('1')",
    "a name by an escape": "found = '\\x5f\\x5fclass\\x5f\\x5f'",
    "a name by a named escape": "found = '\\N{LOW LINE}\\N{LOW LINE}class\\N{LOW LINE}\\N{LOW LINE}'",
}

CODED: dict[str, str] = {
    **{
        f"{how}, {name}": U + source.format(name=f"u + '{name}' + u")
        for (how, source), name in product((_MAKERS | _LIBRARY).items(), NAMES)
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
