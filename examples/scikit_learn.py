"""The surrogate in scikit-learn: a pipeline with a regressor that sees that its cases are a factorial."""

import numpy as np
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer

import solver
import surrogate

columns = ["volume_fraction", "radius", "load"]
levels = {
    "volume_fraction": surrogate.chebyshev_levels(0.2, 0.8, 12),
    "radius": surrogate.chebyshev_levels(0.02, 0.2, 6, "log"),
    "load": surrogate.chebyshev_levels(5e3, 5e4, 6, "log"),
}
table = solver.solve(levels | {"friction": 0.2})["voltage"].to_dataframe().reset_index()
table = table.sample(frac=1, random_state=0)  # a factorial in any order

regressor = surrogate.FactorialRegressor()
pipeline = make_pipeline(FunctionTransformer(lambda X: X.assign(volume_fraction=100 * X.volume_fraction)), regressor)
pipeline.fit(table[columns], table["voltage"])

fresh = {"volume_fraction": np.linspace(0.25, 0.75, 11), "radius": [0.03, 0.1], "load": [7e3, 3e4], "friction": 0.2}
exact = solver.solve(fresh)["voltage"].to_dataframe().reset_index()
error = abs(pipeline.predict(exact[columns]) - exact["voltage"]).max() / np.ptp(table["voltage"])
print(f"{type(regressor.model_).__name__}, {len(table)} cases: largest error {error:.1e} of range")
