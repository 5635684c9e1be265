"""Groups and similar cases: axes, stored cases, the surrogate, and effects of one factor, against the solver."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import solver
from solver import FactorError
from surrogate import GroupedGP
from surrogate.transforms.groups import Scales
from tests.studies import edited, fitted, made
from workflow.dataset import effects, factorial
from workflow.learning import training
from workflow.study import representatives
from workflow.study.reading import InputError

STUDY = """\
title: Films in groups
fixed: {surroundings: insulated, composite: fibrous, volume_fraction: 0.4, friction: 0.2, interface_magnetic: grounded}
categories: {base: [rigid, steel]}
factors:
  thickness: {low: 2e-4, high: 1e-3, scale: log}
  radius: {low: 0.03, high: 0.1, scale: log}
  load: {low: 2e4, high: 5e4, scale: log}
  charge: {low: -1e-6, high: 2e-6}
groups:
  load * radius / thickness^2: {levels: 4}
  charge / load: {levels: 3}
validation: {cases: 20, calibration: 40}
"""


def test_a_case_that_is_refused_is_named() -> None:
    study = made(STUDY)
    axes = {"thickness": np.array([1e-3]), "load": 0.03, "radius": np.array([0.1, 0.05, 0.03]), "charge": 0.0}
    with pytest.raises(FactorError) as caught:
        factorial.exact(study, axes)
    said = str(caught.value)
    assert "contact: narrower than the resolved range" in said
    last = "; the case is thickness = 0.001 m, radius = 0.03 m, load = 0.03 N m-1, charge = 0 C m-1, base = rigid"
    assert said.endswith(last)
    assert "\n" not in said


def test_every_quantity_follows_from_the_case_with_the_same_groups() -> None:
    """The depth on steel too, whose logarithm of the datum is added."""
    study = made(STUDY)
    case = {"thickness": 2.3e-4, "radius": 0.08, "load": 2.2e4, "charge": 1.7e-6}
    grouping = factorial.grouping(study)
    X = np.array([[case[name] for name in study.factors]])
    axes = dict(zip(study.axes, grouping.axis_values(X)[0][:, None], strict=True))
    stored, true = (factorial.training_data(study, factorial.exact(study, place)) for place in (axes, case))
    factors = representatives.factors(study, axes)
    near = np.array([[np.asarray(factors[name]).item() for name in study.factors]])
    assert near[0, 0] == pytest.approx(np.sqrt(2e-4 * 1e-3))
    values = np.array([[stored[name].item()] for name in study.output_names])
    scales = Scales(grouping, study.output_names)
    followed = scales.untransform(scales.transform(values, near), X)
    for name, value in zip(study.output_names, followed[:, 0], strict=True):
        assert value == pytest.approx(true[name].item(), rel=1e-7), name
    assert grouping.scalings["depth[steel]"].coefficient > 0
    assert grouping.scalings["depth[rigid]"].coefficient == pytest.approx(0, abs=1e-12 * true["depth[rigid]"].item())


#: Prints the bytes of the stored cases' factors.
REPRESENTATIVES = """
import sys
from pathlib import Path
from workflow.dataset import factorial
from workflow.study import representatives
from workflow.study.model import thawed
from workflow.study.reading import read_yaml
plan = {"study": read_yaml(Path(sys.argv[1])), "path": sys.argv[1], "materials": {}, "absent": [], "hanging": []}
study = thawed(plan)
factors = representatives.factors(study, dict(factorial.axes(study)))
print({name: values.values.tobytes().hex() for name, values in factors.items() if hasattr(values, "values")})
"""


def test_equal_inputs_give_equal_bytes_whatever_python_hashes_texts_to(tmp_path: Path) -> None:
    """Two factors are divided by in the second product: the order, which decides bits, is the product's."""
    (tmp_path / "study.yaml").write_text(STUDY, encoding="utf-8")
    command = [sys.executable, "-c", REPRESENTATIVES, str(tmp_path / "study.yaml")]
    environments = ({**os.environ, "PYTHONHASHSEED": seed} for seed in ("0", "1"))
    first, second = (subprocess.check_output(command, env=variables, text=True) for variables in environments)
    assert "load" in first
    assert first == second


FILM = """\
title: A film on two bases
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, friction: 0.2}
categories: {base: [rigid, steel]}
factors:
  load: {low: 2e4, high: 4e4, levels: 5, scale: log}
  thickness: {low: 1.5e-4, high: 3e-4, levels: 6, scale: log}
  volume_fraction: {low: 0.45, high: 0.55, levels: 3}
dataset: {slabs: 2, positions: {inside: 4, outside: 2}}
effects:
  baseline: {volume_fraction: 0.5, radius: 0.05, load: 3e4, friction: 0.3}
  film: {thickness: 2e-4, base: silicon}
  vary: {thickness: [1e-4, 2e-4], base: [rigid, silicon], friction: [0.0, 0.3]}
  positions: {inside: 5, outside: 4}
"""


@pytest.mark.parametrize(("factor", "last"), [("thickness", np.nan), ("base", "half-plane")])
def test_effects_of_films_stand_beside_the_half_plane(factor: str, last: object) -> None:
    film_study = made(FILM)
    assert film_study.effects is not None
    curves = effects.effect(film_study, factor)
    np.testing.assert_array_equal(curves[factor].values[-1:], [last])
    positions = film_study.effects.positions.values()
    baseline = dict(film_study.effects.baseline)
    half_plane = solver.solve(baseline, positions)["contact_pressure"]
    np.testing.assert_array_equal(curves["contact_pressure"].isel({factor: -1}), half_plane)
    film = solver.solve(baseline | {"thickness": 2e-4, "surroundings": "insulated", "base": "silicon"}, positions)
    np.testing.assert_allclose(curves["stress_xx"].isel({factor: 1}), film["stress_xx"], rtol=1e-12)
    assert "thickness" not in effects.effect(film_study, "friction").coords


SWEEPS = """\
title: Sweeps
effects:
  baseline: {composite: fibrous, volume_fraction: 0.5, radius: 0.05, load: 3e4, friction: 0.3}
  vary: {friction: [0.0, 0.3, 0.6], load: [1e4, 3e4], speed: [0.0, 500.0], composite: [fibrous, laminate]}
  positions: {inside: 5, outside: 4}
"""


def test_effects_about_one_baseline_stand_together() -> None:
    study = made(SWEEPS)
    assert study.effects is not None
    assert study.effects.of_baseline == ["friction", "load", "composite"]  # the baseline states no speed
    single = {name: effects.effect(study, name) for name in study.effects.of_baseline}
    together = effects.together(single)
    assert dict(together.sizes) == {"case": 7, "position": single["load"].sizes["position"]}
    assert set(together.coords) == {*study.effects.baseline, "varied", "position"}
    for name, alone in single.items():
        cases = np.flatnonzero(together["varied"] == name)
        np.testing.assert_array_equal(together[name][cases], alone[name])
        np.testing.assert_array_equal(together["stress_xx"][cases], alone["stress_xx"])
    rows = {name: together[name].values.tolist() for name in study.effects.baseline}
    again = solver.solve([dict(zip(rows, row, strict=True)) for row in zip(*rows.values(), strict=True)])
    np.testing.assert_allclose(again["voltage"], together["voltage"], rtol=1e-12)


GROUPED = """\
title: A half-plane in groups
fixed: {composite: fibrous, datum: 0.5}
factors:
  volume_fraction: {low: 0.2, high: 0.8}
  friction: {low: 0.0, high: 0.4}
  radius: {low: 0.02, high: 0.2, scale: log}
  load: {low: 5e3, high: 5e4, scale: log}
  charge: {low: -1e-6, high: 2e-6}
groups:
  volume_fraction: {levels: 8, scale: logit}
  friction: {levels: 4}
  load * radius / datum^2: {levels: 5}
  charge / load: {levels: 3}
dataset: {slabs: 2, positions: {inside: 6, outside: 2}}
surrogate: {outputs: [depth, voltage, peak_pressure, trailing_tension, blocked_load_per_volt, contact_trailing]}
validation: {cases: 300, calibration: 600, tolerance: 1e-3}
"""


@pytest.fixture(scope="module")
def model() -> GroupedGP:
    half_plane = made(GROUPED)
    grouped = fitted(half_plane, calibrated=True)
    assert isinstance(grouped, GroupedGP)
    return grouped


def test_axes_are_the_groups_over_the_box_and_stored_cases_have_their_values() -> None:
    half_plane = made(GROUPED)
    assert list(half_plane.axes) == ["volume_fraction", "friction", "load_radius_per_datum2", "charge_per_load"]
    pressed, charged = half_plane.axes["load_radius_per_datum2"], half_plane.axes["charge_per_load"]
    np.testing.assert_allclose([pressed.low, pressed.high], [5e3 * 0.02 / 0.25, 5e4 * 0.2 / 0.25], rtol=1e-9)
    np.testing.assert_allclose([charged.low, charged.high], [-1e-6 / 5e3, 2e-6 / 5e3], rtol=1e-12)
    assert (pressed.scale, charged.scale, half_plane.axes["volume_fraction"].scale) == ("log", "linear", "logit")
    assert half_plane.cases == 8 * 4 * 5 * 3
    assert list(half_plane.factors) == ["volume_fraction", "friction", "radius", "load", "charge"]
    # stored cases have the groups' values
    axes = factorial.levels(half_plane)
    factors = representatives.factors(half_plane, axes)
    assert factors["radius"] == pytest.approx(np.sqrt(0.02 * 0.2))
    load, charge = xr.DataArray(factors["load"]), xr.DataArray(factors["charge"])
    np.testing.assert_allclose(load * factors["radius"] / 0.25, axes["load_radius_per_datum2"], rtol=1e-12)
    np.testing.assert_allclose((charge / load).isel(load_radius_per_datum2=2), axes["charge_per_load"], rtol=1e-12)


def test_what_the_surrogate_says_in_the_factors_is_exact(model: GroupedGP) -> None:
    half_plane = made(GROUPED)
    fresh = factorial.cases(half_plane, "validation")
    table = training.validate(half_plane, factorial.exact(half_plane, factorial.axes(half_plane)), fresh, model)
    assert float(table.max_error.max()) < 1e-4
    assert float(np.abs(table.coverage - 0.95).max()) < 0.05
    assert list(table.axis.values) == list(half_plane.axes)
    assert list(model.box) == list(half_plane.factors)


def test_logarithms_are_chosen_by_decay_and_refused_of_signs() -> None:
    wide = GROUPED.replace("low: 0.02, high: 0.2", "low: 0.005, high: 0.2").replace("5e3, high: 5e4", "3e3, high: 3e5")
    wide = wide.replace("datum: 0.5", "datum: 1.0")
    half_plane = made(wide)
    data = factorial.exact(half_plane, factorial.axes(half_plane))
    learned = factorial.with_factors(half_plane, factorial.training_data(half_plane, data))
    chosen = factorial.grouping(half_plane, learned)
    assert chosen.scalings["blocked_load_per_volt"].logarithm == -1
    assert chosen.scalings["depth"].logarithm == 0
    named = made(wide.replace("surrogate: {", "surrogate: {log: [trailing_tension], "))
    logs = {name: scaling.logarithm for name, scaling in factorial.grouping(named, learned).scalings.items()}
    assert logs.pop("trailing_tension") == 1
    assert not any(logs.values())
    signs = made(wide.replace("surrogate: {", "surrogate: {log: [voltage], "))
    wrong = learned.assign(voltage=learned["voltage"] - learned["voltage"].mean())
    with pytest.raises(InputError, match=r"surrogate: log: 'voltage' is from -.* to .*: no logarithm"):
        factorial.grouping(signs, wrong)


def test_groups_that_do_not_tell_the_datum_or_an_elastic_punch_leave_out_what_hangs_on_them() -> None:
    """Without a datum load and radius scale away; that of an elastic punch is its radius."""
    without = edited(GROUPED, "  load * radius / datum^2: {levels: 5}\n", "")
    without = edited(without, "depth, voltage, ", "").replace("blocked_load_per_volt, ", "")
    assert made(without).outputs == ["peak_pressure", "trailing_tension", "contact_trailing"]
    elastic = made(edited(GROUPED, "datum: 0.5}", "datum: 0.5, punch: steel}").split("surrogate:")[0])
    assert {"depth", "blocked_load_per_volt", "blocked_load_per_ampere"}.isdisjoint(elastic.outputs)
    assert "voltage" in elastic.outputs
