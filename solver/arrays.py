"""Types of arrays, and small operations on them, for every room of the solver."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from numbers import Real
from typing import TYPE_CHECKING, Any, SupportsFloat, TypeGuard, TypeVar

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array as Array
from approximation.arrays import Indices
from approximation.arrays import unmasked as unmasked

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]
#: Real or complex arrays: positions on the surface, or complex coordinates of the interior.
Points = TypeVar("Points", Array, ComplexArray)
Scalar = TypeVar("Scalar", bound=np.generic)
Record = TypeVar("Record", bound="DataclassInstance")

_LONGEST = 60  # most characters of a value that a message quotes
#: Words that people use for names of factors and their values.
SYNONYMS = {"ball": "sphere", "indenter": "punch", "substrate": "base", "grounded": "conducting", "vacuum": "insulated"}
_NEAR = 0.65  # least share of common letters: mass and base, or PMMA and PDMS, are different words


def is_finite(value: object) -> TypeGuard[SupportsFloat]:
    """Return whether a plain value is a finite real number, and not a truth value."""
    try:
        return not isinstance(value, bool | np.bool_) and isinstance(value, Real) and bool(np.isfinite(float(value)))
    except OverflowError:
        return False


def shown(value: object) -> str:
    """Return a faulty value as messages quote it, in one line and cut to its beginning."""
    text = str(value)
    return repr(text if len(text) <= _LONGEST else f"{text[:_LONGEST]}...")


def nearest(name: object, known: Collection[str]) -> str | None:
    """Return the known name that a misspelt name probably means, or None."""
    word = SYNONYMS.get(str(name).casefold())
    return word if word in known else next(iter(get_close_matches(str(name), known, 1, _NEAR)), None)


def dot(first: Array, second: Array) -> Array:
    """Sum of products of arrays (..., n) over the last axis."""
    return np.asarray(np.einsum("...i,...i", first, second))


def distinct_rows(rows: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return the distinct rows, sorted (distinct, n), and the index of each row among them (row,)."""
    varying = np.flatnonzero(np.any(rows != rows[:1], axis=0))  # often none: many cases share one body
    if not varying.size:
        return rows[:1], np.zeros(len(rows), dtype=np.intp)
    _, first, index = np.unique(rows[:, varying], axis=0, return_index=True, return_inverse=True)
    return rows[first], index.ravel()


def joined(parts: Sequence[tuple[Indices, Mapping[str, Array]]], count: int) -> dict[str, Array]:
    """Join outputs of parts of the cases, as far as all parts have them; (case, ...) each."""
    (_, first), *following = parts
    result = {}
    for name, values in first.items():
        if all(name in outputs for _, outputs in following):
            result[name] = np.empty((count, *values.shape[1:]))
            for cases, outputs in parts:
                result[name][cases] = outputs[name]
    return result


def selected(record: Record, cases: slice | Indices, *names: str) -> Record:
    """Return a dataclass whose named arrays over cases, unless None, hold the selected cases."""
    arrays = {name: getattr(record, name) for name in names}
    return replace(record, **{name: values[cases] for name, values in arrays.items() if values is not None})


def fields_by_name(names: Sequence[str], values: Array) -> dict[str, Array]:
    """Split fields (case, field, ...) into one array (case, ...) for each name."""
    return dict(zip(names, np.moveaxis(values, 1, 0), strict=True))


def column(values: Array) -> Array:
    """Reshape values (...) to (..., 1, 1), to multiply matrices."""
    return values[..., None, None]


def outer(values: Array) -> Array:
    """Products of all pairs of values (..., n); (..., n, n)."""
    return values[..., :, None] * values[..., None, :]


def stack(*values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Stack values that broadcast against each other along a new last axis."""
    return np.stack(np.broadcast_arrays(*values), -1)


def matrix_of(rows: Sequence[Sequence[Array]]) -> Array:
    """Stack rows of entries that broadcast against each other; (..., row, column)."""
    flat = stack(*(entry for row in rows for entry in row))
    return flat.reshape(*flat.shape[:-1], len(rows), len(rows[0]))


def components(vector: Array) -> list[Array]:
    """Split (..., n) into n arrays (..., 1), which broadcast over an axis of positions."""
    return [vector[..., j, None] for j in range(vector.shape[-1])]


def power_series(coefficients: Array, x: Points) -> Points:
    """Sum of coefficients (..., degree + 1) times x^k at x (..., point), by Horner's rule; (..., point)."""
    value: Any = coefficients[..., -1, None]
    for k in range(coefficients.shape[-1] - 2, -1, -1):
        value = value * x + coefficients[..., k, None]
    out: Points = value + np.zeros_like(x)
    return out
