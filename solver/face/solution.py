"""The labelled face of the solver: named factors in, an ``xarray.Dataset`` with units out."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType

import numpy as np
import xarray as xr

from solver.arrays import Array, unmasked
from solver.face.bodies import body_of
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.refusal import FactorError
from solver.face.rows import Factors
from solver.fields import ACROSS, ALONG, EVERY_FIELD
from solver.material.constants import Material
from solver.names import ALL_PEAKS, ALL_QUANTITIES


def solve(
    factors: Factors,
    positions: Iterable[float] | None = None,
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
    regular: bool = False,
    peaks: bool | Collection[str] = False,
) -> xr.Dataset:
    """Exact solution of every case: all quantities, and the surface fields where positions are given.

    Parameters
    ----------
    factors
        Values by factor name: scalars, ``DataArray`` of any dimensions, or plain sequences, which become a dimension
        named after their factor; dimensions broadcast, so sequences span the full factorial. A table spans none: every
        row of a ``pandas.DataFrame``, and every mapping of a list, is one case, along the one dimension ``case`` with
        the labels of the frame's index. A cell that is masked, NA or None is NaN. ``load`` must be given,
        what the ``profile`` needs (default ``cylinder``: ``radius``; see ``solver.names.PROFILES``; or a
        :class:`Profile` of one's own), and either ``material`` (a name or :class:`Material`) or the fraction of a
        composite (``composite``, default ``fibrous``; see ``solver.names.COMPOSITES``). The rest default to 0
        (``datum``: 1 m; ``electric`` and ``magnetic``: conducting). A case with a ``thickness`` is a film on its
        ``base``, graded with a ``base_volume_fraction``, see ``solver.names.OF_A_FILM``; NaN and empty names mean that
        a case has none. Instead of material, film and base a ``body`` may be given: a :class:`Stack`, or a list.
        Beside a film's contact is air, where that can be, unless ``surroundings`` is ``insulated``: voltages and
        capacitances are others by factors.
    positions
        Surface positions X = (x - c)/h, or r/a of a point contact, dimensionless, any but +-1.
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

    Returns
    -------
    xarray.Dataset
        Quantities over the factors' dimensions, fields over these and ``position``; names and units as in
        ``solver.names``. Values that a dimension does not change are broadcast views, not copies. A quantity that
        some case does not have is left out: the potentials of a field that a punch does not conduct; peak pressure,
        edge intensities and edge stresses at a corner of the punch, where they are infinite; what only films or only
        half-planes have, where both are asked for.

    Raises
    ------
    FactorError
        Unknown, missing, non-finite or out-of-range factor or position; an unknown name in ``peaks``; a charge on an
        insulating punch; a speed that is not below the limiting one or a film's critical one; a film without base, or a
        base without film; a contact that would need tension, one beyond the resolved range of a film, or several for
        one load. Names field, value and what is allowed.
    MaterialError
        Unknown or inadmissible material.

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
    cases = Cases(checked(factors), materials, phases)
    X = None if positions is None else _positions(positions)
    searched = _searched(peaks)

    def part(cases: Cases) -> xr.Dataset:
        body, coordinates = body_of(cases), cases.coordinates
        values = body.quantities() | (body.peaks(searched) if searched else {})
        outputs = cases.labelled(values, ALL_QUANTITIES, "factors (contact as wide as the datum, or overflow)")
        if X is not None:
            coordinates |= (
                axis := {"position": xr.Variable("position", X, ALONG if cases.kind.contact == "line" else ACROSS)}
            )
            fields = body.surface(X, regular=regular)
            outputs |= cases.labelled(fields, EVERY_FIELD, "factors and positions (overflow)", axis)
        return xr.Dataset(outputs, coordinates)

    out = cases.solved("exact solution of a punch on a magneto-electro-elastic half-plane", part)
    first = [name for name in ALL_QUANTITIES if name in out]
    return out[[*first, *(name for name in out.data_vars if name not in first)]]


def _searched(peaks: bool | Collection[str]) -> frozenset[str]:
    """Names of the quantities that are searched for."""
    if isinstance(peaks, bool):
        return frozenset(ALL_PEAKS if peaks else ())
    for name in peaks:
        if name not in ALL_PEAKS:
            raise FactorError(f"peaks: {name!r} is unknown; known are {', '.join(ALL_PEAKS)}")
    return frozenset(peaks)


def _positions(positions: Iterable[float]) -> Array:
    X = np.empty(())
    with suppress(TypeError, ValueError):
        positions = unmasked(positions)
        X = np.asarray(positions if isinstance(positions, np.ndarray) else list(positions), dtype=np.float64)
    if X.ndim != 1 or not X.size:
        raise FactorError("positions: not a list of at least one number")
    bad = X[~np.isfinite(X) | (np.abs(X) == 1)]
    if bad.size:
        raise FactorError(f"positions: {bad[0]:g} is not allowed; any finite X but -1 and 1 (the edges are singular)")
    return X
