"""Numerical solution of the singular integral equations (2.2) in double precision, for any punch profile.

    eta k sigma_yy + N H[(sigma_yy, D_y, B_y)] = (g', 0, 0)        on -b < x < a,

without the rows and columns of fields that the punch does not conduct. Unknown are the tractions and the contact ends.

Formulation. Next to an edge (2.2) admits the powers of the distance that make eta k e1^T + cot(pi A) N singular:
cot(pi A) = -eta (N^-1 k)_1, so that A is alpha or alpha - 1, and A = -1/2 for D_y and B_y. Hence, with X = (x - c)/h,

    sigma_yy = (1-X)^A (1+X)^B F(X),     D_y, B_y = (1-X)^A (1+X)^B G(X) + (1-X^2)^(-1/2) K(X)

has analytic F, G, K. They are Chebyshev series: the error falls geometrically with the number of terms, to rounding at
once where g' is a polynomial. Moments are Gauss-Jacobi quadratures. The equations hold at twice as many Chebyshev
points as a series has terms and are solved, with the balances, by least squares. At alpha = 1/2 the two families of D_y
and B_y coincide; then the singular-value cut-off and a preference for low orders choose.

Ends. Two smooth edges leave one consistency condition: the punch may tilt, and Powell's hybrid method finds the ends
with zero tilt and the given load. One smooth edge follows from the load alone. A sharp edge is at the punch's corner.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq, root
from scipy.special import gamma, hyp2f1, rgamma, roots_jacobi

from verification.oracles import precise
from verification.oracles.surface_response import Array, SurfaceResponse

_CUT_OFF = 1e-15  # of singular values
_ABSCISSAE = np.linspace(-5.9, 5.9, 1181)  # of the double-exponential quadrature
_PREFERENCE = 0.5  # from one order to the next: without it the two families cancel in high orders from 16 terms on


@dataclass(frozen=True)
class Profile:
    """A rigid punch."""

    slope: Callable[[Array], Array]  # dg/dx [1] at x [m], arrays
    # Place x [m] of the right and of the left edge where the punch has its corner there; None for a smooth edge
    sharp_trailing: float | None = None
    sharp_leading: float | None = None

    @property
    def smooth(self) -> bool:
        """Return True if both edges are smooth."""
        return self.sharp_trailing is None and self.sharp_leading is None

    @property
    def sharp(self) -> bool:
        """Return True if both edges are sharp."""
        return self.sharp_trailing is not None and self.sharp_leading is not None


def cylinder(radius: float) -> Profile:
    """Circular punch in the parabolic approximation of theory section 1."""
    return Profile(lambda x: x / radius)


def circle(radius: float) -> Profile:
    """Circular punch itself, without closed form, so that the number of terms matters."""
    return Profile(lambda x: x / np.sqrt(radius**2 - x**2))


def flat(width: float, tilt: float = 0.0) -> Profile:
    """Flat punch centred on x = 0."""
    return Profile(lambda x: np.full_like(x, tilt), width / 2, -width / 2)


def wedge(slope: float, corner: str = "leading") -> Profile:
    """Triangular punch with its corner at x = 0."""
    return _cornered(lambda x: np.full_like(x, slope if corner == "leading" else -slope), corner)


def half_cylinder(radius: float, corner: str = "leading") -> Profile:
    """Half of the cylinder with its corner at x = 0."""
    return _cornered(lambda x: x / radius, corner)


def _cornered(slope: Callable[[Array], Array], corner: str) -> Profile:
    return Profile(slope, sharp_leading=0.0) if corner == "leading" else Profile(slope, sharp_trailing=0.0)


def moments(A: float, B: float, count: int) -> Array:
    """(1/pi) int (1-X)^A (1+X)^B T_n dX, n < count, by Gauss-Jacobi quadrature."""
    with np.errstate(invalid="ignore"):  # at A + B = -1 SciPy computes 0/0 for an entry that it does not use
        x, w = roots_jacobi(count, A, B)
    out: Array = w @ np.polynomial.chebyshev.chebvander(x, count - 1) / np.pi
    return out


def transforms(X: Array, A: float, B: float, count: int) -> Array:
    """(1/pi) PV int (1-s)^A (1+s)^B T_n(s)/(s-X) ds at places |X| < 1, (count, points).

    The first from Erdogan, Gupta and Cook (Methods of Analysis and Solutions of Crack Problems, 1973, chapter 7), the
    others from T_n+1 = 2 X T_n - T_n-1.
    """
    mean = moments(A, B, max(count, 2))
    out = np.empty((max(count, 2), len(X)))
    factor = 2 ** (A + B) * gamma(A) * gamma(B + 1) * rgamma(A + B + 1) / np.pi
    out[0] = (1 - X) ** A * (1 + X) ** B / np.tan(np.pi * A) - factor * hyp2f1(1, -A - B, 1 - A, (1 - X) / 2)
    out[1] = X * out[0] + mean[0]
    for n in range(1, len(out) - 1):
        out[n + 1] = 2 * (X * out[n] + mean[n]) - out[n - 1]
    return out[:count]


def end_proof_nodes() -> tuple[Array, Array, Array]:
    """Return 1 - X, 1 + X and weights of double-exponential quadrature over -1 < X < 1, for any end exponents."""
    growth = np.exp(np.pi * np.sinh(_ABSCISSAE))
    right, left = 2 / (1 + growth), 2 / (1 + 1 / growth)
    return right, left, (_ABSCISSAE[1] - _ABSCISSAE[0]) * np.pi * np.cosh(_ABSCISSAE) * right * left / 2


@dataclass(frozen=True, eq=False)
class Problem:
    """A punch on a half-plane, SI units."""

    N: Array  # shape (3, 3)
    k: Array  # shape (3,); theory (2.2), over (y, phi, psi)
    profile: Profile
    friction: float
    load: float
    charge: float = 0.0  # not used if the punch does not conduct the field
    magnetic_charge: float = 0.0
    conducted: tuple[int, ...] = (1, 2)  # conducted fields, 1 electric and 2 magnetic
    terms: int = 8  # terms of each Chebyshev series, at least 3

    @property
    def unknown(self) -> list[int]:
        """Indices into (sigma_yy, D_y, B_y) of the unknown tractions."""
        return [0, *self.conducted]

    def scaled(self) -> tuple[Array, Array, Array]:
        """N with diagonal +-1 and k, both over the unknown tractions, and the scale of each."""
        N = self.N[np.ix_(self.unknown, self.unknown)]
        scale: Array = 1 / np.sqrt(np.abs(np.diag(N)))
        return scale[:, None] * N * scale, scale * self.k[self.unknown] * scale[0], scale

    def weights(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Exponents (A, B) of 1 - X and 1 + X in the two families."""
        N, k, _ = self.scaled()
        alpha = float(np.arctan2(1.0, -self.friction * np.linalg.solve(N, k)[0])) / np.pi
        right, left = (end is not None for end in (self.profile.sharp_trailing, self.profile.sharp_leading))
        return (alpha - right, 1 - alpha - left), (-0.5, -0.5)


@dataclass(frozen=True, eq=False)
class Contact:
    """Solution of a problem between two ends."""

    problem: Problem
    trailing: float  # a [m]
    leading: float  # b [m]
    coefficients: Array  # shape (3, 2, terms); Chebyshev coefficients of (F, G, G) and of (0, K, K), SI units
    tilt: float  # rotation of the punch [1], zero unless both edges are smooth and the ends are wrong

    @property
    def half_width(self) -> float:
        """h [m]."""
        return (self.trailing + self.leading) / 2

    @property
    def totals(self) -> Array:
        """Integrals of sigma_yy, D_y, B_y over the contact: -P, -T, -J."""
        table = np.stack([moments(*w, self.problem.terms) for w in self.problem.weights()])
        return np.asarray(np.pi * self.half_width * np.einsum("fwk,wk->f", self.coefficients, table))

    def tractions(self, X: Array) -> Array:
        """sigma_yy, D_y, B_y at X, shape (3, points); zero outside and for a field that is not conducted."""
        out, inside = np.zeros((3, len(X))), np.abs(X) < 1
        out[:, inside] = self._tractions(1 - X[inside], 1 + X[inside])
        return out

    def _tractions(self, right: Array, left: Array) -> Array:
        """Return tractions from the distances 1 - X and 1 + X, which are exact next to an edge."""
        basis = np.polynomial.chebyshev.chebvander((left - right) / 2, self.problem.terms - 1)
        weights = np.stack([right**A * left**B for A, B in self.problem.weights()])
        return np.asarray(np.einsum("fwk,wn,nk->fn", self.coefficients, weights, basis))

    def transforms(self, X: Array) -> Array:
        """H of sigma_yy, D_y, B_y at any X but the edges, shape (3, points)."""
        out, inside = np.empty((3, len(X))), np.abs(X) < 1
        tables = np.stack([transforms(X[inside], *w, self.problem.terms) for w in self.problem.weights()])
        out[:, inside] = np.einsum("fwk,wkn->fn", self.coefficients, tables)
        right, left, weight = end_proof_nodes()
        outside = X[~inside][:, None]
        distance = np.where(outside > 0, -right - (outside - 1), left - (outside + 1))  # s - X, exact at both edges
        out[:, ~inside] = (weight * self._tractions(right, left)) @ (1 / distance).T / np.pi
        return out

    def punch_response(self, datum: float = 1.0) -> Array:
        """Depth [m], voltage [V], magnetic potential [A]: logarithmic potentials at x = a, theory section 6.

        The potential of a field that is not conducted is that of the surface at x = a. Depth is that of the profile's
        point x = 0.
        """
        right, left, weight = end_proof_nodes()
        samples = self.half_width * weight * self._tractions(right, left)
        problem, logarithms = self.problem, np.log(self.half_width * right / datum)
        response = -problem.N @ (samples @ logarithms) / np.pi + problem.k * problem.friction * samples[0].sum() / 2
        rise = quad(lambda x: problem.profile.slope(np.array(x)).item(), 0, self.trailing, epsabs=0, epsrel=1e-13)[0]
        return np.array([rise - response[0], response[1], response[2]])


def solve(problem: Problem) -> Contact:
    """Solve (2.2) with its contact ends."""
    right, left = problem.profile.sharp_trailing, problem.profile.sharp_leading
    if right is not None and left is not None:
        return _between(problem, right, -left)
    if right is not None:
        return _with_load(problem, lambda h: (right, 2 * h - right))
    if left is not None:
        return _with_load(problem, lambda h: (2 * h + left, -left))
    return _with_load_upright(problem)


def _with_load(problem: Problem, ends: Callable[[float], tuple[float, float]]) -> Contact:
    """Return the contact whose half-width h gives the load, from its ends as functions of h."""

    def excess(h: float) -> float:
        return float(-_between(problem, *ends(h)).totals[0]) / problem.load - 1

    low = high = 1e-4
    while excess(low) > 0:
        low /= 1.5
    while excess(high) < 0:
        high *= 1.5
    return _between(problem, *ends(brentq(excess, low, high, xtol=1e-30, rtol=1e-14)))


def _with_load_upright(problem: Problem) -> Contact:
    """Return the contact between two smooth edges that has the load and no tilt."""
    start = _with_load(problem, lambda h: (h, h)).half_width
    steepest = np.max(np.abs(problem.profile.slope(np.array([start, -start]))))

    def contact(unknown: Array) -> Contact:
        h = start * np.exp(unknown[1])
        return _between(problem, h * (1 + unknown[0]), h * (1 - unknown[0]))

    def mismatch(unknown: Array) -> Array:
        trial = contact(unknown)
        return np.array([trial.tilt / steepest, -trial.totals[0] / problem.load - 1])

    ends = root(mismatch, np.zeros(2), tol=1e-13).x
    worst = float(np.max(np.abs(mismatch(ends))))
    if worst > 1e-11:
        raise ArithmeticError(f"contact ends not found: tilt or load is off by {worst:.1e}")
    return contact(ends)


def _between(problem: Problem, trailing: float, leading: float) -> Contact:
    """Solve (2.2) between given ends [m]; the load is an outcome unless both edges are sharp."""
    terms, h, centre = problem.terms, (trailing + leading) / 2, (trailing - leading) / 2
    X = np.cos(np.pi * (np.arange(2 * terms + 2) + 0.5) / (2 * terms + 2))
    families = [(0, 0), *((f, w) for f in range(1, len(problem.unknown)) for w in (0, 1))]
    loaded = [f for f in range(len(problem.unknown)) if f or problem.profile.sharp]  # tractions of known total
    matrix = _matrix(problem, X, families, loaded)

    # One right-hand side for every cause (slope, load, charges): each keeps its own relative accuracy.
    scale = problem.scaled()[2]
    totals = np.array([-problem.load, -problem.charge, -problem.magnetic_charge])[problem.unknown] / (h * scale)
    causes = np.zeros((len(matrix), 1 + len(loaded)))
    causes[: len(X), 0] = scale[0] * problem.profile.slope(centre + h * X)
    causes[len(matrix) - len(loaded) :, 1:] = np.diag(totals[loaded])

    preference = np.ones(matrix.shape[1])
    preference[: len(families) * terms] = np.tile(_PREFERENCE ** np.arange(terms), len(families))
    unknown = preference[:, None] * np.linalg.lstsq(matrix * preference, causes, rcond=_CUT_OFF)[0]

    total = unknown.sum(axis=1)
    coefficients = np.zeros((3, 2, terms))
    for i, (f, w) in enumerate(families):
        coefficients[problem.unknown[f], w] = scale[f] * total[i * terms : (i + 1) * terms]
    tilt = float(total[-1] / scale[0]) if problem.profile.smooth else 0.0
    return Contact(problem, trailing, leading, coefficients, tilt)


def _matrix(problem: Problem, X: Array, families: list[tuple[int, int]], loaded: list[int]) -> Array:
    """Rows: the equations at X, then the balances. Columns: the series of every family, then the tilt if it is free."""
    N, k, _ = problem.scaled()
    terms, (powers, root_family) = problem.terms, problem.weights()
    tables = [transforms(X, *w, terms).T for w in (powers, root_family)]
    means = [np.pi * moments(*w, terms) for w in (powers, root_family)]
    blocks = []
    for f, w in families:
        equations = np.kron(N[:, f : f + 1], tables[w])
        if f == 0:
            values = np.polynomial.chebyshev.chebvander(X, terms - 1).T * (1 - X) ** powers[0] * (1 + X) ** powers[1]
            equations += np.kron(problem.friction * k[:, None], values.T)
        balances = np.array([(f == g) * means[w] for g in loaded]).reshape(len(loaded), terms)
        blocks.append(np.vstack([equations, balances]))
    if problem.profile.smooth:
        tilt = np.zeros((len(blocks[0]), 1))
        tilt[: len(X)] = -1.0
        blocks.append(tilt)
    return np.hstack(blocks)


def quantities(contact: Contact, surface: SurfaceResponse, datum: float) -> dict[str, float]:
    """Ends, response, edge values."""
    depth, voltage, magnetic_potential = contact.punch_response(datum)
    alpha, h, near = contact.problem.weights()[0][0], contact.half_width, np.array([1e-24])
    trailing, leading = (contact._tractions(*sides)[:, 0] for sides in ((near, 2 - near), (2 - near, near)))
    to_intensity = np.sqrt(2 * np.pi * h * near[0])
    edges = np.zeros((4, 2))
    edges[0] = contact.problem.friction * contact.transforms(np.array([1.0, -1.0]))[0]  # an ordinary integral there
    tension, compression = surface.along_surface(np.zeros((4, 2)), edges)[0]
    return {
        "contact_trailing": contact.trailing,
        "contact_leading": contact.leading,
        "pressure_exponent": alpha,
        "peak_pressure": -contact.tractions(np.array([1 - 2 * alpha]))[0, 0],  # where alpha/(a-x) = (1-alpha)/(x+b)
        "depth": depth,
        "voltage": voltage,
        "magnetic_potential": magnetic_potential,
        "electric_edge_intensity_trailing": to_intensity * trailing[1],
        "electric_edge_intensity_leading": to_intensity * leading[1],
        "magnetic_edge_intensity_trailing": to_intensity * trailing[2],
        "magnetic_edge_intensity_leading": to_intensity * leading[2],
        "trailing_tension": tension,
        "leading_compression": compression,
    }


def fields(contact: Contact, surface: SurfaceResponse, X: Array) -> dict[str, Array]:
    """The surface fields at places X, (n,), over the contact's half-width."""
    t, transform = (
        np.vstack([contact.problem.friction * rows[0], rows]) for rows in (contact.tractions(X), contact.transforms(X))
    )
    along = surface.along_surface(t, transform)
    return dict(zip(precise.FIELDS, (-t[1], t[0], t[2], t[3], along[0], along[2], along[3]), strict=True))
