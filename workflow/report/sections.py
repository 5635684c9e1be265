"""The sections of the page in its order: when each stands, its figures and how the contents name it.

What a section shows is its piece of template, named in full: a job depends on the data files that its modules name.
Page and rules loop over this registry.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from workflow.study.model import Study
from workflow.study.sections import CONVERGING

Page = Mapping[str, Any]


def _no_figures(_: Study) -> list[str]:
    return []


@dataclass(frozen=True)
class Section:
    """A section of the page.

    Attributes
    ----------
    template
        File of its piece, in ``templates/``.
    title
        In the contents.
    stands
        Whether a page with some content has it.
    figures
        Files of a study that it shows, under ``figures/`` and without their ending; those of designs are in folders.
    links
        Anchors and titles, where it has others than its own.
    """

    template: str
    title: str
    stands: Callable[[Page], object]
    figures: Callable[[Study], list[str]] = _no_figures
    links: Callable[[Page], list[tuple[str, str]]] | None = None

    @property
    def name(self) -> str:
        """Its anchor."""
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
    parts = (Part(one.name, tuple(own for own in one.sections if own.stands(page)), one.title, one.aside)
             for one in PARTS)  # fmt: skip
    return [part for part in parts if part.sections]


def figures(study: Study) -> list[str]:
    """Names of every figure's file of a study, but those of its designs."""
    return [name for part in PARTS for section in part.sections for name in section.figures(study)]


def _of_factorial(*names: str) -> Callable[[Study], list[str]]:
    return lambda study: list(names) if study.factors else []


def effects(study: Study) -> list[str]:
    """Names of the figures of one factor at a time, which are those of their files too."""
    if not study.effects:
        return []
    kinds: Sequence[str] = ["effect", "interior"] if study.effects.interior else ["effect"]
    return [f"{kind}_{name}" for name in study.effects.vary for kind in kinds]


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
                lambda study: [f"readout_{name}" for name in study.readout],
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
                _of_factorial("sensitivity", "main_effects"),
            ),
            Section(
                "dataset.html.j2",
                "Data set",
                lambda page: page["dataset"],
                lambda study: ["fields"] if study.factors and study.stores_fields else [],
            ),
            Section("effects.html.j2", "Effects", lambda page: page["effects"], effects),
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
                lambda study: ["measurements"] if study.measurements else [],
            ),
            Section(
                "verification.html.j2",
                "Verification",
                lambda page: page["verification"],
                lambda study: [f"convergence_{group}" for group in CONVERGING if study.verification],
                lambda page: [(key, group["title"]) for key, group in page["verification"]["groups"].items()],
            ),
            Section("speed.html.j2", "Time", lambda page: page["verification"]),
            Section(
                "surrogate.html.j2",
                "Surrogate",
                lambda page: page["dataset"],
                _of_factorial("decay", "errors", "residuals", "intervals"),
            ),
            Section("surface.html.j2", "Fields", lambda page: page["surface"]),
            Section("time.html.j2", "Time", lambda page: page["dataset"]),
            Section("provenance.html.j2", "Provenance", lambda _: True),
        ),
        "Evidence",
        "open a line for its proof",
    ),
)
