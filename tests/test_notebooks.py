"""Materials and surrogates are short in a notebook, and no name can do anything to the page."""

from xml.etree import ElementTree

import numpy as np
import xarray as xr

import solver
import surrogate

HOSTILE = "<script>alert(1)</script> & co"


def table(page: str) -> list[list[str]]:
    """Rows of the tables of a well-formed piece of a page."""
    root = ElementTree.fromstring(f"<div>{page}</div>")
    assert {part.tag for part in root.iter()} <= {"div", "p", "b", "table", "thead", "tbody", "tr", "th", "td"}
    return [["".join(cell.itertext()) for cell in row] for row in root.iter("tr")]


def test_a_material_shows_its_constants() -> None:
    rows = table(solver.find("PZT-4")._repr_html_())
    assert ["e33", "15.1", "C m-2"] in rows
    several = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), np.array([[0.0], [1.0]]))
    assert ["c33", "1.62e+11 to 2.695e+11", "Pa"] in table(several._repr_html_())
    assert HOSTILE in "".join(ElementTree.fromstring(f"<div>{several.renamed(HOSTILE)._repr_html_()}</div>").itertext())


def test_a_surrogate_shows_its_box_and_its_calibration() -> None:
    x = surrogate.Input("x", 0.0, 2.0, units="m/s<")
    levels = x.levels(6)
    model = surrogate.GridGP(inputs=[x]).fit(xr.Dataset({HOSTILE: ("x", np.exp(levels))}, coords={"x": levels}))
    assert ["x", "0.0", "2.0", "m/s<", "linear"] in table(model._repr_html_())
    points = np.linspace(0, 2, 60)
    model.calibrate(xr.Dataset({"x": ("case", points), HOSTILE: ("case", np.exp(points))}))
    assert "intervals calibrated on 60 cases" in model._repr_html_()
