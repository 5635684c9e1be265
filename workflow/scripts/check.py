"""Rule check: one group of checks of the solver, against the independent methods in tests/."""

import sys
from importlib import import_module
from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import joblog, planned
from workflow.files import write_text
from workflow.provenance import ROOT

snakemake: Snakemake

joblog.start(snakemake.log[0])
sys.path.insert(0, str(ROOT))  # the tests are not installed
tests = import_module("tests.verification")
asked = planned.study(snakemake.wildcards.study, snakemake.params.study).verification
assert asked is not None
findings = tests.GROUPS[snakemake.wildcards.group](tests.Sizes(**asked.model_dump()))
write_text(Path(snakemake.output[0]), findings.to_json())
