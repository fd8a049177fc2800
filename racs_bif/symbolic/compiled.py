"""A compiled model: numbers in, numbers out, and what people need to know of it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from racs_bif.errors import ModelError
from racs_bif.symbolic import cache
from racs_bif.symbolic.generate import Sources, generate
from racs_bif.symbolic.jets import Algebra, Coefficients, JetFunctions
from racs_bif.symbolic.kernels import Functions, Kernel, build
from racs_bif.symbolic.metadata import facts
from racs_bif.symbolic.model import Calibration, Model, Parameter

if TYPE_CHECKING:
    import sympy as sp
    from numpy.typing import ArrayLike

    from racs_bif.symbolic.external import External
    from racs_bif.symbolic.field import Array, Vectors


@dataclass(frozen=True)
class DerivedInfo:
    """A derived parameter, its expression as text (see `DerivedParameter`)."""

    name: str
    expression: str
    sets: str
    unit: str
    description: str
    source: str
    valid: tuple[float, float]


class CompiledModel:
    """The core of a model, compiled.

    ``X = (y, zeta)`` (n + ne,) holds the model's states and the memory of its elements,
    ``P = (p, D)`` (np + ne,) the base parameters and the direct feedthroughs; see
    `racs_bif.symbolic.generate`.

    Parameters
    ----------
    sources : Sources
        Texts of the compiled modules.
    external : External, optional
        The Python function that they call, if they call any.
    """

    def __init__(self, sources: Sources, external: External | None = None) -> None:
        self.sources = sources
        self.external = external
        self.meta, self._scalar, self._array = build(sources.main, "model", external)
        meta = self.meta
        self.name: str = meta["name"]
        self.states: tuple[str, ...] = tuple(meta["states"])
        self.elements: tuple[str, ...] = tuple(e["output"] for e in meta["elements"])
        self.feedthrough: tuple[bool, ...] = tuple(meta["feedthrough"])
        self.parameters: tuple[Parameter, ...] = tuple(map(_parameter, meta["parameters"]))
        self.derived: tuple[DerivedInfo, ...] = tuple(
            DerivedInfo(**{**d, "valid": _interval(d["valid"])}) for d in meta["derived"]
        )
        self.outputs: tuple[str, ...] = tuple(meta["outputs"])
        self._kernels: dict[str, Kernel] = {}
        self._forms: tuple[Functions, Functions] | None = None
        self._jets: JetFunctions | None = None
        size = len(self.states) + len(self.elements)
        self.size = size
        self._fixed_at = _places(meta["fixed"])
        self.varying_at = _places(meta["varying"])
        self._columns: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        self._base_key: bytes | None = None
        self._base_jacobian = np.zeros((size, size))

    @property
    def digest(self) -> str:
        """Digest of the compiled texts: equal digests, equal equations."""
        text = self.sources.main + self.sources.forms
        return hashlib.sha256(text.encode()).hexdigest()

    def __reduce__(self) -> tuple[type[CompiledModel], tuple[Sources, External | None]]:
        """Pickle the texts; the code is built again where they arrive."""
        return (CompiledModel, (self.sources, self.external))

    def kernel(self, name: str) -> Kernel:
        """Return a compiled function by name."""
        found = self._kernels.get(name)
        if found is None:
            scalar, array = self._scalar, self._array
            if name not in scalar:
                if self._forms is None:
                    _, *forms = build(self.sources.forms, "forms", self.external)
                    self._forms = (forms[0], forms[1])
                scalar, array = self._forms
            found = self._kernels[name] = Kernel(name, scalar, array)
        return found

    def core(self, x: Array, p: Array) -> Array:
        """Return ``(y', e)``, shaped like `x` (size,) or (size, N)."""
        return self.kernel("core")(p, x)

    def core_jacobian(self, x: Array, p: Array) -> Array:
        """Return the derivative of `core` by `x`, (size, size) or (N, size, size)."""
        base = self.fixed_jacobian(p)
        rows, columns = self.varying_at
        values = self.varying_jacobian(x, p)
        if x.ndim == 1:
            jacobian = base.copy()
            jacobian[rows, columns] = values
            return jacobian
        many = np.broadcast_to(base, (x.shape[1], *base.shape)).copy()
        many[:, rows, columns] = values.T
        return many

    def core_jacobian_sparse(self, x: Array, p: Array) -> Any:  # noqa: ANN401 - scipy has no types
        """Return `core_jacobian` at one point as a scipy.sparse.csc_array."""
        from scipy.sparse import csc_array

        if self._columns is None:
            places = zip(self._fixed_at, self.varying_at, strict=True)
            rows, columns = (np.concatenate(pair) for pair in places)
            order = np.lexsort((rows, columns))
            starts = np.searchsorted(columns[order], np.arange(self.size + 1))
            self._columns = order, rows[order], starts
        order, rows, starts = self._columns
        values = np.concatenate((self.kernel("jacobian_fixed")(p), self.varying_jacobian(x, p)))
        return csc_array((values[order], rows.copy(), starts.copy()), shape=(self.size, self.size))

    def fixed_jacobian(self, p: Array) -> Array:
        """Return the entries of the core's Jacobian that do not depend on the state."""
        key = p.tobytes()
        if key != self._base_key:
            rows, columns = self._fixed_at
            self._base_jacobian = np.zeros((self.size, self.size))
            self._base_jacobian[rows, columns] = self.kernel("jacobian_fixed")(p)
            self._base_key = key
        return self._base_jacobian

    def varying_jacobian(self, x: Array, p: Array) -> Array:
        """Return the entries at `varying_at`, (k,) or (k, N)."""
        return self.kernel("jacobian_varying")(p, x)

    def core_p(self, x: Array, p: Array, dp: Array) -> Array:
        """Return the derivative of `core` in the direction `dp` (np + ne,) of P."""
        return self.kernel("core_p")(p, x, dp)

    def core_xx(self, x: Array, p: Array, u: Vectors, v: Vectors) -> Vectors:
        """Return the second derivative form of `core` at one point."""
        return self.kernel("core_xx")(p, x, u, v)

    def core_xxx(self, x: Array, p: Array, u: Vectors, v: Vectors, w: Vectors) -> Vectors:
        """Return the third derivative form of `core` at one point."""
        return self.kernel("core_xxx")(p, x, u, v, w)

    def core_xp(self, x: Array, p: Array, u: Vectors, dp: Array) -> Vectors:
        """Return the derivative of (core_x u) in the direction `dp` of P at one point."""
        return self.kernel("core_xp")(p, x, u, dp)

    def expand(self, name: str, algebra: Algebra, *groups: Coefficients) -> Coefficients:
        """Return Taylor coefficients of a function of the main module, of any order.

        Parameters
        ----------
        name : str
            Function, such as ``core``.
        algebra : Algebra
            The monomials of the expansion.
        *groups : arrays (k,) or (k, len(algebra))
            Arguments, P first: constants or coefficients.

        Returns
        -------
        array (outputs, len(algebra))

        Raises
        ------
        ConvergenceError
            If the function is not smooth here.
        """
        if self._jets is None:
            self._jets = JetFunctions(self.sources.main, self.external)
        return self._jets(name, algebra, *groups)

    @property
    def has_inertia(self) -> bool:
        """Whether there is a mass matrix that states or parameters may make singular."""
        return bool(self.meta["inertia"])

    def inertia(self, x: Array, p: Array) -> Array:
        """Return the determinant of the mass matrix but for a constant factor, () or (N,).

        Where it changes its sign an eigenvalue passes through infinity. Only of models that
        `has_inertia`.
        """
        return np.asarray(self.kernel("inertia")(p, x)[0])

    def forces(self, x: Array, p: Array) -> Array:
        """Return what the mass matrix is to be divided by, and `inertia`, (n + 1,) or (n + 1, N).

        These are finite where the mass matrix is singular. Only of models that `has_inertia`.
        """
        return self.kernel("forces")(p, x)

    def forces_d(self, x: Array, p: Array, dx: Vectors, dp: Vectors) -> Vectors:
        """Return the derivative of `forces` along (dx, dp)."""
        return self.kernel("forces_d")(p, x, dx, dp)

    def output_values(self, x: Array, p: Array) -> dict[str, Array]:
        """Return the model's outputs by name."""
        return dict(zip(self.outputs, self.kernel("outputs")(p, x), strict=True))

    def derived_values(self, p: Array) -> Array:
        """Return the derived parameters at base parameters p (np,)."""
        return self.kernel("derived")(self.padded(p))

    def inverse(self, k: int, p: Array, value: float) -> float:
        """Return the base parameter that derived parameter k sets, where it shall be `value`."""
        return float(self.kernel(f"inverse{k}")(self.padded(p), np.array([value]))[0])

    def inverse_slope(self, k: int, p: Array, value: float, dp: Array, slope: float) -> float:
        """Return the derivative of `inverse` along (dp, slope)."""
        kernel = self.kernel(f"inverse{k}_p")
        arguments = np.array([value]), self.padded(dp), np.array([slope])
        return float(kernel(self.padded(p), *arguments)[0])

    def padded(self, p: ArrayLike) -> Array:
        """Return (p, D) with no feedthrough."""
        p = np.asarray(p, dtype=float)
        return np.concatenate([p, np.zeros((len(self.elements), *p.shape[1:]))])


def compile_model(model: Model) -> CompiledModel:
    """Compile a symbolic model, or take it from the cache under the key of its equations.

    Raises
    ------
    ModelError
        If the model cannot be compiled; see `racs_bif.symbolic.generate.generate`.
    """
    try:
        return CompiledModel(_sources(model), model.external)
    except RecursionError:
        msg = f"model '{model.name}': an expression is nested too deeply; split it"
        raise ModelError(msg) from None


def _sources(model: Model) -> Sources:
    """Return the compiled texts of a model, from the cache if they are there."""
    expressions = [*model.equations.values(), *model.outputs.values(), *model.terms.values()]
    expressions += [part for e in model.elements for part in (e.input, e.law)]
    expressions += [d.expression for d in model.derived]
    expressions += list(model.mass) if model.mass is not None else []
    told = repr((facts(model), list(model.outputs), list(model.terms)))
    key = cache.key("model", told, *map(_spelled, expressions))
    sources = read_sources(key)
    if sources is None:
        sources = generate(model)
        write_sources(key, sources)
    return sources


def _spelled(expression: sp.Basic) -> str:
    """Return a text that says exactly what an expression is; quicker than sympy's own."""
    import sympy as sp

    if not expression.args:
        return str(sp.srepr(expression))
    return f"{type(expression).__name__}({','.join(map(_spelled, expression.args))})"


def read_sources(key: str) -> Sources | None:
    """Return the texts stored under a key, None unless both are whole."""
    main, forms = cache.read(f"{key}-main.py"), cache.read(f"{key}-forms.py")
    return None if main is None or forms is None else Sources(main, forms)


def write_sources(key: str, sources: Sources) -> None:
    """Store both texts under a key."""
    cache.write(f"{key}-main.py", sources.main)
    cache.write(f"{key}-forms.py", sources.forms)


def _places(entries: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
    table = np.array(entries, dtype=int).reshape(-1, 2)
    return table[:, 0], table[:, 1]


def _interval(bounds: list[float | None]) -> tuple[float, float]:
    low, high = bounds
    return (-math.inf if low is None else low, math.inf if high is None else high)


def _parameter(entry: dict[str, Any]) -> Parameter:
    default = entry["default"]
    if isinstance(default, dict):
        default = Calibration(**{**default, "span": tuple(default["span"])})
    return Parameter(**{**entry, "default": default, "valid": _interval(entry["valid"])})
