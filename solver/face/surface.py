"""Cases of contacts in space, which are solved one by one, and their maps."""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr
from scipy.interpolate import RegularGridInterpolator
from typing_extensions import override

from solver.arrays import Array, shown
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.filmbodies import stack_of
from solver.face.materials import elasticity_of, one_of_case
from solver.face.refusal import CaseError, FactorError
from solver.face.rows import Factors
from solver.halfplane.precision import PrecisionWarning
from solver.material.constants import Material
from solver.names import HEIGHT_MAP, MAPS, PROFILES
from solver.stack.layers import Stack
from solver.surface.contact import Slopes, SurfaceContact, solve_contact
from solver.surface.quantities import quantities, slopes_of
from solver.surface.response import SurfaceBody, SurfaceError, SurfaceLayer
from solver.surface.shape import Cone, Disc, Ellipsoid, Map, Roller, RoughSphere, Shape, sphere

#: Shapes whose sizes have the names of their factors.
_SHAPES: dict[str, Callable[..., Shape]] = {
    "rough_sphere": RoughSphere, "ellipsoid": Ellipsoid, "cone": Cone, "sphere": sphere,
}  # fmt: skip
_LARGEST_MAP = 2**28  # bytes of a file of heights: 4096 x 4096 numbers of 16 characters
_MECHANICAL = (
    "contact_area", "contact_length_x", "contact_length_y", "peak_pressure", "depth", "friction_force_x",
    "friction_force_y", "moment_x", "moment_y", "moment_z", "contact_stiffness", "relative_error",
)  # fmt: skip


class OnSurface(Body):
    """Contacts in space on half-spaces and layers."""

    @cached_property
    def _contacts(self) -> list["_Contact"]:
        return [_Contact(case) for case in _singles(self.cases)]

    def quantities(self) -> dict[str, Array]:
        """Quantities of ``solver.names.SPACE_QUANTITIES`` that every case has; (...)."""
        return self.requested(None)

    @override
    def requested(self, names: Set[str] | None) -> dict[str, Array]:
        slopes = slopes_of(names)
        self._contacts = [_Contact(case, slopes) for case in _singles(self.cases)]
        out = self._joined([contact.quantities() for contact in self._contacts])
        excess = out["relative_error"] / np.broadcast_to(self.cases.number("grid_error"), self.shape)
        if np.any(excess > 1):
            worst = np.unravel_index(np.argmax(excess), excess.shape)
            warnings.warn(
                f"grid_error: {out['relative_error'][worst] / excess[worst]:g} is not reached on the finest grid by "
                f"{np.count_nonzero(excess > 1)} of {excess.size} cases; the largest relative_error is "
                f"{np.max(out['relative_error'][excess > 1]):.2g}",
                PrecisionWarning,
                stacklevel=2,
            )
        return out

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        return self._joined([contact.along_x(positions) for contact in self._contacts])

    def _joined(self, cases: Sequence[Mapping[str, Any]]) -> dict[str, Array]:
        """Join outputs that every case has; (..., other axes)."""
        names = [name for name in cases[0] if all(name in case for case in cases)]
        stacked = {name: np.array([case[name] for case in cases]) for name in names}
        return {name: values.reshape((*self.shape, *values.shape[1:])) for name, values in stacked.items()}

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Refuse the request, since no stresses inside are solved."""
        raise FactorError("peaks: of a contact in space are not solved; the largest pressure is peak_pressure")

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Refuse the request, since no stresses inside are solved."""
        raise FactorError("curves: of a contact in space are not solved; solve_map has its surface")

    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        raise FactorError("fields: inside a contact in space are not solved; solve_map has its surface")

    @property
    def _lacks_c12(self) -> str | None:
        return None  # refused with the stiffness tensor


def solve_map(
    factors: Factors,
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Maps of the surface under one contact in space.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solver.solve`, of one case.

    Returns
    -------
    xarray.Dataset
        ``solver.names.MAPS`` over ``x`` and ``y``, the middles of the cells [m] from the middle of the punch, SI units.

    Raises
    ------
    FactorError
        As :func:`solver.solve`; several cases; a contact along a line or at a point of revolution.
    MaterialError
        Unknown or inadmissible material.

    Examples
    --------
    >>> egg = {"material": "PZT-4", "profile": "ellipsoid", "radius_x": "5 mm", "radius_y": "10 mm", "force": 1.0}
    >>> pressed = solve_map(egg | {"grid_error": 0.01})
    >>> pressed["contact_pressure"].dims, bool(pressed["contact_pressure"].max() > 1e8)
    (('x', 'y'), True)
    """
    cases = Cases(checked(factors, materials), materials, phases)
    if any(size != 1 for size in cases.sizes.values()):
        raise FactorError(f"factors: several cases, over {', '.join(cases.sizes)}; a map is that of one")
    (case,) = _singles(cases)
    if not case.kind.space:
        raise FactorError(
            f"profile: of a {case.kind.name}; only contacts in space have a map, see solver.names.PROFILES"
        )

    def part(case: Cases) -> xr.Dataset:
        contact = _Contact(case).charged
        values = (contact.pressure, contact.electric_displacement, contact.gap, contact.weight)
        maps = {
            name: xr.Variable(("x", "y"), np.where(np.isfinite(map_), map_, np.nan), MAPS[name].attrs)
            for name, map_ in zip(MAPS, values, strict=True)
        }
        axes = {
            name: xr.Variable(name, axis, {"units": "m", "long_name": f"{name} from the middle of the punch"})
            for name, axis in (("x", contact.x), ("y", contact.y))
        }
        return xr.Dataset(maps, case.coordinates | axes)

    return case.solved("exact solution of a punch on a magneto-electro-elastic half-plane", part)


def _singles(cases: Cases) -> Iterator[Cases]:
    """Yield the cases one by one, without dimensions, in the order of their axes."""
    for multi_index in np.ndindex(*cases.sizes.values()):
        index = dict(zip(cases.sizes, multi_index, strict=True))
        arrays = {
            name: array.isel({dim: index[str(dim)] for dim in array.dims}, drop=True)
            for name, array in cases.arrays.items()
        }
        yield replace(cases, arrays=arrays)


@dataclass(frozen=True, eq=False)
class _Contact:
    """One contact in space."""

    case: Cases
    slopes: Slopes = Slopes.NONE

    def quantities(self) -> dict[str, float]:
        """Return the quantities that the case has, by name."""
        out = quantities(self.charged, self.slopes)
        if self._metallic:
            return {name: out[name] for name in _MECHANICAL if name in out}
        if self._stack is not None:
            out["nominal_field"] = abs(out["voltage"]) / (self._stack.above_ground * self._stack.top.thickness)
        return {name: value for name, value in out.items() if name in self.case.kind.quantities}

    def along_x(self, positions: Array) -> dict[str, Array]:
        """Fields along x through the middle of the contact, at positions in half-lengths; (position,) each."""
        contact = self.charged
        covered = contact.weight > 0
        x, y = (axis[np.any(covered, axis=1 - k)] for k, axis in enumerate((contact.x, contact.y)))
        points = (x[0] + x[-1]) / 2 + positions * contact.lengths[0] / 2, np.full(positions.size, (y[0] + y[-1]) / 2)

        def read(values: Array, beyond: float) -> Array:
            grid = RegularGridInterpolator((contact.x, contact.y), values, bounds_error=False, fill_value=beyond)
            return np.asarray(grid(np.stack(points, -1)))

        return {
            "contact_pressure": read(contact.pressure, 0.0),
            "electric_displacement": read(contact.electric_displacement, np.nan),
        }

    @cached_property
    def charged(self) -> SurfaceContact:
        """Contact with its charge, or at zero voltage on a metal, which takes the charge."""
        charge = float(self.case.number("total_charge"))
        if not self._metallic:
            return self._solved(charge=charge, slopes=self.slopes)
        if charge:
            raise FactorError(f"total_charge: {charge:g} of a punch on a metal, which takes it; must be 0")
        return self._solved(voltage=0.0, slopes=min(self.slopes, Slopes.BY_VOLTAGE))

    def _solved(self, **control: Any) -> SurfaceContact:
        """Solve the contact at a charge or a voltage."""
        case = self.case
        try:
            return solve_contact(
                self._body,
                self._shape,
                force=float(case.force),
                friction=float(case.number("friction")),
                direction=float(case.number("sliding_direction")),
                air=float(case.number("gap_permittivity")) if case.kind.air else None,
                end=self._end,
                punch=self._punch,
                error=float(case.number("grid_error")),
                **control,
            )
        except SurfaceError as error:
            raise CaseError(str(error)) from None

    @property
    def _metallic(self) -> bool:
        """True if the top layer is a metal, which is at zero potential."""
        return self._stack is not None and self._stack.conductors[0]

    @property
    def _punch(self) -> tuple[float, float] | None:
        """Modulus [Pa] and Poisson's ratio of an elastic punch."""
        modulus, poisson = (float(value) for value in elasticity_of(self.case))
        return None if np.isinf(modulus) else (modulus, poisson)

    @cached_property
    def _stack(self) -> Stack | None:
        """Layers of the case, None for a half-space."""
        return stack_of(self._factors, self.case.materials, self.case.phases) if self.case.kind.layered else None

    @property
    def _factors(self) -> dict[str, Any]:
        return {name: value.item() for name, value in self.case.values.items()}

    @cached_property
    def _body(self) -> SurfaceBody:
        """Half-space or layers with their stiffness tensors."""
        stack = self._stack
        if stack is None:
            material = one_of_case(self._factors, self.case.materials, self.case.phases)
            body = SurfaceBody((), material.stiffness_tensor())
        else:
            layers = [
                SurfaceLayer(layer.material.stiffness_tensor(), layer.thickness, 2 in components, metal)
                for layer, components, metal in zip(stack.layers, stack.grounded, stack.conductors, strict=False)
            ]
            base = None if isinstance(stack.base, str) else stack.base.stiffness_tensor()
            body = SurfaceBody(layers, base, stack.conductors[-1])
        if body.fields > 4 and self._factors.get("magnetic") != "insulating":
            raise FactorError(
                "magnetic: conducting on a magnetic body in space; must be insulating: the punch has B = 0"
            )
        return body

    @property
    def _outline(self) -> tuple[str, dict[str, float]]:
        """Profile of the case and its factors."""
        profile = str(self._factors.get("profile"))
        return profile, {name: float(self.case.number(name)) for name in PROFILES[profile].takes}

    @cached_property
    def _shape(self) -> Shape:
        """Shape of the punch."""
        profile, size = self._outline
        try:
            if profile == "map":
                return _map(self._factors.get(HEIGHT_MAP), size["map_spacing"])
            if profile == "roller":
                crown = size["crown_radius"]
                return Roller(size["radius"], size["length"], crown if crown > 0 else np.inf, size["tilt"])
            if profile == "disc":
                return Disc(size["width"] / 2)
            return _SHAPES[profile](**size)
        except SurfaceError as error:
            raise FactorError(str(error)) from None

    @property
    def _end(self) -> float:
        """Distance at which the gap ends [m]: a factor, a ball's radius, or infinity for a bounded punch."""
        gap_radius = float(self.case.number("gap_radius"))
        if gap_radius > 0:
            return gap_radius
        profile, size = self._outline
        if profile == "ellipsoid":
            return float(np.sqrt(size["radius_x"] * size["radius_y"]))
        return size["radius"] if profile in ("sphere", "rough_sphere") else np.inf


def _map(heights: object, spacing: float) -> Map:
    """Return the height map of an array, of a CSV with a line for each x, or of a file for SurfaceTopography."""
    distance: Any = spacing
    if isinstance(heights, str | Path):
        heights, file_spacing = _read(Path(heights))
        distance = spacing if spacing > 0 else file_spacing
    if not np.all(np.asarray(distance) > 0):
        raise FactorError("map_spacing: missing; must be a finite number > 0 [m]")
    try:
        values = np.asarray(heights, dtype=np.float64)
    except (TypeError, ValueError):
        raise FactorError(f"{HEIGHT_MAP}: {shown(heights)} is no array of heights over x and y [m]") from None
    return Map(values, distance)


def _read(path: Path) -> tuple[Array, Any]:
    """Read the heights of a file [m], and the distance between its points [m], 0 for a CSV."""
    try:
        size = path.stat().st_size
    except OSError as error:
        raise FactorError(f"{HEIGHT_MAP}: {path}: {error.strerror or error}") from None
    if not path.is_file() or size > _LARGEST_MAP:
        raise FactorError(f"{HEIGHT_MAP}: {path}: no file of at most {_LARGEST_MAP} bytes")
    if path.suffix == ".csv":
        try:
            return np.loadtxt(path, delimiter=",", ndmin=2), 0.0
        except (ValueError, UnicodeDecodeError) as error:
            raise FactorError(f"{HEIGHT_MAP}: {path}: {str(error).splitlines()[0]}") from None
    try:
        topography = import_module("SurfaceTopography").read_topography(str(path)).to_unit("m")
        measured = np.asarray(topography.heights())  # positive out of the punch
        return np.max(measured) - measured, tuple(topography.pixel_size)
    except ImportError:
        raise FactorError(
            f"{HEIGHT_MAP}: {path}: no .csv; other files need the optional package SurfaceTopography"
        ) from None
    except Exception as error:  # readers of other formats raise any exception
        raise FactorError(f"{HEIGHT_MAP}: {path}: {' '.join(str(error).split())[:200]}") from None
