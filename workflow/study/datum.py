"""The datum of a study: the arbitrary length of a half-plane's logarithmic potentials, and what hangs on it."""

from solver.names import EVERY_QUANTITY, FACTORS
from workflow.study.model import Study

#: Names of the quantities that change with the datum.
HANGING = frozenset(name for name, one in EVERY_QUANTITY.items() if one.on_datum)


def length(study: Study) -> float | None:
    """The datum of every case [m]; None where it is a factor."""
    if "datum" in study.factors:
        return None
    return float(study.fixed.get("datum", FACTORS["datum"].default or 1.0))
