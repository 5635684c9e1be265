"""The sections of the page in its order: when each stands, its figures and how the contents name it.

What a section shows is its piece of template, named in full: a job depends on the data files that its modules name.
Page and rules loop over this registry.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from string import Formatter
from typing import Any

from workflow.study.model import Study
from workflow.study.sections import CONVERGING

#: Of which wildcards a study has a figure: one by each of these.
Wildcards = Sequence[Mapping[str, str]]


@dataclass(frozen=True)
class Figure:
    """A figure that is drawn from results."""

    file: str  # Below the study's ``figures/`` and without its ending, with wildcards. See `kind`.
    reads: str  # Below the study's folder, with the same wildcards, or with ``{slab}`` for all slabs of the data set
    draw: str  # Module of ``figures/`` and its function: of the data, and of what it ``asks`` by name
    label: str  # In Snakemake's own report
    wildcards_of: Callable[[Study], Wildcards]  # The wildcards of a study; none where it lacks the figure
    asks: tuple[str, ...] = ()  # Parameters of the study that `draw` takes, as ``rules/report.smk`` names them

    @property
    def kind(self) -> str:
        """The first word of its file, as its caption is called."""
        return self.file.partition("_")[0]

    @property
    def source(self) -> str:
        """The file of the function that draws it."""
        return f"workflow/report/figures/{self.draw.partition('.')[0]}.py"

    @property
    def labels(self) -> dict[str, str]:
        """Labels in Snakemake's report, with the values of the wildcards."""
        return {"figure": self.label, **{name: f"{{{name}}}" for name in self.wildcards}}

    @property
    def wildcards(self) -> list[str]:
        """Names of the wildcards, in order."""
        return [name for _, name, _, _ in Formatter().parse(self.file) if name]

    def files(self, study: Study) -> list[str]:
        """Names of the files without wildcards."""
        return [self.file.format(**wildcards) for wildcards in self.wildcards_of(study)]


Page = Mapping[str, Any]


@dataclass(frozen=True)
class Section:
    """A section of the page."""

    template: str  # File of its piece, in ``templates/``
    title: str  # In the contents
    stands: Callable[[Page], object]  # Whether a page with some content has it
    figures: tuple[Figure, ...] = ()  # Those that it shows; those of designs are in folders
    links: Callable[[Page], list[tuple[str, str]]] | None = None  # Anchors and titles, where it has others than its own

    @property
    def name(self) -> str:
        """Anchor of the section."""
        return self.template.partition(".")[0]

    def anchors(self, page: Page) -> list[tuple[str, str]]:
        """Anchors and titles of the contents."""
        return self.links(page) if self.links else [(self.name, self.title)]


@dataclass(frozen=True)
class Part:
    """Sections under one headline; ``aside`` says more beside it."""

    name: str
    sections: tuple[Section, ...]
    title: str = ""
    aside: str = ""


def standing(page: Page) -> list[Part]:
    """The parts of a page with the sections that stand on it; none without any."""
    parts = [
        replace(part, sections=tuple(section for section in part.sections if section.stands(page))) for part in PARTS
    ]
    return [part for part in parts if part.sections]


def figures(study: Study) -> list[str]:
    """Names of every figure's file of a study, but those of its designs."""
    return [name for _, figure in _figures() for name in figure.files(study)]


def drawn() -> list[list[tuple[Section, Figure]]]:
    """The figures by the results that they are drawn from: one rule each, called after its first."""
    figures: dict[str, list[tuple[Section, Figure]]] = {}
    for section, figure in _figures():
        figures.setdefault(figure.reads, []).append((section, figure))
    return list(figures.values())


def _figures() -> list[tuple[Section, Figure]]:
    return [(section, figure) for part in PARTS for section in part.sections for figure in section.figures]


def effects(study: Study) -> list[str]:
    """Files of the fields of one factor at a time, under ``fields/`` and without their ending."""
    return [
        name.format(**wildcards)
        for name, wildcards_of in ((_EFFECT, _varied), (_INTERIOR, _inside), (_MAP, _mapped), (_SPREAD, _repeated))
        for wildcards in wildcards_of(study)
    ]


def _readouts(study: Study) -> Wildcards:
    return [{"name": name} for name in study.readout]


def _signal(study: Study) -> Wildcards:
    return [{}] if study.signal else []


def _factorial(study: Study) -> Wildcards:
    return [{}] if study.factors else []


def _slabs(study: Study) -> Wildcards:
    return [{}] if study.factors and study.stores_fields else []


def _varied(study: Study) -> Wildcards:
    return [{"name": name} for name in study.effects.vary] if study.effects else []


def _inside(study: Study) -> Wildcards:
    return _varied(study) if study.effects and study.effects.interior else []


def _mapped(study: Study) -> Wildcards:
    return _varied(study) if study.kind.space else []


def _repeated(study: Study) -> Wildcards:
    return _varied(study) if study.effects and study.effects.realisations > 1 else []


def _cut(study: Study) -> Wildcards:
    return [{}] if "cut_angle" in study.factors else []


def _measured(study: Study) -> Wildcards:
    return [{}] if study.measurements else []


def _converging(study: Study) -> Wildcards:
    return [{"group": group} for group in CONVERGING if study.verification]


_EFFECT, _INTERIOR = "fields/effect_{name}", "fields/interior_{name}"
_MAP, _SPREAD = "fields/map_{name}", "fields/spread_{name}"
_SENSITIVITY, _VALIDATION = "sensitivity.nc", "validation.nc"
_ROWS, _CHECKS = "measured/measurements.json", "verification/{group}.json"
_QUANTITIES, _INTEREST = ("quantities",), ("quantities", "of_interest")

PARTS = (
    Part(
        "answer",
        (
            Section("whatif.html.j2", "What if", lambda page: page["whatif"]),
            Section("design.html.j2", "Designs", lambda page: page["designs"]),
            Section(
                "readout.html.j2",
                "Read-out",
                lambda page: page["readouts"],
                (Figure("readout_{name}", "readout/{name}.nc", "measured_rows.readout", "read-out", _readouts),),
            ),
            Section(
                "signal.html.j2",
                "Signal",
                lambda page: page["signal"],
                (Figure("signal", "signal.nc", "signal_in_time.figure", "signal in time", _signal),),
            ),
        ),
    ),
    Part(
        "physics",
        (
            Section("study.html.j2", "Study", lambda page: page["study"].factors or page["effects"]),
            Section(
                "sensitivity.html.j2",
                "What matters",
                lambda page: page["dataset"],
                (
                    Figure(
                        "sensitivity",
                        _SENSITIVITY,
                        "sobol.indices",
                        "Sobol' indices",
                        _factorial,
                        ("quantities", "aims"),
                    ),
                    Figure("main_effects", _SENSITIVITY, "sobol.main_effects", "main effects", _factorial, _INTEREST),
                ),
            ),
            Section(
                "dataset.html.j2",
                "Data set",
                lambda page: page["dataset"],
                (
                    Figure("cut", "quantities.nc", "contact_maps.polar", "charge over the cut", _cut),
                    Figure(
                        "fields", "fields/slab_{slab}.nc", "field_panels.fields", "surface fields", _slabs, ("felt",)
                    ),
                ),
            ),
            Section(
                "effects.html.j2",
                "Effects",
                lambda page: page["effects"],
                (
                    Figure(
                        "effect_{name}", f"{_EFFECT}.nc", "field_panels.effect", "surface fields", _varied, ("felt",)
                    ),
                    Figure("interior_{name}", f"{_INTERIOR}.nc", "field_panels.interior", "below the punch", _inside),
                    Figure("map_{name}", f"{_MAP}.nc", "contact_maps.maps", "maps of the contact", _mapped),
                    Figure("spread_{name}", f"{_SPREAD}.nc", "contact_maps.spread", "random surfaces", _repeated),
                ),
            ),
        ),
        "Physics",
    ),
    Part(
        "evidence",
        (
            Section(
                "measurements.html.j2",
                "Measurements",
                lambda page: page["measurements"],
                (Figure("measurements", _ROWS, "measured_rows.figure", "measured and modelled", _measured),),
            ),
            Section(
                "verification.html.j2",
                "Verification",
                lambda page: page["verification"],
                (Figure("convergence_{group}", _CHECKS, "convergence.figure", "convergence", _converging),),
                lambda page: [(key, group["title"]) for key, group in page["verification"]["groups"].items()],
            ),
            Section("speed.html.j2", "Time", lambda page: page["verification"]),
            Section(
                "surrogate.html.j2",
                "Surrogate",
                lambda page: page["dataset"],
                (
                    Figure("errors", _VALIDATION, "surrogate_errors.errors", "errors", _factorial, _QUANTITIES),
                    Figure(
                        "decay",
                        _VALIDATION,
                        "surrogate_errors.coefficients",
                        "decay of the coefficients",
                        _factorial,
                        _QUANTITIES,
                    ),
                    Figure(
                        "residuals", _VALIDATION, "surrogate_errors.residuals", "residuals", _factorial, _QUANTITIES
                    ),
                    Figure("intervals", _VALIDATION, "surrogate_errors.coverage", "intervals", _factorial, _QUANTITIES),
                ),
            ),
            Section("surface.html.j2", "Fields", lambda page: page["surface"]),
            Section("time.html.j2", "Time", lambda page: page["dataset"]),
            Section("provenance.html.j2", "Provenance", lambda _: True),
        ),
        "Evidence",
        "open a line for its proof",
    ),
)
