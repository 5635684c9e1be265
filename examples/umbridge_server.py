"""Serve a surrogate to any program that speaks UM-Bridge; needs `pip install umbridge`.

`python examples/umbridge_server.py results/quickstart/surrogate.nc`, and in another program
`umbridge.HTTPModel("http://localhost:4242", "surrogate")([[0.6, 0.2, 0.1, 1e4, 0.0]])`.
The server listens on every address of the machine.
"""

import sys

import numpy as np
import umbridge

import surrogate


class Served(umbridge.Model):
    """Factors to quantities, in the order of the file and in SI units."""

    def __init__(self, path: str) -> None:
        super().__init__("surrogate")
        self.model = surrogate.load(path)
        self.supports_evaluate = self.supports_apply_jacobian = lambda: True

    def get_input_sizes(self, config: dict) -> list:
        return [len(self.model.inputs_)]

    def get_output_sizes(self, config: dict) -> list:
        return [len(self.model.outputs_)]

    def __call__(self, parameters: list, config: dict) -> list:
        return self.model.predict_array(np.array(parameters)).tolist()

    def apply_jacobian(self, out_wrt: int, in_wrt: int, parameters: list, vec: list, config: dict) -> list:
        return (self.model.gradient_array(np.array(parameters))[0] @ vec).tolist()


umbridge.serve_models([Served(sys.argv[1])], 4242)
