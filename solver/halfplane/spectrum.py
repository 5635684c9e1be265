"""Functions of the Stroh roots without eigenvectors of coalescing roots: nodes and matrix weights.

Fields inside the half-plane are functions of ``Pi = B diag(p) B^-1``, p the upper roots (Ting, Anisotropic Elasticity,
1996, section 5.5), f analytic for Im p > 0 and y <= 0:

    f(x + y Pi) = sum_j W_j f(x + y p_j).

An isolated root is a node with its spectral projector W_j. Roots that nearly coincide share a contour: the trapezoid
rule on a circle in the disk (p - c)/(p - conj c), whose error falls geometrically with the number of nodes.
"""

import numpy as np

from solver.arrays import Array, BoolArray, ComplexArray, column
from solver.halfplane.surface import HalfPlane

_ISOLATED = 0.05  # distance |p - p'|/|p - conj p'| from which a root's eigenvector loses at most two digits
_SMALLEST = 0.1  # radius of a contour in the disk: the resolvent of a fourfold root grows as its fourth power
_ERROR = 1e-15


def spectrum(halfplane: HalfPlane) -> tuple[ComplexArray, ComplexArray]:
    """Nodes p_j (..., node) and weights W_j (..., node, 4, 4), scaled as the Stroh matrix is."""
    N = halfplane.stroh_matrix
    Pi = N[..., 4:, :4] @ halfplane.surface_impedance + N[..., 4:, 4:]
    roots, right = np.linalg.eig(Pi)
    mirrored, left = np.linalg.eig(Pi.mT)
    order = np.argmin(np.abs(roots[..., :, None] - mirrored[..., None, :]), -1)
    left = np.take_along_axis(left, order[..., None, :], -1)
    isolated = _isolated(roots)

    size = np.einsum("...ik,...ik->...k", left, right)
    outer = right[..., :, None, :] * left[..., None, :, :] / np.where(isolated, size, 1.0)[..., None, None, :]
    projectors = np.where(isolated[..., None, None], np.moveaxis(outer, -1, -3), 0.0)
    if np.all(isolated):
        return roots, projectors
    close = ~np.all(isolated, -1)
    remainder = np.where(column(close), np.eye(4) - projectors.sum(-3), 0.0)
    nodes, factors = _contour(roots, ~isolated)
    resolvent = np.linalg.inv(nodes[..., None, None] * np.eye(4) - Pi[..., None, :, :])
    shared = factors[..., None, None] * (resolvent @ remainder[..., None, :, :])
    return np.concatenate([roots, nodes], -1), np.concatenate([projectors, shared], -3)


def _isolated(roots: ComplexArray) -> BoolArray:
    """Return True for roots that are far from all others; (..., 4)."""
    p, q = roots[..., :, None], roots[..., None, :]
    distance = np.abs((p - q) / (p - np.conj(q))) + np.eye(4)
    return np.asarray(np.min(distance, -1) >= _ISOLATED)


def _contour(roots: ComplexArray, members: BoolArray) -> tuple[ComplexArray, ComplexArray]:
    """Nodes around the member roots, and factors of the resolvent at these; (..., node) each."""
    count = np.maximum(members.sum(-1, keepdims=True), 1)
    mean = np.sum(np.where(members, roots, 0), -1, keepdims=True) / count
    centre = np.where(members.any(-1, keepdims=True), mean, 1j)
    spread = np.abs((roots - centre) / (roots - np.conj(centre)))
    radius = np.sqrt(np.maximum(np.max(np.where(members, spread, 0.0), -1, keepdims=True), _SMALLEST**2))
    nodes = int(np.ceil(np.log(_ERROR) / np.log(float(np.max(radius)))))
    q: Array = np.exp(2j * np.pi * (np.arange(nodes) + 0.5) / nodes)
    disk = radius * q
    p = (centre - np.conj(centre) * disk) / (1 - disk)
    return p, disk * (centre - np.conj(centre)) / (1 - disk) ** 2 / nodes
