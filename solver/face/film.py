"""Cases on films: from their factors to contacts, which share tables by kind, and to outputs by name."""

from collections.abc import Callable, Iterator, Sequence, Set
from typing import Any, ClassVar, NamedTuple

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, distinct_rows, fields_by_name
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
    """Functions of films, of the permittivity in the gaps beside their contacts, and of the request."""

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
        self._bodies = self._films_of_cases()
        self._groups = list(self._grouped())

    def quantities(self) -> dict[str, Array]:
        """Quantities of the kind, and of its electrodes if one is read, that every case has; (...)."""
        if (reading := reading_of(self.cases)) is None:
            return self._of_groups(self._outputs.quantities)
        parts = ((index, self._films(index, kind)) for index, kind in self._groups)
        return self._put_together(
            (index, quantities(films) | electrode_quantities(films, reading.part(index))) for index, films in parts
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

        return self._of_groups(lambda *arguments: fields_by_name(names, self._outputs.inside(*arguments)), x, y, names)

    @property
    def _lacks_c12(self) -> str | None:
        return self._bodies.lacks_c12

    def _medium(self, index: Indices) -> tuple[Array, ...]:
        """Relative permittivity in the gaps of the indexed cases, in a tuple that is empty without air."""
        return ()

    def _of_groups(self, output: Callable[..., dict[str, Array]], *requested: Any) -> dict[str, Array]:
        """Return outputs of every group's films, created here and dropped: there can be thousands of tables."""
        return self._put_together(
            (index, output(self._films(index, kind), *self._medium(index), *requested)) for index, kind in self._groups
        )

    def _films_of_cases(self) -> Bodies:
        """Return the films and bases of the cases."""
        return films_of(self.cases)

    # -- groups --------------------------------------------------------------------------------------------------------
    def _grouped(self) -> Iterator[tuple[Indices, Kind]]:
        """Yield the indices and the kind of cases with the same film, friction, conduction and punch."""
        conducts, punch = self.cases.conducts, punch_of(self.cases)
        sliding = [self.cases.number("friction"), conducts[..., 0], conducts[..., 1]]
        columns = [self._bodies.which, *sliding, punch.compliance, punch.coupling]
        table = np.stack(np.broadcast_arrays(*(np.asarray(c, dtype=np.float64) for c in columns)), -1)
        kinds, which = distinct_rows(table.reshape(-1, table.shape[-1]))
        shape = (1,) * (len(self.shape) - table.ndim + 1) + table.shape[:-1]
        kind_index = np.broadcast_to(which.reshape(shape), self.shape).ravel()
        for number, row in enumerate(kinds.tolist()):
            yield np.flatnonzero(kind_index == number), self._kind(row)

    def _kind(self, row: list[float]) -> Kind:
        """Return the kind of film, friction, conduction of both fields, and compliance and coupling of the punch."""
        which, friction, electric, magnetic, compliance, coupling = row
        profile, stack = self.cases.profile, self._bodies.films[int(which)]
        degree = max(len(profile.slope) - 1, 1)
        if metal := stack.electroded or stack.conductors[0]:  # the electrode on top has the potential, not the punch
            refuse_charge(self.cases)
        conducts = bool(electric) and not metal, bool(magnetic)
        return Kind(stack, friction, conducts, profile.smooth, degree, (compliance, coupling))

    def _films(self, index: Indices, kind: Kind) -> Films:
        """Return the contacts of the indexed cases."""
        datum_of_punch = punch_datum(self.cases)
        return Films(
            kind,
            self.cases.profile.part(index, self.shape),
            self._flat(self.cases.force)[index],
            self._flat(self.cases.charges, 2)[index],
            self._flat(self.cases.number("datum"))[index],
            self._flat(self._bodies.thickness)[index],
            None if datum_of_punch is None else self._flat(datum_of_punch)[index],
        )
