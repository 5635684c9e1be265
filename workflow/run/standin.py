"""A stand-in for Snakemake's job object, for a script that runs alone: in an editor, a debugger or the shell.

``python workflow/scripts/card.py results/quickstart/datacard.json`` makes that file from the files that are there. The
Snakefile is read, and no job is started.
"""

import logging
import re
import sys
from pathlib import Path

from snakemake.api import Workflow  # first: Snakemake's modules import each other in a circle
from snakemake.dag import DAG
from snakemake.exceptions import WorkflowError
from snakemake.iocontainers import Snakemake
from snakemake.jobs import Job
from snakemake.logging import LoggerManager
from snakemake.settings.types import (
    ConfigSettings,
    DAGSettings,
    OutputSettings,
    ResourceSettings,
    StorageSettings,
    WorkflowSettings,
)

SNAKEFILE = Path(__file__).parents[1] / "Snakefile"


def job(script: Path, file: str = "") -> Snakemake:
    """The job of a script's rule that makes a file, with its input, output, params, wildcards and log."""
    try:
        workflow = _workflow()
        rules = [rule for rule in workflow.rules if rule.script and Path(rule.script).name == script.name]
        rule = next((candidate for candidate in rules if candidate.is_producer(file)), None)
        if rule is None:
            outputs = ", ".join(str(output) for named in rules for output in named.output)
            outputs = re.sub(r",[^{}]*}", "}", outputs)  # without what a wildcard may be
            raise WorkflowError(f"{script.name}: {file!r} is not one of {outputs}")
        rule_job = Job(rule, DAG(workflow, rules=[rule]), rule.get_wildcards(file), targetfile=file)
    except WorkflowError as error:
        sys.exit(str(error))
    for path in map(Path, rule_job.output):
        path.parent.mkdir(parents=True, exist_ok=True)
    names = rule_job.input, rule_job.output, rule_job.params, rule_job.wildcards
    return Snakemake(*names, rule_job.threads, rule_job.resources, rule_job.log, workflow.config, rule.name, None)


def _workflow() -> Workflow:
    """The rules of the Snakefile, read and not run."""
    workflow = Workflow(
        config_settings=ConfigSettings(),
        resource_settings=ResourceSettings(cores=1),
        workflow_settings=WorkflowSettings(),
        storage_settings=StorageSettings(),
        dag_settings=DAGSettings(rerun_triggers=frozenset()),
        storage_provider_settings={},
        logger_manager=LoggerManager(logging.getLogger("snakemake"), OutputSettings()),
    )
    workflow.include(SNAKEFILE)
    return workflow
