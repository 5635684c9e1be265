"""The page of the measurements: tables, and plots of error and time against the number of cases."""

import base64
import io
from itertools import cycle
from pathlib import Path
from statistics import median
from typing import Any

import matplotlib.pyplot as plt
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from workflow.language.numbers import counted, number
from workflow.report.figures.style import styled

_ABOUT = ("machine", "processor", "versions")


def page(results: dict[str, Any]) -> str:
    """The page as text; a measurement that gives plain numbers becomes a table of them."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"number": _number, "counted": counted, "median": median}
    surrogates = results.get("surrogates")
    plain = {name: part for name, part in results.items() if name not in (*_ABOUT, "surrogates")}
    pictures = [_svg(draw(surrogates["rows"])) for draw in (_errors, _times)] if surrogates else []
    return environment.get_template("page.html.j2").render(
        surrogates=surrogates, plain=plain, pictures=pictures, about={name: results[name] for name in _ABOUT}
    )


@styled
def _errors(rows: list[dict[str, Any]]) -> Figure:
    """Largest error of a smooth and of a sharp output against the number of cases."""
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    for ax, output in zip(axes, ("trailing_tension", "voltage"), strict=True):
        _lines(ax, rows, lambda row, output=output: row["error"][output])
        ax.set_title(f"{output.replace('_', ' ')}: largest error over range")
    axes[0].legend()
    return figure


@styled
def _times(rows: list[dict[str, Any]]) -> Figure:
    """Time of a fit and of a query against the number of cases."""
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2))
    _lines(axes[0], rows, lambda row: row["fit_seconds"])
    axes[0].set_title("fit, all outputs [s]")
    _lines(axes[1], rows, lambda row: row["std_seconds"] or row["mean_seconds"])
    axes[1].set_title("a query, all outputs, with interval where there is one [s]")
    axes[0].legend()
    return figure


def _lines(ax: Axes, rows: list[dict[str, Any]], value: Any) -> None:
    for method, marker in zip(dict.fromkeys(row["method"] for row in rows), cycle("osD^v<>P")):
        points = sorted((row["cases"], value(row)) for row in rows if row["method"] == method and value(row))
        ax.loglog(
            [cases for cases, _ in points], [size for _, size in points], marker=marker, ms=5, lw=1.2, label=method
        )
    ax.set_xlabel("cases")


def _svg(figure: Figure) -> str:
    with io.BytesIO() as file:
        figure.savefig(file, format="svg", metadata={"Date": None})
        plt.close(figure)
        return base64.b64encode(file.getvalue()).decode("ascii")


def _number(value: float | str | None) -> str:
    return value if isinstance(value, str) else number(value, 3)
