"""A design question as the nonlinear program that an optimiser solves: rows of objectives and excesses, with slopes."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Array
from solver.names import ALL_QUANTITIES
from surrogate.search.optimise import Problem
from workflow.design.asking.question import Question
from workflow.design.asking.scenarios import Scenarios
from workflow.design.asking.sources import Source
from workflow.design.asking.terms import Term

_SCANNED, _SCANNED_FILMS = 1 << 17, 1 << 15  # most evaluations in one scan: 4 and 40 us each


def scan(question: Question) -> int:
    """Points of a scan: a power of two, fewer where each stands for many scenarios."""
    size = sum(chosen.count for chosen in question.searched.values())
    most = _SCANNED_FILMS if question.study.kind.tabled else _SCANNED
    return 1 << int(np.clip(np.log2(most / size), 7, 12))


def problem(question: Question, source: Source, safety: Array | None = None) -> Problem:
    """The question for the optimiser.

    safety: (limits,), margins that are added to the relative excesses; None: zero.
    """
    margins = np.zeros(len(question.terms))
    if safety is not None:
        margins[question.objectives :] = safety
    program = _Program(question, source, margins)
    return Problem(len(question.inputs), program.value, program.slope)


@dataclass(frozen=True)
class _Program:
    """Rows of all terms, kinks split into their smooth pieces, each over its own scenarios."""

    question: Question
    source: Source
    safety: Array

    @cached_property
    def _groups(self) -> list[tuple[Scenarios, list[int], list[Term]]]:
        """Scenarios, and the pieces of the terms that count over them behind the places of their terms."""
        groups = []
        for scenarios in self.question.searched.values():
            parts = [(place, piece) for place in scenarios.terms for piece in self.question.smooth(place)]
            if parts:
                groups.append((scenarios, [place for place, _ in parts], [piece for _, piece in parts]))
        return groups

    def value(self, x: Array) -> tuple[Array, Array]:
        """Rows of objectives and of limits at scaled points (n, d): (n, s) and (n, m)."""
        variables = self.question.physical(x)
        wanted, limited = self._split(
            (place, term.oriented(term.measure.rows(values), self.safety[place]))
            for scenarios, places, terms in self._groups
            for place, term, values in zip(
                places, terms, self.question.values(self.source, variables, scenarios, terms), strict=True
            )
        )
        limited += self._beyond(variables)
        return np.concatenate(wanted, -1), np.concatenate([np.empty((len(x), 0)), *limited], -1)

    def slope(self, x: Array) -> tuple[Array, Array]:
        """Derivatives of the rows by the scaled variables at one point (d,): (s, d) and (m, d)."""
        derivatives = self._chain if self.source.step is None else self._quotients
        wanted, limited = self._split(
            (place, term.sign / term.scale * jacobian)
            for scenarios, places, terms in self._groups
            for place, term, jacobian in zip(places, terms, derivatives(x, scenarios, terms), strict=True)
        )
        return np.concatenate(wanted), np.concatenate([np.empty((0, len(x))), *limited, *self._beyond_slopes(x)])

    def _beyond(self, variables: dict[str, Array]) -> list[Array]:
        """Behind the limits: how far every corner lies beyond the edge of the cases that have answers."""
        edge = self.source.edge
        return [] if edge is None else [edge.excess(self.question.factors(variables, self.question.searched[False]))]

    def _beyond_slopes(self, x: Array) -> list[Array]:
        edge = self.source.edge
        if edge is None:
            return []
        variables = self.question.physical(x[None])
        chain = np.array([1 / axis.unit_slope(variables[name][0]) for name, axis in self.question.inputs.items()])
        factors = self.question.factors(variables, self.question.searched[False])
        return [edge.slopes(factors, list(variables)) * chain]

    def _split(self, rows: Iterable[tuple[int, Array]]) -> tuple[list[Array], list[Array]]:
        """Rows of the objectives and rows of the limits, in the order of the terms."""
        ordered, count = sorted(rows, key=lambda pair: pair[0]), self.question.objectives
        return [row for place, row in ordered if place < count], [row for place, row in ordered if place >= count]

    def _chain(self, x: Array, scenarios: Scenarios, terms: list[Term]) -> list[Array]:
        """By the chain rule: rows by scenarios, expressions by names, names by scaled variables."""
        variables = self.question.physical(x[None])
        known, slopes = self._known(variables, scenarios, terms)
        chain = np.array([1 / axis.unit_slope(variables[name][0]) for name, axis in self.question.inputs.items()])
        jacobians = []
        for term in terms:
            value, partials = term.expression.partials(known)
            slope = np.zeros((scenarios.count, len(x)))
            for name, partial in partials.items():
                slope += np.broadcast_to(partial, scenarios.count)[:, None] * slopes[name] * chain
            values = np.broadcast_to(value, scenarios.count).reshape(scenarios.groups, scenarios.draws)
            jacobians.append(term.measure.jacobian(values) @ slope)
        return jacobians

    def _known(
        self, variables: dict[str, Array], scenarios: Scenarios, terms: list[Term]
    ) -> tuple[dict[str, Array], dict[str, Array]]:
        """All names in some terms at one point: values (scenarios,), and derivatives by the variables."""
        factors = self.question.factors(variables, scenarios)
        known = self.question.known(self.source, factors, [term.expression for term in terms])
        learned = [name for name in known if name in ALL_QUANTITIES]
        slopes = self.source.slopes(factors, learned, list(variables))
        for name in (name for name in known if name not in learned):
            own = [float(name == variable) for variable in variables]
            slopes[name] = np.broadcast_to(own, (scenarios.count, len(own)))
        return {name: values[0] for name, values in known.items()}, slopes

    def _quotients(self, x: Array, scenarios: Scenarios, terms: list[Term]) -> list[Array]:
        """Difference quotients of the rows, central where the range allows."""
        d, step = len(x), self.source.step or 0.0
        ends = np.clip(np.concatenate([x + step * np.eye(d), x - step * np.eye(d)]), -1, 1)
        width = np.diag(ends[:d] - ends[d:])[:, None]
        values = self.question.values(self.source, self.question.physical(ends), scenarios, terms)
        rows = [term.measure.rows(value) for term, value in zip(terms, values, strict=True)]
        return [((row[:d] - row[d:]) / width).T for row in rows]
