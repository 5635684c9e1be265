"""The imports of a warm process, from which `tests/warm.py` forks commands; Snakemake's jobs in it are forks again.

Snakemake, rules and scripts are those of any run: only a Python's start, a second or three, is left out.
"""

import contextlib
import gc
import importlib
import os
import runpy
import sys
import threading
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

from snakemake.script import PythonScript

LIBRARIES = """
snakemake.api snakemake.cli snakemake.dag snakemake.executors.local snakemake.logging snakemake.report
snakemake.scheduling snakemake.workflow scipy.linalg scipy.optimize scipy.special
"""
#: They import what the scripts import.
ROOMS = """
surrogate.use.sensitivity workflow.cli.launch workflow.cli.learn workflow.cli.main workflow.cli.sensing
workflow.cli.solve workflow.cli.studies workflow.dataset.datacard workflow.dataset.effects workflow.dataset.levels
workflow.design.search.targets workflow.design.wording.table workflow.learning.readout_trial workflow.learning.surface
workflow.learning.timing workflow.learning.training workflow.measured.comparison workflow.report.figures.design_plots
workflow.report.page workflow.report.sections workflow.run.provenance workflow.study.planned
"""
#: Jobs start in threads, of which the first imports the modules.
LOCK = threading.Lock()


def execute(self: Any, fname: str, edit: bool = False) -> None:
    """Run a job's script in a fork; replaces Snakemake's `PythonScript.execute_script`."""
    from snakemake.benchmark import benchmarked

    with LOCK:  # of another folder's packages nothing is imported yet
        for name in ROOMS.split():
            importlib.import_module(name)
    process = os.fork()
    if process == 0:
        status = 0
        try:
            runpy.run_path(fname, run_name="__main__")
        except BaseException:
            sys.excepthook(*sys.exc_info())
            status = 1
        os._exit(status)
    with benchmarked(process, self.bench_record) if self.bench_record else contextlib.nullcontext():
        _, status = os.waitpid(process, 0)
    if status:
        raise CalledProcessError(os.waitstatus_to_exitcode(status), fname)


PythonScript.execute_script = execute
for module in (LIBRARIES + ROOMS).split():
    importlib.import_module(module)
for script in Path("workflow/scripts").glob("*.py"):
    sys.modules["workflow.run.provenance"].code(str(script))  # it remembers the sources
gc.freeze()
