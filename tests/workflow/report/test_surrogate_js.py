"""The surrogate in the browser says what it says in Python, with its groups too."""

import json
from pathlib import Path

import numpy as np

from surrogate import GroupedGP, Input
from surrogate.use.export import exported
from tests.surrogate.grouped import GROUPING, INPUTS, cases, factorial
from tests.workflow.report.browser import evaluated, needs_browser
from workflow.report.page import TEMPLATES


@needs_browser
def test_the_browser_says_the_same_of_groups(tmp_path: Path) -> None:
    model = GroupedGP(GROUPING).fit(factorial(0.2)).calibrate(cases(400, 1, 0.2))
    t = np.random.default_rng(2).uniform(-1, 1, (40, len(INPUTS)))
    t[0], t[1] = 1.0, -1.0
    X = np.stack([one.from_unit(row) for one, row in zip(INPUTS, t.T, strict=True)], axis=1)
    mean, std = model.predict_array(X, return_std=True)
    lower, upper = model.interval_array(X)
    share = Input("share", 0.02, 0.9, "logit")
    script = (TEMPLATES / "surrogate.js").read_text(encoding="utf-8")
    plain = json.dumps({"name": "share", "low": 0.02, "high": 0.9, "scale": "logit"})
    script += f"const model = loadSurrogate({json.dumps(exported(model))}), points = {json.dumps(t.tolist())};"
    script += "const told = points.map((t) => predict(model, t)).map((one) => ['mean', 'std', 'lower', 'upper'].map("
    script += f"(part) => [...one[part]])); const shares = points.map((t) => fromUnit({plain}, t[0]));"
    told, shares = evaluated(script, "[told, shares]", tmp_path)
    for part, expected in zip(np.array(told).transpose(1, 0, 2), (mean, std, lower, upper), strict=True):
        np.testing.assert_allclose(part, expected, rtol=1e-9, atol=1e-9 * float(np.abs(std).min()))
    np.testing.assert_allclose(shares, share.from_unit(t[:, 0]), rtol=1e-13)
