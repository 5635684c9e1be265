"""The best design of one choice, and its polish on the exact solver: limits are shifted until the verdict holds."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array
from surrogate.search.optimise import Optimum, Problem, improve, maximise, retreat
from surrogate.search.pareto import Front, scalarised
from workflow.design.question import costly
from workflow.design.question.question import Question
from workflow.design.question.sources import Source
from workflow.design.verdict import assessment
from workflow.design.verdict.answer import ROOM, ROUNDING
from workflow.language import titles

_SMALL = 1e-3  # share of its range below which an objective's value is no scale
_NO_OPTIMUM = Optimum(np.empty(0), -np.inf, np.empty(0), False)
_ROUNDS = 6  # polishes, each with limits shifted by the result of many more scenarios
_SAFETY = 1e-10  # relative safety margin, beyond rounding
_NEAR = 1e-6  # relative distance at which a limit binds
_FLAT, _SAME = 5, 1e-9  # values of a variable, and relative change of the goal over them that counts as none
_UNMOVED = 1e-6  # length of a scaled range to which a variable without effect is found
_LOST = 1e-6  # share of the objective that safety margins may cost
_RETREATS = 3  # steps back behind limits over the scenarios of the verdict


@dataclass(frozen=True)
class Candidate:
    """The best design of one choice, at some stage of the search."""

    choice: dict[str, float | str]  # values of the variables with a list, and names of the categories
    question: Question  # for this choice
    best: Optimum = _NO_OPTIMUM
    front: Front | None = None  # with several objectives
    normalisation: tuple[Array, Array] | None = None  # reference and weights of their compromise
    polish: str = ""  # its description
    cases: int = 0  # costly cases of the polish
    passed: "tuple[Candidate, ...]" = ()  # better choices by the surrogate that miss a limit on the exact solver

    @property
    def design(self) -> Question:
        """The question at the best design."""
        return self.question.at(self.best.x)

    @property
    def words(self) -> str:
        """Choice in words: names as they are, numbers with the names of their variables."""
        return ", ".join(
            value if isinstance(value, str) else f"{titles.title(key)} {titles.value(key, value, 4)}"
            for key, value in self.choice.items()
            if key in self.question.target.variables
        )

    def problem(self, source: Source, safety: Array | None = None) -> Problem:
        """Return the optimiser's problem with safety margins, (limits,); several objectives as their compromise."""
        problem = self.question.problem(source, safety)
        if self.normalisation is None:
            return problem
        return scalarised(problem, self.question.objectives, *self.normalisation)

    def sought(self, source: Source) -> "Candidate":
        """Search the whole box for the best design."""
        return replace(self, best=maximise(self.problem(source), scan=self.question.scan))

    def improved(self, source: Source, safety: Array) -> "Candidate":
        """Search near this design for the best one; safety: relative margins to the limits, (limits,)."""
        best = self.best
        return replace(self, best=improve(self.problem(source, safety), best.x, self.size(best.objective)))

    def retreated(self, source: Source, safety: Array) -> "Candidate":
        """Search for the nearest design behind the limits; safety: relative margins, (limits,)."""
        problem = self.problem(source, safety)
        return replace(self, best=replace(self.best, x=retreat(problem, self.best.x))).counted(source)

    def counted(self, source: Source) -> "Candidate":
        """Return the same design with its values on another source."""
        objective, excess = (rows[0] for rows in self.problem(source).value(self.best.x[None]))
        return replace(self, best=replace(self.best, objective=float(objective.min()), excess=excess))

    def size(self, objective: float) -> float:
        """Return the scale of the objective at a value; next to zero, a share of its range."""
        spread = self.question.spread if self.normalisation is None else 1.0
        return max(abs(objective), _SMALL * spread) or 1.0


def first_feasible(candidates: Iterable[Candidate]) -> Candidate:
    """Return the best choice that stays feasible on the exact solver, with better ones in ``passed``, or the first."""
    passed: list[Candidate] = []
    for candidate in sorted(candidates, key=_rank, reverse=True):
        polished = _cheapest(_polish(candidate))
        if polished.best.feasible:
            return replace(polished, passed=tuple(passed), polish="; ".join([polished.polish, *map(_missed, passed)]))
        passed.append(polished)
        if not candidate.best.feasible or sum(attempt.cases for attempt in passed) > costly.most(candidate.question):
            break
    return passed[0]


def _rank(candidate: Candidate) -> tuple[bool, float]:
    """Sort feasible before infeasible candidates, then by the objective or the violation."""
    best = candidate.best
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _missed(passed: Candidate) -> str:
    """Return the reason for which a choice that is better by the surrogate is not taken."""
    excess = _excess(passed.design, costly.affordable(passed.question)).judged
    missed = passed.question.limits[excess.argmax()].label
    return f"{passed.words} is better and not taken: it misses {missed} by {excess.max():.2g} of it"


@dataclass(frozen=True)
class _Excess:
    """Relative excess of every limit at one design."""

    judged: Array  # exact, over the many scenarios of the verdict, (limit,)
    searched: Array  # on the source of the polish, over the few scenarios of the search, (limit,)
    cases: int  # costly cases of both

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Limits that hold in the verdict, (limit,)."""
        return self.judged <= ROUNDING

    @property
    def beyond(self) -> bool:
        """Return whether some limit is missed, but each by little, so that a step back may help."""
        return not np.all(self.kept) and bool(np.all(self.judged <= _NEAR))

    def agrees(self, safety: Array) -> bool:
        """Return whether all limits hold, and the same ones bind in the verdict and in the search."""
        bound = self.searched + safety > -_NEAR
        return bool(np.all(self.kept & ((self.judged > -_NEAR) | ~bound)))


def _excess(design: Question, source: Source) -> _Excess:
    values, cases = assessment.exactly(design, design.limits)
    judged = [float(term.oriented(value)) for term, value in zip(design.limits, values, strict=True)]
    return _Excess(np.array(judged), design.excess(design.count(source, design.searched)[0]), cases)


def _polish(candidate: Candidate) -> Candidate:
    """Polish a candidate on the exact solver until the scenarios of verdict and search agree; costly parts shifted."""
    polished = _shifted(candidate)
    if (
        polished.best.feasible
        or not candidate.best.feasible
        or costly.asked(candidate.question)
        or not candidate.question.inputs
    ):
        return polished
    # the surrogate has led to no feasible design though it knows one: search on the exact solver itself
    searched = _shifted(candidate.sought(candidate.question.exact))
    return searched if searched.best.feasible else polished


def _shifted(candidate: Candidate) -> Candidate:
    """Return the best of the feasible designs, each polished with limits shifted by the last one's excess."""
    question, source = candidate.question, costly.affordable(candidate.question)
    usual = (costly.SAFETY if costly.asked(question) else _SAFETY) * question.inequality
    rounds = _ROUNDS if question.inputs else 0
    first = candidate.counted(source)
    current, last, safety, spent = first, None, np.zeros(len(question.inequality)), 0
    for k in range(rounds + 1):
        excess = _excess(current.design, source)
        spent += excess.cases
        if last is not None and _lost(last, current):
            break
        last = current if np.all(excess.kept) else last
        done = not current.best.feasible or excess.agrees(safety)
        if (k > 0 and done) or k == rounds or spent + excess.cases > costly.most(question):
            break
        # shift limits by the difference between many and few scenarios
        safety = excess.judged - excess.searched + usual
        current = current.improved(source, safety)
    if excess.beyond and not (last is not None and _lost(last, current)):
        last, cases = _retreated(last, current, excess, source, usual)
        spent += cases
    best = replace(current.best, feasible=False) if last is None else last.best
    return replace(
        candidate, best=best, cases=spent, polish=costly.words(question, spent, rounds > 0 and last is not first)
    )


def _retreated(
    last: Candidate | None, current: Candidate, excess: _Excess, source: Source, usual: Array
) -> tuple[Candidate | None, int]:
    """Return the nearest feasible design to one next to the limits, or the last one, and the costly cases."""
    cases = 0
    for _ in range(_RETREATS):
        current = current.retreated(source, excess.judged - excess.searched + usual)
        excess = _excess(current.design, source)
        cases += excess.cases
        if np.all(excess.kept):
            feasible = replace(current, best=replace(current.best, feasible=True))
            return (feasible if last is None or not _lost(last, feasible) else last), cases
    return last, cases


def _lost(last: Candidate, current: Candidate) -> bool:
    """Return whether the objective fell by more than a polish costs: a search that went astray."""
    return current.best.objective < last.best.objective - _LOST * last.size(last.best.objective)


def _cheapest(candidate: Candidate) -> Candidate:
    """Set variables without effect on the goal to the least value at which every limit keeps ``ROOM``, or its room."""
    question, design, x = candidate.question, candidate.design, candidate.best.x.copy()
    if not candidate.best.feasible or question.objectives > 1 or costly.asked(question):
        return candidate

    def excess(points: Array) -> Array:
        return question.excess(design.at(points).count(design.exact, question.judged))

    room = np.maximum(excess(x[None])[0], -ROOM)
    for column in range(len(x)):
        ends = np.tile(x, (_FLAT, 1))
        ends[:, column] = np.linspace(-1.0, 1.0, _FLAT)
        goals = design.at(ends).count(design.exact, question.searched)[:, 0]
        if np.ptp(goals) > _SAME * np.abs(goals).max():
            continue
        low, high = -1.0, float(x[column])
        if np.all(excess(_moved(x, column, low)) <= room):
            high = low
        while high - low > _UNMOVED:
            middle = (low + high) / 2
            low, high = (low, middle) if np.all(excess(_moved(x, column, middle)) <= room) else (middle, high)
        x[column] = high
    return replace(candidate, best=replace(candidate.best, x=x))


def _moved(x: Array, column: int, value: float) -> Array:
    """Return one design with one variable at another value, (1, d)."""
    moved = x[None].copy()
    moved[0, column] = value
    return moved
