"""Reading of an electrode and its patches, from the factors of cases."""

import numpy as np

from solver.arrays import Array, BoolArray
from solver.face.cases import Cases
from solver.names import CHOICES
from solver.stack.electrodes import DISC, STRIP, Reading


def reading_of(cases: Cases) -> Reading | None:
    """Return the reading of the cases, None without a ``collector``."""
    if "collector" not in cases.values:
        return None
    axes = tuple(cases.sizes.values())

    def flat(name: str) -> Array:
        return np.asarray(np.broadcast_to(cases.number(name), axes).ravel(), dtype=np.float64)

    size, pitch = (flat(name) if name in cases.values else None for name in ("patch_size", "patch_pitch"))
    usual = CHOICES["patch"][STRIP if cases.kind.contact == "line" else DISC]
    is_strip = np.asarray(cases.values.get("patch", np.array(usual))) == CHOICES["patch"][STRIP]
    shapes = np.broadcast_to(np.where(is_strip, STRIP, DISC), axes).ravel()
    return Reading(flat("collector"), shapes, flat("patch_position"), size, pitch)


def electroded(cases: Cases) -> BoolArray:
    """Return True for cases with an electrode without stiffness on the film; (...)."""
    return cases.among("electrode", "top")
