"""Comparisons of the solver with independent methods, for pytest and the page of ``make run STUDY=verification``."""

from collections.abc import Callable

from verification import digits, film_elements, films, integral_equations, limits, points
from verification.findings import Findings, Sizes

#: The groups by their names in ``workflow.study.model``, in the order of the page.
GROUPS: dict[str, Callable[[Sizes], Findings]] = {
    "limits": limits.run,
    "integral_equations": integral_equations.run,
    "films": films.run,
    "film_elements": film_elements.run,
    "film_air": film_elements.run_in_air,
    "points": points.run,
    "digits": digits.run,
}

__all__ = ["GROUPS", "Findings", "Sizes"]
