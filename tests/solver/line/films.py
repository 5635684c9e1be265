"""Materials that the tests of films share."""

import solver

BTO, CFO, STEEL, SILICON = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "steel", "silicon"))
FIBROUS = solver.fibrous(BTO, CFO, 0.5)
