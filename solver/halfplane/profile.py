"""Rigid punch profiles: a polynomial slope, and which edges of the contact are corners of the punch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from approximation.arrays import Indices
from solver.arrays import Array, unmasked


@dataclass(frozen=True, eq=False)
class Profile:
    """Profile y = g(x) of a punch by its slope; one form for every case, parameters as arrays over case axes.

    Parameters
    ----------
    slope
        Coefficients of g'(x) in ascending powers of x, each (...) [m^-k]. The origin is the corner of a punch with one
        corner, the middle of one with two, any point of one without.
    smooth
        Whether the punch leaves the surface smoothly at the trailing and the leading edge of the contact; otherwise it
        has a corner there.
    width
        Distance of the corners of a punch with two [m]; (...).
    moment
        Moment int x p dx of the pressure about the origin [N], of a punch with two corners that may tilt: it then
        replaces the constant of the slope.

    Examples
    --------
    >>> import solver
    >>> body = {"material": "PZT-4", "load": 1e5}
    >>> quartic = Profile.polynomial([0, 0, 0, 1.25e8])  # y = x^4/4 s^-3, s = 2 mm
    >>> f"{float(solver.solve(body | {'profile': quartic})['contact_trailing']):.4g}"
    '0.0003545'
    >>> Profile.cylinder(np.array(0.05)).homogeneous, Profile.half_cylinder(np.array(0.05)).smooth
    (True, (True, False))
    >>> Profile.flat(width=np.array(1e-3), slope=np.array(0.0)).homogeneous, Profile.wedge(np.array(0.01)).homogeneous
    (False, True)
    """

    slope: tuple[Array, ...]
    smooth: tuple[bool, bool]
    width: Array | None = None
    moment: Array | None = None

    def __post_init__(self) -> None:
        if any(self.smooth) != (self.width is None):
            raise ValueError("width: given by a punch with two corners, and only by that")
        if self.moment is not None and any(self.smooth):
            raise ValueError("moment: only a punch with two corners can take one")

    @classmethod
    def polynomial(
        cls, slope: Sequence[ArrayLike], smooth: tuple[bool, bool] = (True, True), width: ArrayLike | None = None
    ) -> Self:
        """Any polynomial slope g'(x).

        Parameters
        ----------
        slope : sequence of array_like, coefficients in ascending powers of x [m^-k], each (...)
        smooth : (bool, bool), whether the trailing and the leading edge are
        width : array_like, between two corners [m]; None: it has not two
        """
        coefficients = tuple(np.asarray(unmasked(c), dtype=np.float64) for c in slope)
        return cls(coefficients, smooth, None if width is None else np.asarray(unmasked(width), dtype=np.float64))

    @classmethod
    def cylinder(cls, radius: Array) -> Self:
        """Circular punch of radius R in the parabolic approximation: g' = x/R."""
        return cls((np.zeros(()), 1 / radius), (True, True))

    @classmethod
    def flat(cls, width: Array, slope: Array | float = 0.0, moment: Array | None = None) -> Self:
        """Flat punch, tilted by a slope or as a moment asks.

        Parameters
        ----------
        width : ndarray, m; (...)
        slope : ndarray, of the tilt; (...)
        moment : ndarray, int x p dx of the pressure about the middle [N]; (...); None: the slope is given
        """
        return cls((np.asarray(slope),), (False, False), width, moment)

    @classmethod
    def wedge(cls, slope: Array, corner: str = "leading") -> Self:
        """Triangular punch, rising from its corner to the other edge.

        Parameters
        ----------
        slope : ndarray, > 0; (...)
        corner : {"leading", "trailing"}, the edge at which it is
        """
        return cls((slope,), (True, False)) if corner == "leading" else cls((-slope,), (False, True))

    @classmethod
    def half_cylinder(cls, radius: Array, corner: str = "leading") -> Self:
        """Half of the cylinder with its corner, and lowest point, at an edge.

        Parameters
        ----------
        radius : ndarray, m; (...)
        corner : {"leading", "trailing"}, the edge at which it is
        """
        return cls((np.zeros(()), 1 / radius), (corner == "leading", corner != "leading"))

    @property
    def homogeneous(self) -> bool:
        """True if the slope is one power of x, so that contacts under all loads are similar."""
        return self.width is None and not any(np.any(c) for c in self.slope[:-1])

    def part(self, places: slice | Indices, size: tuple[int, ...]) -> Self:
        """Some of the cases of a size.

        Parameters
        ----------
        places
            Which cases, of all in a row.
        size
            Sizes of the cases' axes; (...).

        Examples
        --------
        >>> Profile.cylinder(np.array([0.05, 0.1, 0.2])).part(slice(1, 3), (3,)).slope[-1].size
        2
        """
        return self._changed(lambda values, _: np.broadcast_to(values, size).ravel()[places])

    def in_units_of(self, length: Array) -> Self:
        """The profile with all lengths over one; (...).

        Examples
        --------
        >>> Profile.cylinder(np.array(0.05)).in_units_of(np.array(1e-3)).slope[-1].item()
        0.02
        """
        return self._changed(lambda values, power: values * length**power)

    def _changed(self, change: Callable[[Array, int], Array]) -> Self:
        """Return the profile with ``change`` of each parameter and of the power of a length that cancels its unit."""
        width, moment = (
            None if values is None else np.asarray(change(values, power))
            for values, power in ((self.width, -1), (self.moment, -2))
        )
        slope = tuple(np.asarray(change(values, power)) for power, values in enumerate(self.slope))
        return type(self)(slope, self.smooth, width, moment)
