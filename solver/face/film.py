"""Cases of films: from their factors to contacts, all of one kind from the same tables, and outputs by name."""

from collections.abc import Callable, Iterator, Sequence, Set
from typing import Any, ClassVar, NamedTuple

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, distinct_rows
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.electrodes import reading_of
from solver.face.filmbodies import Bodies, films_of, refuse_charge
from solver.face.materials import punch_datum, punch_of
from solver.line.electrodecharge import electrode_quantities
from solver.line.fields import fields, interior_fields
from solver.line.quantities import curves, peaks, quantities
from solver.line.similar import Films
from solver.line.windows import Kind
from solver.names import FILM_PEAKS


class Outputs(NamedTuple):
    """Functions of films, of what fills the gaps beside their contacts, and of what is requested."""

    quantities: Callable[..., dict[str, Array]]
    peaks: Callable[..., dict[str, Array]]
    curves: Callable[..., dict[str, Array]]
    fields: Callable[..., dict[str, Array]]
    inside: Callable[..., Array]


class OnFilm(Body):
    """Contact of cases of one kind of punch on films, each on its base."""

    _outputs: ClassVar[Outputs] = Outputs(quantities, peaks, curves, fields, interior_fields)

    def __init__(self, cases: Cases) -> None:
        super().__init__(cases)
        self._bodies = self._made()
        self._groups = list(self._grouped())

    def quantities(self) -> dict[str, Array]:
        """Quantities of the kind, and of its electrodes if one is read, that every case has; (...)."""
        if (reading := reading_of(self.cases)) is None:
            return self._of_groups(self._outputs.quantities)
        parts = ((places, self._films(places, kind)) for places, kind in self._groups)
        return self._put_together(
            (places, quantities(films) | electrode_quantities(films, reading.part(places))) for places, films in parts
        )

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested quantities of ``solver.names.FILM_PEAKS`` that every case has; (...)."""
        self._refuse_electroded("peaks")
        if requested & FILM_PEAKS.keys():
            self._require_c12("film_peak_von_mises needs")
        return self._of_groups(self._outputs.peaks, requested)

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Sizes and curves of regions, see ``solver.curves``, that every case has; (...) and (..., point)."""
        self._refuse_electroded("curves")
        self._require_c12("stresses inside the film need")
        return self._of_groups(self._outputs.curves, regions)

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        self._refuse_electroded("fields")
        values = self._of_groups(self._outputs.fields, positions)
        return self._with_regular(values, positions) if regular else values

    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        self._refuse_electroded("fields")

        def named(*arguments: Any) -> dict[str, Array]:
            return dict(zip(names, np.moveaxis(self._outputs.inside(*arguments), 1, 0), strict=True))

        return self._of_groups(named, x, y, names)

    @property
    def _lacks_c12(self) -> str | None:
        return self._bodies.lacks_c12

    def _medium(self, places: Indices) -> tuple[Array, ...]:
        """Relative permittivity of what fills the gaps of some cases; without air there is none."""
        return ()

    def _of_groups(self, output: Callable[..., dict[str, Array]], *requested: Any) -> dict[str, Array]:
        """Outputs of the films of every group; these are made anew: tables of thousands of stacks are not kept."""
        return self._put_together(
            (places, output(self._films(places, kind), *self._medium(places), *requested))
            for places, kind in self._groups
        )

    def _made(self) -> Bodies:
        """Films and bases of the cases."""
        return films_of(self.cases)

    # -- groups --------------------------------------------------------------------------------------------------------
    def _grouped(self) -> Iterator[tuple[Indices, Kind]]:
        """Cases by film, friction, conduction and punch, told apart at the smallest shape that these have."""
        conducts, punch = self.cases.conducts, punch_of(self.cases)
        sliding = [self.cases.number("friction"), conducts[..., 0], conducts[..., 1]]
        columns = [self._bodies.which, *sliding, punch.compliance, punch.coupling]
        table = np.stack(np.broadcast_arrays(*(np.asarray(c, dtype=np.float64) for c in columns)), -1)
        kinds, which = distinct_rows(table.reshape(-1, table.shape[-1]))
        shape = (1,) * (len(self.shape) - table.ndim + 1) + table.shape[:-1]
        of_case = np.broadcast_to(which.reshape(shape), self.shape).ravel()
        for number, row in enumerate(kinds.tolist()):
            yield np.flatnonzero(of_case == number), self._kind(row)

    def _kind(self, row: list[float]) -> Kind:
        which, friction, electric, magnetic, compliance, coupling = row
        profile, stack = self.cases.profile, self._bodies.films[int(which)]
        degree = max(len(profile.slope) - 1, 1)
        if metal := stack.electroded or stack.conductors[0]:  # the electrode on top has the potential, not the punch
            refuse_charge(self.cases)
        conducts = bool(electric) and not metal, bool(magnetic)
        return Kind(stack, friction, conducts, profile.smooth, degree, (compliance, coupling))

    def _films(self, places: Indices, kind: Kind) -> Films:
        number, datum_of_punch = self.cases.number, punch_datum(self.cases)
        return Films(
            kind,
            self.cases.profile.part(places, self.shape),
            self._flat(self.cases.force)[places],
            self._flat(self.cases.charges, 2)[places],
            self._flat(number("datum"))[places],
            self._flat(self._bodies.thickness)[places],
            None if datum_of_punch is None else self._flat(datum_of_punch)[places],
        )
