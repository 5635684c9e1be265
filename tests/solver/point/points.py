"""Point contacts that the tests of the room share."""

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.material.constants import Material
from solver.point.body import Film
from solver.point.contact import Pressed
from solver.point.profile import Shape
from solver.point.table import PointKind
from solver.stack.layers import RIGID, Layer, Stack


def film(material: Material, base: Material | None = None, **interface: Any) -> Stack:
    """One layer of unit thickness on a base, rigid without one."""
    return Stack([Layer(material, 1.0, **interface)], RIGID if base is None else base)


def on_film(layers: Stack, exponent: float, coefficient: float, force: Array) -> Pressed:
    """Contacts without charges on films of unit thickness."""
    kind, count = PointKind(layers, (True, True), Shape(exponent)), force.shape
    body, conducts = Film(kind, np.ones(count)), np.array([True, True])
    return Pressed(body, kind.scale, np.full(count, coefficient), force, np.zeros((*count, 2)), conducts)
