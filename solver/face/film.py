"""Cases of films: from their factors to contacts, all of one kind from the same tables, and outputs by name."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.face.cases import Cases
from solver.face.filmfactors import absent
from solver.face.materials import base_of, material_of
from solver.face.refusal import FactorError
from solver.film.along import fields
from solver.film.inside import inside
from solver.film.quantities import peaks, quantities
from solver.film.similar import Constants, Films, Kind
from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.material.constants import UNITS, Material, MaterialError
from solver.names import CHOICES, FIELDS, INTERIOR, NEED_C12, SINGULAR

_STRUCTURE = tuple(key for key in UNITS if key != "rho")


@dataclass(frozen=True, eq=False)
class _Group:
    """Cases that share one set of tables, and their places among all."""

    places: NDArray[np.intp]
    kind: Kind


class OnFilm:
    """Contact of cases of one kind of punch on films, each on its base.

    Raises
    ------
    FactorError, MaterialError
        An unknown base, an interface that a base does not have, inadmissible materials, a contact that does not exist.
    """

    #: A rigid base has no fields inside.
    hollow = True

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self.shape = tuple(cases.sizes.values())
        self._groups = list(self._grouped())

    def quantities(self) -> dict[str, Array]:
        """Those of ``solver.names.QUANTITIES`` and ``FILM_QUANTITIES`` that every case has; (...)."""
        return self._put_together(quantities)

    def peaks(self) -> dict[str, Array]:
        """Those of ``solver.names.FILM_PEAKS`` that every case has; (...)."""
        if (lacks := self._lacks_c12) is not None:
            raise MaterialError(f"{lacks}: c12: missing; film_peak_von_mises needs it [Pa]")
        return self._put_together(peaks)

    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """The surface fields at X, the singular ones also in regular form if asked; (..., position)."""

        def found(films: Films) -> dict[str, Array]:
            values = fields(films, positions)
            if regular:
                root = np.sqrt(np.abs((1 - positions) * (1 + positions)))
                values |= {f"{name}_regular": values[name] * root for name in SINGULAR}
            return values

        whole = self._put_together(found)
        order = [name for field in FIELDS for name in (field, f"{field}_regular") if name in whole]
        return {name: whole[name] for name in order}

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """The fields asked for, by default all of ``INTERIOR`` that the materials have; (..., y, x)."""
        names = tuple(asked or [name for name in INTERIOR if name not in NEED_C12 or self._lacks_c12 is None])
        if (lacks := self._lacks_c12) is not None:
            for name in names:
                if name in NEED_C12:
                    raise MaterialError(f"{lacks}: c12: missing; {name} needs it [Pa]")

        def found(films: Films) -> dict[str, Array]:
            return dict(zip(names, np.moveaxis(inside(films, x, y, names), 1, 0), strict=True))

        return self._put_together(found)

    @property
    def _lacks_c12(self) -> str | None:
        """The name of a material without c12, of films and of bases that are not rigid."""
        base, rigid = self._base
        for material, there in ((self._material, True), (base, ~rigid)):
            if np.any(np.isnan(material.c12) & there):
                return material.name
        return None

    @np.errstate(all="ignore")  # what is not finite is named in the outputs
    def _put_together(self, output: Callable[[Films], dict[str, Array]]) -> dict[str, Array]:
        """Outputs of every group in the places of their cases; those that every group has."""
        try:
            # films are made anew for every output: tables of thousands of stacks are not held at once
            parts = [output(self._films(group)) for group in self._groups]
        except ContactError as error:
            raise FactorError(str(error)) from None
        out: dict[str, Array] = {}
        for name in parts[0]:
            if not all(name in part for part in parts):
                continue
            own = parts[0][name].shape[1:]
            whole = np.empty((int(np.prod(self.shape)), *own))
            for group, part in zip(self._groups, parts, strict=True):
                whole[group.places] = part[name]
            out[name] = whole.reshape((*self.shape, *own))
        return out

    # -- groups --------------------------------------------------------------------------------------------------------
    @cached_property
    def _material(self) -> Material:
        return material_of(self.cases)

    @cached_property
    def _base(self) -> tuple[Material, NDArray[np.bool_]]:
        return base_of(self.cases)

    def _grouped(self) -> Iterator[_Group]:
        """Cases by stack, friction and conduction, told apart at the smallest shape that these have."""
        base, rigid = self._base
        conducts = self.cases.conducts
        interfaces = [self._interface(name) for name in ("interface_electric", "interface_magnetic")]
        columns = [
            *(np.nan_to_num(getattr(self._material, key), nan=np.inf) for key in _STRUCTURE),
            *(np.where(rigid, 0.0, np.nan_to_num(getattr(base, key), nan=np.inf)) for key in _STRUCTURE),
            rigid, *interfaces, self.cases.number("friction"), conducts[..., 0], conducts[..., 1],
        ]  # fmt: skip
        table = np.stack(np.broadcast_arrays(*(np.asarray(c, dtype=np.float64) for c in columns)), -1)
        kinds, which = np.unique(table.reshape(-1, table.shape[-1]), axis=0, return_inverse=True)
        shape = (1,) * (len(self.shape) - table.ndim + 1) + table.shape[:-1]
        of_case = np.broadcast_to(which.reshape(shape), self.shape).ravel()
        for number, row in enumerate(kinds.tolist()):
            yield _Group(np.flatnonzero(of_case == number), self._kind(row))

    def _interface(self, name: str) -> Array:
        """What the interface is to a field: the place among the choices, -1 for the default of its base."""
        values = self.cases.values.get(name, np.array(None, dtype=object))
        codes = [-1.0 if absent(value) else CHOICES[name].index(str(value)) for value in values.flat]
        return np.array(codes).reshape(values.shape)

    def _kind(self, row: list[float]) -> Kind:
        count = len(_STRUCTURE)
        rigid, electric, magnetic, friction, *conducts = row[2 * count :]
        profile = self.cases.profile
        kind = Kind(
            top=_constants(row[:count]),
            base=None if rigid else _constants(row[count : 2 * count]),
            electric=None if electric < 0 else CHOICES["interface_electric"][int(electric)],
            magnetic=None if magnetic < 0 else CHOICES["interface_magnetic"][int(magnetic)],
            friction=friction,
            conducts=(bool(conducts[0]), bool(conducts[1])),
            smooth=profile.smooth,
            degree=max(len(profile.slope) - 1, 1),
        )
        kind.stack()  # refuses what its base does not have before anything is computed
        return kind

    def _films(self, group: _Group) -> Films:
        def chosen(values: Any) -> Array:
            return np.asarray(np.broadcast_to(values, self.shape).ravel()[group.places])

        p, number = self.cases.profile, self.cases.number
        profile = Profile(
            tuple(chosen(c) for c in p.slope), p.smooth,
            None if p.width is None else chosen(p.width),
            None if p.moment is None else chosen(p.moment),
        )  # fmt: skip
        charges = np.stack([chosen(number("charge")), chosen(number("magnetic_charge"))], -1)
        return Films(
            group.kind, profile, chosen(number("load")), charges, chosen(number("datum")), chosen(number("thickness"))
        )


def _constants(row: list[float]) -> Constants:
    """Constants in the order of ``UNITS``; the density has no part."""
    known = dict(zip(_STRUCTURE, row, strict=True))
    return tuple(None if np.isinf(value := known.get(key, np.inf)) else value for key in UNITS)
