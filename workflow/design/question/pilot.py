"""Pilot of a design question: a few hundred designs that show undefined terms, kinks and forgotten units."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from math import log10

import numpy as np

from approximation.arrays import Array
from approximation.sobol import sobol_points
from solver import units
from workflow.design.question.question import Question
from workflow.design.question.risk import RelativeDeviation, Term, WorstCase
from workflow.design.question.sources import Exact, Predicted
from workflow.language.expressions import Expression, Number, Operation
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

_POINTS = 512  # designs, which show an unbounded or undefined term
_EVALUATED = 1 << 13  # evaluations of one term
_ENDS = 8  # variables of which every combination of ends is evaluated
_PIECES = 8  # most smooth pieces of one expression
_ROUNDING = 1e-12  # share of the largest value that counts as none
_FAR = 100.0  # ratio of a bound to the nearest value from which a forgotten unit is likelier than the number
_PREFIXES = ("p", "n", "u", "m", "k", "M", "G")


def ask(
    study: Study,
    name: str,
    target: Target,
    predicted: Predicted,
    exact: Exact,
    chosen: dict[str, float] | None = None,
) -> Question:
    """Return the question of a target, checked on the surrogate at a few hundred designs."""
    held = {name: value for name, value in {**target.at, **(chosen or {})}.items() if not isinstance(value, str)}
    question = Question(study, target, predicted, exact, held)
    if not question.inputs:
        return question
    corner = question.searched[False]
    designs = question.at(_pilot(len(question.inputs), corner.count))
    factors = designs.factors(corner)
    scales: dict[str, float] = {}
    notes: list[str] = []
    pieces: dict[int, list[Expression]] = {}
    spread = 0.0
    for place, term in enumerate(question.terms):
        label = f"design: {name}: {term.label!r}"
        values = designs.value(predicted, question.searched[term.measure.key], term)
        for divisor in _divisors(term.expression):
            ends = designs.value(predicted, corner, replace(term, expression=divisor))
            if ends.min() <= 0 <= ends.max():
                named = " and ".join(divisor.names())
                raise InputError(f"{label} is unbounded: {named} in a divisor passes 0 in the ranges")
        counted = term.measure.rows(values) if isinstance(term.measure, RelativeDeviation) else values
        if not np.all(np.isfinite(counted)):
            raise InputError(f"{label} is not defined everywhere within the ranges of {', '.join(question.inputs)}")
        if place == 0:
            spread = float(np.ptp(values))
        if term.bound == 0:
            scales[term.label] = float(np.abs(values).max()) or 1.0
        if isinstance(term.measure, WorstCase):
            known = question.known(predicted, factors, [term.expression])
            split = smooth_pieces(term.expression, -term.sign if term.limited else term.sign, known)
            pieces |= {place: split} if len(split) > 1 else {}
        if term.unitless:
            notes += unit_notes(label, term, values)
    return replace(question, scales=scales, pieces=pieces, spread=spread, notes=tuple(notes))


def _pilot(d: int, scenarios: int) -> Array:
    """Return scaled points inside the ranges and at combinations of their ends, (n, d); fewer with many scenarios."""
    ends = np.array(list(product([-1.0, 1.0], repeat=min(d, _ENDS))))
    count = 1 << int(np.clip(np.log2(_EVALUATED / scenarios), 5, np.log2(_POINTS)))
    inside = 2 * sobol_points(count, d) - 1
    return np.concatenate([inside, np.pad(ends, ((0, 0), (0, d - ends.shape[1])))])


def _divisors(expression: Expression) -> list[Expression]:
    """Return the divisors, negative powers and arguments of logarithms in an expression that have names."""
    inner: list[Expression] = []
    for node in (node for node in expression.walk() if isinstance(node, Operation)):
        first, last = node.parts[0], node.parts[-1]
        if node.symbol == "/":
            inner.append(last)
        elif node.symbol == "log" or (node.symbol == "^" and isinstance(last, Number) and last.value < 0):
            inner.append(first)
    return [node for node in inner if node.names()]


def smooth_pieces(
    expression: Expression, sign: float, known: Mapping[str, Array], most: int = _PIECES
) -> list[Expression]:
    """Return smooth expressions whose least value, times `sign`, is that of the expression: gradients stop at kinks."""
    whole = sign * expression.evaluate(known)
    room = _ROUNDING * np.abs(whole).max()
    for kink in dict.fromkeys(node for node in expression.walk() if isinstance(node, Operation)):
        parts = [_swapped(expression, kink, branch) for branch in _branches(kink)]
        if not 1 < len(parts) <= most:
            continue
        values = [sign * part.evaluate(known) for part in parts]
        least = all(np.all(value >= whole - room) for value in values)
        if least and not any(np.all(value <= whole + room) for value in values):
            return [piece for part in parts for piece in smooth_pieces(part, sign, known, most // len(parts))]
    return [expression]


def _branches(kink: Operation) -> list[Expression]:
    """Return the smooth branches of a node, none for a smooth function."""
    if kink.symbol == "abs":
        return [kink.parts[0], Operation("*", (Number(-1.0), kink.parts[0]))]
    return list(kink.parts) if kink.symbol in ("min", "max") else []


def _swapped(tree: Expression, node: Expression, other: Expression) -> Expression:
    """Return the tree with `other` in place of every node that equals `node`."""
    if tree == node:
        return other
    if isinstance(tree, Operation):
        return replace(tree, parts=tuple(_swapped(part, node, other) for part in tree.parts))
    return tree


def unit_notes(label: str, term: Term, values: Array) -> list[str]:
    """Return a note where a bound without unit is far beyond all values; refuse one that nothing keeps."""
    excess = term.sign * (values - term.bound)
    low, high = float(excess.min()), float(excess.max())
    nearest = term.bound + term.sign * (low if low > 0 else high)
    if low <= 0 <= high or nearest == 0 or 1 / _FAR < abs(nearest / term.bound) < _FAR:
        return []
    read = f"{term.bound:g} without a unit is read as {term.bound:g} {term.units}"
    size = f"{values.min():.3g} to {values.max():.3g} {term.units}{_intended(term, values)}"
    if low > 0:
        raise InputError(f"{label}: {read}, which no design satisfies: the values within the ranges are {size}")
    return [f"{term.label!r}: {read}, which every design satisfies: the values within the ranges are {size}"]


def _intended(term: Term, values: Array) -> str:
    """Return a question with the prefix that brings the bound closest to the values, where the unit takes one."""
    unit = term.expression.interface_unit()
    if unit is None or unit.startswith("kg"):
        return "; write a unit after the number"
    size = float(np.abs(values).max())
    scales = {prefix: units.parse(f"{prefix}{unit}").scale / units.parse(unit).scale for prefix in _PREFIXES}
    closest = min(scales, key=lambda prefix: abs(log10(abs(term.bound) * scales[prefix] / size)))
    return f"; did you mean {term.bound:g} {closest}{unit}?"
