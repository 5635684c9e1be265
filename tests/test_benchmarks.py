"""The benchmarks: what they compare is right, and their page holds it; times are for `make bench`."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import benchmarks.__main__ as runner
from benchmarks import direct, intervals, overhead, page, rivals, surrogates
from surrogate import GridGP
from tests.surrogate import functions


def smooth(t: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.stack([np.exp(0.3 * t[:, 0]) * t[:, 1], np.cos(t.sum(axis=1))], axis=1)


@pytest.mark.filterwarnings("ignore::sklearn.exceptions.ConvergenceWarning")
@pytest.mark.parametrize("rival", rivals.RIVALS[:2], ids=lambda rival: rival.name)
def test_rivals_learn_a_smooth_function(rival: rivals.Rival) -> None:
    random = np.random.default_rng(0)
    t, at = random.uniform(-1, 1, (120, 3)), random.uniform(-0.9, 0.9, (40, 3))
    y = smooth(t)
    assert np.abs(np.asarray(rival.fit(t, y)(at)) - smooth(at)).max() < 0.1


def test_the_comparison_measures_errors_on_the_exact_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(surrogates, "GRIDS", [(8, 3, 3, 4, 2)])
    monkeypatch.setattr(surrogates, "QUERIES", 2000)
    monkeypatch.setattr(surrogates, "installed", lambda: ([], ["another"]))
    monkeypatch.setattr(surrogates, "ratios", lambda rows: {"some": 2.0})
    found = surrogates.measure()
    ours, kronecker, chebyshev = found["rows"]
    assert [row["cases"] for row in (ours, kronecker, chebyshev)] == [576] * 3
    for name in surrogates.OUTPUTS:
        # the accuracy of the Gaussian process is that of interpolation
        assert ours["error"][name] == pytest.approx(chebyshev["error"][name], rel=0.6, abs=1e-4)
        assert 1e-8 < chebyshev["error"][name] < 0.2
    text = page.page({"surrogates": found, "exact": {"alone": 1e-3}, "machine": "m", "processor": "p", "versions": {}})
    assert "Left out, as not installed here: another." in text
    assert text.count("<img") == 2
    assert "Kronecker RBF GP" in text


def test_the_comparison_of_intervals_tells_calibrated_from_raw() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((10, 4, 4, 4, 3)))
    found = intervals.compare(model, functions.scattered(1500, seed=1), functions.scattered(4000, seed=2))
    for level in (50, 95):
        ends = [found[f"calibrated, {level} %, {end}"] for end in ("least", "largest")]
        assert level / 100 - 0.05 < ends[0] <= ends[1] < level / 100 + 0.05
    assert found["calibrated, worst slab"] > found["standardised, worst slab"]
    assert found["calibrated, CRPS over raw, median"] < found["standardised, CRPS over raw, median"]
    assert found["calibrated, largest error over range, median"] < found["raw, largest error over range, median"]


def test_the_worst_slab_is_found_and_judged_apart() -> None:
    random = np.random.default_rng(0)
    t = random.uniform(-1, 1, (2, 20_000))
    along = (t[0] + t[1]) / np.sqrt(2)
    held = random.uniform(size=t.shape[1]) < np.where(along > np.quantile(along, 0.9), 0.5, 0.95)
    found = intervals.worst_slab(t, np.stack([held, np.ones_like(held)]))
    assert found[0] == pytest.approx(0.5, abs=0.06)
    assert found[1] == 1.0


def test_the_runner_writes_whole_files_and_refuses_unknown_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {"exact", "surrogates"} <= set(runner.MEASUREMENTS)
    monkeypatch.setattr(runner, "FOLDER", tmp_path)
    assert runner.main(["exakt"]) == 2
    assert "'exakt' is none of" in capsys.readouterr().err
    monkeypatch.setattr("benchmarks.exact.measure", lambda: {"alone": 0.5})
    assert runner.main(["exact"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split() == ["alone", "0.5"]
    assert json.loads((tmp_path / "benchmarks.json").read_text(encoding="utf-8"))["exact"] == {"alone": 0.5}
    assert "alone" in (tmp_path / "benchmarks.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("cores", [1, 2])
def test_the_plain_driver_runs_scripts_after_those_that_they_wait_for(cores: int, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "from pathlib import Path\n"
        "found = [Path(one).read_text() for one in snakemake.input]\n"
        "Path(snakemake.output[0]).write_text('+'.join([*found, snakemake.params.name]))\n"
        "with Path(snakemake.params.order).open('a') as file:\n"
        "    file.write(snakemake.params.name)\n",
        encoding="utf-8",
    )
    files = {name: str(tmp_path / "made" / name) for name in "abcd"}
    before: dict[str, str] = {"a": "", "b": "a", "c": "a", "d": "bc"}
    numbers = {name: number for number, name in enumerate("dcba")}
    jobs = {
        numbers[name]: direct.Job(
            str(script),
            SimpleNamespace(
                input=[files[one] for one in before[name]],
                output=[files[name]],
                log=[str(tmp_path / "logs" / name)],
                params=SimpleNamespace(name=name, order=tmp_path / "order"),
            ),
            priority=int(name == "c"),
        )
        for name in before
    }
    direct.run(jobs, {numbers[name]: {numbers[one] for one in waits} for name, waits in before.items()}, cores)
    assert Path(files["d"]).read_text(encoding="utf-8") == "a+b+a+c+d"
    assert cores > 1 or (tmp_path / "order").read_text(encoding="utf-8") == "acbd"


def test_overhead_is_not_measured_between_different_results(tmp_path: Path) -> None:
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "data.nc").write_bytes(b"same")
        (tmp_path / name / "timing.json").write_text(name, encoding="utf-8")
    overhead._compare(tmp_path / "one", tmp_path / "other")
    (tmp_path / "other" / "data.nc").write_bytes(b"not the same")
    with pytest.raises(RuntimeError, match=r"data\.nc"):
        overhead._compare(tmp_path / "one", tmp_path / "other")
