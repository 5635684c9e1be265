"""The laws by which composites are made: one entry each, whose name and factor stand in ``solver.names.COMPOSITES``."""

from collections.abc import Callable

from approximation.arrays import Array
from solver.material.alloy import aluminium_scandium_nitride
from solver.material.composite import fibrous, laminate
from solver.material.constants import Material, MaterialError
from solver.names import COMPOSITES

#: The two phases of a composite.
Phases = tuple[Material, Material]

_LAWS: dict[str, Callable[[Phases, float | Array], Material]] = {
    "fibrous": lambda phases, fraction: fibrous(*phases, fraction),
    "laminate": lambda phases, fraction: laminate(*phases, fraction),
    "AlScN": lambda _, fraction: aluminium_scandium_nitride(fraction),
}


def made(composite: str, phases: Phases, fraction: float | Array) -> Material:
    """The composite of a name.

    Parameters
    ----------
    composite
        A name in ``solver.names.COMPOSITES``.
    phases
        Phase one and phase two; a law in ``COMPOSITES`` that is not in ``MIXTURES`` leaves them aside.
    fraction
        The factor that the law takes, ``COMPOSITES[composite]`` [1]; (...).

    Raises
    ------
    MaterialError
        A composite that has no law, and what the law itself refuses.
    """
    if composite not in _LAWS:
        raise MaterialError(f"composite: {composite!r} is not one of {', '.join(COMPOSITES)}")
    return _LAWS[composite](phases, fraction)
