"""OpenSCENARIO's `${...}` expressions: numbers, Booleans and the functions of versions 1.1 to 1.3.

Formulas: ASAM OpenSCENARIO 1.3, section 9.2. Knows no XML; parameters are already filled in.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable

MAX_CHARACTERS = 1000
Value = float | bool

_BINARY: dict[type[ast.AST], Callable[[Value, Value], Value]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Mod: math.fmod,
}  # fmt: skip
_COMPARE: dict[type[ast.AST], Callable[[Value, Value], bool]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}  # fmt: skip
_UNARY: dict[type[ast.AST], Callable[[Value], Value]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_,
}  # fmt: skip
_FUNCTIONS: dict[str, Callable[..., Value]] = {
    "round": lambda x: math.floor(x + 0.5), "floor": math.floor, "ceil": math.ceil, "sqrt": math.sqrt, "pow": math.pow,
    "abs": abs, "sign": lambda x: (x > 0) - (x < 0), "max": max, "min": min, "sin": math.sin, "cos": math.cos,
    "tan": math.tan, "asin": math.asin, "acos": math.acos, "atan": math.atan,
}  # fmt: skip
_NAMES: dict[str, Value] = {"pi": math.pi, "e": math.e, "true": True, "false": False}


def evaluated(expression: str) -> str:
    """The value as an attribute says it. Raises ValueError (with the reason) for what is no expression."""
    if len(expression) > MAX_CHARACTERS:
        raise ValueError(f"longer than {MAX_CHARACTERS} characters")
    try:
        value = _value(ast.parse(expression.strip(), mode="eval").body)
        if isinstance(value, bool):
            return str(value).lower()
        return repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))
    except (SyntaxError, ArithmeticError, TypeError, RecursionError, MemoryError) as fault:
        raise ValueError(str(fault)) from fault


def _value(node: ast.AST) -> Value:
    match node:
        case ast.Constant(value=bool() | int() | float() as value):
            return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
        case ast.Name(id=name) if name in _NAMES:
            return _NAMES[name]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _BINARY[type(op)](_value(left), _value(right))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
            return _UNARY[type(op)](_value(operand))
        case ast.BoolOp(op=op, values=values):
            return (all if isinstance(op, ast.And) else any)(bool(_value(v)) for v in values)
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARE:
            return _COMPARE[type(op)](_value(left), _value(right))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in _FUNCTIONS:
            return _FUNCTIONS[name](*map(_value, args))
    raise ValueError(f"{type(node).__name__} is not allowed")
