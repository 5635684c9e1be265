"""The public functions of the solver, from named factors to an ``xarray.Dataset`` with units."""

import warnings
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from itertools import product
from math import prod
from types import MappingProxyType
from typing import cast

import numpy as np
import xarray as xr

from solver.arrays import Array, unmasked
from solver.body import Touch
from solver.curves import REGIONS, SIZES, described
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.refusal import FactorError, SmallStrainWarning
from solver.face.rows import Factors, of_kinds, solved_by_kind
from solver.face.strain import Excess, excesses, sentence
from solver.fields import ACROSS, ALONG, EVERY_FIELD, EVERY_INTERIOR
from solver.material.constants import Material
from solver.names import ALL_PEAKS, ALL_QUANTITIES, OF_HEAT

#: Module and class by contact, layers of the body, and charge in the air beside the contact. A module is imported with
#: the first case of its kind: cases on a half-plane never load the films.
_BODIES: dict[tuple[Touch, bool, bool], tuple[str, str]] = {
    ("line", False, False): ("halfplane", "OnHalfPlane"),
    ("line", True, False): ("film", "OnFilm"),
    ("line", False, True): ("air", "HalfPlaneInAir"),
    ("line", True, True): ("air", "FilmInAir"),
    ("point", False, False): ("point", "OnHalfSpace"),
    ("point", True, False): ("point", "OnPointFilm"),
    ("point", False, True): ("airpoint", "HalfSpaceInAir"),
    ("point", True, True): ("airpoint", "PointFilmInAir"),
    **dict.fromkeys(product(("space",), (False, True), (False, True)), ("surface", "OnSurface")),
}


def solve(
    factors: Factors,
    positions: Iterable[float] | None = None,
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
    regular: bool = False,
    peaks: bool | Collection[str] = False,
    outputs: Collection[str] | None = None,
) -> xr.Dataset:
    """Exact solution of every case: all quantities, and the surface fields where positions are given.

    Parameters
    ----------
    factors
        Values by factor name: scalars, ``DataArray`` of any dimensions, or plain sequences, which become a dimension
        named after their factor; dimensions broadcast, so sequences span the full factorial. A table spans none: every
        row of a ``pandas.DataFrame``, of the ``pandas.Series`` in a mapping, which share an index, and every mapping of
        a list is one case, along the one dimension ``case`` with the labels of the index. A cell that is masked, NA or
        None is NaN. A heading may have a unit, as ``radius [mm]``. Rows of several kinds (lines and points, materials
        and composites) are solved kind by kind; cells that a kind has no use for are empty, and a row is NaN in the
        quantities of other kinds. ``load`` must be given, what the ``profile`` needs (default ``cylinder``:
        ``radius``; see ``solver.names.PROFILES``; or a :class:`Profile` of one's own), and either ``material`` (a name
        or :class:`Material`) or the fraction of a composite (``composite``, default ``fibrous``; see
        ``solver.names.COMPOSITES``). The rest default to 0 (``datum``: 1 m; ``electric`` and ``magnetic``: conducting).
        A case with a ``thickness`` is a film on its ``base``, graded with a ``base_volume_fraction``, see
        ``solver.names.OF_A_FILM``; NaN and empty names mean that a case has none. A film that something warm
        touches (``touch_temperature``, ``hold``) has the quantities of ``solver.names.HEAT_QUANTITIES`` as well.
        Instead of material, film and base a ``body`` may be given: a :class:`Stack`, or a list. Beside a film's contact
        is air, where that can be, unless ``surroundings`` is ``insulated``: voltages and capacitances are others by
        factors.
    positions
        Surface positions X = (x - c)/h, or r/a of a point contact, dimensionless. At an edge, +-1, contact pressure and
        shear traction are 0 where the punch is smooth; all other fields, which jump or are infinite there, are NaN.
    materials
        Own materials by name, beside the built-in ones.
    phases
        Phase one and phase two of a composite, names or :class:`Material`.
    regular
        Also give ``<field>_regular``, the square-root singular fields times sqrt|1 - X^2|.
    peaks
        Also give the quantities of ``solver.names.PEAKS``, or ``FILM_PEAKS`` of films, or those of them that are named:
        they are searched for over the body, some milliseconds a case where the others take some microseconds, under a
        point a second, and need c12.
    outputs
        Names of ``solver.names.ALL_QUANTITIES`` to return, those of a search among them; by default all but these. In
        space stiffness, blocked force and voltage per force take half of the time: they are solved if named.

    Returns
    -------
    xarray.Dataset
        Quantities over the factors' dimensions, fields over these and ``position``; names and units as in
        ``solver.names``. Values that a dimension does not change are broadcast views, not copies. A quantity that
        some case does not have is left out: the potentials of a field that a punch does not conduct; peak pressure,
        edge intensities and edge stresses at a corner of the punch, where they are infinite; what only films or only
        half-planes have, where both are asked for; those of heat where a constant is not known, which the attribute
        ``heat`` names.

    Raises
    ------
    FactorError
        Unknown, missing, non-finite or out-of-range factor or position; an unknown name in ``peaks`` or ``outputs``; a
        charge on an insulating punch; a speed that is not below the limiting one; a film without base, or a base
        without film; a contact that would need tension, one beyond the resolved range of a film, or several for one
        load. Names field, value and what is allowed.
    MaterialError
        Unknown or inadmissible material.

    Warns
    -----
    SmallStrainWarning
        Contact half-widths above 0.2 of the punch's radius, or depths above 0.1 of the thickness of a film on a rigid
        or much stiffer base: one line with the number of cases and the worst one.

    Examples
    --------
    >>> answer = solve({"material": "PZT-4", "radius": 0.05, "load": [1e4, 4e4]}, positions=[0.0, 2.0])
    >>> dict(answer.sizes), answer["voltage"].attrs["units"]
    ({'load': 2, 'position': 2}, 'V')
    >>> half = answer["contact_trailing"]  # as the square root of the load
    >>> float((half[1] / half[0]).round(12))
    2.0
    >>> abs(answer["contact_pressure"].sel(position=2.0)).values.tolist()
    [0.0, 0.0]
    >>> roller = {"material": "PZT-4", "radius": "50 mm"}
    >>> dict(solve([roller | {"load": 1e4}, roller | {"load": 4e4}]).sizes)
    {'case': 2}
    """
    if parts := of_kinds(factors):
        solve_kind = partial(solve, materials=materials, phases=phases, regular=regular, peaks=peaks, outputs=outputs)
        return solved_by_kind(parts, lambda part: solve_kind(part, positions))
    arrays = checked(factors, materials)
    pressed = {name: array for name, array in arrays.items() if name not in OF_HEAT}
    cases = Cases(pressed, materials, phases)
    X = None if positions is None else _axis("positions", positions)
    requested = None if outputs is None else _known("outputs", outputs, ALL_QUANTITIES)
    searched = frozenset(ALL_PEAKS if peaks else ()) if isinstance(peaks, bool) else _known("peaks", peaks, ALL_PEAKS)
    if requested is not None:
        searched |= requested & ALL_PEAKS.keys()
        requested |= searched
    strains = list[Excess]()

    def part(cases: Cases) -> xr.Dataset:
        coordinates, inner = cases.coordinates, np.empty(1) if X is None else np.where(np.abs(X) == 1, _WITHIN, X)

        def solved(block: Cases) -> tuple[dict[str, Array], dict[str, Array]]:
            body = body_of(block)
            values = body.requested(requested) | (body.peaks(searched) if searched else {})
            return values, {} if X is None else body.surface(inner, regular=regular)

        searching = _SEARCH if searched else 1
        values, fields = cases.by_blocks(solved, (), inner.shape, values=max(inner.size, searching))
        strains.extend(excesses(cases, values))
        outputs = cases.labelled(values, ALL_QUANTITIES, _OF)
        if X is not None:
            attrs = ALONG if cases.kind.contact == "line" else ACROSS
            coordinates |= {"position": xr.Variable("position", X, attrs)}
            outputs |= _on_surface(cases, fields, X)
        return xr.Dataset(outputs, coordinates)

    out = cases.solved("exact solution of a punch on a magneto-electro-elastic half-plane", part)
    if "touch_temperature" in arrays:
        from solver.face.heat import with_heat  # few cases are touched

        out = with_heat(out, arrays, materials, phases)
    if strains:
        count = prod(cases.sizes.values())
        warnings.warn(SmallStrainWarning(sentence(strains, count), strains), stacklevel=2)
    first = [name for name in ALL_QUANTITIES if name in out and (requested is None or name in requested)]
    ordered = [*first, *(name for name in out.data_vars if name not in ALL_QUANTITIES)]
    return out if ordered == list(out.data_vars) else out[ordered]


def body_of(cases: Cases) -> Body:
    """Return the solved body of cases of one kind."""
    kind = cases.kind
    module, name = _BODIES[kind.touch, kind.layered, kind.air]
    body_class = cast(Callable[[Cases], Body], getattr(import_module(f"solver.face.{module}"), name))
    return body_class(cases)


_CARRIED = ("contact_pressure", "shear_traction")  # fields that tend to 0 at a smooth edge
_WITHIN = 0.5  # position at which fields are solved in place of an edge
_SEARCH = 256  # numbers per case in a search: 100 kB of temporaries
_OF = "factors (contact as wide as the datum, or overflow)"


def _on_surface(cases: Cases, fields: Mapping[str, Array], X: Array) -> dict[str, xr.Variable]:
    """Return surface fields at positions, at an edge 0 if that is their limit from both sides, else NaN."""
    axis = {"position": xr.Variable("position", X)}
    hollow = cases.kind.space  # fields beyond the solved window are NaN
    result = cases.labelled(fields, EVERY_FIELD, "factors and positions (overflow)", axis, hollow=hollow)
    if not np.any(edge := np.abs(X) == 1):
        return result
    leading, trailing = cases.smooth_edges
    smooth = ((X == -1) & leading) | ((X == 1) & trailing)
    at_edges = {name: np.where(smooth & (name in _CARRIED), 0.0, np.nan) for name in result}
    return {
        name: variable.copy(data=np.where(edge, at_edges[name], variable.values)) for name, variable in result.items()
    }


def _known(option: str, names: Collection[str], known: Collection[str]) -> frozenset[str]:
    """Return the names of an option, or refuse the first unknown one."""
    names = [names] if isinstance(names, str) else names
    for name in names:
        if name not in known:
            raise FactorError(f"{option}: {name!r} is not one of {', '.join(known)}")
    return frozenset(names)


def _axis(name: str, values: Iterable[float]) -> Array:
    """Return the coordinates of an axis of the outputs, or refuse what is no list of finite numbers; (point,)."""
    points = np.empty(())
    with suppress(TypeError, ValueError):
        values = unmasked(values)
        points = np.asarray(values if isinstance(values, np.ndarray) else list(values), dtype=np.float64)
    if points.ndim != 1 or not points.size:
        raise FactorError(f"{name}: not a list of at least one number")
    if (bad := points[~np.isfinite(points)]).size:
        raise FactorError(f"{name}: {bad[0]:g} is not allowed; any finite number")
    return points


_ALONG_X = {"units": "1", "long_name": "position (x - c)/h along the surface"}
_ALONG_Y = {"units": "1", "long_name": "height y/h over the surface"}


def solve_interior(
    factors: Factors,
    x: Iterable[float],
    y: Iterable[float],
    *,
    fields: Sequence[str] | None = None,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Exact fields inside half-planes, films and their bases, on the surface too, for every case on a grid.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solve`.
    x, y
        (x - c)/h and y/h <= 0, dimensionless: the grid is their product. At an edge of the contact, (+-1, 0), fields
        are NaN. On the surface the fields are those of the body. Under a film the fields are those of its base; a rigid
        base has none: NaN. A point on an interface belongs to the film.
    fields
        Names of ``solver.fields.INTERIOR`` and ``INTERIOR_ON_REQUEST``; by default all of the former, without what
        needs c12 if a material has none.

    Returns
    -------
    xarray.Dataset
        Fields over the factors' dimensions, ``y`` and ``x``, SI units. Potentials in a film above a grounded interface
        are absolute.

    Raises
    ------
    FactorError
        As :func:`solve`; a point above the surface; an unknown field.
    MaterialError
        Unknown or inadmissible material, or one without c12 when a field asked for needs it; inside a film, points
        some hundred thicknesses beside the contact, or the magnetic potential over a base that insulates that field.

    Examples
    --------
    >>> film = {"material": "BaTiO3", "thickness": 0.5e-3, "base": "rigid", "radius": 0.05, "load": 1e5}
    >>> round(float(solve_interior(film, [0.0], [-1.0], fields=["stress_yy"])["stress_yy"].squeeze()) / 1e6, 3)
    -221.335
    """
    if parts := of_kinds(factors):
        solve_kind = partial(solve_interior, fields=fields, materials=materials, phases=phases)
        return solved_by_kind(parts, lambda part: solve_kind(part, x, y))
    cases = Cases(checked(factors, materials), materials, phases)
    grid_x, grid_y = _axis("x", x), _axis("y", y)
    if np.any(grid_y > 0):
        raise FactorError(f"y: {grid_y.max():g} is above the surface; y/h must be <= 0")
    _known("fields", fields or (), EVERY_INTERIOR)
    edges = (grid_y == 0)[:, None] & (np.abs(grid_x) == 1)  # where fields are infinite or jump
    axes = {"y": xr.Variable("y", grid_y, _ALONG_Y), "x": xr.Variable("x", grid_x, _ALONG_X)}

    def part(cases: Cases) -> xr.Dataset:
        body = body_of(cases)
        values = body.interior(grid_x, grid_y, fields)
        if np.any(edges):
            values = {name: np.where(edges, np.nan, field) for name, field in values.items()}
        hollow = body.hollow or bool(np.any(edges))
        outputs = cases.labelled(values, EVERY_INTERIOR, "factors and points (overflow)", axes, hollow=hollow)
        return xr.Dataset(outputs, cases.coordinates | axes)

    return cases.solved("exact fields inside a magneto-electro-elastic half-plane below a punch", part)


def solve_curves(
    factors: Factors,
    regions: Sequence[str] = tuple(REGIONS),
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Exact stresses on the panels of regions, of which the peaks of every case are the largest measures.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solver.solve`.
    regions
        Names in ``solver.curves.REGIONS``.

    Returns
    -------
    xarray.Dataset
        ``solver.curves.SIZES`` that every case has over the factors' dimensions, and ``<region>_<field>`` over these
        and ``<region>_point`` for the regions that every case has: a half-plane its ``body``, a film its ``interface``,
        a homogeneous one ``film``, one on an elastic base ``base``. SI units.

    Raises
    ------
    FactorError, MaterialError
        As :func:`solver.solve` with peaks; an unknown region.

    Examples
    --------
    >>> import solver
    >>> from solver.curves import VON_MISES
    >>> case = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}
    >>> curves = solve_curves(case, ["body"])
    >>> stresses = [curves[f"body_stress_{name}"].values for name in ("xx", "yy", "xy", "zz")]
    >>> largest = VON_MISES.of(np.stack(stresses, -1)).max()
    >>> bool(abs(largest / solver.solve(case, peaks=True)["peak_von_mises"] - 1) < 0.01)
    True
    """
    if parts := of_kinds(factors):
        return solved_by_kind(parts, lambda part: solve_curves(part, regions, materials=materials, phases=phases))
    cases = Cases(checked(factors, materials), materials, phases)
    _known("regions", regions, REGIONS)

    def part(cases: Cases) -> xr.Dataset:
        body, coordinates = body_of(cases), cases.coordinates
        values = body.curves(regions)
        outputs = cases.labelled({name: values[name] for name in SIZES if name in values}, SIZES, _OF)
        for name in regions:
            table = described(name)
            if not values.keys() >= table.keys():
                continue
            attrs = {"units": "1", "long_name": f"number of a point of the panels over the {name}"}
            axis = {f"{name}_point": xr.Variable(f"{name}_point", np.arange(REGIONS[name].panels.size), attrs)}
            outputs |= cases.labelled({key: values[key] for key in table}, table, _OF, axis)
            coordinates |= axis
        return xr.Dataset(outputs, coordinates)

    return cases.solved("exact stresses inside a magneto-electro-elastic body below a punch", part)
