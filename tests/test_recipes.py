"""CONTRIBUTING's recipes, followed on a copy of the rooms: what each adds is there when its files alone are touched."""

import json
import re
import shutil
from pathlib import Path

import pytest

from tests import warm
from workflow.run.provenance import ROOT

ROOMS = ("approximation", "solver", "storage", "surrogate", "workflow")

#: Recipes (==) by files (--): the beginning of the line behind which a file is changed, and what is added.
TEXT = """\
== a composite law
-- solver/material/inverse.py
def inverse(phases, fraction):
    from solver.material.composite import fibrous  # which imports this law

    return fibrous(phases[1], phases[0], 1 - fraction)
-- solver/material/composite.py: from solver.material.constants
from solver.material.inverse import inverse
-- solver/material/composite.py: _LAWS
    "inverse": lambda phases, fraction: inverse(phases, fraction),
-- solver/names.py: COMPOSITES
COMPOSITES["inverse"] = "volume_fraction"
== a profile of the punch
-- solver/halfplane/profile.py:         return cls((np.zeros(()), 1 / radius), (corner == "leading"
    @classmethod
    def quartic(cls, radius):
        return cls((np.zeros(()), np.zeros(()), np.zeros(()), radius**-3), (True, True))
-- solver/names.py: PROFILES
    "quartic": Outline(("radius",)),
== a quantity
-- solver/names.py: QUANTITIES
    "contact_skew": Described("1", "leading extent over trailing"),
-- solver/halfplane/quantities.py:         "pressure_exponent"
        "contact_skew": contact.leading / contact.trailing,
== a limit
-- solver/names.py: LIMITS
    "fatigue_strength": Described("Pa", "peak pressure that it bears for long"),
-- solver/material/materials.toml: c11 = 166e9
limits.fatigue_strength = {value = 1e8, source = "a test"}
== a risk measure
-- workflow/language/statistics.py:         return f"mean minus {self.deviations
@dataclass(frozen=True)
class Tail:
    drawn: ClassVar[bool] = True
    share: float

    @property
    def told(self):
        return f"(mean of the worst {100 * self.share:g} %)"
-- workflow/language/statistics.py:         return Mean(
    if match := re.fullmatch(r"worst ([0-9.]+) % on average", words):
        return Tail(float(match[1]) / 100)
-- workflow/design/question/risk.py:         return WorstCase()
    if isinstance(statistic, statistics.Tail):
        return Shortfall(statistic.share, sign)
-- workflow/design/question/risk.py:     return MeanDeviation(-sign
@dataclass(frozen=True)
class Shortfall(RiskMeasure):
    share: float
    sign: float

    def _weights(self, values):
        ranks = (self.sign * values).argsort(-1).argsort(-1)
        worst = ranks < max(1, round(self.share * values.shape[-1]))
        return worst / worst.sum(-1, keepdims=True)

    def rows(self, values):
        return (self._weights(values) * values).sum(-1)

    def jacobian(self, values):
        return _by_group(self._weights(values))
== a figure
-- workflow/report/figures/gaps.py
def figure(validation, told):
    raise NotImplementedError
-- workflow/report/captions/gaps.rst
Gaps.
-- workflow/report/sections.py:     Figure("intervals"
    Figure("gaps", _VALIDATION, "gaps.figure", "gaps", _factorial),
"""


def steps(recipe: str) -> list[tuple[str, str, str]]:
    """File, beginning of a line, and addition of every step; a new file has no line."""
    parts = re.split(r"^-- ([\w/.]+)(?:: (.*))?\n", recipe, flags=re.MULTILINE)
    return [
        (name, begins or "", added) for name, begins, added in zip(parts[1::3], parts[2::3], parts[3::3], strict=True)
    ]


RECIPES = {name: steps(recipe) for name, recipe in re.findall(r"^== (.*)\n((?:(?!== ).*\n)*)", TEXT, re.MULTILINE)}

#: What each has then added, asked in one process of the copy.
ASKED = """
import json
import numpy as np
import solver
from workflow.design.question.risk import measure
from workflow.language import statements
from workflow.language.statistics import statistic
from workflow.report import sections
from workflow.study.model import Study

case = {"radius": 0.05, "load": 1e4}
mixed = solver.solve({**case, "composite": ["inverse", "fibrous"], "volume_fraction": 0.3})
turned = solver.solve({**case, "composite": "fibrous", "volume_fraction": 0.7}, phases=("CoFe2O4", "BaTiO3"))
quartic = solver.solve({**case, "material": "PZT-4", "profile": "quartic"})
own = solver.Profile.polynomial([0, 0, 0, 0.05**-3])
free = solver.solve({"load": 1e4, "material": "PZT-4", "profile": own})
study = {
    "title": "all", "fixed": {"composite": "inverse", "profile": "quartic"},
    "factors": {"volume_fraction": {"low": 0.4, "high": 0.8, "levels": 4},
                "radius": {"low": 0.02, "high": 0.2, "levels": 4}, "load": {"low": 1e4, "high": 2e4, "levels": 4}},
    "design": {"sensor": {"maximise": "abs(voltage_per_load)", "over": ["volume_fraction"], "robust":
               "worst 25 % on average", "uncertain": {"load": {"normal": [1.5e4, 1e3]}}, "at": {"radius": 0.05},
               "subject_to": ["peak_pressure <= 100 MPa"]}},
}
read = Study.model_validate(study)
tail = measure(read.design["sensor"].statistic, 1.0)
draws = np.arange(8.0)[None, None]
print(json.dumps({
    "a composite law": [mixed["voltage"].values[0].item(), turned["voltage"].item(), mixed["voltage"].values[1].item()],
    "a profile of the punch": [quartic["depth"].item(), free["depth"].item(), quartic["contact_trailing"].item()],
    "a quantity": ["contact_skew" in read.quantities, quartic["contact_skew"].item()],
    "a limit": [solver.find("BaTiO3").limits["fatigue_strength"].value,
                statements.limit("peak_pressure <= 50 % of fatigue_strength").allowable],
    "a risk measure": [tail.rows(draws).item(), tail.jacobian(draws[0]).tolist(), read.design["sensor"].statistic.told],
    "a figure": ["gaps" in sections.figures(read)],
}))
"""


def put(text: str, begins: str, added: str) -> str:
    """The text with something added behind the statement or entry that begins so; all of it where nothing does."""
    if not begins:
        return added
    place = re.search(rf"^{re.escape(begins)}.*?\n", text, re.MULTILINE)
    assert place, begins
    behind = place.end()
    return text[:behind] + added + text[behind:]


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[object]]:
    """Answers of a copy of the rooms in which all recipes were followed."""
    copy = tmp_path_factory.mktemp("recipes")
    for room in ROOMS:
        shutil.copytree(ROOT / room, copy / room, ignore=shutil.ignore_patterns("__pycache__"))
    for name, begins, added in (step for recipe in RECIPES.values() for step in recipe):
        file = copy / name
        file.write_text(put(file.read_text("utf-8") if file.is_file() else "", begins, added), "utf-8")
    done = warm.run(["python", "-c", ASKED], copy, copy)
    assert not done.returncode, done.stderr
    answer: dict[str, list[object]] = json.loads(done.stdout)
    return answer


@pytest.mark.parametrize("recipe", RECIPES)
def test_a_recipe_touches_three_files_that_its_row_names(recipe: str) -> None:
    rows = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    row = next(row for row in rows if row.startswith(f"| {recipe} "))
    names = {name for name, *_ in RECIPES[recipe]}
    assert len(names) <= 3
    for name in names:
        assert name in row or str(Path(name).parent) + "/" in row, name


def test_what_the_recipes_add_is_there(answers: dict[str, list[object]]) -> None:
    same, turned, other = answers["a composite law"]
    assert same == turned != other
    depth, free, width = answers["a profile of the punch"]
    assert depth == free
    assert width
    assert answers["a quantity"] == [True, 1.0]  # without friction both extents are alike
    assert answers["a limit"] == [1e8, "fatigue_strength"]
    worst, weights, words = answers["a risk measure"]
    assert (worst, weights) == (0.5, [[0.5, 0.5, 0, 0, 0, 0, 0, 0]])  # of eight draws the least two
    assert words == "(mean of the worst 25 %)"
    assert answers["a figure"] == [True]
