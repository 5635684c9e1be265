"""Pressed surfaces of any cut, half-spaces and films: nested elliptical punches instead of a grid of cells.

Pressure and charge are continua of concentric rigid punches, whose potentials are Weber-Schafheitlin integrals. The
contact is an ellipse with a centre, two semi-axes and a direction: Newton's method removes the singularity of the
pressure at its edge in the harmonics 0, 1 and 2. Half-spaces follow from Barnett and Lothe's integrals, films from
Galerkin's method through the depth. The module shares only the materials' constants with the solver.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev, legendre
from numpy.typing import ArrayLike, NDArray
from scipy.special import hyp2f1, jv, rgamma, spherical_jn

from verification.oracles.surface_response import Array, angular_integrals

Complex = NDArray[np.complex128]

STRESS, DISPLACEMENT_FIELD, POTENTIAL = 1e11, 10.0, 1e10  # units with all constants of order one [Pa, C/m2, V/m]
VACUUM = 8.8541878128e-12
_VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_AZIMUTHS = 32  # of wave vectors; the series of lithium niobate's response ends at 1e-9
_DEEP = 16.0  # wavenumber times thickness from which a film is its half-space: exp(-2 x 16)
_DEPTHS = 40  # wavenumbers of a film's table
_DEGREE = 12  # of polynomials through a third of the film
_DISTANCES = (0.65, 0.35, 0.15, 0.05, 0.015, 0.004, 0.001)  # from the edge, where the layer of air is thin
_NODES = 5  # of a panel
_NEWTON = 20  # steps at most
_HALVINGS = 4
_SETTLED = 1e-8  # change of the gap over the depth
_TURN = 256  # angles of the series of an ellipse's response
_SMOOTH = 1e-7  # singular pressure at the edge over the mean density
_SPLIT = 16  # quadrature nodes to each side of a cusp


# --- bodies ---


def tensor(stiffness: ArrayLike, piezo: ArrayLike, permittivity: ArrayLike, axes: ArrayLike | None = None) -> Array:
    """Generalised stiffness E_iJKl in scaled units, shape (3, 4, 4, 3).

    stiffness, piezo: Voigt's (6, 6) and (3, 6) in SI; axes: rows are the surface's x, y and normal in the crystal.
    """
    turn = np.eye(3) if axes is None else np.asarray(axes, dtype=np.float64)
    c = np.einsum("ia,jb,kc,ld,abcd->ijkl", turn, turn, turn, turn, np.asarray(stiffness)[_VOIGT][:, :, _VOIGT])
    e = np.einsum("ia,jb,kc,abc->ijk", turn, turn, turn, np.asarray(piezo)[:, _VOIGT])
    whole = np.zeros((3, 4, 4, 3))
    whole[:, :3, :3] = c / STRESS
    whole[:, :3, 3] = np.moveaxis(e, 0, 2) / DISPLACEMENT_FIELD
    whole[:, 3, :3] = e / DISPLACEMENT_FIELD
    whole[:, 3, 3] = -turn @ np.asarray(permittivity) @ turn.T * (POTENTIAL / DISPLACEMENT_FIELD)
    return whole


def _blocks(whole: Array, azimuth: float) -> tuple[Array, Array, Array]:
    """Q = m.E.m, R = m.E.n and N = n.E.n for wave vectors along m, shape (4, 4) each."""
    m = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    return np.einsum("i,iJKl,l->JK", m, whole, m), np.einsum("i,iJK->JK", m, whole[..., 2]), whole[2, :, :, 2]


def half_space(whole: Array, azimuths: ArrayLike) -> Complex:
    """Y of k U = Y T over (x, y, z, phi), shape (azimuth, 4, 4)."""
    parts = [angular_integrals(*_blocks(whole, azimuth)) for azimuth in np.atleast_1d(azimuths)]
    return np.array([inverse - 1j * local for local, inverse in parts])


def film(whole: Array, depths: ArrayLike, azimuths: ArrayLike, base: Array | None = None) -> Complex:
    """Y of a film on a grounded base, rigid by default, shape (wavenumber times thickness, azimuth, 4, 4)."""
    depths, azimuths = np.atleast_1d(depths).astype(np.float64), np.atleast_1d(azimuths)
    stretch, slope, mass = _lines()
    result = np.empty((depths.size, len(azimuths), 4, 4), dtype=np.complex128)
    for a, azimuth in enumerate(azimuths):
        Q, R, N = _blocks(whole, azimuth)
        cross = np.kron(slope, R.T)
        below = None if base is None else np.linalg.inv(half_space(base, azimuth)[0])[:3, :3]
        for d, depth in enumerate(depths):
            system = np.kron(stretch, N) + 1j * depth * (cross - cross.T) + depth**2 * np.kron(mass, Q)
            free = list(range(4, len(system)))
            if below is not None:
                system[:3, :3] += depth * below
                free = [0, 1, 2, *free]
            right = np.zeros((len(free), 4))
            right[-4:] = np.eye(4)
            result[d, a] = depth * np.linalg.solve(system[np.ix_(free, free)], right)[-4:]
    return result


@lru_cache(maxsize=1)
def _lines() -> tuple[Array, Array, Array]:
    """Integrals of v'u', v'u and vu over nodal functions of z in (0, 1), three elements."""
    nodes = -np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE)
    x, w = legendre.leggauss(_DEGREE + 2)
    basis = np.linalg.inv(chebyshev.chebvander(nodes, _DEGREE))
    value = chebyshev.chebvander(x, _DEGREE) @ basis
    steep = chebyshev.chebval(x, chebyshev.chebder(basis)).T
    ends = np.array([0.0, 0.6, 0.9, 1.0])  # the surface is at 1, where short waves end
    size = _DEGREE * (len(ends) - 1) + 1
    stretch, slope, mass = np.zeros((3, size, size))
    for number, length in enumerate(np.diff(ends)):
        block = np.ix_(*[range(number * _DEGREE, (number + 1) * _DEGREE + 1)] * 2)
        stretch[block] += (steep.T * w) @ steep * 2 / length
        slope[block] += (steep.T * w) @ value
        mass[block] += (value.T * w) @ value * length / 2
    return stretch, slope, mass


@dataclass(frozen=True, eq=False)
class Body:
    """Response of (u_z, phi) to (s_zz, D_z), friction included, as series over the azimuth of the wave vector."""

    half: Complex  # shape (azimuth harmonic, 2, 2)
    layers: Complex | None = None  # Chebyshev coefficients of the film's excess, shape (degree, harmonic, 2, 2)
    thickness: float = np.inf


def body(whole: Array, friction: float = 0.0, thickness: float = np.inf) -> Body:
    """Body under a punch that slides along x with a friction coefficient."""
    azimuths = 2 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    pick = np.zeros((4, 2))
    pick[2, 0] = pick[3, 1] = 1.0
    push = pick.copy()
    push[0, 0] = -friction  # s_xz = -eta s_zz: the pressed surface is dragged along x
    above = half_space(whole, azimuths)
    half = pick.T @ above @ push
    if not np.isfinite(thickness):
        return Body(np.fft.fft(half, axis=0) / _AZIMUTHS)
    depths = _DEEP * (1 - np.cos(np.pi * (np.arange(_DEPTHS) + 0.5) / _DEPTHS)) / 2
    layered = film(whole, depths, azimuths[: _AZIMUTHS // 2])
    layered = np.concatenate([layered, layered.conj()], axis=1)  # waves that run the other way
    excess = pick.T @ (layered - above) @ push
    flat = np.fft.fft(excess, axis=1).reshape(_DEPTHS, -1) / _AZIMUTHS
    series = np.linalg.solve(chebyshev.chebvander(2 * depths / _DEEP - 1, _DEPTHS - 1), flat)
    layers = np.asarray(series.reshape(excess.shape), dtype=np.complex128)
    return Body(np.fft.fft(half, axis=0) / _AZIMUTHS, layers, thickness)


# --- nested punches ---


@dataclass(frozen=True, eq=False)
class Nest:
    """Radii of nested punches, densities and potentials of their harmonics, all over the contact's radius."""

    radii: Array  # shape (node,); the last is the edge, whose weight is that of a single punch
    weights: Array
    inside: NDArray[np.bool_]
    densities: Array  # shape (m, place, node); the places are the radii
    potentials: Array  # shape (order, m, place, node), of exp(i m theta) and the order of the Bessel function


@lru_cache(maxsize=4)
def nest(reach: float, harmonics: int, orders: int) -> Nest:
    """Nested punches up to a reach over the contact's radius (1: insulated surroundings)."""
    inner = [0.0, *(1 - np.array(_DISTANCES if reach > 1 else _DISTANCES[:5])), 1.0]
    outer = [1 + d for d in _DISTANCES[::-1]] if reach > 1 else []
    while outer and outer[-1] < reach:
        outer.append(min(1.8 * outer[-1], reach))
    ends = np.array([*inner, *outer])
    x, w = legendre.leggauss(_NODES)
    u, v = (1 + legendre.leggauss(_SPLIT)[0]) / 2, legendre.leggauss(_SPLIT)[1] / 2
    middles, halves = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
    radii = np.append((middles[:, None] + halves[:, None] * x).ravel(), 1.0)
    weights = np.append((halves[:, None] * w).ravel(), 1.0)
    densities = np.zeros((harmonics + 1, radii.size, radii.size))
    potentials = np.zeros((orders + 1, harmonics + 1, radii.size, radii.size))
    lagrange = np.linalg.inv(legendre.legvander(x, _NODES - 1))
    for panel, (low, high) in enumerate(pairwise(ends)):
        cusp = np.clip(radii, low, high)[:, None]
        s = np.hstack([cusp - (cusp - low) * u**2, cusp + (high - cusp) * u**2])
        step = np.hstack([(cusp - low) * 2 * u * v, (high - cusp) * 2 * u * v])
        columns = slice(panel * _NODES, (panel + 1) * _NODES)
        shares = (legendre.legvander((s - middles[panel]) / halves[panel], _NODES - 1) @ lagrange) * step[..., None]
        for m in range(harmonics + 1):
            density = np.where(s > radii[:, None], _density(m, radii[:, None], s), 0.0)
            densities[m, :, columns] = np.einsum("iq,iqj->ij", density, shares)
            for order in range(orders + 1):
                values = s * weber_schafheitlin(order, m, radii[:, None], s)
                potentials[order, m, :, columns] = np.einsum("iq,iqj->ij", values, shares)
    for m in range(harmonics + 1):
        for order in range(orders + 1):
            potentials[order, m, :, -1] = weber_schafheitlin(order, m, radii, np.ones_like(radii))
    return Nest(radii, weights, radii <= 1, densities, potentials)


def _density(m: int, r: Array, s: Array) -> Array:
    """Density (r/s)^m (s^2 - r^2)^(-1/2) of a punch of radius s."""
    return np.asarray((r / s) ** m / np.sqrt(np.maximum(s**2 - r**2, 1e-300)))


def weber_schafheitlin(order: int, m: int, r: Array, s: Array) -> Array:
    """Integral of J_order(k r) j_m(k s) over k from 0 to infinity."""
    r, s = np.broadcast_arrays(r, s)
    near = r < s
    series, nu = _hypergeometric(order, m), m + 0.5
    ratio = np.minimum(r, s) / np.maximum(r, s)
    y = 2 * np.sqrt(1 - ratio**2) - 1
    sum_ = (order + nu + 0.5) / 2
    inner = rgamma(order + 1) * rgamma((nu - order + 1.5) / 2) * ratio**order / s
    outer = rgamma(nu + 1) * rgamma((order - nu + 1.5) / 2) * ratio ** (m + 1) / s
    value = np.where(near, inner * chebyshev.chebval(y, series[0]), outer * chebyshev.chebval(y, series[1]))
    return np.asarray(value / rgamma(sum_) * np.sqrt(np.pi) / 2)


@lru_cache(maxsize=1024)
def _hypergeometric(order: int, m: int) -> tuple[Array, Array]:
    """Chebyshev coefficients of both of Weber and Schafheitlin's functions in (1 - ratio^2)^(1/2), smooth at a cusp."""
    y = (1 + np.cos(np.pi * (np.arange(40) + 0.5) / 40)) / 2
    nu, z = m + 0.5, 1 - y**2
    values = (
        hyp2f1((nu + order + 0.5) / 2, (order - nu + 0.5) / 2, order + 1, z),
        hyp2f1((nu + order + 0.5) / 2, (nu - order + 0.5) / 2, nu + 1, z),
    )
    vander = chebyshev.chebvander(2 * y - 1, 39)
    first, second = (np.asarray(np.linalg.solve(vander, part), dtype=np.float64) for part in values)
    return first, second


# --- contact ---


@dataclass(frozen=True, eq=False)
class Press:
    """A rigid grounded punch of gap x^2 curvatures[0]/2 + y^2 curvatures[1]/2, pressed on a body."""

    body: Body
    curvatures: tuple[float, float]
    force: float
    reach: float = 1.0  # of the charge in air, in semi-axes; 1: insulated surroundings
    end: float = np.inf  # the charge in air is that of the gap over 1 + r^2/end^2 [m]
    harmonics: int = 4

    @property
    def nest(self) -> Nest:
        """Nested punches, with all orders that the angles resolve."""
        return nest(self.reach, self.harmonics, 2 * self.harmonics + 1)

    @property
    def angles(self) -> Array:
        """Angles of the collocation, shape (angle,)."""
        count = 4 * self.harmonics + 4
        return 2 * np.pi * np.arange(count) / count

    @property
    def waves(self) -> Array:
        """Parts cos(m t), m from 0, and -sin(m t), m from 1, at the angles, shape (angle, part)."""
        waves = np.exp(1j * np.outer(self.angles, np.arange(self.harmonics + 1)))
        return np.hstack([waves.real, -waves.imag[:, 1:]])

    def operator(self, axes: Array) -> Array:
        """(u_z, phi) at (place, angle) by (s_zz, D_z) in (part, node), shape (2, place, angle, 2, part, node).

        axes: (2, 2), the map from the unit disc to the contact [m].
        """
        nested, top = self.nest, 2 * self.harmonics + 1
        psi = 2 * np.pi * np.arange(_TURN) / _TURN
        vectors = np.linalg.solve(axes.T, np.array([np.cos(psi), np.sin(psi)]))
        sigma, azimuth = np.hypot(*vectors), np.arctan2(vectors[1], vectors[0])
        waves = np.exp(1j * np.outer(azimuth, np.fft.fftfreq(_AZIMUTHS, 1 / _AZIMUTHS))) / sigma[:, None]
        series = np.fft.fft(np.tensordot(waves, self.body.half, 1), axis=0) / _TURN
        orders = np.arange(-top, top + 1)
        result = np.empty((2, nested.radii.size, self.angles.size, 2, 2 * self.harmonics + 1, nested.radii.size))
        k, excess = self._excess(sigma, waves)
        bessel = [jv(order, np.outer(k, nested.radii)) for order in range(top + 1)]
        for m in range(self.harmonics + 1):
            parts = np.einsum("lab,lij->labij", series[orders - m], nested.potentials[np.abs(orders), m])
            punch = nested.weights * nested.radii * spherical_jn(m, np.outer(k, nested.radii))
            for number, order in enumerate(orders if k.size else ()):
                layered = excess[:, order - m].reshape(k.size, 4).T[:, None, :] * bessel[abs(order)].T
                parts[number] += (layered @ punch).reshape(parts[number].shape)
            turns = (-1j) ** m * 1j ** np.abs(orders)
            field = np.tensordot(np.exp(1j * np.outer(self.angles, orders)) * turns, parts, 1).transpose(1, 3, 0, 2, 4)
            result[..., m, :] = field.real
            if m:
                result[..., self.harmonics + m, :] = -field.imag
        return result

    def _excess(self, sigma: Array, waves: Complex) -> tuple[Array, Complex]:
        """Wavenumbers, and the layers' response there by harmonics of the wave's angle, shape (k, harmonic, 2, 2)."""
        layers, thickness = self.body.layers, self.body.thickness
        if layers is None:
            return np.empty(0), np.empty((0, _TURN, 2, 2), dtype=np.complex128)
        x, w = legendre.leggauss(16)
        highest = _DEEP / thickness / float(sigma.min())
        ends = np.linspace(0.0, highest, 2 + int(highest * self.nest.radii.max() / 8))  # 16 nodes to 16 rad
        k = (ends[:-1, None] + np.diff(ends)[:, None] / 2 * (1 + x)).ravel()
        depth = np.outer(k, sigma) * thickness
        values = chebyshev.chebvander(2 * np.minimum(depth, _DEEP) / _DEEP - 1, len(layers) - 1)
        values[depth > _DEEP] = 0.0
        excess = np.einsum("kpn,nhab,ph->kpab", values, layers, waves, optimize=True)
        weights = (np.diff(ends)[:, None] / 2 * w).ravel() / _TURN
        return k, np.asarray(np.fft.fft(excess, axis=1) * weights[:, None, None, None])

    def solve(self, centre: Array, axes: Array, before: "State | None" = None) -> "State":
        """Tractions under a given ellipse, by Newton's iteration on the gap; edges keep their singularity."""
        nested, parts = self.nest, self.waves
        scale, count = float(np.sqrt(np.linalg.det(axes))), parts.shape[1]
        unit = nested.radii[:, None] * np.array([np.cos(self.angles), np.sin(self.angles)])[:, None]
        where = np.einsum("ab,bik->aik", axes, unit) + centre[:, None, None]
        profile = np.einsum("a,aik->ik", np.asarray(self.curvatures) / 2, where**2) / scale
        air = (1 + (where**2).sum(axis=0) / self.end**2) / (VACUUM * POTENTIAL / DISPLACEMENT_FIELD)
        pressed = nested.inside
        charged = pressed if self.reach <= 1 else np.ones_like(pressed)
        columns = np.stack([np.broadcast_to(part, (count, pressed.size)) for part in (pressed, charged)])
        # unknowns: weights of the punches, and the depth; equations: heights, potentials and the force
        field = np.zeros((3, *profile.shape, int(columns.sum()) + 1))  # heights, potentials, charges
        field[:2, ..., :-1] = self.operator(axes)[..., columns] / scale
        field[0, ..., -1] = 1.0
        density = np.einsum("kh,hij->ikhj", parts, nested.densities[self._orders])
        field[2, ..., count * int(pressed.sum()) : -1] = density[..., charged].reshape(*profile.shape, -1)
        total = np.zeros(field.shape[-1])
        total[: int(pressed.sum())] = (2 * np.pi * nested.weights * nested.radii)[pressed]
        project = np.linalg.pinv(parts)

        def harmonics(values: Array) -> Array:
            """Harmonics of values at (place, angle, ...), shape (place times part, ...)."""
            return np.moveaxis(np.tensordot(project, values, (1, 1)), 0, 1).reshape(-1, *values.shape[2:])

        heights, level = harmonics(field[0][pressed]), harmonics(profile[pressed])
        gap, charge = np.zeros((2, *profile.shape)) if before is None else (before.gap / scale, before.charge_field)
        for _ in range(_NEWTON):
            opened = np.where(~pressed[:, None] & (gap > 0), air, 0.0)
            law = field[1] - (opened * gap)[..., None] * field[2] + (opened * charge)[..., None] * field[0]
            known = opened * charge * (profile - gap)
            right = np.concatenate([level, harmonics(known[charged]), [-self.force / STRESS / scale**2]])
            solution = np.linalg.solve(np.vstack([heights, harmonics(law[charged]), total]), right)
            last, gap, charge = gap, profile - field[0] @ solution, field[2] @ solution
            if np.max(np.abs(gap - last)[charged & ~pressed], initial=0.0) < _SETTLED * solution[-1]:
                break
        values = np.zeros(columns.shape)
        values[columns] = solution[:-1]
        return State(self, centre, axes, values, float(solution[-1]) * scale, gap * scale, charge)

    @property
    def _orders(self) -> list[int]:
        """Order m of each part."""
        return [*range(self.harmonics + 1), *range(1, self.harmonics + 1)]

    def contact(self) -> "State":
        """Tractions under the ellipse without singular pressure in the harmonics 0, 1 and 2."""
        if self.reach > 1:  # air changes the contact little
            first = replace(self, reach=1.0).contact()
            shape = np.array([*first.centre, *first.axes[[0, 1, 0], [0, 1, 1]]])
        else:
            mean = float(np.sqrt(self.curvatures[0] * self.curvatures[1]))
            size = (3 * self.force * float(self.body.half[0, 0, 0].real) / STRESS / 8 / mean) ** (1 / 3)
            slender = (self.curvatures[0] / self.curvatures[1]) ** (1 / 3)  # semi-axes follow this power within 10 %
            shape = np.array([0.0, 0.0, 1 / slender, slender, 0.0]) * size
        before: State | None = None

        def edges(shape: Array) -> tuple[State, Array]:
            """State under an ellipse, and the singular pressure at its edge over the mean density."""
            state = self.solve(shape[:2], shape[[[2, 4], [4, 3]]], before)
            part = self.harmonics + np.arange(1, 3)
            edge = state.values[0, [0, 1, 2, *part], -1]
            return state, edge / np.sqrt((state.values[0, 0] ** 2).mean())

        state, wrong = edges(shape)
        slopes, fast = np.zeros((5, 5)), False
        for _ in range(_NEWTON):
            before = state
            if np.max(np.abs(wrong)) < _SMOOTH:
                return state
            if not fast:
                size = 1e-4 * float(np.sqrt(shape[2] * shape[3]))
                slopes = np.array([(edges(shape + d)[1] - wrong) / size for d in size * np.eye(5)]).T
            step = -np.linalg.solve(slopes, wrong)
            step *= min(1.0, 0.3 * float(np.min(shape[2:4])) / float(np.max(np.abs(step))))
            for _ in range(_HALVINGS):
                state, fresh = edges(shape + step)
                if np.abs(fresh).max() < np.abs(wrong).max():
                    break
                step = step / 2
            fast = bool(np.abs(fresh).max() < 0.3 * np.abs(wrong).max())
            slopes += np.outer(fresh - wrong - slopes @ step, step) / (step @ step)  # Broyden's
            shape, wrong = shape + step, fresh
        raise RuntimeError("the ellipse of the contact is not found")


@dataclass(frozen=True, eq=False)
class State:
    """A solved press."""

    press: Press
    centre: Array  # m
    axes: Array  # shape (2, 2), from the unit disc to the contact [m]
    values: Array  # weights of the punches, shape (2, part, node), scaled
    depth: float  # m
    gap: Array  # shape (place, angle), m
    charge_field: Array  # D_z, shape (place, angle), scaled

    @property
    def semi_axes(self) -> Array:
        """Semi-axes, the larger first [m]."""
        return np.asarray(np.linalg.svd(self.axes)[1])

    @property
    def charge(self) -> float:
        """Charge of the punch [C]."""
        nested = self.press.nest
        total = float((2 * np.pi * nested.weights * nested.radii) @ self.values[1, 0])
        return -total * DISPLACEMENT_FIELD * float(np.linalg.det(self.axes))

    @property
    def odd_tractions(self) -> tuple[Array, Array, Array]:
        """Return radii over the contact's, and the cos(angle) parts of pressure [Pa] and D_z [C/m2]; (place,) each."""
        nested = self.press.nest
        r = nested.radii[:-1]
        density = nested.densities[1, :-1].copy()
        density[:, -1] = np.where(r < 1, _density(1, r, np.ones_like(r)), 0.0)
        stress, charge = self.values[:, 1] @ density.T
        return r, -STRESS * stress, DISPLACEMENT_FIELD * charge

    @property
    def central_pressure(self) -> float:
        """Pressure in the middle of the ellipse [Pa]."""
        nested = self.press.nest
        return -STRESS * float((nested.weights / nested.radii)[nested.inside] @ self.values[0, 0, nested.inside])

    @property
    def misfit(self) -> float:
        """Singular edge pressure in harmonics beyond 2 over the largest weight, zero for an elliptical contact."""
        return float(np.abs(self.values[0, :, -1]).max() / np.abs(self.values[0, 0]).max())
