"""`python warm.py meecontact run small`: a run whose jobs are forks of a process that has imported what they need.

Snakemake, the rules and the scripts are those of any run. Only that each job begins with a Python of its own, which
imports for a second or two, is not. Runs that are killed or that two start at once stay as users start them
(tests/faults), so do an installed program's and one of designs (test_pipeline): their bytes are compared with these.
"""

import ast
import contextlib
import importlib
import os
import runpy
import sys
import threading
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

SCRIPTS = Path("workflow/scripts")

#: Jobs begin in threads, and the first of them waits for the modules.
ONE = threading.Lock()


def bring() -> None:
    """Import what scripts import, once, from the packages of the current folder."""
    for file in sorted(SCRIPTS.glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and not str(node.module).startswith("verification"):  # rare and slow
                module = importlib.import_module(str(node.module))
                for name in node.names:
                    if not hasattr(module, name.name):
                        importlib.import_module(f"{node.module}.{name.name}")


def fork(script: str) -> int:
    """Run a script as a Python of its own would; the number of its process."""
    process = os.fork()
    if process == 0:
        status = 0
        try:
            runpy.run_path(script, run_name="__main__")
        except BaseException:
            sys.excepthook(*sys.exc_info())  # the job's own, which is all that is said of it
            status = 1
        os._exit(status)
    return process


def execute(self: Any, fname: str, edit: bool = False) -> None:
    """In the place of Snakemake's `PythonScript.execute_script`."""
    from snakemake.benchmark import benchmarked

    with ONE:
        if "workflow.report.page" not in sys.modules:  # a dry run needs none
            bring()
    process = fork(fname)
    with benchmarked(process, self.bench_record) if self.bench_record else contextlib.nullcontext():
        _, status = os.waitpid(process, 0)
    if status:
        raise CalledProcessError(os.waitstatus_to_exitcode(status), fname)


def main(program: str) -> None:
    """Run a program of the virtual environment so, with the rest of the command line."""
    from snakemake.cli import main as snakemake
    from snakemake.script import PythonScript

    from workflow.cli.main import main as meecontact

    PythonScript.execute_script = execute
    sys.exit({"meecontact": meecontact, "snakemake": snakemake}[Path(program).name]())


if __name__ == "__main__":
    del sys.path[0], sys.argv[0]  # this file and its folder
    main(sys.argv[0])
