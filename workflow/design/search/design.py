"""A design for people who work in Python: one target of a study answered, with its verdict and its numbers."""

from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import Self

import pandas as pd

from surrogate import GaussianProcess
from workflow.design.search.targets import solve_target
from workflow.design.verdict.answer import Answer
from workflow.design.wording.words import Verdict, verdict
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown
from workflow.study.model import Study


@dataclass(frozen=True)
class Design:
    """The answer to one target; `str` says its verdict, and a notebook shows its numbers. See `examples/design.py`.

    Attributes
    ----------
    target
        Name of the target.
    answer
        All that is known of it: what `workflow.design.search.targets.solve_target` gives.
    """

    target: str
    answer: Answer

    @classmethod
    def of(cls, study: Study, target: str, model: GaussianProcess) -> Self:
        """The design that answers a target of the study, searched for on the model and judged on the exact solver.

        Parameters
        ----------
        study : Study
        target : str, the name of one of its targets
        model : GaussianProcess, its surrogate

        Raises
        ------
        InputError
            As `workflow.design.search.targets.solve_target`.
        """
        return cls(target, solve_target(study, target, model))

    @cached_property
    def verdict(self) -> Verdict:
        """Recommended, at the edge of the studied range, or not reachable, and why."""
        return verdict(self.answer)

    @property
    def factors(self) -> dict[str, float]:
        """Every factor of the design by name, in SI: what was chosen, and what was given."""
        return {variable.name: variable.value for variable in self.answer.variables}

    @property
    def exact(self) -> dict[str, float]:
        """Goals and limits as the question has them, with their exact values, in SI."""
        return {term.name: term.exact for term in self.answer.terms}

    def __str__(self) -> str:
        return f"{self.target}: {self.answer.goal}. {self.verdict}"

    def _repr_html_(self) -> str:
        answer = self.answer
        roles = [(category.category, category.kind, category.kind_role) for category in answer.categories]
        roles += [
            (variable.name, shown(variable.value, FACTORS[variable.name].units), variable.role)
            for variable in answer.variables
        ]
        terms = [
            (term.name, *(shown(value, term.units) for value in (term.exact, term.predicted))) for term in answer.terms
        ]
        tables = [
            pd.DataFrame(roles, columns=["factor", "value", "role"]),
            pd.DataFrame(terms, columns=["goals and limits", "exact", "predicted"]),
        ]
        return f"<p>{escape(str(self))}</p>" + "".join(table.to_html(index=False, border=0) for table in tables)
