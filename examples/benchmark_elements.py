"""A disc on a bonded elastic layer by scikit-fem, for `meecontact benchmark`: twice the energy at a depth of 1 m."""

from typing import Any

import numpy as np
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, MeshQuad, condense, solve

A = H = 1e-3  # radius of the disc, thickness of the layer
SHEAR, LAME = 210e9 / 2.6, 210e9 * 0.3 / (1.3 * 0.4)  # E = 210 GPa, nu = 0.3


def strains(u: Any, r: Any) -> tuple[Any, Any, Any, Any]:
    """Radial, hoop, axial and shear strain."""
    return u.grad[0, 0], u[0] / r, u.grad[1, 1], u.grad[0, 1] + u.grad[1, 0]


@BilinearForm
def energy(u: Any, v: Any, w: Any) -> Any:
    """Work of the stresses of u on the strains of v, over a ring's circumference."""
    (*axial, shear), (*virtual, turned) = strains(u, w.x[0]), strains(v, w.x[0])
    work = 2 * SHEAR * sum(a * b for a, b in zip(axial, virtual, strict=True)) + SHEAR * shear * turned
    return 2 * np.pi * w.x[0] * (LAME * sum(axial) * sum(virtual) + work)


small = np.geomspace(1e-4, 1, 14)  # distances from the disc's edge and from the surface
r = np.unique([0, *A * (1 - small), A, *A * (1 + small), *np.linspace(2 * A, 12 * A, 16)])
basis = Basis(MeshQuad.init_tensor(r, np.unique([0, *-H * small])), ElementVector(ElementQuad2()), intorder=5)
matrix, near = energy.assemble(basis), 1e-9 * A
fixed = basis.get_dofs(lambda x: (x[1] < near - H) | (x[0] > 12 * A - near)).all()
axis = basis.get_dofs(lambda x: x[0] < near).all(["u^1"])
disc = basis.get_dofs(lambda x: (x[1] > -near) & (x[0] < A + near)).all(["u^2"])
u = basis.zeros()
u[disc] = -1.0
u = solve(*condense(matrix, x=u, D=np.unique([*fixed, *axis, *disc])))
print(f"problem,quantity,value\ndisc-layer,contact_stiffness,{u @ (matrix @ u):.4e}")
