"""The first critical speed of steady sliding on a film: that of the slowest wave that runs freely under the punch."""

from collections.abc import Callable

import numpy as np

from solver.arrays import Array
from solver.halfplane.speed import transonic_speed
from solver.material.constants import MaterialError
from solver.stack.layers import Stack
from solver.stack.reflection import waves

_SCAN = 64  # speeds
_HALVINGS = 30
_WAVES = np.geomspace(1e-3, 30.0, 120)  # wavenumbers times the thickness of the top layer, and below all
_SHORT_OF = 1 - 1e-6  # at a transonic speed itself the responses are not defined


@np.errstate(all="ignore")  # beyond the critical speed responses may be anything
def critical_speed(stack: Stack, conducts: tuple[bool, bool] = (True, True)) -> float:
    """First critical speed [m/s]: the least of the transonic speeds and of the free waves under the punch's conduction.

    A wave of wavenumber k runs freely at V where 1/lam(k; V) falls to zero, lam the compliance of the surface with what
    the punch conducts held at zero. In a film that depends on k; at large k it is the surface wave of the top material,
    at small k that of the base.
    """
    bodies = [layer.material for layer in stack.layers]
    bodies += [] if isinstance(stack.base, str) else [stack.base]
    for body in bodies:
        if np.any(np.isnan(body.rho)):
            raise MaterialError(f"{body.name}: rho: missing; a speed needs the density [kg m-3]")
    transonic = float(min(transonic_speed(body) for body in bodies)) * _SHORT_OF
    free = _stiffness(stack, conducts)
    below = 0.0
    for speed in np.linspace(0.0, transonic, _SCAN + 1)[1:].tolist():
        if not free(speed) > 0:
            above = speed
            for _ in range(_HALVINGS):
                middle = (below + above) / 2
                below, above = (middle, above) if free(middle) > 0 else (below, middle)
            return below
        below = speed
    return transonic


def _stiffness(stack: Stack, conducts: tuple[bool, bool]) -> Callable[[float], float]:
    """The least 1/lam over the waves at a speed."""
    scaled: Array = _WAVES / stack.top.thickness
    k = np.concatenate([1e-3 / stack.thickness * np.array([1e-3, 1e-2, 0.1]), scaled, scaled * 0.1])
    held = [1 + number for number, conducted in enumerate((True, *conducts)) if conducted]

    def least(speed: float) -> float:
        moving = Stack(stack.layers, stack.base, speed)
        Y = moving.media[0].compliance + waves(moving, k)[0].difference
        inverse = np.linalg.inv(Y[:, held][:, :, held])
        return float(np.min(inverse[:, 0, 0]))

    return least
