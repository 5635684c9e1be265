"""The benchmarks compare what they say, and their page holds it; times are for `make bench`."""

import pytest

from benchmarks import rivals, scattered, surrogates
from surrogate.gp import scattergp


def test_the_comparison_measures_errors_on_the_exact_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(surrogates, "GRIDS", [(8, 3, 3, 4, 2)])
    monkeypatch.setattr(surrogates, "FRESH", 500)
    monkeypatch.setattr(surrogates, "CALIBRATION", 200)
    monkeypatch.setattr(surrogates, "LONG", 0.0)
    monkeypatch.setattr(surrogates, "installed", lambda: ([], ["another"]))
    monkeypatch.setattr(surrogates, "ratios", lambda rows: {"some": 2.0})
    result = surrogates.measure()
    exact, ours, calibrated, chebyshev, spline = result["rows"]
    assert [row["cases"] for row in result["rows"]] == [0, 576, 776, 576, 576]
    assert set(exact["error"].values()) == {0.0}
    for name in surrogates.OUTPUTS:
        # the accuracy of the Gaussian process is that of interpolation
        assert ours["error"][name] == pytest.approx(chebyshev["error"][name], rel=0.6, abs=1e-4)
        assert 1e-8 < chebyshev["error"][name] < 0.2
        assert 1e-8 < spline["error"][name] < 0.5
        assert 0.85 < calibrated["coverage"][name] <= 1
        assert calibrated["crps"][name] < calibrated["error"][name]
    assert all(max(row["error"].values()) <= row["accuracy"] for row in result["equal_accuracy"])
    assert result["left_out"] == ["another"]


def test_the_comparison_on_scattered_cases_is_with_the_truth_and_tells_who_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(scattergp, "SUBSET", 150)
    monkeypatch.setattr(scattered, "FUNCTIONS", {"noisy": scattered.FUNCTIONS["circuit with noise"]})
    absent = rivals.Rival("another", "no_such_package", scattered.ours, (10_000,))
    monkeypatch.setattr(scattered, "METHODS", [scattered.METHODS[0], absent])
    result = scattered.measure((800,))
    by_measure = {key.rsplit(": ", 1)[1]: value for key, value in result.items()}
    # below the noise of 0.01, and intervals of new cases with it
    assert 1e-4 < by_measure["root-mean-square error over range"] < 0.007
    assert 0.92 < by_measure["coverage"] < 0.98
    assert "left out, as not installed here: another" in capsys.readouterr().out
