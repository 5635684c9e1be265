"""A rounded surrogate as C: C89 with no library but math.h, no allocation, no state."""

import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from numpy.typing import ArrayLike

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.face.persistence import probe_points
from surrogate.intervals.distribution import NOMINAL
from surrogate.intervals.guard import Guard, unguarded
from surrogate.transforms.groups import Group, Grouping, Scales, row_of
from surrogate.transforms.transformed import groups_of
from surrogate.use.rounding import Rounded

TEMPLATES = Path(__file__).parent / "templates"
TAIL = 1e-10  # share of the largest term below which the tail of a kernel's series is left out
ROOM = 1e-6  # tolerance of the self-test besides the rounding: logarithms of processors differ in the last digits
_WIDTH = 100
#: Keywords of C and C++, and names of math.h.
_RESERVED = frozenset(
    """auto break case char class const continue default delete do double else enum extern float for friend goto if int
    long main namespace new operator private protected public register return short signed sizeof static struct switch
    template this throw try typedef union unsigned using virtual void volatile while exp log pow sqrt""".split()  # noqa: SIM905
)


def environment(*, escaped: bool = False) -> jinja2.Environment:
    """Return the templates of exported files; undefined names are errors."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), undefined=jinja2.StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, keep_trailing_newline=True, autoescape=escaped,
    )  # fmt: skip


def identifier(name: str) -> str:
    """Return a name as an identifier of C; ValueError if it cannot be one."""
    plain = re.sub(r"_+", "_", re.sub(r"\W", "_", name, flags=re.ASCII)).strip("_")
    if not plain or not plain[0].isalpha() or plain in _RESERVED or len(plain) > 40:
        raise ValueError(f"{name!r} is no name in C: a letter, then up to 39 letters, digits and underscores")
    return plain


def printable(text: str) -> str:
    """Return a text that cannot end a comment: ASCII, without stars, backslashes and question marks."""
    return re.sub(r"[^ -~]|[*\\?]", "_", " ".join(text.split()))


def code(
    name: str, outputs: Sequence[Rounded], arithmetic: type[np.floating[Any]], notes: Sequence[str]
) -> dict[str, str]:
    """Return the texts of NAME.h and NAME.c for outputs of one model; notes are lines of the header's comment."""
    context = _Context(name, outputs, arithmetic).values
    comment = ["A surrogate of meecontact in C89: no allocation, no state, nothing but math.h.", *notes, ""]
    comment += ["Compile with -ffp-contract=off where the processor has fused multiplications: the same bits on all."]
    comment += ["", "inputs:", *(f"  {entry['macro']}: {entry['text']}" for entry in context["inputs"])]
    comment += ["outputs, with the largest error of the rounding over the range:"]
    comment += [
        f"  {entry['macro']}: {entry['text']}; {part.error:.1e}"
        for entry, part in zip(context["outputs"], outputs, strict=True)
    ]
    paragraphs = (textwrap.wrap(printable(line), _WIDTH, subsequent_indent="    ") or [""] for line in comment)
    plain = "/*\n" + "".join(f" * {line}".rstrip() + "\n" for lines in paragraphs for line in lines) + " */"
    texts = environment()
    return {f"{name}.{end}": texts.get_template(f"model.{end}").render(context, comment=plain) for end in ("h", "c")}


def macros(names: Sequence[str]) -> list[str]:
    """Return names as upper-case macros, different ones for different names."""
    distinct_names: list[str] = []
    for name in names:
        plain = re.sub(r"\W+", "_", name.upper(), flags=re.ASCII).strip("_") or "X"
        while plain in distinct_names:
            plain += "_"
        distinct_names.append(plain)
    return distinct_names


class _Context:
    """Values of the templates, with numbers as literals of C."""

    def __init__(self, name: str, outputs: Sequence[Rounded], arithmetic: type[np.floating[Any]]) -> None:
        self._arithmetic = arithmetic
        first = outputs[0].grid
        single = arithmetic == np.float32
        stored = np.float32 if all(part.storage == np.float32 for part in outputs) else np.float64
        model, grouping = outputs[0].model, groups_of(outputs[0].model)
        calibration = model.calibration_
        outer = None if calibration is None else calibration.outer
        names = macros([axis.name for axis in model.inputs_]), macros([part.name for part in outputs])
        cosine = [_kernel(factor.decay, factor.unknown) for factor in first.factors_]
        degrees = np.zeros((1, len(first.factors_)), int) if calibration is None else calibration.trend_degree
        units = [self._unit(axis, f"x[{k}]") for k, axis in enumerate(first.inputs_)]
        scales = [Scales(by, [part.name]) for part in outputs if (by := groups_of(part.model))]
        if grouping is not None:
            rows = zip(grouping.groups, grouping.powers.tolist(), strict=True)
            units = [self._unit(group.axis, self._product(row, group.constant)) for group, row in rows]
        read = np.any([scale.powers[0] != 0 for scale in scales] + [scale.added != 0 for scale in scales[:1]], axis=0)
        slopes = self._slopes(model, grouping)
        self.values: dict[str, Any] = {
            "name": name,
            "NAME": name.upper(),
            "real": "float" if single else "double",
            "storage": "float" if stored == np.float32 else "double",
            "shift": 1 if single else 4,
            "near": self.number(1e-4 if single else 1e-9),  # of a slab's width: coordinates differ by rounding
            "largest": "0xFF" if single else "0x7FF",
            **{word: self.number(value) for word, value in {"zero": 0, "one": 1, "minus_one": -1, "two": 2}.items()},
            **{function: f"(float){function}" if single else function for function in ("exp", "sqrt")},
            "axes": len(first.factors_),
            "modes": max(max(part.grid.chebyshev_.modes) for part in outputs),
            "rank": max(core.shape[2] for part in outputs for core in part.grid.chebyshev_.cores),
            "terms": len(degrees),
            "degrees": max(2, 1 + int(degrees.max())),
            "trend_degree": degrees.tolist(),
            "order": first.order_,
            "levels": [factor.levels for factor in first.factors_],
            "kernels": [{part: self._floats(values) for part, values in entry.items()} for entry in cosine],
            "kernel_terms": [len(entry["kernel"]) for entry in cosine],
            "unknown_terms": [len(entry["unknown"]) for entry in cosine],
            "units": units,
            "slopes": slopes,
            "reads_x": any("x[" in text for row in slopes for text in row),
            "scales_read": bool(np.any(read)),
            "grouped": bool(scales),
            "added_power": self.numbers(scales[0].added) if scales else [],
            "outer": outer is not None,
            "inputs": [
                {
                    "macro": macro, "text": printable(_ranged(axis)), "low": self.number(axis.low),
                    "high": self.number(axis.high), "unit": self._unit(axis, f"x[{k}]"),
                    "relative": (
                        self._log(f"x[{k}] / {self.number(scales[0].references[k])}") if scales and read[k] else ""
                    ),
                }
                for k, (axis, macro) in enumerate(zip(model.inputs_, names[0], strict=True))
            ],
        }  # fmt: skip
        self.values["outputs"] = [
            self._output(part, macro, stored, cosine, scales[k] if scales else None)
            for k, (part, macro) in enumerate(zip(outputs, names[1], strict=True))
        ]
        self.values |= self._probes(outputs)

    def number(self, value: float) -> str:
        """Return a number as a literal in the precision of the arithmetic."""
        return literal(value, self._arithmetic)

    def numbers(self, values: ArrayLike) -> list[str]:
        return [self.number(value) for value in np.ravel(values).tolist()] or [self.number(0.0)]

    def _floats(self, values: ArrayLike) -> list[str]:
        return [literal(value, np.float32) for value in np.ravel(values).tolist()] or ["0.0f"]

    def _log(self, text: str) -> str:
        return f"(float)log((double)({text}))" if self._arithmetic == np.float32 else f"log({text})"

    def _unit(self, axis: Input, text: str) -> str:
        """Return the scaled coordinate of an expression."""
        ends = np.array([[axis.low], [axis.high]])
        number = self.number
        if axis.scale == "linear":
            return f"{number(2 / (axis.high - axis.low))} * ({text} - {number(axis.low)}) - {number(1)}"
        if axis.scale == "log":
            share = self._log(f"{text} / {number(axis.low)}")
            return f"{number(2 / np.log(axis.high / axis.low))} * {share} - {number(1)}"
        start, end = np.log(ends / (1 - ends)).ravel().tolist()
        inner = self._log(f"({text}) / ({number(1)} - {text})")
        return f"{number(2 / (end - start))} * ({inner} - {number(start)}) - {number(1)}"

    def _product(self, row: Sequence[float], constant: float = 1.0, without: int = -1) -> str:
        """Return a constant times powers of the inputs, reduced by one for the input `without`."""
        above: list[str] = [self.number(constant)] if constant != 1 else []
        below: list[str] = []
        for k, power in enumerate(row):
            left = power - 1 if k == without else power
            if abs(left) in (1, 2, 3, 4):
                (above if left > 0 else below).extend([f"x[{k}]"] * int(abs(left)))
            elif left:
                above.append(f"(real)pow((double)x[{k}], {left!r})")
        product = " * ".join(above) or self.number(1)
        return f"({product} / ({' * '.join(below)}))" if below else f"({product})"

    def _slopes(self, model: GaussianProcess, grouping: Grouping | None) -> list[list[str]]:
        """Return the derivatives of the axes' scaled coordinates by the inputs, (axes, d)."""
        groups = [Group(axis, {axis.name: 1.0}) for axis in model.inputs_] if grouping is None else grouping.groups
        rows = [(group, row_of(group.powers, model.inputs_).tolist()) for group in groups]
        return [[self._slope(group, row, k) for k in range(len(row))] for group, row in rows]

    def _slope(self, group: Group, row: Sequence[float], k: int) -> str:
        number, axis = self.number, group.axis
        if not row[k]:
            return number(0)
        if axis.scale == "log":
            return f"{number(2 * row[k] / np.log(axis.high / axis.low))} / x[{k}]"
        derivative = self._product(row, group.constant, k)
        if axis.scale == "linear":
            return f"{number(2 * row[k] / (axis.high - axis.low))} * {derivative}"
        value = self._product(row, group.constant)
        width = np.log(axis.high / (1 - axis.high)) - np.log(axis.low / (1 - axis.low))
        return f"{number(2 * row[k] / width)} * {derivative} / ({value} * ({number(1)} - {value}))"

    def _output(
        self,
        part: Rounded,
        macro: str,
        stored: type[np.floating[Any]],
        kernels: Sequence[Mapping[str, Any]],
        scales: Scales | None,
    ) -> dict[str, Any]:
        """Return the values of one output's table."""
        grid, model = part.grid, part.model
        learnt, train, d = model.calibration_, grid.chebyshev_, len(grid.factors_)
        size = float(grid.scale_[0])
        weights = np.ones(d) if learnt is None else learnt.weights[:, 0]
        floor = 0.0 if learnt is None else float(learnt.floor[0]) / size**2
        guard = unguarded(d, 1) if learnt is None else learnt.guard
        low, high = np.broadcast_to(model.distribution.ends(NOMINAL), (2, 1))[:, 0]
        attrs = model.attrs_[part.name]
        table: dict[str, Any] = {
            "macro": macro,
            "text": printable(_described(part.name, attrs.get("units", ""), attrs.get("long_name", ""))),
            "cores": [literal(value, stored) for core in train.cores for value in core.ravel().tolist()],
            "modes": train.modes,
            "ranks": [1, *(core.shape[2] for core in train.cores)],
            "offset": self.number(grid.offset_[0]),
            "rounding": self.number(part.room),
            "amplitude": self.numbers(grid.amplitude_[:, 0]),
            "aliased": self.numbers(
                [a * entry["first"] for a, entry in zip(grid.amplitude_[:, 0], kernels, strict=True)]
            ),
            "part": self.numbers(weights * grid.variance_[0]),
            "spread": self.number(size),
            "floor": self.number(floor),
            "trend": self._floats([0.0] if learnt is None else learnt.trend[:, 0]),
            "trend_low": self.number(0.0 if learnt is None else learnt.trend_range[0, 0]),
            "trend_high": self.number(0.0 if learnt is None else learnt.trend_range[1, 0]),
            "lower": self.number(low),
            "upper": self.number(high),
            "slabs": self._floats(guard.slabs[..., 0]),
            "corners": self._floats(_corners(guard)),
        }
        outer = None if learnt is None else learnt.outer
        if outer is not None:
            pooled = 0.0 if outer.pooled is None else float(outer.pooled[0])
            table |= {
                "outer_slabs": self._floats(outer.slabs[..., 0]),
                "outer_corners": self._floats(_corners(outer)),
                "outer_pooled": self.number(pooled),
            }
        if scales is not None:
            scaling = {"added": self.number(float(scales.coefficients[0])), "sign": int(scales.signs[0])}
            table |= {"power": self.numbers(scales.powers[0]), **scaling}
        return table

    def _probes(self, outputs: Sequence[Rounded]) -> dict[str, Any]:
        """Return the stored predictions of the surrogate's file, with the tolerance of the rounding."""
        points = probe_points(outputs[0].model.inputs_)
        answers = np.array([
            (part.exact.predict_array(points), *part.exact.interval_array(points, NOMINAL)) for part in outputs
        ])[..., 0]  # fmt: skip
        return {
            "probes": [self.numbers(point) for point in points],
            "expected": [list(map(self.numbers, rows)) for rows in np.moveaxis(answers, 2, 0)],
            "allowed": self.numbers([2 * part.room + ROOM * part.size for part in outputs]),
        }


def _kernel(decay: Array, unknown: Array) -> dict[str, Any]:
    """Return a factor's kernel and its unknown part over the first term, without their tails."""
    first = float(unknown[0])
    relative = unknown / first if first else unknown[:0]
    return {"kernel": _headed(decay), "unknown": _headed(relative), "first": first}


def _headed(series: Array) -> Array:
    """Return a series of terms >= 0, (n,), without its negligible tail."""
    if not series.size:
        return series
    tail = np.cumsum(series[::-1])[::-1]
    return series[: max(1, int(np.count_nonzero(tail > TAIL * series.max())))]


def _corners(guard: Guard) -> Array:
    """Return the four corners of every pair, (pairs, 2, 2): low and high ends of the first and the second input."""
    return guard.corners[:, ::2, ::2, 0]


def literal(value: float, kind: type[np.floating[Any]]) -> str:
    """Return a number as a literal of C, exact in a precision; denormal numbers are zero."""
    with np.errstate(over="ignore"):
        rounded = kind(value)
    if not np.isfinite(rounded):
        raise ValueError(f"{value:g} does not fit single precision: --precision double")
    if abs(rounded) < np.finfo(kind).tiny:
        rounded = kind(0)
    return str(rounded) + ("f" if kind is np.float32 else "")


def _described(name: str, units: str, meaning: str) -> str:
    """Return name, unit and meaning as a text."""
    return " ".join(filter(None, [name, f"[{units or '1'}]", meaning]))


def _ranged(axis: Input) -> str:
    """Return name, unit, meaning and range of an input as a text."""
    return f"{_described(axis.name, axis.units, axis.long_name)}, from {axis.low!r} to {axis.high!r}"
