"""Commands and runs whose Pythons are forks of one that has imported what they need: imports are paid once a worker.

`python warm.py ROOT` imports what commands, Snakemake and scripts import, and then reads orders: each is a process of
its own, in its folder, with its environment, its standard input and output, and its end; one whose packages are not
those of ROOT forgets these first. In it Snakemake's jobs are forks again. Snakemake, the rules and the scripts are
those of any run; only that a Python begins by itself, which takes a second or three, is not. Runs of an installed
program and of designs (test_pipeline) stay as users start them, and those that `make soak` kills: their bytes are
compared with these.
"""

import ast
import contextlib
import ctypes
import gc
import importlib
import io
import json
import os
import runpy
import sys
import threading
import warnings
from pathlib import Path
from subprocess import CalledProcessError
from tempfile import TemporaryDirectory
from typing import Any

ROOMS = ("approximation", "meecontact", "solver", "storage", "surrogate", "verification", "workflow")
SCRIPTS = Path("workflow/scripts")
PROGRAMS = {"meecontact": "workflow.cli.main", "snakemake": "snakemake.cli"}

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
    """Replace Snakemake's `PythonScript.execute_script`."""
    from snakemake.benchmark import benchmarked

    with ONE:
        if "workflow.report.page" not in sys.modules:  # a dry run needs none
            bring()
    process = fork(fname)
    with benchmarked(process, self.bench_record) if self.bench_record else contextlib.nullcontext():
        _, status = os.waitpid(process, 0)
    if status:
        raise CalledProcessError(os.waitstatus_to_exitcode(status), fname)


def python() -> None:
    """Run what `python` would run: a module, a piece of code or a file; `-W error` comes first."""
    first = sys.argv.pop(0)
    if first == "-W":
        warnings.simplefilter(sys.argv.pop(0))  # type: ignore[arg-type]  # an action's name
        first = sys.argv.pop(0)
    sys.path.insert(0, "")
    if first == "-m":
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
    elif first == "-c":
        exec(compile(sys.argv[0], "<string>", "exec"), {"__name__": "__main__"})
    else:
        sys.argv.insert(0, first)
        sys.path[0] = str(Path(first).parent)
        runpy.run_path(first, run_name="__main__")


def preload() -> None:
    """Import what they need."""
    from snakemake.cli import main
    from snakemake.script import PythonScript

    PythonScript.execute_script = execute
    with TemporaryDirectory() as empty, contextlib.chdir(empty), contextlib.suppress(SystemExit):
        Path("Snakefile").write_text("rule nothing:\n    output: 'a'\n    shell: ''\n", encoding="utf-8")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            main(["--cores", "1", "-n"])
    bring()
    for file in sorted(Path("workflow/cli").glob("[a-z]*.py")):  # which a command imports when it is known
        importlib.import_module(f"workflow.cli.{file.stem}")
    provenance = importlib.import_module("workflow.run.provenance")
    for script in SCRIPTS.glob("*.py"):
        provenance.code(str(script))  # which sources are behind it is remembered


def forget() -> None:
    """Remove the project's own modules from this process."""
    for name in [name for name in sys.modules if name.partition(".")[0] in ROOMS]:
        del sys.modules[name]


def bind() -> None:
    """Let permissions bind this process, which those of root do not: it gives up CAP_DAC_OVERRIDE, of number 1."""
    library = ctypes.CDLL(None)
    header, sets = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    assert library.capget(header, sets) == 0
    library.prctl(24, 1)  # nor does a program that it starts get it back: PR_CAPBSET_DROP
    for k in range(3):
        sets[k] &= ~(1 << 1)
    assert library.capset(header, sets) == 0


def ordered() -> str:
    """Fork for each order on standard input, or say how one ended; only in a fork this returns, with its program."""
    for line in sys.stdin:
        order = json.loads(line)
        if "process" in order:
            ended, status = os.waitpid(order["process"], 0 if order["wait"] else os.WNOHANG)
            print(os.waitstatus_to_exitcode(status) if ended else "", flush=True)
            continue
        process = os.fork()
        if process == 0:
            break
        print(process, flush=True)
    else:
        sys.exit()
    if order["bound"]:
        bind()
    os.environ.clear()
    os.environ.update(order["environment"])
    os.chdir(order["folder"])
    if order["environment"]["PYTHONPATH"] != ROOT:
        forget()
    sys.path.insert(0, order["environment"]["PYTHONPATH"])
    written = os.O_WRONLY | os.O_CREAT | os.O_APPEND
    for number, (name, way) in enumerate(zip(order["streams"], (os.O_RDONLY, written, written), strict=True)):
        stream = os.open(name, way)
        os.dup2(stream, number)
        os.close(stream)
    sys.stdin = os.fdopen(0, encoding="utf-8", closefd=False)  # what was read ahead of the orders is not its input
    program, *sys.argv[:] = order["command"]
    return str(program)


if __name__ == "__main__":
    paths = sys.path[1:]  # without this file's folder
    ROOT = sys.argv[1]
    sys.path.insert(0, ROOT)
    os.chdir(ROOT)
    preload()
    sys.path[:] = paths
    gc.freeze()
    program = ordered()
    if program == "python":
        python()
    else:
        sys.argv.insert(0, program)
        sys.exit(importlib.import_module(PROGRAMS[program]).main())
