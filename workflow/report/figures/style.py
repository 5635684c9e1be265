"""Style and scales that the figures share, and their files: SVG whose bytes depend on the data alone."""

import io
from pathlib import Path
from typing import Any

import matplotlib as mpl

from approximation.arrays import Array

mpl.use("Agg")

import hashlib
import re
from collections import Counter
from collections.abc import Collection

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from solver.fields import fields_of
from solver.units import prefixed
from storage.files import write_bytes, write_text
from workflow.language import numbers, titles
from workflow.language.factors import FACTORS
from workflow.language.wordings import TITLES
from workflow.report.figures import hover
from workflow.report.svg import INK, PAPER

#: Style of every figure of the report.
STYLE: dict[Any, Any] = {
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    # no power of ten apart from its ticks: values are scaled by a prefix that stands in the label
    "axes.formatter.limits": (-15, 15),
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "legend.fontsize": 9.5,
    "svg.hashsalt": "meecontact",
    "svg.fonttype": "none",  # words stay words, which can be searched for, in a tenth of the bytes of outlines
    "font.sans-serif": ["DejaVu Sans"],
    **dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color"), INK),
    "hatch.color": INK,
    "hatch.linewidth": 0.5,
    **dict.fromkeys(("figure.facecolor", "axes.facecolor", "savefig.facecolor"), PAPER),
}
styled = mpl.rc_context(STYLE)
NEAR_EDGE = 0.02  # distance in X from an edge within which a singular field is cut
BLUE, ORANGE, GREY = "#2166ac", "#d95f02", "#8a8a8a"
#: Colours that readers of every kind of sight tell apart (M. Okabe and K. Ito, Color universal design, 2008).
DISTINCT = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#7a7a7a", "#9a8b00")
_ROOM_FOR_THREE, _ROOM_FOR_TWO = 1.35, 2.2  # decades of an axis up to which a decade has three ticks, or two

#: Names of fields on axes where they differ from their titles.
_FIELDS = {
    "contact_pressure": "contact pressure",
    "principal_tension": "largest principal stress",
    "von_mises": "von Mises stress",
    "stress_xx": "$\\sigma_{xx}$",
    "stress_yy": "$\\sigma_{yy}$",
    "stress_xy": "$\\sigma_{xy}$",
    "electric_displacement_x": "$D_x$",
    "electric_displacement_y": "$D_y$",
    "magnetic_induction_x": "$B_x$",
    "magnetic_induction_y": "$B_y$",
}
_DROPPED = re.compile(
    r"<!--.*?-->|<metadata>.*?</metadata>|<\?xml[^>]*\?>|<!DOCTYPE[^>]*>|<defs>\s*<style.*?</defs>", re.S
)
_DROPPED_IDS = re.compile(r'<g id="[^"]*"')
_IMAGE_IDS = re.compile(r' id="image[0-9a-f]+"')  # which nothing refers to, and equal images share
_UNTURNED = re.compile(r' transform="rotate\(-?0 [^)]*\)"')
_BETWEEN = re.compile(r">\s*\n\s*<")
_BLANK = re.compile(r"\s*\b([MLCQz])\s+")  # beside a letter of a path
_PLACED = re.compile(r'\s(?:d|x|y|transform)="[^"]*"')
_FINE = re.compile(r"-?\d+\.\d+")
_STYLE = re.compile(r' style="([^"]*)"')
_GROUP = re.compile(r"<g>|<g [^>]*>|</g>")
_ID = re.compile(r'(\bid="|url\(#|href="#)([^")]+)')


def felt_only(data: xr.Dataset, felt: Collection[str]) -> xr.Dataset:
    """Return fields or quantities of a file without those that measure another field than the study's."""
    units = {name: str(array.attrs.get("units", "1")) for name, array in data.data_vars.items()}
    return data.drop_vars([name for name, unit in units.items() if not fields_of(unit) <= set(felt)])


def field_label(field: xr.DataArray, size: float, where: str = "", width: int = 60) -> tuple[float, str]:
    """Return the divisor of a field for values of some size, and its label with the unit."""
    scale, units = prefixed(size, str(field.attrs["units"]), digits=2)
    name = str(field.name)
    name = titles.title(name) if name in TITLES and "position" in field.dims else _FIELDS.get(name, titles.title(name))
    return scale, numbers.label(f"{name} {where}", units, width)


def ticked(value: float, _place: int) -> str:
    """Return the text of a tick."""
    return numbers.number(value, 3)


def panels(
    count: int, columns: int, width: float, height: float, extra_height: float = 0.0, **options: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels in rows, and the axes; the last row may have empty places."""
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width, height * rows + extra_height), squeeze=False, **options)
    for ax in axes.flat[count:]:
        ax.set_visible(False)
    return figure, list(axes.flat[:count])


def by_ratio(values: Array) -> bool:
    """Return whether values of a factor are spaced by ratio, as on a logarithmic axis."""
    return bool(values[0] > 0 and not np.allclose(np.diff(values), np.diff(values)[0]))


def factor_scale(name: str, values: Array) -> tuple[float, str]:
    """Return the divisor of a factor on its axis, and the unit."""
    return prefixed(float(np.abs(values).max()), FACTORS[name].units)


def logarithmic(ax: Axes, which: str, values: Array) -> None:
    """Make an axis logarithmic, with as many plain numbers as have room."""
    (ax.set_xscale if which == "x" else ax.set_yscale)("log")
    axis = ax.xaxis if which == "x" else ax.yaxis
    decades = np.log10(values.max() / values.min())
    steps = (1.0, 2.0, 5.0) if decades < _ROOM_FOR_THREE else (1.0, 3.0) if decades < _ROOM_FOR_TWO else (1.0,)
    axis.set_major_locator(LogLocator(subs=steps))
    axis.set_major_formatter(FuncFormatter(ticked))
    axis.set_minor_formatter(NullFormatter())


def save(figure: Figure | str, path: Path) -> None:
    """Write a figure as SVG with the data for the page's pointer, whole or not at all."""
    if isinstance(figure, str):
        write_text(path, figure)
        return
    drawn = io.BytesIO()
    with mpl.rc_context(STYLE):  # the salt of the ids acts while saving
        figure.savefig(drawn, format="svg", metadata={"Date": None, "Creator": "meecontact"})
    data = f'<metadata class="hover">{hover.metadata(figure)}</metadata>\n</svg>'  # after the layout is drawn
    plt.close(figure)
    write_bytes(path, data.join(compacted(drawn.getvalue().decode()).rsplit("</svg>", 1)).encode())


def compacted(text: str) -> str:
    """Return the same picture with outlines in hundredths of a point, each style once, short ids and few blanks."""
    text = _UNTURNED.sub("", _DROPPED_IDS.sub("<g", _IMAGE_IDS.sub("", _DROPPED.sub("", text))))
    text = _shortened(_ungrouped(text))
    text = _PLACED.sub(_shorter, _BETWEEN.sub("><", text))
    styles = Counter(_STYLE.findall(text))
    names = {style: _class_name(style) for style, times in styles.items() if times > 1}
    text = _STYLE.sub(lambda match: f' class="{names[match[1]]}"' if match[1] in names else match[0], text)
    rules = "".join(f".{name}{{{style}}}" for style, name in names.items())
    # attributes that matplotlib repeats at every element
    head = f' stroke-linejoin="round" stroke-linecap="butt"><style>{rules}</style>'
    return text.strip().replace(">", head, 1) + "\n"


def _ungrouped(text: str) -> str:
    """Return SVG without groups that have no attributes."""
    bare: list[bool] = []

    def kept(match: re.Match[str]) -> str:
        if match[0] != "</g>":
            bare.append(match[0] == "<g>")
            return "" if bare[-1] else match[0]
        return "" if bare.pop() else match[0]

    return _GROUP.sub(kept, text)


def _shortened(text: str) -> str:
    """Return SVG with ids numbered in their order."""
    known: dict[str, str] = {}
    return _ID.sub(lambda match: match[1] + known.setdefault(match[2], f"i{len(known)}"), text)


def _class_name(style: str) -> str:
    """Return the class of a style, which is the same in all figures of a page."""
    return "s" + hashlib.blake2b(style.encode(), digest_size=4).hexdigest()


def _shorter(places: re.Match[str]) -> str:
    """Return coordinates in hundredths of a point."""
    return _FINE.sub(lambda decimal: _number(float(decimal[0])), _BLANK.sub(r"\1", places[0]))


def _number(value: float) -> str:
    """Return a number with two decimals, as short as possible."""
    return re.sub(r"^(-?)0\.", r"\1.", f"{round(value, 2) + 0.0:g}" if abs(value) < 1e3 else f"{value:.2f}")
