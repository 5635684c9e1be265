"""The closed form against finite elements: its tractions applied to a meshed half-plane, and the contact itself."""

from functools import cached_property

import numpy as np

import solver
from verification.cases import CHARGED, SIH_SONG, Array, constants, half_length
from verification.findings import Check, Curve, Findings, Sizes, check, off
from verification.oracles import fem, fem_contact

CASE = {"material": SIH_SONG, **CHARGED}
FRICTIONLESS = CASE | {"friction": 0.0}
X, Y = np.linspace(-2.49, 2.51, 21), -np.geomspace(0.2, 3, 10)
ORDER = 3.0  # of convergence, at least: 4 is the textbook's for gradients of quartic elements


def run(sizes: Sizes) -> Findings:
    """Fields under the closed form's tractions on refined meshes, and the unilateral contact."""
    n = sizes.elements
    meshes = {elements: Loaded(elements) for elements in (n // 4, n // 3, n // 2, n)}
    errors: dict[int, dict[str, float]] = {}

    def worst(elements: int) -> float:
        errors[elements] = meshes[elements].errors()
        return max(errors[elements].values())

    def gain() -> float:
        coarse, fine = (max(errors[elements].values()) for elements in (n // 2, n))
        return fine / coarse

    fine = meshes[n]
    compared = "stress, D and B inside at 210 points; largest root mean square error over root mean square"
    checks = [check(f"Fields, {e} elements", compared, 2e-4 * (24 / e) ** ORDER, worst, e) for e in meshes]
    checks += [
        check("Order of convergence", f"ratio of the errors of {n} and {n // 2} elements; 1/16 at the fourth order",
              0.5**ORDER, gain),
        check("Punch's face", "displacement under the tractions, and the parabola, over its rise", 1e-3, fine.face),
        check("Conductor", "spread of potentials under the punch, over their fall to the datum", 1e-3, fine.conductor),
        check("Response", "depth, voltage and magnetic potential against the surface 1000 half-widths away", 1e-3,
              fine.response),
    ]  # fmt: skip
    curves = [
        Curve("fem_fields", name, "elements under the punch", list(errors), [e[name] for e in errors.values()])
        for name in fem.FIELDS
    ]
    contact, contact_curves = _contact([n, 2 * n, 3 * n])
    return Findings(
        "Finite elements",
        "Coupled plane-strain elements (scikit-fem), equations (1) to (3) of the paper as they stand. First the "
        "tractions of the closed form act on a half-plane whose boundary is a million half-widths away (quartic "
        "elements): its fields, and the face of the punch, must come out. Then the contact itself is solved, "
        "unilateral and without friction (linear elements, active set): its extent must come out.",
        checks + contact,
        curves + contact_curves,
    )


class Loaded:
    """The tractions of the closed form on a meshed half-plane."""

    def __init__(self, elements: int) -> None:
        self.body = fem.Body(constants(solver.find(SIH_SONG)), fem.contact_mesh(elements))
        ends = solver.solve(CASE)
        self.centre = float(ends.contact_trailing - ends.contact_leading) / 2
        self.half = float(half_length(ends))

    @cached_property
    def u(self) -> Array:
        """(u_x, u_y, phi, psi) at the nodes."""
        theta = fem.surface_angles(self.body)
        solution = solver.solve(CASE, np.cos(theta).ravel(), regular=True)
        root = np.sin(theta).ravel()
        rows = [solution.shear_traction * root, -solution.contact_pressure * root]
        rows += [solution.electric_displacement_y_regular, solution.magnetic_induction_y_regular]
        regular = np.stack([row.values.reshape(theta.shape) for row in rows])
        return self.body.solve(fem.surface_load(self.body, regular, self.half))

    def errors(self) -> dict[str, float]:
        """Root mean square error of each field over its root mean square."""
        points = np.stack([grid.ravel() for grid in np.meshgrid(X, Y)])
        fluxes = self.body.fluxes(self.u, points, self.half)
        exact = solver.solve_interior(CASE, X, Y, fields=fem.FIELDS)
        return {
            k: float(np.linalg.norm(v - exact[k].values.ravel()) / np.linalg.norm(exact[k])) for k, v in fluxes.items()
        }

    def _surface(self) -> tuple[Array, Array, Array]:
        """X and u of the nodes of the contact, and the mean u of the surface at the datum's distance on both sides."""
        x, y = self.body.basis.doflocs
        top = y == 0
        distance = np.abs(x[top]) - fem_contact.DATUM
        nearest = top.nonzero()[0][np.argsort(np.abs(distance))[:2]]
        self.datum = float(np.abs(x[nearest[0]])) * self.half
        below = top & (np.abs(x) <= 1)
        return x[below], self.u[:, below], self.u[:, nearest].mean(axis=1)

    def _gap(self, x: Array, u_y: Array) -> Array:
        return np.asarray((self.centre + self.half * x) ** 2 / (2 * CHARGED["radius"]) - u_y)

    def face(self) -> float:
        """Spread of the distance of punch and surface over the rise of the punch."""
        x, u, _ = self._surface()
        return float(np.ptp(self._gap(x, u[1])) / np.ptp(self._gap(x, 0 * x)))

    def conductor(self) -> float:
        """Largest spread of a potential under the punch over its mean against the datum."""
        _, u, at_datum = self._surface()
        return max(float(np.ptp(u[k]) / np.abs(u[k].mean() - at_datum[k])) for k in (2, 3))

    def response(self) -> float:
        """Largest relative error of depth, voltage and magnetic potential."""
        x, u, at_datum = self._surface()
        response = [self._gap(x, u[1]).mean() + at_datum[1], u[2].mean() - at_datum[2], u[3].mean() - at_datum[3]]
        exact = solver.solve(CASE | {"datum": self.datum})
        pairs = zip(response, (exact.depth, exact.voltage, exact.magnetic_potential), strict=True)
        return max(off(value, truth) for value, truth in pairs)


def _contact(cells: list[int]) -> tuple[list[Check], list[Curve]]:
    """Checks and convergence of the contact that the elements find."""
    totals = np.array([CHARGED["load"], CHARGED["charge"], CHARGED["magnetic_charge"]])
    material = constants(solver.find(SIH_SONG))
    rows: dict[int, dict[str, float]] = {}

    def errors(count: int) -> dict[str, float]:
        contact = fem_contact.solve(material, CHARGED["radius"], totals, count, start=4e-4)
        exact = solver.solve(FRICTIONLESS | {"datum": contact.datum})
        half = float(exact.contact_trailing)
        inner = np.abs(contact.x) < 0.95 * half
        places = contact.x[inner] / half
        pressure = solver.solve(FRICTIONLESS, places).contact_pressure
        return {
            "half-width": off(contact.half_width, half),
            "pressure": float(np.max(np.abs(contact.pressure[inner] - pressure)) / exact.peak_pressure),
            "response": max(
                off(getattr(contact, name), exact[name]) for name in ("depth", "voltage", "magnetic_potential")
            ),
        }

    def of(what: str, count: int) -> float:
        if count not in rows:
            rows[count] = errors(count)
        return rows[count][what]

    compared = {
        "half-width": ("half-width found by the active set, and the closed form's", 8e-4),
        "pressure": ("nodal pressure over the inner 95 % of the contact, over the peak", 4e-3),
        "response": ("depth, voltage and magnetic potential of the punch", 1.5e-2),
    }
    checks = [
        check(f"Contact: {what}, {count} elements", text, tolerance * (72 / count) ** 2, of, what, count)
        for count in cells
        for what, (text, tolerance) in compared.items()
    ]  # fmt: skip
    effort = "elements of the surface below the punch"
    return checks, [
        Curve("fem_contact", what, effort, list(rows), [row[what] for row in rows.values()]) for what in compared
    ]
