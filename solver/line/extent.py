"""Causes of a contact, and its extent under a load by bracketing and Newton's iteration (films, section 4)."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from approximation.arrays import blocks
from solver.arrays import Array, BoolArray, dot, selected, stack
from solver.halfplane.pressing import ContactError, slopes
from solver.halfplane.profile import Profile
from solver.line.outputs import BALANCE, LOAD, PRESSURE
from solver.line.table import LengthsError, RangeError, Table


@dataclass(frozen=True, eq=False)
class Causes:
    """Causes at an extent of the contact, and their derivatives by log h and by c/h."""

    values: Array  # Powers of X in g', T/h, J/h and, between corners, P/h; (..., cause)
    by_width: Array
    by_centre: Array
    constant: Array  # Constant slope a_0 (F4.4); (...)
    constant_by_width: Array
    constant_by_centre: Array


@dataclass(frozen=True, eq=False)
class Loading:
    """Slopes of punches and loads of cases, in the units of a stack."""

    slope: Array  # Coefficients of g' in powers of x; (case, degree + 1)
    loads: Array  # P, T and J; (case, 3)
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge are smooth

    @classmethod
    def of(cls, table: Table, profile: Profile, load: Array, charges: Array) -> Self:
        """Return the loading of cases of P (case,) [N/m] and of T and J (case, 2) [C/m, Wb/m], in SI units."""
        scale = table.system.kernel.stack.scale
        slope = np.zeros((load.size, table.system.degree + 1))
        for k, coefficient in enumerate(profile.slope):
            slope[:, k] = coefficient / scale[1]
        return cls(slope, stack(load * scale[1], charges[:, 0] * scale[2], charges[:, 1] * scale[3]), profile.smooth)

    def part(self, cases: slice) -> "Loading":
        """Return the loading of the selected cases."""
        return selected(self, cases, "slope", "loads")

    @property
    def order(self) -> int:
        """Order k0, 1 between smooth edges, 0 with one corner and -1 between corners."""
        return sum(self.smooth) - 1

    def at(self, half: Array, centre: Array) -> Causes:
        """Causes at contacts of half-length h and c/h, (case,) or (case, node) each."""
        axes = (slice(None), *(None,) * (half.ndim - 1))
        powers, by_width, by_centre = slopes([*np.moveaxis(self.slope[axes], -1, 0)], half, centre)
        loads = self.loads[axes] / half[..., None]
        carried = loads[..., [1, 2, 0]] if self.order == -1 else loads[..., 1:]
        first = max(self.order, 0)
        return Causes(
            np.concatenate([powers[..., first:], carried], -1),
            np.concatenate([by_width[..., first:], -carried], -1),
            np.concatenate([by_centre[..., first:], np.zeros_like(carried)], -1),
            powers[..., 0],
            by_width[..., 0],
            by_centre[..., 0],
        )


_EXTENT_STEPS = 40
_EXTENT_CLOSE = 1e-13
_TENSION = 1e-8  # of the largest pressure over its weight: rounding of the terms at the edges
_CASES = 16384  # cases at a time: bounded memory


class TensionError(ContactError):
    """A contact that would need tension between punch and surface."""


def extent(table: Table, loading: Loading, half_width: Array | None) -> tuple[Array, Array]:
    """Half-length [m] and c/h of every case; (case,) each."""
    count = len(loading.loads)
    half, centre = np.empty(count), np.empty(count)
    for block in blocks(count, _CASES):
        part = loading.part(block)
        if half_width is None:
            half[block], centre[block] = _searched(table, part)
        else:
            half[block], centre[block] = half_width[block], 0.0
            _require_within(table, half[block])
        _refuse_tension(table, part, half[block], centre[block])
    return half, centre


def _searched(table: Table, loading: Loading) -> tuple[Array, Array]:
    """Half-length [m] and c/h of contacts with a smooth edge, by Newton's iteration; (case,) each."""
    log_half, centre, lower, upper = _start(table, loading)
    value, rate = (c[:, [LOAD, BALANCE]] for c in (table.series, table.rates))
    load, smooth = loading.loads[:, 0], loading.order == 1
    for _ in range(_EXTENT_STEPS):
        causes = loading.at(np.exp(log_half), centre)
        polynomials = table.interval.polynomials(log_half)
        outputs, moved = (np.tensordot(polynomials, c, 1) for c in (value, rate))
        carried, balance = (dot(outputs[:, i], causes.values) for i in (0, 1))
        widened, balance_width = (dot(moved[:, i], causes.values) + dot(outputs[:, i], causes.by_width) for i in (0, 1))
        carried = np.where(carried > 0, carried, 1e-3 * load / np.exp(log_half))  # the bracket's upper end carries it
        miss = np.log(np.exp(log_half) * carried / load)
        by_width = 1 + widened / carried
        if smooth:
            shifted, balance_centre = (dot(outputs[:, i], causes.by_centre) for i in (0, 1))
            by_centre = shifted / carried
            off = causes.constant - balance
            off_width = causes.constant_by_width - balance_width
            off_centre = causes.constant_by_centre - balance_centre
            determinant = by_width * off_centre - by_centre * off_width
            step = (miss * off_centre - by_centre * off) / determinant
            move = (by_width * off - off_width * miss) / determinant
            centre = centre - np.clip(move, -0.5, 0.5)
        else:
            step, move = miss / by_width, np.zeros(())
        log_half = np.clip(log_half - step, lower, upper)
        if np.all(np.abs(step) + np.abs(move) < _EXTENT_CLOSE):
            break
        if not np.all(np.isfinite(step)):
            raise ContactError("contact: no contact of this punch carries the load")
    return np.exp(log_half), centre


def _start(table: Table, loading: Loading) -> tuple[Array, Array, Array, Array]:
    """Interpolate log h and c/h between the half-lengths of the table, and bracket log h; (case,) each."""
    carried = load_at_nodes(table, loading)
    load, logs = loading.loads[:, :1], np.log(table.half_lengths)
    enough = carried >= load
    require_one(enough)
    if np.any(enough[:, 0]):
        raise RangeError(_beyond(table, "narrower"))
    if not np.all(enough[:, -1]):
        raise RangeError(_beyond(table, "wider"))
    upper = np.argmax(enough, -1)[:, None]
    low, high = (np.take_along_axis(carried, i, -1) for i in (upper - 1, upper))
    share = np.log(load / np.maximum(low, 1e-3 * load)) / np.log(high / np.maximum(low, 1e-3 * load))
    bracket = logs[upper[:, 0] - 1], logs[upper[:, 0]]
    log_half = bracket[0] + share[:, 0] * (bracket[1] - bracket[0])
    half = np.exp(log_half)
    if loading.order == 1:
        balance = table.interval.read(log_half, table.series[:, BALANCE])
        return log_half, _centred(loading, half, balance), *bracket
    return log_half, _corner(loading, half), *bracket


def require_one(enough: BoolArray) -> None:
    """Refuse loads carried by several lengths, from flags of rising half-lengths that carry it (case, half-length)."""
    if np.any(np.sum(enough[:, 1:] != enough[:, :-1], -1) > 1):
        raise LengthsError("contact: contacts of more than one length carry the load (charges too large for it)")


def load_at_nodes(table: Table, loading: Loading) -> Array:
    """Load that each half-length of the table carries; (case, node)."""
    h, load, smooth = table.half_lengths, table.at_nodes[:, LOAD], loading.order == 1
    if smooth and loading.slope.shape[-1] == 2:  # the slope of a cylinder is independent of the centre
        weights = np.stack([h**2 * load[:, 0], load[:, 1], load[:, 2]])
        return np.asarray(np.concatenate([loading.slope[:, 1:], loading.loads[:, 1:]], -1) @ weights)
    half = np.broadcast_to(h, (len(loading.loads), h.size))
    centre = _centred(loading, half, table.at_nodes[:, BALANCE]) if smooth else _corner(loading, half)
    return half * dot(load, loading.at(half, centre).values)


def _corner(loading: Loading, half: Array) -> Array:
    """c/h of a contact whose corner is the origin, of the shape of ``half``."""
    return np.full(half.shape, float(loading.smooth[0]) - float(loading.smooth[1]))


def _centred(loading: Loading, half: Array, balance: Array) -> Array:
    """c/h that balances two smooth edges, by Newton's iteration (one step for a cylinder); of the shape of ``half``."""
    centre = np.zeros(half.shape)
    for _ in range(_EXTENT_STEPS):
        causes = loading.at(half, centre)
        off = causes.constant - dot(balance, causes.values)
        move = off / (causes.constant_by_centre - dot(balance, causes.by_centre))
        centre = centre - np.clip(move, -1.0, 1.0)
        if loading.slope.shape[-1] == 2 or not np.any(np.abs(move) > 1e-6):
            break
    return centre


def _require_within(table: Table, half: Array) -> None:
    """Refuse half-lengths [m] outside the table."""
    if np.any(half < table.lower * (1 - 1e-12)):
        raise RangeError(_beyond(table, "narrower"))
    if np.any(half > table.upper * (1 + 1e-12)):
        raise RangeError(_beyond(table, "wider"))


def _beyond(table: Table, how: str) -> str:
    """Return the message about contacts that are narrower or wider than the table."""
    top = table.system.kernel.stack.top.thickness
    least, most = table.lower / top, table.upper / top
    return f"contact: {how} than the resolved range, {least:g} to {most:g} of half-length over top layer's thickness"


def _refuse_tension(table: Table, loading: Loading, half: Array, centre: Array) -> None:
    """Refuse contacts with tension between punch and surface."""
    samples = table.series[:, PRESSURE][:, ::8]
    pressure = table.interval.read(np.log(half), samples, loading.at(half, centre).values)
    if np.any(np.min(pressure, -1) < -_TENSION * np.max(np.abs(pressure), -1)):
        raise TensionError("contact: it would need tension between punch and surface (charges or tilt too large)")
