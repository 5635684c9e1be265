"""Kinks of expressions, at abs, min and max, split into smooth pieces for an optimiser of the least of many rows.

Where -abs(v) is maximised it is the least of v and -v: two smooth rows in place of one with a kink, at which a search
with gradients would stop short.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from approximation.arrays import Array
from workflow.language.expressions import Call, Expression, Number, Operation, Power

_MOST = 8  # pieces of one expression
_ROUNDING = 1e-12  # share of the largest value that counts as none


def pieces(expression: Expression, sign: float, known: Mapping[str, Array], most: int = _MOST) -> list[Expression]:
    """Expressions whose least, times ``sign``, is the expression times ``sign`` at all known points."""
    whole = sign * expression.evaluate(known)
    room = _ROUNDING * np.abs(whole).max()
    for kink in dict.fromkeys(node for node in expression.walk() if isinstance(node, Call)):
        parts = [_swapped(expression, kink, branch) for branch in _branches(kink)]
        if not 1 < len(parts) <= most:
            continue
        values = [sign * part.evaluate(known) for part in parts]
        least = all(np.all(value >= whole - room) for value in values)
        if least and not any(np.all(value <= whole + room) for value in values):
            return [piece for part in parts for piece in pieces(part, sign, known, most // len(parts))]
    return [expression]


def _branches(kink: Call) -> list[Expression]:
    """What the node may be, one smooth branch each."""
    if kink.function == "abs":
        return [kink.arguments[0], Operation("*", Number(-1.0), kink.arguments[0])]
    return list(kink.arguments) if kink.function in ("min", "max") else []


def _swapped(tree: Expression, node: Expression, other: Expression) -> Expression:
    """The tree with another node wherever it has one."""
    if tree == node:
        return other
    if isinstance(tree, Operation):
        return replace(tree, left=_swapped(tree.left, node, other), right=_swapped(tree.right, node, other))
    if isinstance(tree, Power):
        return replace(tree, base=_swapped(tree.base, node, other))
    if isinstance(tree, Call):
        return replace(tree, arguments=tuple(_swapped(argument, node, other) for argument in tree.arguments))
    return tree
