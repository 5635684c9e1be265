"""Studies for tests: those that come with the program, and those of a text, each checked once a process."""

import functools
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole, write_whole
from surrogate import GaussianProcess
from workflow.dataset import datacard, factorial
from workflow.dataset import slabs as dataset
from workflow.dataset.slabs import gather
from workflow.learning import training
from workflow.run.provenance import ROOT
from workflow.study import partition
from workflow.study.model import Study, load, thawed
from workflow.study.reading import InputError, read_yaml

NAMES = sorted(path.stem for path in (ROOT / "config").glob("*.yaml"))


@functools.cache
def shipped(name: str) -> Study:
    """Return a study of `config/` without solving a case: as if each had every quantity, and none hung on the datum."""
    path = ROOT / "config" / f"{name}.yaml"
    return thawed({"study": read_yaml(path), "path": str(path), "materials": {}, "absent": [], "hanging": []})


@functools.cache
def made(text: str) -> Study:
    """Return the study of a text, as from a file ``study.yaml``."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "study.yaml")
        path.write_text(text, encoding="utf-8")
        return load(path)


def edited(text: str, old: str, new: str) -> str:
    """Return the text with the first occurrence of `old`, which must exist, replaced."""
    assert old in text
    return text.replace(old, new, 1)


def refusal(text: str) -> str:
    """Return the one line with which the study of a text is refused, without its file."""
    with pytest.raises(InputError) as caught:
        made(text)
    line = str(caught.value)
    assert "\n" not in line
    return line.partition("study.yaml: ")[2]


def fitted(study: Study, *, calibrated: bool = False) -> GaussianProcess:
    """Return the surrogate of a study's whole factorial, calibrated on its calibration cases if `calibrated`."""
    model = training.fit(study, factorial.exact(study, factorial.axes(study)))
    if calibrated:
        model.calibrate(factorial.training_data(study, factorial.cases(study, "calibration")))
    return model


def data_set(study: Study, folder: Path) -> list[Path]:
    """Write the files of a study's data set into a folder, as the rules do; return the slabs."""
    (folder / "fields").mkdir()
    slabs = [folder / f"fields/slab_{index}.nc" for index in range(partition.count(study))]
    for index, slab in enumerate(slabs):
        dataset.write_slab(study, index, slab)
    parts = [read_whole(slab, names=ALL_QUANTITIES) for slab in slabs]
    write_whole(gather(parts), folder / "quantities.nc")
    (folder / dataset.CARD).write_text(json.dumps(datacard.card(study, "some", slabs, [])), encoding="utf-8")
    return slabs
