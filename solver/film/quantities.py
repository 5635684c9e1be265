"""Every quantity of films by its name: those of a half-plane that a contact has, and those that only a film has."""

from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.film.contact import FilmContact
from solver.film.crest import peak_pressure
from solver.film.curves import region_curves
from solver.film.net import DEPTH
from solver.film.peaks import PeakTable
from solver.film.similar import Films
from solver.film.stack import StackError
from solver.film.table import RangeError
from solver.film.windows import Kind, peak_window
from solver.names import RESPONSES

_STEPS = 20
_CLOSE = 1e-9  # of a charge: the next step is of its square

#: Cases, a table of their stresses, and their contacts in it.
PeakTables = Iterator[tuple[Indices, PeakTable, FilmContact]]

_INTERFACE = ("interface_shear", "interface_shear_position", "interface_tension", "interface_tension_position")


def quantities(films: Films) -> dict[str, Array]:
    """Quantities of ``solver.names.QUANTITIES`` and ``FILM_QUANTITIES`` that the cases have; (case,) each.

    Left out are the response of a field that the punch does not conduct, and what is infinite at a corner.
    """
    films.require_one_length()
    h, gather = films.thickness, films.gather
    out = {
        "contact_trailing": h * gather(lambda c: c.trailing),
        "contact_leading": h * gather(lambda c: c.leading),
        "contact_offset": h * gather(lambda c: c.offset),
        "pressure_exponent": gather(lambda c: np.full(c.load.shape, c.exponent)),
        "depth": h * gather(lambda c: c.depth),
    }
    smooth = films.kind.smooth
    if all(smooth):
        out["peak_pressure"] = gather(peak_pressure)
    for name, stress, edge, is_smooth in (
        ("trailing", "trailing_tension", 1.0, smooth[0]),
        ("leading", "leading_compression", -1.0, smooth[1]),
    ):
        if is_smooth:
            if not films.kind.electroded:
                out[stress] = gather(_at(FilmContact.edge_stress, edge))
            intensity = np.sqrt(h)[:, None] * gather(_at(FilmContact.edge_intensity, edge))
            out[f"electric_edge_intensity_{name}"] = intensity[:, 0]
            out[f"magnetic_edge_intensity_{name}"] = intensity[:, 1]
    for field, conducts in enumerate(films.kind.conducts):
        if conducts:
            out |= _responses(films, field)
    if "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (h * films.kind.above_ground)
    return out


def _at(output: Callable[[FilmContact, float], Array], edge: float) -> Callable[[FilmContact], Array]:
    return lambda contact: output(contact, edge)


def _responses(films: Films, field: int) -> dict[str, Array]:
    """Response of a field that the punch conducts."""
    j = 1 + field
    t = films.gather(lambda c: c.tangents)
    uncharged = films.with_charges(np.zeros_like(films.charges)) if np.any(films.charges) else films
    values = (
        films.thickness * films.gather(lambda c: c.potential(field)),
        uncharged.gather(lambda c: c.tangents[:, j, 0]),
        _short_circuit(uncharged, field),
        *driven(t, j),
        1 / films.gather(lambda c: c.at_fixed_contact[:, j, field]),
    )
    return dict(zip(RESPONSES[field], values, strict=True))


def driven(tangents: Array, j: int) -> tuple[Array, Array]:
    """Depth per potential at a fixed load, and load per potential at a fixed depth; (...) each.

    Parameters
    ----------
    tangents
        d (depth, voltage, magnetic potential) / d (P, T, J), SI; (..., 3, 3).
    j
        1 of the voltage, 2 of the magnetic potential.
    """
    t = np.moveaxis(tangents, (-2, -1), (0, 1))
    return t[0, j] / t[j, j], 1 / (t[j, 0] - t[j, j] * t[0, 0] / t[0, j])


def _short_circuit(uncharged: Films, field: int) -> Array:
    """Charge per load that makes the potential 0, the other charge 0 [C/N, Wb/N]."""
    j, state = 1 + field, uncharged
    for _ in range(_STEPS):
        potential = state.thickness * state.gather(lambda c: c.potential(field))
        step = potential / state.gather(lambda c: c.tangents[:, j, j])
        charges = np.array(state.charges)
        charges[:, field] -= step
        state = state.with_charges(charges)
        if np.all(np.abs(step) <= _CLOSE * np.abs(charges[:, field])):
            break
    return np.asarray(state.charges[:, field] / state.load)


def peaks(films: Films, asked: Set[str]) -> dict[str, Array]:
    """Quantities of ``solver.names.FILM_PEAKS`` that are asked for and the cases have; (case,) each.

    A film of several layers has those of its lowest interface and of its base.

    Parameters
    ----------
    films : Films, the cases
    asked : set of str, names of quantities

    Raises
    ------
    RangeError
        A contact so wide that the film has no depth below 0.1 h.
    StackError
        A graded film, whose stresses are not tabulated.
    """
    return peaks_of(films, asked, _peak_tables(films))


def peaks_of(films: Films, asked: Set[str], tables: PeakTables) -> dict[str, Array]:
    """The same from tables of some of the cases each.

    Parameters
    ----------
    films : Films, the cases
    asked : set of str, names of quantities
    tables : iterable of places among the cases, table and contacts of these
    """
    bodies = [body for body in _bodies(films.kind) if any(name.startswith(f"{body}_") for name in asked)]
    names = [*_INTERFACE] if asked & set(_INTERFACE) else []
    names += [f"{body}_peak_{of}" for body in bodies for of in ("von_mises", "principal_tension")]
    out = {name: np.empty(films.load.size) for name in names}
    for places, of, own in tables if names else ():
        read: list[Array] = []
        if _INTERFACE[0] in out:
            interface = of.interface(own)
            read += [interface.shear, interface.shear_position, interface.tension, interface.tension_position]
        for body in bodies:
            largest = of.film(own) if body == "film" else of.base(own)
            read += [largest.von_mises, largest.principal_tension]
        for name, value in zip(names, read, strict=True):
            out[name][places] = value
    return {name: values for name, values in out.items() if name in asked}


def curves(films: Films, regions: Sequence[str]) -> dict[str, Array]:
    """Sizes of the contacts, and the curves of regions that the cases have, see ``solver.curves``; (case, ...) each.

    Raises as :func:`peaks`.

    Parameters
    ----------
    films : Films, the cases
    regions : sequence of str, of ``solver.curves.REGIONS``
    """
    films.require_one_length()
    return curves_of(films, regions, _peak_tables(films))


def curves_of(films: Films, regions: Sequence[str], tables: PeakTables) -> dict[str, Array]:
    """The same from tables of some of the cases each.

    Parameters
    ----------
    films : Films, the cases
    regions : sequence of str, of ``solver.curves.REGIONS``
    tables : iterable of places among the cases, table and contacts of these
    """
    sizes = ("mean_pressure", "half_length")
    out = {name: np.empty(films.load.size) for name in sizes} | {"load_over_thickness": films.load / films.thickness}
    for places, of, own in tables:
        half_length = films.thickness[places] * own.half_width
        out["half_length"][places] = half_length
        out["mean_pressure"][places] = films.load[places] / (2 * half_length)
        for region in regions:
            if region == "interface" or region in _bodies(films.kind):
                for name, values in region_curves(of, own, region).items():
                    out.setdefault(name, np.empty((films.load.size, values.shape[1])))[places] = values
    return out


def _peak_tables(films: Films) -> PeakTables:
    """Cases with the table of stresses of their window, and their contacts in it."""
    if films.kind.stack().top.graded:
        raise StackError("peaks: are not given of a film that is graded")
    for places, number, contact in films.parts:
        require_depth(films.kind, contact.half_width)
        of = peak_window(films.kind, number)
        yield places, of, replace(contact, table=of.table)


def require_depth(kind: Kind, half_lengths: Array) -> None:
    """Refuse contacts so wide that the film has no depth below 0.1 h.

    Parameters
    ----------
    kind : Kind, that of the films
    half_lengths : ndarray, over the top layer's thickness

    Raises
    ------
    RangeError
        With the widest.
    """
    thickness = kind.stack().thickness
    if np.any(half_lengths > 0.99 / DEPTH * thickness):
        widest = np.max(half_lengths) / thickness
        raise RangeError(
            f"contact: half-length over thickness {widest:g} is too wide for peaks; must be < {1 / DEPTH:g}"
        )


def _bodies(kind: Kind) -> list[str]:
    """Bodies whose largest stresses are given: panels through several layers would meet their jumps."""
    return ["film"] * kind.uniform + ["base"] * (kind.base is not None)
