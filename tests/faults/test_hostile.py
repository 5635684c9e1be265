"""Hostile studies, materials, tables and surrogates: exit status 2 or a good answer, in little time and memory."""

import contextlib
import io
import json
import os
import random
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given
from hypothesis import strategies as st

import surrogate
from storage import examined, quarantine
from storage.sealed import SEAL, FormatError, seal
from tests.faults import hostile, hostilefiles
from tests.faults.conftest import TINY
from tests.layers import few_and_many
from workflow.cli.main import main
from workflow.dataset import factorial
from workflow.learning import training
from workflow.study import model as studies
from workflow.study.reading import InputError
from workflow.study.sections import MOST_CASES

SECONDS = 20  # of processors, its children's too: what passes meanwhile is the machine's matter
BYTES = 2 * 2**30


def peak() -> int:
    """Most bytes that this process has taken: it never falls, so that what other tests took before is no fault here."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def spent() -> float:
    """Seconds of processors that this process and its children have taken."""
    process, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return process.ru_utime + process.ru_stime + children.ru_utime + children.ru_stime


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("model")
    (folder / "tiny.yaml").write_text(TINY, encoding="utf-8")
    study = studies.load(folder / "tiny.yaml")
    fitted = training.fit(study, factorial.exact(study, dict(factorial.levels(study))))
    surrogate.save(fitted, folder / "surrogate.nc")
    return (folder / "surrogate.nc").read_bytes()


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, model: bytes) -> Path:
    """An empty project with a surrogate, as the current folder."""
    (tmp_path / "config").mkdir()
    (tmp_path / "surrogate.nc").write_bytes(model)
    (tmp_path / "points.csv").write_text(hostile.POINTS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(place: Path, *words: str) -> int:
    """Run a command in this process under guard; one line at most on standard error, and bounds kept."""
    before = set(place.rglob("*"))
    out, said = io.StringIO(), io.StringIO()
    start, most = spent(), peak()
    with hostile.guarded(place), contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        try:
            status = main(words)
        except SystemExit as stop:
            status = int(stop.code or 0)
    assert spent() - start < SECONDS
    assert peak() <= max(BYTES, most)
    assert status in (0, 2), said.getvalue()
    new_files = set(place.rglob("*")) - before
    assert new_files <= ({place / words[words.index("-o") + 1]} if status == 0 and "-o" in words else set())
    if status == 2:
        assert said.getvalue().count("\n") == 1
        assert len(said.getvalue()) < 2000
        assert said.getvalue().isprintable() or said.getvalue()[:-1].isprintable()
    assert not (place / hostile.CANARY).exists()
    for file in new_files:
        file.unlink()
    return status


def spoiling(few: int, many: int) -> Callable[[Callable[..., None]], Any]:
    """A property of spoilt files; shrinking a slow example would take minutes."""
    quiet = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large]
    return few_and_many(few, many, phases=[Phase.generate], suppress_health_check=quiet)


#: A valid text of each kind, its file, and the command that reads it.
TEXTS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "cases": (hostile.CASES, "cases.csv", ("solve", "cases.csv", "-o", "out.nc", "--positions=-0.5,2")),
    "points": (hostile.POINTS, "cases.csv", ("query", "surrogate.nc", "cases.csv", "-o", "out.csv")),
    "material": (hostile.MATERIAL, "mine.yaml", ("material", "mine.yaml")),
}


@pytest.mark.parametrize("kind", TEXTS)
@spoiling(8, 2000)
@given(data=st.data())
def test_spoilt_texts(kind: str, data: st.DataObject, place: Path) -> None:
    valid, file, words = TEXTS[kind]
    (place / file).write_bytes(data.draw(hostile.spoilt(valid)))
    run(place, *words)


@spoiling(30, 3000)
@given(content=hostile.spoilt(hostile.STUDY))
def test_studies(content: bytes, place: Path) -> None:
    (place / "config/tiny.yaml").write_bytes(content)
    with hostile.guarded(place), contextlib.suppress(InputError):
        study = studies.named("tiny")
        assert study.cases <= MOST_CASES
        assert studies.thawed(json.loads(json.dumps(study.frozen()))).cases == study.cases
    assert not (place / hostile.CANARY).exists()


@spoiling(6, 500)
@given(name=st.one_of(st.text(max_size=30), st.sampled_from(hostile.PAYLOADS)))
def test_names_of_studies(name: str, place: Path) -> None:
    (place / "outside.yaml").write_text(hostile.STUDY, encoding="utf-8")
    outside = "../outside", str(place / "outside"), "tiny/../../outside"
    for word in (name, f"../{name}", f"{name}\0", f"no {name}.yaml", *outside):
        if not word.startswith("-"):
            assert run(place, "run", word) == 2


@spoiling(20, 3000)
@given(seed=st.integers(0, 2**64), flips=st.integers(1, 30), sealed=st.booleans(), tail=st.integers(0, 300))
def test_bytes_of_surrogates(seed: int, flips: int, sealed: bool, tail: int, place: Path) -> None:
    dice = random.Random(seed)
    content = bytearray((place / "surrogate.nc").read_bytes()[: -SEAL.size])
    for _ in range(flips):  # the headers stand in front
        content[dice.randrange(min(len(content), dice.choice([8000, len(content)])))] = dice.choice([0, 255, 1, 128])
    spoilt = place / "spoilt.nc"
    spoilt.write_bytes(bytes(content[: len(content) - tail]))
    if sealed:
        seal(spoilt)
    status = run(place, "query", "spoilt.nc", "points.csv", "-o", "out.csv")
    assert sealed or status == 2


@spoiling(15, 1500)
@given(seed=st.integers(0, 2**64))
def test_contents_of_surrogates(seed: int, place: Path) -> None:
    dice = random.Random(seed)
    spoilt = place / "spoilt.nc"
    spoilt.write_bytes((place / "surrogate.nc").read_bytes()[: -SEAL.size])
    with netCDF4.Dataset(spoilt, "a") as file:
        file.set_auto_maskandscale(False)  # a text as scale_factor, set before, is not to be applied here
        for _ in range(dice.randint(1, 3)):
            edit(file, dice)
    seal(spoilt)
    run(place, "query", "spoilt.nc", "points.csv", "-o", "out.csv")


def edit(file: netCDF4.Dataset, dice: random.Random) -> None:
    """Change one thing in a model's file: an attribute, values, or a variable more."""
    small = sorted(name for name, variable in file.variables.items() if variable.size <= 2**20)
    name, text = dice.choice(small), dice.choice(hostile.PAYLOADS).replace("\0", "")
    what = dice.choice(["attribute", "of_a_variable", "values", "variable", "group", "texts"])
    if what == "attribute":
        file.setncattr(dice.choice([*file.ncattrs(), "new"]), dice.choice([text, 1, -1, 2**40, np.nan, np.arange(99)]))
    elif what == "of_a_variable":
        file[name].setncattr(dice.choice(["units", "scale_factor", "add_offset", "calendar"]), text)
    elif what == "group":
        file.createGroup(f"g{len(file.groups)}")
    elif what == "texts":
        file[name].setncattr_string("comment", [text] * dice.choice([2, 500]))
    elif what == "values" and file[name].dtype is str:
        file[name][...] = np.full(file[name].shape, text, dtype=object)
    elif what == "values":
        value = dice.choice([0.0, np.nan, np.inf, -1.0, 1e308, 1e-308])
        with contextlib.suppress(OverflowError, ValueError):
            file[name][...] = value
    else:
        size = dice.choice([1, 2**20, 2**27, 2**40, 2**50])
        file.createDimension(f"d{len(file.dimensions)}", size)
        last = (list(file.dimensions)[-1],)
        file.createVariable(f"v{len(file.variables)}", "f8", last, chunksizes=(min(size, 1024),))


def test_a_valid_file_of_each_kind_is_accepted(place: Path) -> None:
    for valid, file, words in TEXTS.values():
        (place / file).write_text(valid, encoding="utf-8")
        assert run(place, *words) == 0
    (place / "config/tiny.yaml").write_text(hostile.STUDY, encoding="utf-8")
    assert studies.named("tiny").cases == 320


@pytest.mark.parametrize("name", hostilefiles.ATTACKS)
def test_a_file_of_more_than_plain_numbers_and_texts_is_refused(name: str, place: Path) -> None:
    hostilefiles.write(name, place / "spoilt.nc")
    start, most = spent(), peak()
    with pytest.raises(FormatError, match=rf"^{place}/spoilt\.nc: {hostilefiles.ATTACKS[name][1]}"):
        surrogate.load(place / "spoilt.nc")
    assert spent() - start < SECONDS
    assert peak() <= max(BYTES, most)


@pytest.fixture(params=["forked", "started"])
def child(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Either way to a process of its own."""
    monkeypatch.setattr(quarantine, "_has_one_thread", lambda: request.param == "forked")
    return str(request.param)


_SPOILT_SCRIPT = """\
import os, sys
sys.path.insert(0, {root!r})
from storage import examined
from tests.faults import hostilefiles
examined.SECONDS, examined.examine = 1, hostilefiles.{what}
os._exit(examined.outcome(sys.argv[1], 0)[0])
"""


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize(
    ("what", "says"), [("endless", "signal 9"), ("crash", "signal 6"), ("greedy", "cannot read it within its limits")]
)
def test_a_file_that_never_ends_crashes_the_library_or_asks_for_gigabytes_is_refused(
    what: str, says: str, child: str, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = str(Path(hostile.__file__).parents[2])
    (place / "script.py").write_text(_SPOILT_SCRIPT.format(root=root, what=what), encoding="utf-8")
    monkeypatch.setattr(quarantine, "SCRIPT", str(place / "script.py"))
    monkeypatch.setattr(examined, "SECONDS", 1)
    monkeypatch.setattr(examined, "examine", getattr(hostilefiles, what))
    with pytest.raises(FormatError, match=rf"surrogate\.nc: no readable netCDF-4 file .*{says}"):
        quarantine.try_to_read(place / "surrogate.nc", BYTES)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_either_way_a_plain_file_passes_and_another_is_refused_in_the_same_words(child: str, place: Path) -> None:
    quarantine.try_to_read(place / "surrogate.nc", BYTES)
    hostilefiles.write("fifo", place / "spoilt.nc")
    with pytest.raises(FormatError, match="the values of variable 'x' are stored elsewhere"):
        quarantine.try_to_read(place / "spoilt.nc", BYTES)
    with pytest.raises(FileNotFoundError, match="no such file"):
        quarantine.try_to_read(place / "fifo", BYTES)


def test_the_guard_sees_what_it_should(place: Path) -> None:
    with hostile.guarded(place), pytest.raises(AssertionError, match=r"led to os\.system"):
        os.system("true")
    with hostile.guarded(place), pytest.raises(AssertionError, match="led to a write"):
        (place.parent / "elsewhere").write_text("", encoding="utf-8")
