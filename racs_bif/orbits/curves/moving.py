"""From point to point along a curve of cycles: another reference, another mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from racs_bif.orbits.curves.layout import TAIL
from racs_bif.orbits.curves.references import CycleReference
from racs_bif.orbits.piecewise import Piecewise, equidistant
from racs_bif.orbits.polishing import direction, polished

if TYPE_CHECKING:
    from racs_bif.orbits.curves.problem import CycleCurve
    from racs_bif.orbits.mesh import Mesh
    from racs_bif.symbolic.field import Array


def begin(problem: CycleCurve, z: Array) -> Array:
    """Return a first point, near a solution, with its eigenfunctions in phase and of length 1."""
    before = problem.references[z[-3]]
    functions, factor = _normalised(problem, z, before.scales)
    known = _orthonormal(problem, z, functions, before.scales)
    return _in_terms(problem, z, replace(before, functions=known), functions, factor)


def refer(problem: CycleCurve, z: Array) -> Array:
    """Take a solution as the reference of the next points; return it in its terms."""
    before = problem.references[z[-3]]
    scales = np.maximum(before.scales, problem.curve(z).ranges())
    functions, factor = _normalised(problem, z, scales)
    dual = problem.twisted(z).dual
    turned = before.dual is not None and float(np.sum(dual * before.dual)) < 0.0
    entry = CycleReference(
        curve=Piecewise(problem.reference(z).mesh, problem.nodes(z).copy()),
        scales=scales,
        functions=_orthonormal(problem, z, functions, scales),
        directions=_directions(problem, z),
        dual=(-dual if turned else dual) / np.linalg.norm(dual),
    )
    return _in_terms(problem, z, entry, functions, factor)


def on_mesh(problem: CycleCurve, z: Array, mesh: Mesh, tangent: Array) -> tuple[Array, Array]:
    """Solve for the same cycle on another mesh.

    Parameters
    ----------
    problem : CycleCurve
        The equations.
    z, tangent : array
        The point and the direction of the curve.
    mesh : Mesh
        The other mesh.

    Returns
    -------
    tuple of array
        The solution and the direction on the other mesh.

    Raises
    ------
    ConvergenceError, numpy.linalg.LinAlgError
        If it is not found there.
    """
    layout, variation = problem.layout, problem.variation(z)
    old, times = problem.reference(z).mesh, equidistant(mesh, problem.settings.degree)

    def moved(vector: Array, further: Array | None) -> Array:
        ends = variation.closed(layout.functions(vector), further)[:, -1, -1]
        pairs = zip(layout.functions(vector), ends, strict=True)
        functions = np.stack([Piecewise(old, one, end)(times) for one, end in pairs])
        orbit = Piecewise(old, layout.orbit(vector))(times)
        return layout.join(orbit, functions, layout.further_of(vector), vector[-TAIL:])

    found, row = moved(z, None), moved(tangent, layout.further_of(tangent))
    entry = problem.references[z[-3]]
    shape = problem.nodes(z).shape
    directions = [
        np.append(Piecewise(old, one[:-3].reshape(shape))(times), one[-3:])
        for one in entry.directions
    ]
    functions = layout.functions(found)
    first = replace(
        entry,
        curve=Piecewise(mesh, layout.orbit(found).copy()),
        functions=np.zeros_like(functions),
        directions=np.stack(directions),
    )
    found[-3] = problem.references.add(first)
    known = _orthonormal(problem, found, functions, entry.scales)
    found[-3] = problem.references.add(replace(first, functions=known))
    row[-3] = 0.0
    found = polished(problem, found, row)
    return found, direction(problem, found, row)


def _in_terms(
    problem: CycleCurve, z: Array, entry: CycleReference, functions: Array, factor: float
) -> Array:
    followed = np.array(z)
    followed[-3] = problem.references.add(entry)
    problem.layout.functions(followed)[:] = functions
    further = problem.layout.further_of(followed)
    further[:] = problem.kind.rescaled(further.copy(), factor)
    return followed


def _quadrature(problem: CycleCurve, z: Array) -> Array:
    """Return the weights (N, m, 1) of an integral over the period."""
    mesh = problem.reference(z).mesh
    return np.asarray(mesh.widths[:, None, None] * problem.gauss.weights[:, None])


def _normalised(problem: CycleCurve, z: Array, scales: Array) -> tuple[Array, float]:
    """Return the eigenfunctions in phase with the orbit and of length 1, and the factor."""
    at, nodes, variation = problem.at(z), problem.nodes(z), problem.variation(z)
    quadrature, functions = _quadrature(problem, z), problem.layout.functions(z)
    velocities = problem.equations.rates(nodes.reshape(-1, nodes.shape[-1]), problem.active(z))
    weights = quadrature * at.rates / scales**2
    flow = velocities.reshape(nodes.shape), weights / np.sum(weights * at.rates)
    functions = problem.kind.settled(functions, variation.stages(functions), flow)
    stages = variation.stages(functions) / scales
    factor = 1.0 / float(np.sqrt(np.sum(quadrature * stages[0] ** 2)))
    return functions * factor, factor


def _orthonormal(problem: CycleCurve, z: Array, functions: Array, scales: Array) -> Array:
    """Return eigenfunctions (k, N, m, n) at the Gauss points over the scales, orthonormal."""
    stages = problem.variation(z).stages(functions) / scales
    roots = np.sqrt(_quadrature(problem, z))
    q, r = np.linalg.qr((stages * roots).reshape(len(stages), -1).T)
    signs = np.where(np.diagonal(r) < 0.0, -1.0, 1.0)
    return np.asarray((q * signs).T.reshape(stages.shape) / roots)


def _directions(problem: CycleCurve, z: Array) -> Array:
    """Return two orthonormal directions (2, N m n + 3) in which the orbit's equations hold."""
    found = problem.solutions(z, np.zeros((0, *problem.nodes(z).shape)), np.zeros(0))
    spread = problem.spread(z)
    return np.asarray(np.linalg.qr((found / spread).T)[0].T * spread)
