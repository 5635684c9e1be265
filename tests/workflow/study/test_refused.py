"""Studies that are refused: each in one line that names the key, its value and what is allowed."""

import pytest

from tests.studies import edited, refusal
from tests.workflow.dataset.test_levels import FILM as CROSSED
from tests.workflow.dataset.test_similar import GROUPED
from tests.workflow.design.test_verdict import STUDY as TOLERATED
from tests.workflow.device.test_signal import STUDY as PRESSED
from tests.workflow.report.test_figures import ROUGH
from tests.workflow.study.test_bodies import AIR_BALL, AIR_FILM, BALL, LAYERS
from tests.workflow.study.test_films import FILM
from tests.workflow.study.test_model import POINT
from workflow.run.provenance import ROOT

NAMES = ("quickstart", "catalogue", "taxel", "measured")
QUICKSTART, CATALOGUE, TAXEL, MEASURED = ((ROOT / f"config/{name}.yaml").read_text(encoding="utf-8") for name in NAMES)
BOX = edited(QUICKSTART, "<= tensile_strength]", "<= 50 MPa, peak_pressure <= 500 MPa]")
LARGE, FEW = edited(BOX, "levels: 26", "levels: 1000"), edited(BOX, "calibration: 10000", "calibration: 99")
AXES = ["volume_fraction", "friction", "radius", "load", "charge", "magnetic_charge", "speed", "width", "slope"]
KINDS = ["profile", "electric", "magnetic", "corner"]
CORNERS = f"""\
title: A box of nine factors and four categories
factors: {{{", ".join(f"{name}: {{low: 0.001, high: 0.002}}" for name in AXES)}}}
categories: {{{", ".join(f"{name}: [a, b, c, d, e, f, g, h]" for name in KINDS)}}}
"""
MODEL = next(line for line in MEASURED.splitlines(keepends=True) if line.startswith("    model:"))
POINTS = """\
title: Effects of a point
effects: {baseline: {material: PZT-4, profile: sphere, radius: 0.01, force: 1}, vary: {force: [1, 2]}}
"""
EFFECTS = """\
title: Effects of a factor
effects: {baseline: {material: PZT-4, radius: 0.05, load: 1e5}, vary: {friction: [0, 0.1]}}
"""

#: A study, a part of it, what stands in its place, and words of the refusal.
REFUSED: list[tuple[str, str, str, str]] = [
    # keys, factors, questions
    (BOX, "high: 0.6", "hihg: 0.6", "factors.friction.hihg: unknown key; did you mean 'high'? allowed: low, high,"),
    (BOX, "high: 0.6", "high: 0.6, kinks: [0.3]", "factors.friction.kinks: was removed in 0.3.0; leave it out"),
    (BOX, "levels: 5", "levels: 5.5", "factors.friction.levels: 5.5: input should be a valid integer"),
    (BOX, "high: 0.6", "high: .nan", "factors.friction.high: nan: input should be a finite number"),
    (BOX, "low: 0.0, high: 0.6", "low: 0.7, high: 0.6", "factors.friction: low = 0.7 must be below high = 0.6"),
    (BOX, "high: 0.95", "high: 1.05", "volume_fraction: 1.05 is not a finite number >= 0 and <= 1 [1]"),
    (BOX, "{low: 0.0, high: 0.6, levels: 5}", "0.2", "factors.friction: 0.2: must be a mapping of low, high, levels"),
    (BOX, "friction: {low", "fricton: {low", "factors.fricton: 'fricton' is not a factor; did you mean 'friction'?"),
    (BOX, "[BaTiO3, CoFe2O4]", "[BaTi3, CoFe2O4]", "material: 'BaTi3' is unknown; did you mean 'BaTiO3'?"),
    (BOX, "magnetic_charge: 0.0", "magnetic_charge: none", "fixed: magnetic_charge: 'none' is not a finite number"),
    (BOX, "magnetic_charge: 0.0", "charge: 0.0", "fixed: charge: is one of the factors already"),
    (BOX, "tension <=", "tensin <=", "design.sensor: 'trailing_tensin': 'trailing_tensin' is not a quantity; did"),
    (BOX, "<= 50 MPa", "<= 50 mm", "design.sensor: 'trailing_tension <= 50 mm': unit mismatch: the limit is in mm, "),
    (BOX, "maximise: abs(voltage_per_load)", "robust: mean", "design.sensor: maximise or minimise: missing; one"),
    (BOX, "[trailing_tension <= 50 MPa,", "[depth <= 1 mm with probability 0.9,", "design.sensor: subject_to: depth <"),
    (BOX, "over: [volume_fraction, radius]", "over: {volume_fraction: {}, radius: {high: 1.0}}",
     "design: sensor: radius = 1 is not within 0.005 to 0.2"),
    (BOX, "[0.1, 0.4]", "[0.4, 0.1]", "design.sensor: worst_case: friction: 0.4 must not be above 0.1"),
    (BOX, "{load: 5e3, charge: 0.0}", "{load: 5e3}", "design: sensor: 'charge' is missing; put it in over, at, worst"),
    (BOX, "  sensor:", "  my sensor:", "design: 'my sensor' must be letters, digits and underscores"),
    (BOX, "cases: 5000", "cases: 5000\n  cases: 4", "not valid YAML: key 'cases' is given twice"),
    (BOX, "\ndesign:", "\n\tdesign:", "not valid YAML: found character '\\t' that cannot start any token"),
    (BOX, "trailing_tension <=", "nominal_field <= 1 kV/mm, trailing_tension <=",
     "'thickness' is a film's: a half-plane has none"),
    (BOX, "peak_pressure <=", "peak_von_mises <=", "design: sensor: 'peak_von_mises' needs dataset: peaks: true"),
    (BOX, "  fields: 24", "  outputs: [peak_von_mises]", "surrogate: outputs: 'peak_von_mises' needs dataset: peaks"),
    (FEW, "surrogate:", "surrogate:\n  level: 0.99", "level: 0.99 is more than 0.98, all that 99 cases of validation"),
    # numbers that are none of their factor, and bare ones that have probably lost their unit
    (BOX, "low: 5e-3", "low: 20 V", "radius: low: '20 V': unit mismatch: 'V' does not measure what 'm' measures"),
    (BOX, "low: 5e-3", "low: 20e mm", "radius: low: '20e mm' is not a finite number [m], nor one with its unit"),
    (POINT, "radius: 0.01", "radius: 20", "fixed: radius: 20 is 20 m; did you mean 20 mm? '20 m' is read as it stands"),
    (POINT, "radius: 0.01", "radius: 0.01, friction: 20", "fixed: friction: 20 is 2000 %; did you mean 20 %?"),
    (POINT, "high: 2.0", "high: 5e9", "factors: force: high: 5e+09 is 5e+09 N; did you mean 5e+09 mN?"),
    (POINT, "radius: 0.01", "radius: 0.01, punch_modulus: 200, punch_poisson: 0.3",
     "punch_modulus: 200 is 200 Pa; did you mean 200 GPa?"),
    (FILM, "design:", "device: {amplifier: {input_capacitance: 1 pF, charge_noise: 1}}\ndesign:",
     "device.amplifier.charge_noise: 1 is 1 C; did you mean 1 fC?"),
    # more than any later step could bear
    (LARGE, "slabs: 2", "slabs: 2, positions: {inside: 2000, outside: 2}",
     "dataset: 1600000 cases x 2002 positions are more than 2000000000 values of each field"),
    (LARGE, "slabs: 2", "slabs: 2", "surrogate: fields: 1600000 cases x 24 angles are more than 20000000"),
    (CORNERS, "factors", "factors", "factors: a box of 2097152 corners, over all categories, has more than 262144"),
    (EFFECTS, "[0, 0.1]", f"[{'0.1, ' * 201}]", "effects: vary: friction: 201 values; must be 1"),
    (EFFECTS, "[0, 0.1]}", f"[{'0.1, ' * 12}]}}, positions: {{inside: 10000, outside: 10000}}",
     "effects: vary: friction: 12 values x 20000 positions are more than 200000"),
    (EFFECTS, "[0, 0.1]}", "[0, 0.1]}, interior: {across: 2000, down: 2000}",
     "effects.interior: across x down: 2000 x 2000 points are more than 250000"),
    # tolerances
    (TOLERATED, "radius: 5 %", "radius: 95 %", "radius: 95 % is larger than the range 0.02 to 0.3 leaves room for"),
    (TOLERATED, "radius: 5 %", "radius: -1.0", "radius: -1 is not a positive number"),
    (TOLERATED, "{radius: 5 %", "{friction: 0.1", "friction: is not one of the design variables: volume_fraction"),
    (TOLERATED, "abs(voltage_per_load)", "deviation(voltage_per_load)", "': a deviation is minimised"),
    (TOLERATED, "trailing_tension <= 50 MPa", "deviation(voltage_per_load over load) <= 2 %", "'load' is none of"),
    # categories
    (CATALOGUE, "  profile: [cylinder, half_cylinder]", "  profile: [cylinder, cylinder]", "a name is given twice"),
    (CATALOGUE, "  profile: [cylinder, half_cylinder]", "  colour: [red, blue]", "'colour' is not a category"),
    (CATALOGUE, "[radius, material, profile]", "[radius, material]", "design: voltage: 'profile' is missing"),
    (CATALOGUE, "{voltage: 0.1 %}", "{voltage: 2 A}", "readout.voltage: measured: voltage: unit mismatch: '2 A'"),
    (BOX, "magnetic_charge: 0.0", "profile: half_cylinder",
     "surrogate: fields: only those under a cylinder that conducts in both fields are learned"),
    (CATALOGUE, "  outputs: [", "  fields: 8\n  outputs: [", "are not learned over categories: material, profile"),
    # films
    (FILM, "  thickness: {low: 2e-4, high: 3e-4, levels: 3, scale: log}\n", "", "base: 'rigid' without a thickness"),
    (FILM, "categories: {base: [rigid, steel]}\n", "", "base: missing; must be 'rigid' or a material's name, or else"),
    (FILM, "electric: grounded", "electric: insulated", "interface_electric: 'insulated' is not one of gr"),
    (FILM, "electric: grounded", "magnetic: insulated", "interface_magnetic: 'insulated' is allowed above a"),
    (FILM, "design:", "surrogate: {fields: 4}\ndesign:", "surrogate: fields: only those of half-planes are learned"),
    (FILM, "design:", "surrogate: {outputs: [peak_von_mises]}\ndesign:", "surrogate: outputs: some of thes"),
    # what the library or the study lacks
    (FILM, "<= 3 kV/mm", "<= breakdown_field", "breakdown_field: none is known of BaTiO3 and CoFe2O4"),
    (FILM, "nominal_field <= 3 kV/mm", "trailing_tension <= base_tensile_strength",
     "base_tensile_strength: a rigid base has none"),
    (FILM, "voltage_per_load)", "charge_per_force * force)", "electrode_length: missing; must be a number with a unit"),
    (edited(FILM, "voltage_per_load", "signal_voltage"), "design:", "device: {electrode_length: 10 mm}\ndesign:",
     "device: amplifier: input_capacitance: missing; must be a number with a unit"),
    # heat
    (TAXEL, "base: FR4", "base: rigid", "have no 'heat_time'; heat: not known for the base 'rigid': conductivity;"),
    (TAXEL, "charge_noise: 1 fC", "feedback_resistance: 1 TOhm\n    charge_noise: 1 fC",
     "device: amplifier: feedback_resistance: 1 TOhm is beside one of the factors; give one of them"),
    # points
    (BALL, "{amplifier:", "{electrode_length: 10 mm, amplifier:",
     "device: electrode_length: a point contact has none: its forces and charges are whole"),
    (BALL, "groups:", "surrogate: {fields: 8}\ngroups:", "surrogate: fields: point contacts have none; must be 0"),
    (BALL, "peak_pressure <=", "leading_compression <= 1 MPa, peak_pressure <=", "'leading_compression' is not one of"),
    (BALL, "groups:", "categories: {profile: [sphere, cylinder]}\ngroups:",
     "categories: profile: sphere, cylinder: lines and points need a study each"),
    (POINTS, "[1, 2]}", "[1, 2]}, film: {thickness: 1e-4, base: steel}",
     "effects: film: is not drawn of a point; a film stands in the baseline"),
    (ROUGH, "rough_sphere", "ellipsoid, radius_x: 1 mm, radius_y: 2 mm", "realisations: only a rough_sphere"),
    (ROUGH, "realisations: 2", "interior: {}", "interior: of a contact in space"),
    # groups
    # equally strong pressing does not fix the vacuum in the gap
    (AIR_FILM, "  radius / thickness: {levels: 3}\n", "", "make radius / thickness a group"),
    (AIR_BALL, "  radius / thickness: {levels: 2}\n", "", "make radius / thickness a group"),
    (GROUPED, "load * radius / datum^2", "load / radius", "depth, voltage, blocked_load_per_volt depend on the datum"),
    (GROUPED, "charge / load", "charge^2 / load^2", "groups: the sign of charge is in no group"),
    (GROUPED, "charge / load", "radius * charge", "groups: radius = -0.4 in a corner of their ranges; must be a"),
    (GROUPED, "charge / load", "volume_fraction * load / radius", "'volume_fraction' is a group of its own"),
    (GROUPED, "0.5}", "0.5, punch: steel}", "groups: depth, blocked_load_per_volt depend on an elastic punch's radius"),
    (GROUPED, "volume_fraction: {levels: 8, scale: logit}", "volume_fraction * charge / load: {levels: 3}",
     "charge = 0 is in the box, where volume_fraction * charge / load, charge / load"),
    (GROUPED, "charge / load", "charge / load^2", "radius x 0.316 and load x 3.16 and charge x 10 is in no group, and"),
    (GROUPED, "charge / load", "charge + load", "groups: 'charge + load': 'C m-1' and 'N m-1' cannot be added"),
    (GROUPED, "charge / load", "voltage / load", "groups: 'voltage / load': 'voltage' is no factor"),
    (GROUPED, "load * radius / datum^2: {levels: 5}", "load * radius: {levels: 5, scale: logit}", "between 0 and 1"),
    (GROUPED, "charge / load: {levels: 3}", "load / datum: {levels: 3}", "begins with 'load' as another group does"),
    (GROUPED, "low: 0.02,", "levels: 4, low: 0.02,", "radius: levels: of a study with groups they stand in groups"),
    # bodies
    (LAYERS, "copper_thickness: {", "zinc_thickness: {", "body.1: thickness: 'copper_thickness' is neither in factors"),
    (LAYERS, "radius: 0.05", "radius: 0.05, x_thickness: 1e-3", "fixed: x_thickness: no layer of the body names it"),
    (LAYERS, "categories: {base: [rigid, silicon]}\n", "", "base: a body needs a base, or else base_modulus and base"),
    (LAYERS, "volume_fraction: volume_fraction,", "", "body.0: volume_fraction: missing; must be a finite number >= 0"),
    (LAYERS, "copper_thickness}", "thickness}", "body.1: thickness: 'thickness' must be <word>_thickness, or a number"),
    # presses in time
    (PRESSED, "signal: {design: touch,", "signal: {study: ball, design: touch,",
     "signal: design: 'touch' is a name of this study's designs"),
    (PRESSED, "signal: {design: touch,", "signal: {", "signal.design: missing"),
    (PRESSED, "design: touch", "design: tuch", "signal: design: 'tuch' is not a design target; known are touch"),
    (PRESSED, "hold: 1 s", "hold: 0", "0 is not a finite number > 0 [s]"),
    (PRESSED, "device: {", "# {", "signal: needs device: amplifier"),
    # parts of a factorial
    (CROSSED, "0.55, levels: 3}", "0.55}", "factors: volume_fraction: levels are missing; surrogate: method: cross"),
    (CROSSED, "outputs: [v", "fields: 8, outputs: [v", "surrogate: method: cross learns no fields"),
    (CROSSED, "slabs: 2", "slabs: 2, budget: 5", "factors: 6 cases at a place are more than dataset: budget: 5"),
    (CROSSED, "slabs: 2", "slabs: 2, peaks: true", "peaks: surrogate: method: cross learns no largest stresses"),
    (CROSSED, "method: cross", "method: kross", "surrogate.method: 'kross': input should be"),
    # measured rows
    (MEASURED, "value: 13.0", "value: -13.0", "lithium_niobate_tip.value: -13.0: input should be greater than 0"),
    (MEASURED, "unit: pC/N", "unit: nC/N", "measurements.lithium_niobate_tip.unit: 'nC/N': "),
    (MEASURED, "unit: pC/N", "units: pC/N", "measurements.lithium_niobate_tip.units: unknown key"),
    (MEASURED, "{material: LiNbO3, profile", "{profile", "lithium_niobate_tip.model.0: case: material: missing"),
    (MEASURED, "composite: AlScN, scandium_fraction: 0.1", "composite: fibrous, volume_fraction: 0.5",
     "measurements.scandium_nitride_diffraction.model.0: case: composite: 'fibrous' is not one of AlScN"),
    (MEASURED, "collector: 2, patch_size: 1.0e-5", "collector: 2",
     "measurements.aluminium_nitride_full_electrode.rivals.2: case: patch_size: missing"),
    (MEASURED, MODEL, "    model: []\n", "measurements.lithium_niobate_tip: model: 0 values; must be one"),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore::solver.face.refusal.SmallStrainWarning")
@pytest.mark.parametrize(("text", "old", "new", "words"), REFUSED, ids=[row[-1] for row in REFUSED])
def test_it_is_refused_in_one_line(text: str, old: str, new: str, words: str) -> None:
    assert words in refusal(edited(text, old, new))
