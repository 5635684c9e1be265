"""Heat from a warm punch into layers, through its contact and the air beside it (docs/heat.md, Contact and Charge).

The surface is cut into rings (under a line: pairs of strips), narrow at the contact's edge. In the modes of conduction
along them, punch and layers have admittances in closed form.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy  # scipy.interpolate, slow to import, and few jobs ask for heat

from approximation.arrays import Array
from solver.heat.conduction import Conduction, in_time, laplace

# rings in the contact and beside it: errors of charges 5e-3, on a far patch that heat has just reached 1e-2
_INSIDE, _OUTSIDE = 20, 48
_FIRST = 0.02  # width of the rings at the edge over the radius, or over the diffusion length if that is less
_FAR = 8.0  # diffusion lengths beside the contact
_PARTS = 4  # of a ring that lies partly over a patch
_AIR = 0.0257  # W/m/K at 20 degC
# m: both faces' jumps of temperature as a gap, at an accommodation of 0.9 (E. Kennard, Kinetic Theory of Gases, 1938)
_JUMP = 2.7e-7

Shape = Literal["disc", "strip"]


@dataclass(frozen=True)
class Spot:
    """Contact through which heat flows."""

    shape: Shape  # disc of a point contact, strip of a line contact
    half_width: float  # radius, half of a width [m]
    punch: tuple[float, float] | None = None  # conductivity [W/m/K], heat capacity [J/m3/K]; None: a perfect conductor
    radius: float | None = None  # of a ball or roller with air around its contact [m]

    @property
    def area(self) -> float:
        """Area of a disc [m2], or width of a strip [m]."""
        return np.pi * self.half_width**2 if self.shape == "disc" else 2 * self.half_width

    def gap(self, r: Array) -> Array:
        """Hertz's gap below a ball or roller at distances r, infinite without air [m]; of the shape of ``r``."""
        x = np.maximum(r / self.half_width, 1.0)
        if self.radius is None:
            return np.where(x > 1, np.inf, 0.0)
        root = np.sqrt(x**2 - 1)
        disc = self.shape == "disc"
        shape = (root + (x**2 - 2) * np.arccos(1 / x)) / np.pi if disc else (x * root - np.arccosh(x)) / 2
        return np.where(r < self.radius, self.half_width**2 / self.radius * shape, np.inf)


@dataclass(frozen=True)
class Patch:
    """Part of an electrode that collects charge."""

    shape: Shape
    half_width: float  # [m]
    distance: float = 0.0  # of its middle from that of the contact [m]

    @property
    def ends(self) -> tuple[float, float]:
        """Distances from the contact's middle between which rings lie partly over the patch [m]."""
        return abs(self.half_width - abs(self.distance)), self.half_width + abs(self.distance)

    def share(self, r: Array, line: bool) -> Array:
        """Share of rings of radii r (r,) [m], or of pairs of strips, that lies over the patch; (r,)."""
        low, high = self.distance - self.half_width, self.distance + self.half_width
        if line:
            return (((low < r) & (r < high)).astype(float) + ((low < -r) & (-r < high))) / 2
        if self.shape == "strip":
            return np.asarray(np.arccos(np.clip(low / r, -1, 1)) - np.arccos(np.clip(high / r, -1, 1))) / np.pi
        distance = max(abs(self.distance), 1e-9 * self.half_width)
        cosine = (r**2 + distance**2 - self.half_width**2) / (2 * r * distance)
        return np.asarray(np.arccos(np.clip(cosine, -1, 1))) / np.pi


@dataclass(frozen=True, eq=False)
class Warmed:
    """Charge of warm layers below a contact, by the distance from its middle."""

    spot: Spot
    edges: Array  # of the rings [m]; (ring + 1,)
    means: Array  # charge per area of each ring, per kelvin of the punch [C m-2 K-1]; (ring,)

    @classmethod
    def after(cls, body: Conduction, weights: Array, spot: Spot, time: float, leak: float = np.inf) -> "Warmed":
        """Return layers of ``weights`` (charge per area and kelvin) at a time after a punch 1 K warmer touched."""
        diffusivity, r = body.conductivity / body.capacity, spot.half_width
        fastest = max(diffusivity.max(), spot.punch[0] / spot.punch[1]) if spot.punch else diffusivity.max()
        first = _FIRST * min(r, float(np.sqrt(diffusivity.min() * time)))
        outer = r + _graded(_FAR * float(np.sqrt(fastest * time)), first, _OUTSIDE)
        edges = np.concatenate([(r - _graded(r, first, _INSIDE))[:0:-1], outer])
        edges[0] = 0.0
        middles, areas = (edges[1:] + edges[:-1]) / 2, _areas(edges, spot)
        crossed = 2 * np.pi * edges[1:-1] if spot.shape == "disc" else np.full(len(middles) - 1, 2.0)
        links = np.pad(crossed / np.diff(middles), 1)
        conduction = np.diag(links[1:] + links[:-1]) - np.diag(links[1:-1], 1) - np.diag(links[1:-1], -1)
        root = np.sqrt(areas)
        squares, modes = np.linalg.eigh(conduction / np.outer(root, root))
        k = np.sqrt(np.maximum(squares, 0.0))

        s = laplace(time)
        admittance, transfers = body.transfers(k, s)
        impedance = 1 / admittance
        if spot.punch:
            conductivity, capacity = spot.punch
            impedance = impedance + 1 / (conductivity * np.sqrt(k[:, None] ** 2 + s * (capacity / conductivity)))
        gap = spot.gap(middles)
        passing = np.isfinite(gap)
        resistance = np.where(gap > 0, gap + _JUMP, 0.0)[passing] / _AIR
        passing_modes, charge_per_flux = modes[passing], np.tensordot(weights, transfers, 1) / admittance
        parts = np.concatenate([impedance.real.T, impedance.imag.T])  # faster than products of complex numbers
        real, imaginary = np.split((passing_modes * parts[:, None]) @ passing_modes.T, 2)
        step = root[passing] / (s[:, None] + 1 / leak)
        flux = np.linalg.solve(real + np.diag(resistance) + 1j * imaginary, step[..., None])[..., 0]
        means = modes @ (charge_per_flux * (passing_modes.T @ flux.T)) / root[:, None]
        return cls(spot, edges, in_time(means, time))

    def over(self, patch: Patch | None) -> float:
        """Charge per kelvin of the punch on a patch or an unbounded electrode [C/K], along a line [C m-1 K-1]."""
        if patch is None:
            return float(_areas(self.edges, self.spot) @ self.means)
        r, charges = self._parts(patch.ends)
        return float(charges @ patch.share(r, self.spot.shape == "strip"))

    def on_punch(self, film_gap: float) -> float:
        """Charge per kelvin on a punch that is the electrode, also through air [C/K], along a line [C m-1 K-1]."""
        r, charges = self._parts((self.spot.half_width,))
        gap = self.spot.gap(r)
        exterior = gap > 0
        return float(charges[~exterior].sum() + charges[exterior] @ (film_gap / (film_gap + gap[exterior])))

    def _parts(self, ends: tuple[float, ...]) -> tuple[Array, Array]:
        """Cut rings into parts, at ``ends`` [m] too, and return the parts' middles [m] and charges; (part,) each."""
        rings = np.arange(len(self.edges))
        parts = np.interp(np.arange(_PARTS * rings[-1] + 1) / _PARTS, rings, self.edges)
        parts = np.unique(np.concatenate([parts, [end for end in ends if end < parts[-1]]]))
        cumulative = np.append(0.0, np.cumsum(_areas(self.edges, self.spot) * self.means))
        charges = np.diff(scipy.interpolate.CubicSpline(self.edges, cumulative)(parts))
        return (parts[1:] + parts[:-1]) / 2, charges


def _graded(length: float, first: float, count: int) -> Array:
    """Edges of cells from 0 to a length [m], the first one of width ``first`` and growing; (count + 1,)."""
    growth = np.log1p(length / first)
    return np.asarray(length * np.expm1(growth * np.linspace(0, 1, count + 1)) / np.expm1(growth))


def _areas(edges: Array, spot: Spot) -> Array:
    """Areas of rings [m2], or widths of pairs of strips [m]; (ring,)."""
    return np.pi * np.diff(edges**2) if spot.shape == "disc" else 2 * np.diff(edges)
