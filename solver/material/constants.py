"""Material constants of a transversely isotropic magneto-electro-elastic solid, poled along y."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from html import escape
from typing import Any, Self
from weakref import WeakSet

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array, BoolArray, is_finite, matrix_of, unmasked
from solver.material.cuts import canonical, generalised_stiffness
from solver.material.datasheet import ENTRIES, converted, meant
from solver.material.evidence import SECTIONS, Alternative, Sourced, read_alternatives, read_sourced, with_unit
from solver.material.usual import question, questions
from solver.units import VACUUM_PERMEABILITY as VACUUM_PERMEABILITY
from solver.units import VACUUM_PERMITTIVITY as VACUUM_PERMITTIVITY
from solver.units import in_si

#: Unit of each constant, by name.
UNITS: dict[str, str] = {
    **dict.fromkeys(("c11", "c13", "c33", "c44"), "Pa"),
    **dict.fromkeys(("e31", "e33", "e15"), "C m-2"),
    **dict.fromkeys(("f31", "f33", "f15"), "N A-1 m-1"),
    **dict.fromkeys(("eps11", "eps33"), "F m-1"),
    **dict.fromkeys(("g11", "g33"), "N s V-1 C-1"),
    **dict.fromkeys(("mu11", "mu33"), "N s2 C-2"),
    "c12": "Pa",
    "rho": "kg m-3",
}

#: Unit of each constant that only crystals of the trigonal classes 3m (c14, e22) and 32 (c14, e11, e14) have.
TRIGONAL: dict[str, str] = {"c14": "Pa", **dict.fromkeys(("e11", "e14", "e22"), "C m-2")}

_ALL_UNITS = UNITS | TRIGONAL

#: Every constant, for materials that are computed from others or dimensionless.
ANY_SIZE = frozenset(_ALL_UNITS)

_MU11_HINT = (
    "published BaTiO3-CoFe2O4 tables carry mu11 = -590e-6 for CoFe2O4, a wrong sign: "
    "use mu11 = +590e-6, and composites computed from it"
)


class MaterialError(ValueError):
    """A material that is malformed, unknown or inadmissible."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Material:
    """Constants of equations (1a)-(1c) of Elloumi et al. (2014), SI units; each an array over any case axes.

    A constant may be a text with its unit, as ``"120 GPa"``. A bare number whose size no material has is refused when
    the material is used: it has probably lost its unit.

    Parameters
    ----------
    c11, c13, c33, c44
        Elastic stiffnesses [Pa] at constant electric and magnetic field.
    e31, e33, e15
        Piezoelectric constants [C/m2].
    f31, f33, f15
        Piezomagnetic constants [N/(A m)].
    eps11, eps33
        Dielectric permittivities [F/m]; vacuum by default.
    g11, g33
        Magneto-electric constants [N s/(V C)].
    mu11, mu33
        Magnetic permeabilities [N s2/C2]; vacuum by default.
    c12
        Transverse stiffness [Pa]; NaN where unknown. Only composites and out-of-plane stress need it.
    rho
        Mass density [kg/m3]; NaN where unknown. Only a moving punch needs it.
    conductor
        Whether it is a metal: one potential inside, no electric field; its permittivity has no part.
    c14, e11, e14, e22
        Constants of the trigonal classes 3m and 32, [Pa] and [C/m2]; only contacts in space take them into account.
    cut
        Orientation of the surface in the crystal, as ``"36Y"``, ``"tilt 10 deg"``, three Euler angles in degrees or
        the rows of a rotation (see ``solver/material/cuts.py``); empty: Z, the poling along the normal.
    name, source, note
        What it is, where the constants come from, what is disputed about them.
    limits
        What it bears, by the names of ``solver.names.LIMITS``; a limit that is not known is not there.
    thermal
        Constants for heat, by the names of ``solver.names.THERMAL``; one that is not known is not there, also of a
        composite whose phases lack it. All alternatives share them.
    alternatives
        Other published values of its constants, set by set: what :meth:`variants` are made of.
    any_size
        Names of constants that may have any size: those given with their unit, and all of a computed material.

    Examples
    --------
    >>> stiffness = {"c11": "126 GPa", "c12": "79.5 GPa", "c13": "84.1 GPa", "c33": "117 GPa", "c44": "23 GPa"}
    >>> coupling = {"e31": -6.5, "e33": 23.3, "e15": 17.0, "eps11": 15e-9, "eps33": 13e-9}
    >>> soft = Material(**stiffness, **coupling, name="soft")
    >>> soft.check()
    >>> soft.shape, soft.spread, soft.plain()["e33"]
    ((), {}, 23.3)
    >>> float(soft.generalised_stiffness()[2][1, 1])  # T's c33
    117000000000.0
    >>> soft.axial, soft.require_axial(), float(soft.stiffness_tensor()[2, 2, 2, 2])  # c33
    (True, None, 117000000000.0)
    """

    c11: Array
    c13: Array
    c33: Array
    c44: Array
    e31: Array = field(default_factory=lambda: np.array(0.0))
    e33: Array = field(default_factory=lambda: np.array(0.0))
    e15: Array = field(default_factory=lambda: np.array(0.0))
    f31: Array = field(default_factory=lambda: np.array(0.0))
    f33: Array = field(default_factory=lambda: np.array(0.0))
    f15: Array = field(default_factory=lambda: np.array(0.0))
    eps11: Array = field(default_factory=lambda: np.array(VACUUM_PERMITTIVITY))
    eps33: Array = field(default_factory=lambda: np.array(VACUUM_PERMITTIVITY))
    g11: Array = field(default_factory=lambda: np.array(0.0))
    g33: Array = field(default_factory=lambda: np.array(0.0))
    mu11: Array = field(default_factory=lambda: np.array(VACUUM_PERMEABILITY))
    mu33: Array = field(default_factory=lambda: np.array(VACUUM_PERMEABILITY))
    c12: Array = field(default_factory=lambda: np.array(np.nan))
    rho: Array = field(default_factory=lambda: np.array(np.nan))
    conductor: BoolArray = field(default_factory=lambda: np.array(False))
    c14: Array = field(default_factory=lambda: np.array(0.0))
    e11: Array = field(default_factory=lambda: np.array(0.0))
    e14: Array = field(default_factory=lambda: np.array(0.0))
    e22: Array = field(default_factory=lambda: np.array(0.0))
    cut: str = ""
    name: str = "material"
    source: str = ""
    note: str = ""
    limits: Mapping[str, Sourced] = field(default_factory=dict)
    thermal: Mapping[str, Sourced] = field(default_factory=dict)
    alternatives: tuple[Alternative, ...] = ()
    any_size: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        for name in _ALL_UNITS:
            value: Any = getattr(self, name)
            if isinstance(value, str):
                value = _read(self.name, name, value)
                object.__setattr__(self, "any_size", self.any_size | {name})
            object.__setattr__(self, name, np.asarray(unmasked(value), dtype=np.float64))
        object.__setattr__(self, "conductor", np.asarray(self.conductor, dtype=np.bool_))
        try:
            object.__setattr__(self, "cut", canonical(self.cut) if np.size(self.cut) > 1 or self.cut else "")
        except ValueError as error:
            raise MaterialError(f"{self.name}: {error}") from None

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, object]) -> Self:
        """Material from plain values, checked for unknown, missing and non-numeric entries and for admissibility.

        Constants by name, in SI or with their unit, ``conductor``, texts ``name``, ``source`` and ``note``, ``limits``
        and ``thermal`` (see :func:`read_sourced`) and ``alternatives`` (see :func:`read_alternatives`), each of which
        must be admissible too. Constants may also stand as data sheets print them: compliances ``s11`` ..., charge
        constants ``d31``, ``d33``, ``d15`` or coupling factors ``k31``, ``k33``, ``k15``, free permittivities
        ``eps_T33`` or ``eps_r33`` (relative), ``E`` and ``nu`` of an isotropic solid, or the matrices ``c``, ``s``,
        ``e``, ``d``, ``eps`` in the ``order`` IEEE or Abaqus.

        Raises
        ------
        MaterialError
            Naming the entry, its value and what is allowed.

        Examples
        --------
        >>> known = {"name": "mine", "c11": 2.7e11, "c13": 1.2e11, "c33": 2.7e11, "c44": 7.7e10}
        >>> mine = Material.from_mapping(known)
        >>> Material.from_mapping(mine.plain()).name
        'mine'
        >>> Material.from_mapping(known | {"c44": -1.0})
        Traceback (most recent call last):
        solver.material.constants.MaterialError: mine: c44 = -1 Pa: must be positive
        """
        known = [entry.name for entry in fields(cls) if entry.name != "any_size"]
        label = str(mapping.get("name", "material"))
        for key in mapping:
            if key not in known and key not in ENTRIES:
                raise MaterialError(f"{label}: {key}: unknown entry; {meant(str(key), (*known, *ENTRIES))}")
        try:
            mapping = converted(mapping)
        except ValueError as error:
            raise MaterialError(f"{label}: {error}") from None
        evidence: dict[str, Any] = {}
        for key, value in mapping.items():
            if key in (*SECTIONS, "alternatives"):
                try:
                    evidence[key] = (
                        read_sourced(key, value) if key in SECTIONS else read_alternatives(value, _ALL_UNITS)
                    )
                except ValueError as error:
                    raise MaterialError(f"{label}: {error}") from None
            elif key == "conductor":
                if not isinstance(value, bool):
                    raise MaterialError(f"{label}: {key}: {value!r} is not true or false")
            elif key == "cut":
                continue  # checked with the others
            elif key not in _ALL_UNITS:
                if not isinstance(value, str):
                    raise MaterialError(f"{label}: {key}: {value!r} is not a text")
            elif isinstance(value, str):
                _read(label, key, value)
            elif not is_finite(value):
                raise MaterialError(f"{label}: {key}: {value!r} is not a finite number [{_ALL_UNITS[key]}]")
        missing = [key for key in ("c11", "c13", "c33", "c44") if key not in mapping]
        if missing:
            raise MaterialError(
                f"{label}: {missing[0]}: missing; needed are c11, c13, c33, c44 [Pa], or s11, s12, s13, s33, s44 of a "
                "data sheet, or E and nu of an isotropic solid"
            )
        entries: dict[str, Any] = {**mapping, **evidence}
        material = cls(**entries)
        for variant in (material, *material.variants()):
            variant.check()
        return material

    @classmethod
    def isotropic(
        cls,
        young: ArrayLike,
        poisson: ArrayLike,
        *,
        name: str = "isotropic",
        rho: float = np.nan,
        any_size: bool = False,
    ) -> Self:
        """Isotropic elastic solid without coupling, vacuum permittivity and permeability.

        Parameters
        ----------
        young : array_like or text with its unit, Young's modulus [Pa]
        poisson : array_like, Poisson's ratio, -1 < nu < 0.5
        name : str
        rho : float, density [kg/m3]; NaN: not known
        any_size : bool, take a plain modulus that is smaller than any solid's

        Raises
        ------
        MaterialError
            Young's modulus not positive, or Poisson's ratio not within -1 to 0.5.

        Examples
        --------
        >>> steel = Material.isotropic(210e9, 0.3, name="steel")
        >>> f"{float(steel.c44):.4g}"
        '8.077e+10'
        """
        bare = not (isinstance(young, str) or any_size)
        young = _read(name, "young", young) if isinstance(young, str) else young
        E, nu = (np.asarray(unmasked(value), np.float64) for value in (young, poisson))
        if bare and (complaint := question("young", E, "Pa")):
            raise MaterialError(f"{name}: {complaint}")
        if np.any(bad := ~((nu > -1) & (nu < 0.5))):
            raise MaterialError(f"{name}: Poisson's ratio {nu[bad].flat[0]:g} is not within -1 < nu < 0.5")
        shear, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
        c11 = lame + 2 * shear
        material = cls(c11=c11, c12=lame, c13=lame, c33=c11, c44=shear, rho=np.array(rho), name=name, any_size=ANY_SIZE)
        material.check()
        return material

    @property
    def axial(self) -> bool:
        """True where contacts along a line and at a point can use it: poled along the normal, and no cut.

        Of a crystal of class 3m they use the transversely isotropic part; one of class 32 has none that couples.
        """
        return not self.cut and not (np.any(self.e11) or np.any(self.e14))

    def require_axial(self) -> None:
        """Refuse a crystal that only contacts in space can use.

        Raises
        ------
        MaterialError
            A cut, or a crystal of class 32.
        """
        if not self.axial:
            kind = f"the cut {self.cut}" if self.cut else "a crystal of class 32 (e11, e14)"
            raise MaterialError(
                f"{self.name}: {kind} is solved for contacts in space alone: profile ellipsoid, roller, map, sphere, "
                "cone or disc, on its own or as a film"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Case axes of the constants, broadcast."""
        return np.broadcast_shapes(*(getattr(self, name).shape for name in _ALL_UNITS))

    def renamed(self, name: str, source: str = "") -> Self:
        """The same constants under another name and source.

        Parameters
        ----------
        name, source : str, the new ones

        Examples
        --------
        >>> Material.isotropic(210e9, 0.3).renamed("steel").name
        'steel'
        """
        return replace(self, name=name, source=source)

    def variants(self) -> list[Self]:
        """The material with the constants of each alternative in place of its own, for which they are named.

        Designs and studies may take them by name, as ``BaTiO3 (alternative 1)``: see :func:`solver.find`.

        Examples
        --------
        >>> import solver
        >>> [variant.name for variant in solver.find("PZT-5H").variants()]
        ['PZT-5H (alternative 1)']
        """
        variants = []
        for k, alternative in enumerate(self.alternatives, 1):
            any_size = (self.any_size - alternative.constants.keys()) | alternative.any_size
            changed: dict[str, Any] = {
                **alternative.constants, "source": alternative.source, "alternatives": (), "any_size": any_size,
            }  # fmt: skip
            variants.append(replace(self, **changed, name=f"{self.name} (alternative {k})"))
        return variants

    @property
    def spread(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of every constant on which its own values and the alternatives differ.

        The alternatives hold as sets: a mixture of their constants need not be admissible.
        """
        materials = (self, *self.variants())
        values = {name: [float(getattr(material, name)) for material in materials] for name in _ALL_UNITS}
        return {name: (min(known), max(known)) for name, known in values.items() if min(known) < max(known)}

    def plain(self) -> dict[str, Any]:
        """The mapping that :meth:`from_mapping` reads back to the last bit, of a material without case axes."""
        constants = {name: float(getattr(self, name)) for name in _ALL_UNITS if name in UNITS or getattr(self, name)}
        return {
            **with_unit({name: value for name, value in constants.items() if not np.isnan(value)}, _ALL_UNITS),
            **({"cut": self.cut} if self.cut else {}),
            **({"conductor": True} if self.conductor else {}),  # others are as they were before there were any
            **{name: getattr(self, name) for name in ("name", "source", "note")},
            "limits": {name: limit.plain(name) for name, limit in self.limits.items()},
            **({"thermal": thermal} if (thermal := {k: v.plain(k) for k, v in self.thermal.items()}) else {}),
            "alternatives": [
                {**with_unit(alternative.constants, _ALL_UNITS), "source": alternative.source}
                for alternative in self.alternatives
            ],
        }

    def _repr_html_(self) -> str:
        """Table for a notebook: every nonzero constant, as a range if there are cases, and its source."""
        import pandas as pd  # slow to import, and notebooks only

        constants = {name: getattr(self, name) for name in _ALL_UNITS}
        rows = [
            (name, " to ".join(f"{end:.6g}" for end in np.unique([value.min(), value.max()])), _ALL_UNITS[name])
            for name, value in constants.items()
            if np.any(value) and not np.all(np.isnan(value))
        ]
        table = pd.DataFrame(rows, columns=["constant", "value", "unit"]).to_html(index=False, border=0)
        return f"<p><b>{escape(self.name)}</b> {escape(self.source)}</p>{table}"

    def generalised_stiffness(self) -> tuple[Array, Array, Array]:
        """Q, R and T of the Stroh formalism (theory section 2), each (..., 4, 4), rows (u_x, u_y, phi, psi), SI."""
        self.require_axial()
        zero = np.zeros(())
        Q = matrix_of([
            [self.c11, zero, zero, zero],
            [zero, self.c44, self.e15, self.f15],
            [zero, self.e15, -self.eps11, -self.g11],
            [zero, self.f15, -self.g11, -self.mu11],
        ])  # fmt: skip
        R = matrix_of([
            [zero, self.c13, self.e31, self.f31],
            [self.c44, zero, zero, zero],
            [self.e15, zero, zero, zero],
            [self.f15, zero, zero, zero],
        ])  # fmt: skip
        T = matrix_of([
            [self.c44, zero, zero, zero],
            [zero, self.c33, self.e33, self.f33],
            [zero, self.e33, -self.eps33, -self.g33],
            [zero, self.f33, -self.g33, -self.mu33],
        ])  # fmt: skip
        return Q, R, T

    def stiffness_tensor(self, cut: str = "") -> Array:
        """Generalised stiffness of contacts in space, in the axes of the surface (x, y, normal), SI.

        Parameters
        ----------
        cut : str, of a material that has none itself

        Returns
        -------
        ndarray
            E[i, J, K, l] of T_iJ = E_iJKl dU_K/dx_l with U = (u, phi, psi) and T = (sigma, D, B); (3, 5, 5, 3).

        Raises
        ------
        MaterialError
            Constants over case axes, no c12, two cuts, or a cut that is unknown.

        Examples
        --------
        >>> import solver
        >>> solver.find("36Y LiNbO3").stiffness_tensor().shape
        (3, 5, 5, 3)
        """
        if self.shape:
            raise MaterialError(f"{self.name}: constants over cases; a contact in space takes one material")
        if np.isnan(self.c12):
            raise MaterialError(f"{self.name}: c12: missing; contacts in space need it [Pa]")
        if cut and self.cut:
            raise MaterialError(f"{self.name}: cut: {cut!r} beside the cut of the material, {self.cut}")
        constants = {name: float(getattr(self, name)) for name in _ALL_UNITS}
        try:
            return generalised_stiffness(constants, cut or self.cut)
        except ValueError as error:
            raise MaterialError(f"{self.name}: {error}") from None

    @np.errstate(all="ignore")  # products beyond double precision compare as infinite
    def check(self) -> None:
        """Refuse an inadmissible material (theory section 7): an energy that is not positive definite.

        Raises
        ------
        MaterialError
            Naming the first constant at fault, its value, the condition and the likely fix.
        """
        if self in _ADMISSIBLE:
            return
        for name in _ALL_UNITS:
            value = getattr(self, name)
            if not np.all(np.isfinite(value)) and name not in ("c12", "rho"):
                raise MaterialError(f"{self.name}: {name}: not a finite number [{_ALL_UNITS[name]}]")
        for name in ("c11", "c33", "c44", "eps11", "eps33", "mu11", "mu33"):
            hint = f"; {_MU11_HINT}" if name == "mu11" else ""
            self._require(getattr(self, name) > 0, name, f"must be positive{hint}")
        if not np.any(np.isnan(self.rho)):
            self._require(self.rho > 0, "rho", "must be positive")
        known = {name: value for name in _ALL_UNITS if not np.all(np.isnan(value := getattr(self, name)))}
        for complaint in questions(known, _ALL_UNITS, [name for name in known if name not in self.any_size]).values():
            raise MaterialError(f"{self.name}: {complaint}")
        self._require(self.c13**2 < self.c11 * self.c33, "c13", "needs c13^2 < c11 c33 (positive definite stiffness)")
        if not np.any(np.isnan(self.c12)):
            self._require(abs(self.c12) < self.c11, "c12", "needs |c12| < c11 (positive definite stiffness)")
            in_plane = 2 * self.c13**2 < (self.c11 + self.c12) * self.c33
            self._require(in_plane, "c13", "needs 2 c13^2 < (c11 + c12) c33 (positive definite stiffness)")
        if np.any(self.c14):
            shear = self.c14**2 < self.c44 * (self.c11 - self.c12) / 2
            self._require(shear, "c14", "needs c14^2 < c44 (c11 - c12)/2 (positive definite stiffness), and c12")
        for axis in ("11", "33"):
            eps, g, mu = (getattr(self, name + axis) for name in ("eps", "g", "mu"))
            rule = f"needs g{axis}^2 < eps{axis} mu{axis} (positive definite [[eps, g], [g, mu]])"
            self._require(g**2 < eps * mu, f"g{axis}", rule)
        if np.any(self.conductor):
            for name in ("e31", "e33", "e15", "e11", "e14", "e22", "g11", "g33"):
                self._require(~self.conductor | (getattr(self, name) == 0), name, "must be 0 in a conductor")
        _ADMISSIBLE.add(self)

    def _require(self, holds: BoolArray, constant: str, rule: str) -> None:
        """Refuse the material, with the first offending value, unless a condition holds in every case."""
        if not np.all(holds):
            value = np.broadcast_to(getattr(self, constant), np.shape(holds))[np.logical_not(holds)].flat[0]
            raise MaterialError(f"{self.name}: {constant} = {value:g} {_ALL_UNITS[constant]}: {rule}")


def _read(label: str, constant: str, text: str) -> float:
    """Return a constant with its unit, or Young's modulus, in SI."""
    try:
        return in_si(text, _ALL_UNITS.get(constant, "Pa"))
    except ValueError as error:
        raise MaterialError(f"{label}: {constant}: {error}") from None


#: Materials that :meth:`Material.check` has found admissible.
_ADMISSIBLE: WeakSet[Material] = WeakSet()


def combined(change: Callable[..., Array], materials: Iterable[Material], name: str) -> Material:
    """Return a material with ``change`` of each constant of the given materials, without limits and alternatives."""
    originals = tuple(materials)
    for material in originals:
        material.require_axial()
    constants: dict[str, Any] = {
        c: change(*(getattr(material, c) for material in originals)) for c in (*UNITS, "conductor")
    }
    return Material(**constants, name=name, any_size=ANY_SIZE)
