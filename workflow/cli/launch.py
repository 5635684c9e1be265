"""``meecontact run``: the check of a study, and Snakemake up to its report."""

import argparse
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import yaml

from workflow.cli import progress
from workflow.cli.words import say
from workflow.language.spelling import nearest
from workflow.study import configuration, location, partition
from workflow.study import model as studies
from workflow.study.model import Study
from workflow.study.reading import InputError

SNAKEFILE = Path(__file__).parents[1] / "Snakefile"


def run(options: argparse.Namespace) -> int:
    """Check a study and run it, as the options say; its results go below the current folder."""
    _require_programs()
    if "\\" in str(Path.cwd()):  # the netCDF library takes it for a Windows path, and finds no such folder
        raise InputError(
            f"{Path.cwd()}: a backslash in the path: no netCDF file can be written here; use another folder"
        )
    name = location.given(options.study)
    study = studies.named(name)
    answers = [Path("results", name, "design", f"{target}.nc") for target in study.design]
    if other := studies.pressed(study):
        assert study.signal is not None
        _check_results(other.path.stem)
        answers.insert(0, Path("results", other.path.stem, "design", f"{study.signal.design}.nc"))
    for line in study.defaults:
        say(line)
    _check_results(name)
    if study.verification and not find_spec("mpmath"):
        raise InputError(f"study: {name!r} needs mpmath of requirements/dev.txt; `make run` installs it")
    folder = _profile(options.profile)
    arguments = ["--snakefile", str(SNAKEFILE), "--workflow-profile", str(folder)]
    configuration.check_profiles(arguments)
    if location.by_path(name):
        arguments += ["--config", f"study={location.address(name)}"]
    if options.profile == "default":
        arguments += ["--cores", options.cores]
    if study.open and not options.dry_run:
        _choose_levels(name, arguments)
    report, *others = [f"results/{name}/{file}" for file in study.final_files]
    if options.dry_run:
        with progress.followed(study, sys.stdout):
            return _snakemake([*arguments, "--dry-run", "--quiet", "host", "reason", "--", report, *others])
    with progress.followed(study):
        status = _snakemake([*arguments, "--quiet", "host", "reason", "--", report, *others])
    if status == 0:
        if bucket := _bucket(folder):  # no result is in a folder of this machine
            print(f"report: {bucket}/{report}")
            return status
        results = Path(report).parent
        _check_origin(study, results / "provenance.json")
        from workflow.design.wording import table  # scikit-learn stands behind it, for which the start should not wait

        for line in table.outcome(answers):
            print(line)
        print(f"report: {report}")
    return status


def _bucket(profile: Path) -> str:
    """Return the address of a profile's storage of results; empty where results are in the current folder."""
    entries = yaml.safe_load((profile / "config.yaml").read_text(encoding="utf-8")) or {}
    return str(entries.get("default-storage-prefix", "")).rstrip("/")


def _check_results(name: str) -> None:
    """Refuse a file where the folders of results and logs would go."""
    for folder in (Path(kind, *tail) for kind in ("results", "logs") for tail in ((), (name,))):
        if (folder.exists() or folder.is_symlink()) and not folder.is_dir():
            raise InputError(f"{folder}: is no folder, where the results of a run would go; remove or rename it")
    location.check_owner(name, Path("results", name))


def _check_origin(study: Study, provenance: Path) -> None:
    """Refuse results of another state of the study, which Snakemake takes for new ones by their times."""
    origin = json.loads(provenance.read_text(encoding="utf-8"))["study_sha256"]
    if origin != partition.with_slabs(study).digest(*Study.model_fields):
        raise InputError(
            f"{provenance.parent}: was made from another state of the study, and not by this checkout; "
            "remove that folder, and run again"
        )


def _profile(name: str) -> Path:
    """Return the folder of a profile, in the current folder or else of the program."""
    profiles = {file.parent.name: file.parent for file in SNAKEFILE.parent.glob("profiles/*/config.yaml")}
    profiles |= {file.parent.name: file.parent for file in Path("profiles").glob("*/config.yaml")}
    if name not in profiles:
        raise InputError(f"--profile: {name!r} is unknown; {nearest(name, sorted(profiles))}")
    return profiles[name]


def _require_programs() -> None:
    """Refuse a run without the packages that only runs need."""
    missing = [name for name in ("snakemake", "matplotlib") if not find_spec(name)]
    if missing:
        raise InputError(
            f"run: {' and '.join(missing)} not installed; pip install 'meecontact[run]' installs what runs need"
        )


def _snakemake(arguments: list[str]) -> int:
    """Run Snakemake in this process, which has imported most modules of the Snakefile; return its exit status."""
    from snakemake.cli import main  # slow to import, and not for every command

    try:
        main(arguments)
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return 0


def _choose_levels(name: str, options: list[str]) -> None:
    """Choose the levels first, so that an error that no budget reaches is reported as bad input."""
    program = str(Path(sys.executable).with_name("snakemake"))
    command = [program, *options, "--quiet", "all", "--", f"results/{name}/levels.nc"]
    finished = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)
    for line in finished.stderr.splitlines():
        error, colon, reason = line.partition(": ")
        if finished.returncode and colon and error in ("UnreachableError", "InputError"):
            raise InputError(f"{location.location(name)}: {reason}")
