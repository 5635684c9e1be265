"""CONTRIBUTING's recipes, followed on a copy of the rooms: what each adds is there when its files alone are touched."""

import json
import re
import shutil
from pathlib import Path

import pytest

from tests import warm
from workflow.run.provenance import ROOT

ROOMS = ("approximation", "solver", "storage", "surrogate", "workflow")

#: By file: lines, by their beginnings, and what is added behind them; a file of its own has no such line.
Steps = dict[str, dict[str, str]]

RECIPES: dict[str, Steps] = {
    "a composite law": {
        "solver/material/inverse.py": {
            "": (
                "def inverse(phases, fraction):\n"
                "    from solver.material.composite import fibrous  # which imports this law\n"
                "\n"
                "    return fibrous(phases[1], phases[0], 1 - fraction)\n"
            )
        },
        "solver/material/composite.py": {
            "from solver.material.constants": "from solver.material.inverse import inverse\n",
            "_LAWS": '    "inverse": lambda phases, fraction: inverse(phases, fraction),\n',
        },
        "solver/names.py": {"COMPOSITES": 'COMPOSITES["inverse"] = "volume_fraction"\n'},
    },
    "a profile of the punch": {
        "solver/halfplane/profile.py": {
            '        return cls((np.zeros(()), 1 / radius), (corner == "leading"': (
                "\n"
                "    @classmethod\n"
                "    def quartic(cls, radius):\n"
                "        return cls((np.zeros(()), np.zeros(()), np.zeros(()), radius**-3), (True, True))\n"
            )
        },
        "solver/names.py": {"PROFILES": '    "quartic": Outline(("radius",)),\n'},
    },
    "a quantity": {
        "solver/names.py": {"QUANTITIES": '    "contact_skew": Described("1", "leading extent over trailing"),\n'},
        "solver/halfplane/quantities.py": {
            '        "pressure_exponent"': '        "contact_skew": contact.leading / contact.trailing,\n'
        },
    },
    "a limit": {
        "solver/names.py": {
            "LIMITS": '    "fatigue_strength": Described("Pa", "peak pressure that it bears for long"),\n'
        },
        "solver/material/materials.toml": {
            "c11 = 166e9": 'limits.fatigue_strength = {value = 1e8, source = "a test"}\n'
        },
    },
    "a risk measure": {
        "workflow/language/statistics.py": {
            '        return f"mean minus {self.deviations': (
                "\n"
                "\n"
                "@dataclass(frozen=True)\n"
                "class Tail:\n"
                '    """The mean of the worst share of the cases."""\n'
                "\n"
                "    drawn: ClassVar[bool] = True\n"
                "    share: float\n"
                "\n"
                "    @property\n"
                "    def told(self):\n"
                '        return f"(mean of the worst {100 * self.share:g} %)"\n'
            ),
            "        return Mean(": (
                '    if match := re.fullmatch(r"worst ([0-9.]+) % on average", words):\n'
                "        return Tail(float(match[1]) / 100)\n"
            ),
        },
        "workflow/design/question/risk.py": {
            "        return WorstCase()": (
                "    if isinstance(statistic, statistics.Tail):\n        return Shortfall(statistic.share, sign)\n"
            ),
            "    return MeanDeviation(-sign": (
                "\n"
                "\n"
                "@dataclass(frozen=True)\n"
                "class Shortfall(RiskMeasure):\n"
                "    share: float\n"
                "    sign: float\n"
                "\n"
                "    def _weights(self, values):\n"
                "        ranks = (self.sign * values).argsort(-1).argsort(-1)\n"
                "        worst = ranks < max(1, round(self.share * values.shape[-1]))\n"
                "        return worst / worst.sum(-1, keepdims=True)\n"
                "\n"
                "    def rows(self, values):\n"
                "        return (self._weights(values) * values).sum(-1)\n"
                "\n"
                "    def jacobian(self, values):\n"
                "        return _by_group(self._weights(values))\n"
            ),
        },
    },
    "a figure": {
        "workflow/report/figures/gaps.py": {"": ("def figure(validation, told):\n    raise NotImplementedError\n")},
        "workflow/report/captions/gaps.rst": {"": "Gaps.\n"},
        "workflow/report/sections.py": {
            '    Figure("intervals"': '    Figure("gaps", _VALIDATION, "gaps.figure", "gaps", _factorial),\n'
        },
    },
}

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
    for steps in RECIPES.values():
        for name, additions in steps.items():
            file = copy / name
            for begins, added in additions.items():
                file.write_text(put(file.read_text("utf-8") if file.is_file() else "", begins, added), "utf-8")
    done = warm.run(["python", "-c", ASKED], copy, copy)
    assert not done.returncode, done.stderr
    answer: dict[str, list[object]] = json.loads(done.stdout)
    return answer


@pytest.mark.parametrize("recipe", RECIPES)
def test_a_recipe_touches_three_files_that_its_row_names(recipe: str) -> None:
    rows = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    row = next(row for row in rows if row.startswith(f"| {recipe} "))
    assert len(RECIPES[recipe]) <= 3
    for name in RECIPES[recipe]:
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
