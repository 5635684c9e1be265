"""What fields in the plane of symmetry take of the waves below a point contact, by Bessel function (points, 7).

A surface wave in the direction A has the sagittal fields of the plane problem, in the frame of A. Summed over A,
scalars take J_0 and what points along x takes J_1; the stresses in the surface turn with A and take J_0 and J_2. The
part that goes with cos(angle) has one order more, and the shear waves along the crests, of (k u, tau).
"""

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.halfplane.interior import LINEAR, field_rows
from solver.halfplane.potentials import POTENTIALS
from solver.point.shear import Sheared
from solver.stack.fourier import Medium
from solver.stack.layerwaves import TURN

#: Bessel functions J_0 to J_3.
ORDERS = 4

_ALONG = (
    "stress_xy",
    "electric_displacement_x",
    "magnetic_induction_x",
    "electric_field_x",
    "magnetic_field_x",
    "strain_xy",
)
_TURNING = ("stress_xx", "stress_zz", "strain_xx")


def rows_of(medium: Medium, scale: Array, names: tuple[str, ...], *, sliding: bool) -> Array:
    """What fields of ``LINEAR`` take of the real form [k u; t], units of the body; (order, field, 8), SI.

    Potentials are times k.
    """
    half = medium.halfplane
    units = np.concatenate([scale, 1 / scale]) / np.concatenate([half.scale, 1 / half.scale])
    plane = field_rows(half) * units * TURN
    out = np.zeros((ORDERS, len(names), 8))
    for place, name in enumerate(names):
        if name in POTENTIALS:
            channel = 2 + tuple(POTENTIALS).index(name)
            out[1 if sliding else 0, place, channel] = scale[channel]
            continue
        own = plane[LINEAR.index(name)]
        if name in _ALONG:
            turned = (1j * own).real
            if sliding:
                out[[0, 2], place] = -turned / 2, turned / 2
            else:
                out[1, place] = turned
        elif name in _TURNING:
            across = plane[LINEAR.index("stress_zz")] if name != "strain_xx" else np.zeros(8)
            along = plane[LINEAR.index("stress_xx")] if name != "strain_xx" else own
            mean, half_difference = ((along + across) / 2).real, ((along - across) / 2).real
            if name == "stress_zz":
                half_difference = -half_difference
            if sliding:
                out[[1, 3], place] = mean + half_difference / 2, -half_difference / 2
            else:
                out[[0, 2], place] = mean, -half_difference
        else:
            out[1 if sliding else 0, place] = own.real
    return out


def shear_rows(body: Sheared, names: tuple[str, ...]) -> Array:
    """What they take of (k u, tau) of the shear waves of tau = 1 per traction along x; (order, field, 2), SI."""
    out = np.zeros((ORDERS, len(names), 2))
    of_stretch = {"stress_xx": -body.along / 2, "stress_zz": body.along / 2, "strain_xx": -0.25}
    of_shear = {"stress_xy": 0.5, "strain_xy": 0.25 / body.across}
    for place, name in enumerate(names):
        if name in of_stretch:
            out[[1, 3], place, 0] = of_stretch[name]
        elif name in of_shear:
            out[[0, 2], place, 1] = of_shear[name]
    return out


def parted(names: tuple[str, ...]) -> list[tuple[Indices, bool]]:
    """Places of the fields that are no potentials, and of the potentials, which lack the k of the others' integrals."""
    potentials = np.array([name in POTENTIALS for name in names], dtype=bool)
    parts = [(np.flatnonzero(~potentials), False), (np.flatnonzero(potentials), True)]
    return [part for part in parts if part[0].size]
