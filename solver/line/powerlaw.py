"""Composites whose volume fraction is a power of depth: graded films as plain numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.material.constants import ANY_SIZE, UNITS, Material
from solver.material.laws import compose
from solver.stack.layers import StackError

#: Constants in the order of ``solver.material.constants.UNITS``, None where unknown: NaN never equals itself; then 1 of
#: a conductor, 0 of others.
Constants = tuple[float | None, ...]

#: From this exponent on three derivatives exist at the surface, whatever it is.
SMOOTH = 4.0


def material_from(constants: Constants, name: str) -> Material:
    """The material of constants."""
    *values, conductor = constants
    values_of: dict[str, Any] = {
        key: np.array(np.nan if value is None else value) for key, value in zip(UNITS, values, strict=True)
    }
    return Material(**values_of, conductor=np.array(bool(conductor)), name=name, any_size=ANY_SIZE)


def constants_of(material: Material) -> Constants:
    """The constants of a material without case axes."""
    material.require_axial()
    values = {key: float(getattr(material, key)) for key in UNITS}
    known = (None if np.isnan(value) else value for value in values.values())
    return (*known, float(material.conductor))


@dataclass(frozen=True)
class PowerLaw:
    """Material at depths over thickness: v = surface + (base - surface) depth^exponent."""

    composite: str  # One of ``solver.names.MIXTURES``
    phases: tuple[Constants, Constants]  # Constants of phase one and phase two
    # Volume fractions at the surface and at the base, within 0 to 1
    surface: float
    base: float
    exponent: float  # A whole number from 1 on, or any from 4 on

    def __post_init__(self) -> None:
        if not (self.exponent >= SMOOTH or self.exponent in (1.0, 2.0, 3.0)):
            raise StackError(
                f"grading_exponent: {self.exponent:g} is not 1, 2, 3 or >= {SMOOTH:g} [1]: "
                "the material would not be a smooth function of depth at the surface"
            )

    def __call__(self, depth: Array) -> Material:
        """The composite at depths over thickness, 0 to 1."""
        fraction = self.surface + (self.base - self.surface) * depth**self.exponent
        first, two = (material_from(constants, "phase") for constants in self.phases)
        return compose(self.composite, (first, two), fraction)
