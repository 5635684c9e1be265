"""A shipped study without some of its keys is a plan or one line: no check reads what a later one sets."""

from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import pytest
import xarray as xr

from solver.names import ALL_QUANTITIES
from workflow.report import sections as page
from workflow.run.provenance import ROOT
from workflow.study import coupling, datum, model, partition, solvable
from workflow.study.contents import Contents, Origin
from workflow.study.reading import InputError, read_material, read_yaml

STUDIES = sorted(ROOT.glob("config/*.yaml"))


@pytest.fixture(autouse=True)
def _unsolved(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver is not asked: every case has all quantities of its kind of body."""

    def answered(study: Contents, *_: Any, **options: Any) -> xr.Dataset:
        return xr.Dataset(dict.fromkeys(study.kind.quantities, 0.0))

    monkeypatch.setattr(Contents, "solved", answered)
    monkeypatch.setattr(solvable, "solve_effects", lambda study: None)
    monkeypatch.setattr(model, "solve_effects", lambda study: None)
    hanging = datum.hanging
    by_base = frozenset({"depth"})  # as on every base that gives
    monkeypatch.setattr(datum, "hanging", lambda study: by_base if study.kind.datum == "by_base" else hanging(study))


def plan(content: dict[str, Any], origin: Origin) -> bool:
    """Read all that the rules ask of a study; return False for a refusal of several lines."""
    try:
        study = partition.with_slabs(model._validated(content, origin))
    except InputError as refusal:
        return "\n" not in str(refusal)
    page.figures(study), page.effects(study)
    coupling.outputs(study), coupling.aims(study), coupling.of_interest(study)
    study.final_files, study.output_names, study.regions, study.titles, study.crossed, study.frozen()
    study.digest(*type(study).model_fields)
    return study.absent <= ALL_QUANTITIES.keys()


def without(content: dict[str, Any], random: Random) -> dict[str, Any]:
    """A copy without one or two keys, at any depth."""
    copy = deepcopy(content)
    for _ in range(random.choice((1, 2))):
        part, name = copy, random.choice([*copy])
        while isinstance(part[name], dict) and part[name] and random.random() < 2 / 3:
            part = part[name]
            name = random.choice([*part])
        del part[name]
    return copy


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_a_shipped_study_loads_and_is_a_plan_or_one_line_without_some_keys(file: Path) -> None:
    content = read_yaml(file)
    origin = Origin(file, dict(read_material(file.parent / name) for name in content.get("materials", [])))
    assert plan(content, origin)
    assert model._validated(content, origin).title == content["title"]  # no refusal; its corners: test_model.py
    random = Random(file.stem)
    for _ in range(8):
        shorter = without(content, random)
        assert plan(shorter, origin), shorter
