"""The rooms where digits matter under every kernel of OpenBLAS that this processor runs, on one thread and on two.

``python -m tests.kernels`` takes what two minutes suffice for: the usual kernel on two threads (`make test` has it on
one) and each other one on one. ``python -m tests.kernels soak`` takes all rooms under every kernel on one thread and on
two, and the regret of every shipped target against dense searches. It ends with one line on what was not run.
"""

import os
import subprocess
import sys
from collections.abc import Sequence

#: What OPENBLAS_CORETYPE may say; the last one runs on every processor.
KERNELS = ("Haswell", "SkylakeX", "Zen", "Nehalem")
THREADS = (1, 2)
QUICK = (
    "tests/workflow/design/test_polish.py",
    "tests/workflow/study/test_categories.py",
    "tests/surrogate/gp/test_finiterank.py",
    "tests/surrogate/search/test_optimise.py",
    "tests/test_examples.py",
)
ALL = (
    "tests/surrogate",
    "tests/workflow/design",
    "tests/workflow/study",
    "tests/test_examples.py",
    "tests/test_tutorials.py",
)

_PROBE = """
import numpy
from threadpoolctl import threadpool_info
numpy.linalg.cholesky(numpy.eye(64) @ numpy.eye(64))
print(next(one["architecture"] for one in threadpool_info() if one["internal_api"] == "openblas"))
"""


def environment(kernel: str, threads: int = 1) -> dict[str, str]:
    """That of a process with one kernel and some threads."""
    return {**os.environ, "OPENBLAS_CORETYPE": kernel, "OMP_NUM_THREADS": str(threads)}


def chosen(kernel: str | None = None) -> str:
    """The kernel that OpenBLAS takes, by itself or where one is asked for; empty where the processor lacks it."""
    command = [sys.executable, "-c", _PROBE]
    variables = dict(os.environ) if kernel is None else environment(kernel)
    done = subprocess.run(command, env=variables, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def distinct() -> tuple[list[str], list[str]]:
    """Kernels that differ here, and why each other one is left out."""
    kernels: dict[str, str] = {}
    left = []
    for kernel in KERNELS:
        taken = chosen(kernel)
        if taken and taken not in kernels:
            kernels[taken] = kernel
        else:
            left.append(
                f"{kernel} (here the same as {kernels[taken]})"
                if taken
                else f"{kernel} (a processor with AVX-512 runs it)"
            )
    return list(kernels.values()), left


def main(words: Sequence[str]) -> int:
    """Run the rooms under each; the number of runs that failed."""
    soak = "soak" in words
    rooms = ["-m", "not slurm", *ALL] if soak else QUICK
    cores = os.cpu_count() or 1
    kernels, left = distinct()
    failed, usual = 0, chosen()
    for kernel in kernels:
        for threads in THREADS:
            if not soak and (threads == 1) == (chosen(kernel) == usual):
                continue
            print(f"{kernel}, {threads} thread{'s' * (threads > 1)}", flush=True)
            command = [sys.executable, "-m", "pytest", "-n", str(max(cores // threads, 1)), *rooms]
            failed += subprocess.run(command, env=environment(kernel, threads), check=False).returncode != 0
    print(f"kernels not run: {', '.join(left) or 'none'}")
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
