"""Studies that come with the program, read in moments; workflow/study/test_model.py checks that they are solved."""

import functools

from workflow.run.provenance import ROOT
from workflow.study.model import Study, thawed
from workflow.study.reading import read_yaml

NAMES = sorted(path.stem for path in (ROOT / "config").glob("*.yaml"))


@functools.cache
def shipped(name: str) -> Study:
    """A study of `config/` of which no case is solved: as if each had every quantity, and none hung on the datum."""
    path = ROOT / "config" / f"{name}.yaml"
    return thawed({"study": read_yaml(path), "path": str(path), "materials": {}, "absent": [], "hanging": []})
