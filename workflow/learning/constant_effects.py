"""Effects of uncertain constants on a study's quantities: exact differences on a small factorial, as a surrogate.

Effects are a tenth of what they change, or less, so that a tenth of the factorial's accuracy is enough. Of films every
level of a tabled factor costs tables of the solver, for every constant.
"""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver import find
from surrogate import GaussianProcess, GridGP
from surrogate.levels.counts import UnreachableError
from surrogate.levels.pilot import explore
from workflow.dataset import draws, factorial
from workflow.study import categories
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.uncertainty import Constant, concerned, members, moved

_STEP = 0.25  # prior standard deviations, of the difference that a derivative is taken from
_STALE = {True: 1.0, False: 0.1}  # how far constants may move until derivatives are taken anew; films: True
_TOLERANCE = {True: 0.1, False: 0.02}  # over the range of every quantity, for the levels
_BUDGET, _MOST_LEVELS = 20_000, 6
_MOST_TABLES = 2000  # of films, 0.1 to 0.5 s each
_CHECKED, _TOGETHER = 200, 25  # random cases that tell the error; of films, those that share a table


class ConstantEffects:
    """Changes of all outputs of a surrogate when constants move, as surrogates over the same box."""

    def __init__(
        self,
        study: Study,
        model: GaussianProcess,
        constants: list[Constant],
        say: Callable[[str], None],
        silent: Sequence[str] = (),
    ) -> None:
        self._study, self._model, self._constants, self._say, self._silent = study, model, constants, say, silent
        self._levels = _levels(study, model)
        tables = int(np.prod([len(self._levels[name]) for name in study.tabled])) * len(study.combinations)
        solved = sum(not self._parts(constant) for constant in constants)
        if study.tabled and tables * solved > _MOST_TABLES:
            raise InputError(
                f"{study.path}: effects of {solved} constants need {tables} tables of films each, more than "
                f"{_MOST_TABLES} in all; name fewer constants with --uncertain"
            )
        say(f"effects of {solved} constants: exact on {self.cases} cases each")
        self._start = self._exact(np.zeros(len(constants)))
        self._at, self._slopes = np.zeros(len(constants)), self._differences(np.zeros(len(constants)), self._start)
        self.error = self._judged()

    @property
    def cases(self) -> int:
        """Cases that are solved for every constant."""
        return int(np.prod([len(level) for level in self._levels.values()])) * len(self._study.combinations)

    def at(self, z: Array) -> GridGP:
        """The change of every output at scaled constants, then its derivative by each unknown, for every output."""
        z = z[: len(self._constants)]
        exact = self._exact(z) if np.any(z) else self._start
        if np.abs(z - self._at).max() > _STALE[bool(self._study.tabled)]:
            self._say("the constants have moved: their effects anew")
            self._at, self._slopes = z.copy(), self._differences(z, exact)
        parts = {}
        for name in self._model.outputs_:
            parts[f"{name}: change"] = exact[name] - self._start[name]
            for constant, slope in zip(self._constants, self._slopes, strict=True):
                parts[f"{name}: {constant.name}"] = slope[name]
            parts |= {f"{name}: {silent}": xr.zeros_like(exact[name]) for silent in self._silent}
        return self._fitted(parts)

    def _fitted(self, parts: dict[str, xr.DataArray]) -> GridGP:
        return GridGP(self._model.inputs_, list(parts), compression=1e-5).fit(xr.Dataset(parts))

    def _exact(self, z: Array) -> xr.Dataset:
        study = moved(self._study, self._constants, z)
        return factorial.training_data(self._study, factorial.exact(study, dict(self._levels)))

    def _differences(self, z: Array, exact: xr.Dataset) -> list[xr.Dataset]:
        """Derivatives of all outputs by every scaled constant, zero where it has no part."""
        differences: dict[str, xr.Dataset] = {}
        solved = [constant for constant in self._constants if not self._parts(constant)]
        for number, constant in enumerate(solved, 1):
            self._say(f"{number} of {len(solved)}: {constant.name}")
            k = self._constants.index(constant)
            step = z + _STEP * np.eye(len(z))[k]
            held = concerned(self._study, constant)
            cases = factorial.exact(moved(self._study, self._constants, step).narrowed(held), dict(self._levels))
            categories_ = {
                name: [held[name]] if name in held else names for name, names in self._study.categories.items()
            }
            shifted = categories.apart(_expanded(cases, held), categories_, self._study.outputs)
            differences[constant.name] = xr.Dataset({
                name: (shifted[name] - exact[name]) / _STEP if name in shifted else xr.zeros_like(exact[name])
                for name in self._model.outputs_
            })  # fmt: skip
        for family in self._constants:
            for part in self._parts(family):
                share = differences[part.name] * (family.std / part.std)
                differences[family.name] = differences[family.name] + share if family.name in differences else share
        return [differences[constant.name] for constant in self._constants]

    def _parts(self, constant: Constant) -> list[Constant]:
        """The members of a family, where all of them are uncertain too, each for itself."""
        names = members(find(constant.material, self._study.own_materials), constant.family)
        parts = [other for other in self._constants if other.material == constant.material and other.family in names]
        return parts if len(parts) == len(names) else []

    def _judged(self) -> Array:
        """Standard deviation of what the effects leave at random cases, all constants one prior deviation off, (p,)."""
        random = np.random.default_rng(0)
        z = random.choice([-1.0, 1.0], len(self._constants))
        shifted = self._exact(z)
        change = self._fitted({name: shifted[name] - self._start[name] for name in self._model.outputs_})
        points = draws.points(self._study, _CHECKED, (self._study.validation.seed, 11), _TOGETHER)
        exact = factorial.training_data(self._study, factorial.exact(moved(self._study, self._constants, z), points))
        X = np.stack([points[name].values for name in self._model.box], -1)
        predicted = self._model.predict_array(X) + change.predict_array(X)
        truth = np.stack([exact[name].values for name in self._model.outputs_], -1)
        return np.asarray(np.sqrt(np.mean((truth - predicted) ** 2, axis=0)))


def _levels(study: Study, model: GaussianProcess) -> dict[str, Array]:
    """Levels of every factor, tabled ones first, as many as the surrogate's own outputs ask for."""
    films = bool(study.tabled)
    try:
        pilot = explore(
            lambda axes: model.predict(axes, return_std=False), model.inputs_, _TOLERANCE[films], _BUDGET
        ).choice.counts
    except UnreachableError as error:
        raise InputError(f"{study.path}: effects of constants need too many cases: {error}") from None
    counts = {name: min(n if name in study.tabled else n + 1, _MOST_LEVELS) for name, n in pilot.items()}
    return {name: model.box[name].levels(counts[name]) for name in dict.fromkeys([*study.tabled, *counts])}


def _expanded(solved: xr.Dataset, held: dict[str, str]) -> xr.Dataset:
    """Cases of some categories' names with these categories as dimensions again."""
    return solved.drop_vars(list(held), errors="ignore").expand_dims({name: [value] for name, value in held.items()})
