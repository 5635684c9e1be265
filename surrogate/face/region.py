"""The part of the box in which a model has answers, where cases beyond an edge have none."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import xarray as xr

from approximation import products
from approximation.arrays import Array, Flags, Indices
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.points import OutOfBoxError

#: Most degrees, terms and known places of a region in a file.
_MOST_DEGREE, _MOST_TERMS, _MOST_PLACES = 20, 1000, 1000


class OutOfRegionError(OutOfBoxError):
    """A query point lies in the box, but where cases are refused."""


@dataclass(frozen=True)
class Region:
    """Region where sum_m coefficients[m] prod_k T_{degrees[m, k]}(t_k) >= least, at scaled inputs t."""

    degrees: Indices  # shape (m, d)
    coefficients: Array  # shape (m,)
    least: float  # The edge with its margin
    # At most this share of the cases that are refused lies inside all the same, in the mean over held-out cases
    passing: float
    refused: float  # Share of the evenly spread held-out cases that are refused
    lost: float  # Share of those that are not, but lie outside, within the margin
    places: Array  # shape (k, d); Scaled inputs of some cases that are refused
    which: Indices  # shape (k,); The reason of each
    reasons: tuple[str, ...]

    def inside(self, t: Array) -> Flags:
        """Return whether points at scaled inputs (d, n) lie in it, (n,)."""
        return np.asarray(self.above(t) >= 0)

    def above(self, t: Array) -> Array:
        """Return by how much the polynomial is above the least, (n,)."""
        return np.asarray(self.coefficients @ products.values(self.degrees, t)) - self.least

    def narrower(self, share: float) -> Self:
        """Return it with a margin that is wider by a share of the polynomial's steepest rise."""
        return replace(self, least=self.least + share * float(np.abs(self.coefficients[1:]).sum()))

    def slopes(self, t: Array) -> Array:
        """Return the derivatives of `above` by the scaled inputs, (d, n)."""
        return np.stack([self.coefficients @ slope for slope in products.slopes(self.degrees, t)])

    def reason(self, t: Array) -> str:
        """Return why the known case nearest to a point, (d,), is refused."""
        return self.reasons[int(self.which[int(((self.places - t) ** 2).sum(axis=1).argmin())])]

    def require(self, X: Array, inputs: Sequence[Input]) -> None:
        """Raise OutOfRegionError, with the first point's inputs and the reason, unless all points lie in the region.

        X: (n, d), points in physical units.
        """
        t = unit_coordinates(inputs, X)
        wrong = ~self.inside(t)
        if wrong.any():
            row = int(wrong.argmax())
            where = ", ".join(
                f"{input_.name} = {value:.6g}" for input_, value in zip(inputs, X[row].tolist(), strict=True)
            )
            others = f" ({int(wrong.sum())} of {len(X)} points are beyond it)" if len(X) > 1 else ""
            raise OutOfRegionError(
                f"{where} is beyond the edge of the cases that have answers{others}: {self.reason(t[:, row])}"
            )

    def state(self) -> xr.Dataset:
        """Return what a file must hold."""
        return xr.Dataset(
            {
                "region_degree": (("region_term", "input"), self.degrees),
                "region_coefficient": ("region_term", self.coefficients),
                "region_place": (("region_case", "input"), self.places),
                "region_which": ("region_case", self.which),
                "region_reason": ("region_text", np.array(self.reasons, dtype=str)),
                "region_shares": ("region_share", [self.least, self.passing, self.refused, self.lost]),
            }
        )

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: int) -> Self | None:
        """Return the region in a file, None where it has none."""
        if "region_degree" not in stored:
            return None
        degrees, coefficients = stored["region_degree"].values, stored["region_coefficient"].values
        places, which = stored["region_place"].values, stored["region_which"].values
        reasons, shares = stored["region_reason"].values.tolist(), stored["region_shares"].values.tolist()
        fits = [
            degrees.dtype.kind in "iu" and degrees.shape == (*coefficients.shape, inputs) and degrees.size,
            which.dtype.kind in "iu" and places.shape == (*which.shape, inputs) and which.size,
            len(degrees) <= _MOST_TERMS and len(places) <= _MOST_PLACES and len(shares) == 4,
        ]
        if not all(fits) or degrees.min() < 0 or degrees.max() > _MOST_DEGREE:
            raise ValueError("the region in which the model has answers does not fit the model")
        if which.min() < 0 or which.max() >= len(reasons):
            raise ValueError("the reasons of the region do not fit its places")
        return cls(
            degrees.astype(np.intp), coefficients, shares[0], shares[1], shares[2], shares[3], places,
            which.astype(np.intp), tuple(map(str, reasons)),
        )  # fmt: skip
