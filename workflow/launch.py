"""A study from its check to its report: Snakemake, started with the profile that is asked for."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from workflow import study as studies
from workflow import unreached
from workflow.inputs import InputError
from workflow.targets import nearest


def launch(name: str, cores: str, profile: str, *, dry: bool) -> int:
    """Check a study and run it.

    Parameters
    ----------
    name
        A study of ``config/``.
    cores
        Cores of this machine to use at most, or ``all``; a cluster's profile counts jobs instead.
    profile
        A folder of ``profiles/``.
    dry
        Only say what would be done.

    Returns
    -------
    int
        Snakemake's exit status.

    Raises
    ------
    InputError
        Unknown or bad study, unknown profile, or a tolerance that no budget reaches.
    """
    study = studies.named(name)
    if study.verification and (absent := [one for one in ("mpmath", "skfem") if not find_spec(one)]):
        raise InputError(f"study: {name!r} needs {', '.join(absent)} of requirements/dev.txt; `make run` installs them")
    profiles = sorted(file.parent.name for file in Path("profiles").glob("*/config.yaml"))
    if profile not in profiles:
        raise InputError(f"--profile: {profile!r} is unknown; {nearest(profile, profiles)}")
    options = ["--workflow-profile", f"profiles/{profile}"]
    if profile == "default":
        options += ["--cores", cores]
    if study.open and not dry:
        _choose_levels(name, options)
    report, *others = [f"results/{name}/{file}" for file in study.targets]
    quiet = ["--dry-run", "--quiet", "host"] if dry else ["--quiet", "rules", "host", "reason"]
    status = _snakemake([*options, *quiet, "--", report, *others])
    if status == 0 and not dry:
        unreached.tell([name] if study.design else [])
        print(f"report: {report}")
    return status


def _snakemake(arguments: list[str]) -> int:
    """Snakemake in this process, which has imported by now what the Snakefile needs; its exit status."""
    from snakemake.cli import main  # slow to import, and not for every command

    try:
        main(arguments)
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return 0


def _choose_levels(name: str, options: list[str]) -> None:
    """What no budget reaches is bad input, and is told before anything else is done."""
    program = str(Path(sys.executable).with_name("snakemake"))
    command = [program, *options, "--quiet", "all", "--", f"results/{name}/levels.nc"]
    told = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)
    for line in told.stderr.splitlines():
        kind, colon, reason = line.partition(": ")
        if told.returncode and colon and kind in ("UnreachableError", "InputError"):
            raise InputError(f"{studies.FOLDER / name}.yaml: {reason}")
