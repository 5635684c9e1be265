"""Fields of line contacts in air, on the surface and inside, with their peaks and curves, case by case."""

from collections.abc import Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, ComplexArray
from solver.curves import REGIONS
from solver.fields import FIELDS
from solver.gap.airline import LineSolution
from solver.gap.charges import FAR, NEAR, Charges
from solver.gap.densities import integrals
from solver.gap.quantities import solutions
from solver.halfplane.interior import LINEAR, POTENTIALS
from solver.halfplane.peaks import lines as region_lines
from solver.halfplane.peaks import named
from solver.line import quantities as film
from solver.line.fields import in_blocks, local_fields, of_local
from solver.line.interior import Interior, fields_of
from solver.line.kernel import kernel
from solver.line.outputs import Assembly, mixing
from solver.line.peaks import PeakTable, of_whole_body
from solver.line.similar import Films
from solver.line.stressnets import Net, of_whole, require_depth
from solver.line.system import System
from solver.line.tractions import Tractions
from solver.names import PEAKS
from solver.stack.layers import Stack
from solver.stack.wavenumbers import panels

_MIRRORED = np.array([-1.0, -1.0, -1.0, 1.0])  # du/dX of the mirror image, over that of a charge


@dataclass(frozen=True, eq=False)
class AirTractions(Tractions):
    """Tractions of one contact, as one column; ``charges`` excludes the charge induced by exterior charges."""

    exterior_charges: Charges = field(kw_only=True)
    widest: float = 0.0  # Distance from the centre up to which fields are read, in the unit of the half-length

    @cached_property
    def _whole(self) -> Tractions:
        """Tractions of the contact, including the induced charge."""
        induced = self.exterior_charges.induced_terms(self.charges.shape[2])
        densities = (self.pressures, self.charges + induced[None, :, :, None])
        return Tractions(self.system, self.basis, self.half_lengths, *densities, self.upper)

    @property
    def _half(self) -> float:
        return float(self.half_lengths[0])

    def part(self, members: slice | NDArray[np.intp]) -> Self:
        """Return the contact itself, with its cached spectra: it is the only member."""
        return self

    def wavenumbers(self, body: Stack, nearest: float, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights; distant charges extend the range of long waves only."""
        nearest_reach = max(reach, self.widest) - self.longest
        return self.exterior_charges.wavenumbers(panels(body, width), self._half, nearest_reach)

    def by_distance(self, body: Stack, X: Array) -> list[NDArray[np.intp]]:
        """Return all columns as one group, since the charges in the gap lie far from the contact, too."""
        return [np.arange(X.shape[1])]

    def in_fourier_space(self, k: Array) -> ComplexArray:
        """Spectrum of (i sigma_xy, sigma_yy, D_y, B_y) at the surface at wavenumbers k [1/m]; (1, k, 4, 1)."""
        if (key := k.tobytes()) not in self._known:
            result = self._whole.in_fourier_space(k)
            phases = k * self._half
            spectrum = self.exterior_charges.spectrum(float(np.max(phases)))
            result[0, :, 2:, 0] += self._half * spectrum.values(phases).T
            self._known[key] = result
        return self._known[key]

    @cached_property
    def _known(self) -> dict[bytes, ComplexArray]:
        """Spectra computed so far, by their wavenumbers."""
        return {}

    def on_plane(self, z: ComplexArray, *, integrated: bool = False) -> ComplexArray:
        """Hilbert transforms of the tractions at points z = X + iY (1, point), Y >= 0; (4, 1, point, 1)."""
        result = super().on_plane(z, integrated=integrated)
        result[2:, 0, :, 0] += self.exterior_charges.transforms(z[0], integrated=integrated)
        return result


@dataclass(frozen=True, eq=False)
class Solved:
    """Contact in air, solved again at its exact half-length."""

    state: LineSolution
    points: Array  # X at which fields are needed; (point,)
    intervals: int = NEAR  # Number of intervals of ``Charges``

    @cached_property
    def system(self) -> System:
        """System of the contact, with kernels up to the farthest charges."""
        operators = self.state.operators
        wide, narrow = operators._wide, operators.system.kernel
        if wide is None:  # a half-plane's kernels are zero, up to the farthest point
            reach = self.state.half * (1 + float(np.max(np.abs(self.points))))
            wide = narrow if reach <= narrow.reach else kernel(narrow.stack, reach)
        return replace(operators.system, kernel=wide)

    @cached_property
    def assembly(self) -> Assembly:
        """Assembly at the half-length of the solution."""
        half = np.array([self.state.half])
        return Assembly(self.system, self.system.basis(self.state.half), half, self.points)

    @cached_property
    def exterior_charges(self) -> Charges:
        """Exterior charges of the contact."""
        operators = self.state.operators
        grid, unknowns = operators.grid, np.zeros((2, 2, operators.grid.count))
        for f, densities in zip(operators.system.fields, self.state.over_size, strict=True):
            unknowns[:, f] = densities.reshape(-1, grid.count)  # even densities have one side
        return Charges(grid, unknowns, self.intervals)

    @cached_property
    def induced(self) -> Array:
        """Charge unknowns of the contact that exterior charges induce; (unknown,)."""
        basis, result = self.assembly.basis, np.zeros(self.system.unknowns(self.assembly.basis))
        terms = self.exterior_charges.induced_terms(basis.terms + 1)
        for f, start in self.system.starts(basis).items():
            result[start : start + basis.terms + 1] = terms[f]
        return result

    def by_layers(self, X: Array) -> Array:
        """Layers' part of d(u_y, phi, psi, u_x)/dX at X by the exterior charges; (4, point)."""
        operators = self.state.operators
        result = np.zeros((4, X.size))
        if operators._wide is None:
            return result
        mix = np.concatenate([mixing(0.0, np.eye(3)[1 + f])[:, :4] for f in self.system.fields], 1)
        both_sides = integrals(operators._wide, operators.grid, self.state.half, np.concatenate([X, -X]), mix)
        right, left = both_sides.reshape(2, X.size, len(self.system.fields), 4, -1)
        for row, f in enumerate(self.system.fields):
            unknowns = self.exterior_charges.unknowns[:, f]
            result += self.state.half * (right[:, row] @ unknowns[0] + _MIRRORED * (left[:, row] @ unknowns[1])).T
        return result

    @cached_property
    def unknowns(self) -> Array:
        """Unknowns of the contact, without the induced charge; (unknown,)."""
        assembly, basis = self.assembly, self.assembly.basis
        sources = self.by_layers(basis.nodes)[:3] + assembly.at_nodes[0] @ self.induced
        solutions = self.system.solve(basis, assembly.at_nodes, sources=sources[None, :, :, None])[0]
        return np.asarray(solutions @ np.append(self.state.causes, 1.0))

    @property
    def tractions(self) -> AirTractions:
        """Tractions on the whole surface."""
        basis = self.assembly.basis
        pressures, charges = self.system.split(basis, self.unknowns)
        return AirTractions(
            self.system, basis, self.assembly.half_lengths, pressures[None, :, None], charges[None, :, :, None],
            exterior_charges=self.exterior_charges,
        )  # fmt: skip


def surface_fields(state: LineSolution, positions: Array) -> dict[str, Array]:
    """Fields of one case at positions X = (x - c)/h (position,), finite and never exactly +-1; (1, position) each."""
    solved, X = Solved(state, positions), positions
    system, is_exterior = solved.system, np.abs(positions) > 1
    c, local = system.coefficients, local_fields(solved.assembly)[0] @ solved.unknowns
    smooth = solved.assembly.gradients[0] @ solved.induced + solved.by_layers(X)
    charges, H = np.zeros((2, 3, X.size))
    charges[1:, is_exterior] = solved.exterior_charges.density(X[is_exterior])
    charges[1:, ~is_exterior] = solved.exterior_charges.induced(X[~is_exterior])
    z: ComplexArray = np.asarray(X[is_exterior], dtype=np.complex128)
    H[1:, is_exterior] = solved.exterior_charges.transforms(z).real  # within the contact it is zero
    local[:3] += charges
    local[3:] += smooth[1:]
    local[3:5] += c.compliance[1:] @ H
    local[5] -= c.coupling @ charges
    for f in c.fields:
        local[3 + f, ~is_exterior] = 0.0  # an equipotential
    return of_local(system, local[None])


_EDGES = np.array([1.0, -1.0])
_BOTTOM, _FAR = 6.0, 400.0  # depth and distance from the edges over h within which a half-plane is searched
_NEGLIGIBLE = 1e-12  # tension over the mean pressure that counts as none


def fields(films: Films, permittivity: Array, positions: Array) -> dict[str, Array]:
    """Surface fields of ``solver.fields.FIELDS`` at X != +-1, finite; (case, position) each."""
    out = {name: np.empty((films.load.size, positions.size)) for name in FIELDS}
    for case, state in solutions(films, permittivity):
        result = surface_fields(state, positions)
        for name, values in out.items():
            values[case] = result[name][0]
    return out


def inside(films: Films, permittivity: Array, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    """Fields of ``LINEAR`` and potentials at ((x - c)/h, y/h), NaN in a rigid base; (case, field, y, x)."""
    out = np.empty((films.load.size, len(names), y.size, x.size))
    intervals = FAR if set(POTENTIALS) & set(names) else NEAR
    for case, state in solutions(films, permittivity):
        tractions, datum = Solved(state, _EDGES, intervals).tractions, state.contact.datum
        for rows, columns in in_blocks(x, y):
            out[case, :, rows, columns] = fields_of(tractions, x[columns], y[rows], names, datum)[0]
    for number, name in enumerate(names):
        if name in POTENTIALS:
            out[:, number] *= films.thickness[:, None, None]
    return out


def peaks(films: Films, permittivity: Array, names: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.FILM_PEAKS`` that the cases have; (case,) each."""
    return film.peaks(films, names, _tables(films, permittivity))


def curves(films: Films, permittivity: Array, regions: Sequence[str]) -> dict[str, Array]:
    """Sizes of the contacts, and the curves of the requested regions that the cases have; (case, ...) each."""
    return film.curves(films, regions, _tables(films, permittivity))


def body_peaks(films: Films, permittivity: Array, names: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.PEAKS`` of half-planes, treated as films of themselves; (case,) each."""
    out = {name: np.empty(films.load.size) for name in PEAKS if name in names}
    for case, state in solutions(films, permittivity) if out else ():
        h, half_length = np.array([state.half]), state.half * films.thickness[case]
        net = of_whole(films.kind.stack, state.half, _BOTTOM, _FAR)
        tractions = _reaching(state, 1 + _FAR)
        stresses = Interior(tractions).fields(net.positions(h, net.line), -net.depths(h), LINEAR[:4])[..., 0]
        largest, depth, tension = of_whole_body(stresses, net, state.half).values()
        tension = np.where(tension < _NEGLIGIBLE * films.load[case] / (2 * half_length), 0.0, tension)
        for name, value in zip(PEAKS, (largest, depth * half_length, tension), strict=True):
            if name in out:
                out[name][case] = value[0]
    return out


def body_curves(films: Films, permittivity: Array) -> dict[str, Array]:
    """Sizes of the contacts and the curves of the region ``body`` of half-planes as films; (case, ...) each."""
    X, depth = region_lines()
    result: dict[str, list[Array]] = {}
    for case, state in solutions(films, permittivity):
        half = np.array([state.half]) * films.thickness[case]
        stresses = Interior(_reaching(state, float(np.max(np.abs(X))))).fields(X[None], -depth[None], LINEAR[:4])
        panels = REGIONS["body"].panels
        by_panel = panels.by_panel(stresses[..., 0])
        below = panels.by_panel(np.broadcast_to(depth[:, None], (depth.size, X.size)))
        sizes = {"mean_pressure": films.load[[case]] / (2 * half), "half_length": half}
        for name, value in (sizes | named(by_panel, half, below)).items():
            result.setdefault(name, []).append(value)
    return {name: np.concatenate(values) for name, values in result.items()}


def _reaching(state: LineSolution, farthest: float) -> AirTractions:
    """Tractions of a contact for fields up to abs(X) = ``farthest``."""
    return replace(Solved(state, _EDGES).tractions, widest=(1 + farthest) * state.half)


def _tables(films: Films, permittivity: Array) -> film.PeakTables:
    """Yield one case at a time, with the stresses below it."""
    for case, state in solutions(films, permittivity):
        half = np.array([state.half])
        require_depth(half / films.kind.stack.thickness, "half-length")
        table = replace(state.contact.table, lower=state.half, upper=state.half)
        yield np.array([case]), AirPeaks(table, state), half, state.causes[None]


@dataclass(frozen=True, eq=False)
class AirPeaks(PeakTable):
    """Stresses below one contact, on the nets of its exact half-length."""

    state: LineSolution
    outer: ClassVar[int] = 2  # each costs four times as many wavenumbers as the one before

    def _series(self, net: Net, names: tuple[str, ...]) -> Array:
        """Stresses of the case, since there is no series; (1, stress, depth, x)."""
        h = np.array([self.state.half])
        X = net.positions(h, net.line)
        tractions = self._near if np.max(X) <= self._reach else _reaching(self.state, float(np.max(X)))
        return Interior(tractions).fields(X, -net.depths(h), names)[..., 0]

    @cached_property
    def _reach(self) -> float:
        """Largest X of the panels over the interface, the longest of all regions."""
        net = self.net("interface")
        return float(np.max(net.positions(np.array([self.state.half]), net.line)))

    @cached_property
    def _near(self) -> AirTractions:
        return _reaching(self.state, self._reach)

    def read(self, half_width: Array, causes: Array, series: Array) -> Array:
        """Return ``series``, the stresses of the one case; (1, stress, depth, x), Pa."""
        return series
