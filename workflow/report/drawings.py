"""Figures of the page: of each the results that it is drawn from, and by what. ``sections.py`` lists them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from string import Formatter

from workflow.study.model import Study

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
