"""The sections of the page in its order, with their templates, figures and titles, over which page and rules loop.

Templates are named in full: a job depends on the data files that its modules name.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

from workflow.study.model import Study
from workflow.study.sections import CONVERGING


@dataclass(frozen=True)
class Figure:
    """A figure that is drawn from results."""

    file: str  # below the study's ``figures/``, without its ending, with one wildcard at most
    reads: str  # file below the study's folder, with the same wildcard, or with ``{slab}`` for all slabs
    draw: str  # module of ``figures/`` and function of the data and of the parameters `asks`
    label: str  # in Snakemake's report
    values: Callable[[Study], Any]  # values of the wildcard, or whether a study has a figure without one
    asks: tuple[str, ...] = ()  # parameters of the study that `draw` takes, as ``rules/report.smk`` names them

    @property
    def kind(self) -> str:
        """First word of the file, which is the name of its caption."""
        return self.file.partition("_")[0]

    @property
    def source(self) -> str:
        """File of the function that draws the figure."""
        return f"workflow/report/figures/{self.draw.partition('.')[0]}.py"

    @property
    def wildcard(self) -> str:
        """Name of the wildcard; empty without one."""
        return self.file.partition("{")[2].removesuffix("}")

    @property
    def labels(self) -> dict[str, str]:
        """Labels in Snakemake's report, with the value of the wildcard."""
        return {"figure": self.label} | ({self.wildcard: f"{{{self.wildcard}}}"} if self.wildcard else {})

    def named(self, pattern: str, study: Study) -> list[str]:
        """Return the files of a study by a pattern with the wildcard, `file` or `reads`."""
        values = self.values(study) or ()
        if not self.wildcard:
            return [pattern] if values else []
        return [pattern.format(**{self.wildcard: value}) for value in values]


Page = Mapping[str, Any]


@dataclass(frozen=True)
class Section:
    """A section of the page."""

    template: str  # file in ``templates/``
    title: str  # in the contents
    needs: str  # name in the page's content without which there is no such section
    figures: tuple[Figure, ...] = ()  # without those of designs, which are in folders
    links: Callable[[Page], list[tuple[str, str]]] | None = None  # several anchors and titles in place of one

    @property
    def name(self) -> str:
        """Anchor of the section."""
        return self.template.partition(".")[0]

    def anchors(self, page: Page) -> list[tuple[str, str]]:
        """Return anchors and titles for the contents."""
        return self.links(page) if self.links else [(self.name, self.title)]


@dataclass(frozen=True)
class Part:
    """Sections under one headline, with a remark ``aside``."""

    name: str
    sections: tuple[Section, ...]
    title: str = ""
    aside: str = ""


def standing(page: Page) -> list[Part]:
    """Return the parts of a page with the sections that it has; no empty parts."""
    parts = [
        replace(part, sections=tuple(section for section in part.sections if page[section.needs])) for part in PARTS
    ]
    return [part for part in parts if part.sections]


def figures(study: Study) -> list[str]:
    """Return the names of a study's figures, without those of its designs."""
    return [name for _, figure in _figures() for name in figure.named(figure.file, study)]


def drawn() -> list[list[tuple[Section, Figure]]]:
    """Return the figures by the results that they are drawn from: one rule each, named after its first."""
    figures: dict[str, list[tuple[Section, Figure]]] = {}
    for section, figure in _figures():
        figures.setdefault(figure.reads, []).append((section, figure))
    return list(figures.values())


def _figures() -> list[tuple[Section, Figure]]:
    return [(section, figure) for part in PARTS for section in part.sections for figure in section.figures]


def effects(study: Study) -> list[str]:
    """Return the files of fields of one factor at a time, below the study's folder."""
    return [name for figure in _EFFECTS for name in figure.named(figure.reads, study)]


def _varied(study: Study) -> Any:
    return study.effects and study.effects.vary


def _mapped(study: Study) -> Any:
    return study.kind.space and _varied(study)


def _varied_inside(study: Study) -> Any:
    return study.effects and study.effects.interior and study.effects.vary


def _varied_at_random(study: Study) -> Any:
    return study.effects and study.effects.realisations > 1 and study.effects.vary


def _stored_fields(study: Study) -> Any:
    return study.factors and study.stores_fields


_factorial = attrgetter("factors")
_QUANTITIES, _FELT = ("quantities",), ("felt",)
_SENSITIVITY, _VALIDATION = "sensitivity.nc", "validation.nc"
_READOUT = Figure("readout_{name}", "readout/{name}.nc", "measured_rows.readout", "read-out", attrgetter("readout"))
_SIGNAL = Figure("signal", "signal.nc", "signal_in_time.figure", "signal in time", attrgetter("signal"))
_WHAT_MATTERS = (
    Figure("sensitivity", _SENSITIVITY, "sobol.indices", "Sobol' indices", _factorial, ("quantities", "aims")),
    Figure(
        "main_effects", _SENSITIVITY, "sobol.main_effects", "main effects", _factorial, ("quantities", "of_interest")
    ),
)
_DATA = (
    Figure(
        "cut", "quantities.nc", "contact_maps.polar", "charge over the cut", lambda study: "cut_angle" in study.factors
    ),
    Figure("fields", "fields/slab_{slab}.nc", "field_panels.fields", "surface fields", _stored_fields, _FELT),
)
_EFFECTS = (
    Figure("effect_{name}", "fields/effect_{name}.nc", "field_panels.effect", "surface fields", _varied, _FELT),
    Figure("interior_{name}", "fields/interior_{name}.nc", "field_panels.interior", "below the punch", _varied_inside),
    Figure("map_{name}", "fields/map_{name}.nc", "contact_maps.maps", "maps of the contact", _mapped),
    Figure("spread_{name}", "fields/spread_{name}.nc", "contact_maps.spread", "random surfaces", _varied_at_random),
)
_MEASURED = Figure(
    "measurements",
    "measured/measurements.json",
    "measured_rows.figure",
    "measured and modelled",
    attrgetter("measurements"),
)
_CONVERGENCE = Figure(
    "convergence_{group}", "verification/{group}.json", "convergence.figure", "convergence",
    lambda study: study.verification and CONVERGING,
)  # fmt: skip
_ERRORS = (
    Figure("errors", _VALIDATION, "surrogate_errors.errors", "errors", _factorial, _QUANTITIES),
    Figure("decay", _VALIDATION, "surrogate_errors.coefficients", "decay of the coefficients", _factorial, _QUANTITIES),
    Figure("residuals", _VALIDATION, "surrogate_errors.residuals", "residuals", _factorial, _QUANTITIES),
    Figure("intervals", _VALIDATION, "surrogate_errors.coverage", "intervals", _factorial, _QUANTITIES),
)


def _groups(page: Page) -> list[tuple[str, str]]:
    return [(key, group["title"]) for key, group in page["verification"]["groups"].items()]


_ANSWER = (
    Section("whatif.html.j2", "What if", "whatif"),
    Section("design.html.j2", "Designs", "designs"),
    Section("readout.html.j2", "Read-out", "readouts", (_READOUT,)),
    Section("signal.html.j2", "Signal", "signal", (_SIGNAL,)),
)
_PHYSICS = (
    Section("study.html.j2", "Study", "varied"),
    Section("sensitivity.html.j2", "What matters", "dataset", _WHAT_MATTERS),
    Section("dataset.html.j2", "Data set", "dataset", _DATA),
    Section("effects.html.j2", "Effects", "effects", _EFFECTS),
)
_EVIDENCE = (
    Section("measurements.html.j2", "Measurements", "measurements", (_MEASURED,)),
    Section("verification.html.j2", "Verification", "verification", (_CONVERGENCE,), _groups),
    Section("speed.html.j2", "Time", "verification"),
    Section("surrogate.html.j2", "Surrogate", "dataset", _ERRORS),
    Section("surface.html.j2", "Fields", "surface"),
    Section("time.html.j2", "Time", "dataset"),
    Section("provenance.html.j2", "Provenance", "provenance"),
)
PARTS = (
    Part("answer", _ANSWER),
    Part("physics", _PHYSICS, "Physics"),
    Part("evidence", _EVIDENCE, "Evidence", "open a line for its proof"),
)
