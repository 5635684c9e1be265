"""Contacts by spectral elements of rising order: their checks at the highest, and how their error falls."""

from collections.abc import Callable, Mapping
from typing import Protocol

from verification.findings import Check, Curve, Sizes, check


class Refined(Protocol):
    """A case by the solver and by elements of one order."""

    @property
    def compared(self) -> Mapping[str, tuple[str, float]]:
        """Words and tolerance at order 10 of each compared quantity."""

    def error(self, what: str) -> float:
        """Error of one of these."""


def orders_of(sizes: Sizes) -> list[int]:
    """Orders of the polynomials, rising."""
    return list(range(4, 3 + sizes.elements // 6, 2))


def refined(
    figure: str, shown: str, contacts: Mapping[str, Callable[[int], Refined]], sizes: Sizes
) -> tuple[list[Check], list[Curve]]:
    """Checks at the highest order, and curves of one error over all orders."""
    orders = orders_of(sizes)
    slack = 10 ** ((10 - orders[-1]) / 2)
    checks, curves = list[Check](), list[Curve]()
    for name, of_order in contacts.items():
        rising = [of_order(order) for order in orders]
        checks += [
            check(f"{what}: {name}", text, tolerance * slack, rising[-1].error, what)
            for what, (text, tolerance) in rising[-1].compared.items()
        ]
        errors = [contact.error(shown) for contact in rising]
        curves.append(Curve(figure, name, "order of the polynomials", orders, errors))
    return checks, curves
