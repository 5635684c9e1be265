"""The benchmarks: what they compare is right, and their page holds it; times are for `make bench`."""

import json
from pathlib import Path

import numpy as np
import pytest

import benchmarks.__main__ as runner
from benchmarks import page, rivals, surrogates


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


def test_the_runner_writes_whole_files_and_refuses_unknown_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {"exact", "surrogates"} <= set(runner.MEASUREMENTS)
    monkeypatch.setattr(runner, "FOLDER", tmp_path)
    assert runner.main(["exakt"]) == 2
    assert "'exakt' is none of" in capsys.readouterr().err
    monkeypatch.setattr("benchmarks.exact.measure", lambda: {"alone": 0.5})
    assert runner.main(["exact"]) == 0
    assert json.loads((tmp_path / "benchmarks.json").read_text(encoding="utf-8"))["exact"] == {"alone": 0.5}
    assert "alone" in (tmp_path / "benchmarks.html").read_text(encoding="utf-8")
