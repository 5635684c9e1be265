"""A small study without a shared disk: files in a bucket, every job in a folder of its own. `make cloud`."""

import os
import re
import socket
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from tests.faults.conftest import REPORT, RESULTS, TINY, contents
from tests.programs import PATIENCE
from tests.workflow.conftest import Copy, copy
from workflow.run.provenance import ROOT

__all__ = ["copy"]

pytestmark = pytest.mark.cloud

ENVIRONMENT = ROOT / ".venv/cloud/bin"
SUBMIT = """\
#!/bin/sh
# start a job script in a fresh checkout of its own, and print that folder
folder=$(mktemp -d "{nodes}/node.XXXXXX")
cp -r "{checkout}/." "$folder"
(cd "$folder" && rm -rf .snakemake results logs && (sh "$1" > job.log 2>&1; echo $? > status)) > /dev/null 2>&1 &
echo "$folder"
"""
STATUS = """\
#!/bin/sh
if [ ! -s "$1/status" ]; then echo running; elif [ "$(cat "$1/status")" = 0 ]; then echo success; else echo failed; fi
"""


@pytest.fixture
def bucket() -> Iterator[str]:
    """Address of a storage that speaks S3 on this machine, with the bucket `runs`."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"http://127.0.0.1:{port}"
    server = subprocess.Popen(
        [ENVIRONMENT / "moto_server", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        for _ in range(600):
            try:
                urllib.request.urlopen(urllib.request.Request(f"{address}/runs", method="PUT")).close()
                break
            except OSError:
                time.sleep(0.1)
        yield address
    finally:
        server.terminate()
        server.wait(timeout=PATIENCE)


def fetch(address: str) -> bytes:
    """Bytes of a stored file; the storage asks who reads, and takes any answer."""
    request = urllib.request.Request(address, headers={"Authorization": "AWS any:any"})
    with urllib.request.urlopen(request) as answer:
        content: bytes = answer.read()
    return content


def documented_profile(endpoint: str) -> dict[str, object]:
    """Profile of docs/runs.md with the endpoint of this machine's storage."""
    text = (ROOT / "docs/runs.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```\n(executor: .*?)^```", text, re.DOTALL | re.MULTILINE)
    profile = yaml.safe_load(block)
    return {**profile, "storage-s3-endpoint-url": endpoint}


def test_bucket_and_a_local_run_give_the_same_bytes(copy: Copy, tmp_path: Path, bucket: str) -> None:
    local, planner = copy("local"), copy("planner", whole=True)
    for project in (local, planner):
        (project.folder / "config/tiny.yaml").write_text(TINY, encoding="utf-8")
    local.run("meecontact", "run", "tiny", cold=True)
    expected = contents(local)
    assert len(expected) > 8

    scripts = {"submit.sh": SUBMIT.format(nodes=tmp_path, checkout=planner.folder), "status.sh": STATUS}
    for name, text in scripts.items():
        (planner.folder / name).write_text(text, encoding="utf-8")
        (planner.folder / name).chmod(0o755)
    profile = documented_profile(bucket)
    profile |= {f"cluster-generic-{name}-cmd": str(planner.folder / f"{name}.sh") for name in ("submit", "status")}
    (planner.folder / "profiles/cloud").mkdir(parents=True)
    (planner.folder / "profiles/cloud/config.yaml").write_text(yaml.safe_dump(profile), encoding="utf-8")
    keys = {f"SNAKEMAKE_STORAGE_S3_{name}_KEY": "any" for name in ("ACCESS", "SECRET")}
    run = subprocess.run(
        [ENVIRONMENT / "meecontact", "run", "tiny", "--profile", "cloud"],
        cwd=planner.folder,
        env={**os.environ, **keys, "PYTHONPATH": str(planner.folder), "PATH": f"{ENVIRONMENT}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    logs = [file.read_text(encoding="utf-8") for file in sorted(tmp_path.glob("node.*/job.log"))]
    assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-3000:] + "\n".join(log[-1000:] for log in logs)
    assert run.stdout.splitlines()[-1] == f"report: s3://runs/{REPORT}"
    assert len(logs) > 5  # jobs that are not local ones
    assert not (planner.folder / RESULTS / "quantities.nc").exists()

    stored = {name: fetch(f"{bucket}/runs/{RESULTS}/{name}") for name in expected}
    assert [name for name in expected if stored[name] != expected[name]] == []
    assert b"A tiny study" in fetch(f"{bucket}/runs/{REPORT}")
