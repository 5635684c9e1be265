"""The laws by which composites are made: one entry each, whose name and factor stand in ``solver.names.COMPOSITES``."""

from collections.abc import Callable, Sequence

from approximation.arrays import Array
from solver.material.alloy import aluminium_scandium_nitride
from solver.material.composite import fibrous, laminate
from solver.material.constants import Material, MaterialError
from solver.names import COMPOSITES

#: The two phases of a composite; none of one that is not in ``solver.names.MIXTURES``.
Phases = Sequence[Material]

_LAWS: dict[str, Callable[[Phases, float | Array], Material]] = {
    "fibrous": lambda phases, fraction: fibrous(phases[0], phases[1], fraction),
    "laminate": lambda phases, fraction: laminate(phases[0], phases[1], fraction),
    "AlScN": lambda _, fraction: aluminium_scandium_nitride(fraction),
}


def compose(composite: str, phases: Phases, fraction: float | Array) -> Material:
    """The composite of a name."""
    if composite not in _LAWS:
        raise MaterialError(f"composite: {composite!r} is not one of {', '.join(COMPOSITES)}")
    return _LAWS[composite](phases, fraction)
