"""The jobs of a run without Snakemake: the same scripts in the order of their dependencies, in one process a core.

``python -m benchmarks.direct TARGET CORES`` from the root of a copy of the project that holds no results yet. Snakemake
only plans, before the clock starts; it prints seconds, processor time and the number of jobs as JSON.
"""

import json
import runpy
import sys
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from graphlib import TopologicalSorter
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.timing import timed


@dataclass(frozen=True)
class Job:
    """A script and what Snakemake gives to it."""

    script: str
    snakemake: Any
    priority: int

    def run(self) -> None:
        """Run the script in this process."""
        for file in (*self.snakemake.output, *self.snakemake.log):
            Path(file).parent.mkdir(parents=True, exist_ok=True)
        runpy.run_path(self.script, init_globals={"snakemake": self.snakemake})


def planned(target: str, cores: int) -> tuple[dict[int, Job], dict[int, set[int]]]:
    """The jobs that Snakemake would run, and which of them each waits for."""
    from snakemake.api import SnakemakeApi
    from snakemake.iocontainers import Snakemake
    from snakemake.settings.types import DAGSettings, OutputSettings, Quietness, ResourceSettings

    with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as snakemake:
        flow = snakemake.workflow(ResourceSettings(cores=cores), snakefile=Path("workflow/Snakefile"))
        flow.dag(DAGSettings(targets={target})).execute_workflow(executor="dryrun")
        dag = flow._workflow.dag  # the interface tells no job's script
        needed = {job: number for number, job in enumerate(dag.needrun_jobs(exclude_finished=False)) if job.rule.script}
        jobs = {
            number: Job(
                str(Path(job.rule.basedir.get_path_or_uri(secret_free=True)) / job.rule.script),
                Snakemake(
                    job.input, job.output, job.params, job.wildcards, job.threads, job.resources, job.log, {},
                    job.rule.name, None,
                ),
                dag.priority(job),
            )
            for job, number in needed.items()
        }  # fmt: skip
        waits = {number: {needed[other] for other in dag.dependencies[job]} for job, number in needed.items()}
    return jobs, waits


def run(jobs: dict[int, Job], waits: dict[int, set[int]], cores: int) -> None:
    """Run every job once those are done that it waits for, as many at a time as there are cores, by priority."""
    order = TopologicalSorter(waits)
    order.prepare()
    ready: list[int] = []
    running: dict[Future[None], int] = {}
    with ProcessPoolExecutor(cores, mp_context=get_context("spawn")) as pool:
        while order.is_active():
            ready = sorted([*ready, *order.get_ready()], key=lambda number: jobs[number].priority)
            while ready and len(running) < cores:
                number = ready.pop()
                running[pool.submit(jobs[number].run)] = number
            for done in wait(running, return_when=FIRST_COMPLETED).done:
                done.result()
                order.done(running.pop(done))


def main(target: str, cores: int) -> None:
    """Plan, run, and print what it took."""
    jobs, waits = planned(target, cores)
    _, cost = timed(lambda: run(jobs, waits, cores))
    print(json.dumps({**cost._asdict(), "jobs": len(jobs)}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
