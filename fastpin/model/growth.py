"""Laws of crack growth: the rate da/dN from the largest and the smallest stress intensity of a cycle.

No constants of materials are given here: they come with their source from the user. In case files a law is a table
with the key ``law`` and its constants, see :data:`LAWS`.

Sources: Paris and Erdogan, J. Basic Eng. 85 (1963) 528; Walker, ASTM STP 462 (1970) 1; Smith, Watson and Topper, J.
Materials 5 (1970) 767; El Haddad, Smith and Topper, J. Eng. Mater. Technol. 101 (1979) 42; Newman, Int. J. Fract. 24
(1984) R131, for the closure of the NASGRO equation; Forman and Mettu, ASTM STP 1131 (1992) 519.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, check_fields, in_one_shape, not_negative, number, numbers, positive, string

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

SMOOTH_EDGE = 1.1215222
"""K of a short crack at a smooth edge, in units of the stress times sqrt(pi a)."""

MOST_COMPRESSION = 2.0
"""Newman's closure has been fitted to R from -2 on: a smaller K_min counts as -2 K_max."""


def intrinsic_length(threshold_range: float, limit_range: float) -> float:
    """El Haddad's length a0 = (dK_th/(1.1215 ds_0))^2/pi, m, for cracks at a smooth edge.

    With it a short crack at a smooth edge is at the threshold under the range ds_0. The length is 1.258 times smaller
    than :func:`fastpin.damage.critical_distance`, which is of a crack inside a body.

    Parameters
    ----------
    threshold_range : float
        Threshold dK_th of long cracks, Pa sqrt(m).
    limit_range : float
        Range ds_0 of the stress at the fatigue limit of a smooth specimen, Pa, at the same stress ratio.

    Raises
    ------
    InputError
        If a range is not positive and finite.
    """
    ratio = positive("threshold_range", threshold_range) / (SMOOTH_EDGE * positive("limit_range", limit_range))
    length = ratio * ratio / math.pi
    if not 0.0 < length < math.inf:
        raise InputError("threshold_range", f"is {ratio:g} times limit_range: the length can't be computed")
    return length


@dataclass(frozen=True)
class GrowthLaw:
    """What every law answers. K_max and K_min are of K_I over a cycle, Pa sqrt(m), also negative.

    A law of your own is a subclass with the method ``_rate_above(K_max, K_min, length)``: the growth above the
    threshold, m per cycle. All three are float arrays of one shape, and so is the growth. ``_range`` with K_max and
    K_min, ``_threshold`` with all three and :attr:`fracture_toughness` may be replaced too. Without them a law counts K
    as 0 below 0, and has neither threshold nor toughness.
    """

    @property
    def fracture_toughness(self) -> float:
        """K_max at which the crack runs through in one cycle, Pa sqrt(m); infinite unless the law has one."""
        return math.inf

    def range(self, K_max: ArrayLike, K_min: ArrayLike) -> np.ndarray:
        """The range of the stress intensity that the law counts, Pa sqrt(m); 0 for a crack that never opens.

        Raises
        ------
        InputError
            If an argument holds no finite numbers, or the shapes do not fit.
        """
        return self._range(*_checked(K_max, K_min, 1.0)[:2])

    def threshold(self, K_max: ArrayLike, K_min: ArrayLike, length: ArrayLike) -> np.ndarray:
        """The range up to which a crack of this length, m, does not grow, Pa sqrt(m).

        Raises
        ------
        InputError
            See :meth:`range`; also if a length is not positive.
        """
        return self._threshold(*_checked(K_max, K_min, length))

    def rate(self, K_max: ArrayLike, K_min: ArrayLike, length: ArrayLike) -> np.ndarray:
        """The growth da/dN, m per cycle: 0 up to the threshold, and infinite from the toughness on.

        Raises
        ------
        InputError
            See :meth:`threshold`.
        """
        each = top, bottom, _ = _checked(K_max, K_min, length)
        grows, runs = self._range(top, bottom) > self._threshold(*each), top >= self.fracture_toughness
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = self._rate_above(*each)
        return np.where(runs, np.inf, np.where(grows, found, 0.0))

    def _range(self, K_max: np.ndarray, K_min: np.ndarray) -> np.ndarray:
        """K_max - K_min of the part of the cycle in which the crack is open."""
        return np.maximum(K_max, 0.0) - np.maximum(K_min, 0.0)

    def _threshold(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        """The threshold."""
        return np.zeros(K_max.shape)

    def _rate_above(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        """The rate above the threshold and below the toughness; any value elsewhere."""
        raise InputError("law", "needs the method _rate_above(K_max, K_min, length), see fastpin.cracks.GrowthLaw")


def _checked(K_max: ArrayLike, K_min: ArrayLike, length: ArrayLike) -> tuple[np.ndarray, ...]:
    """Stress intensities and lengths in one shape; the largest and the smallest in their order."""
    top, bottom = in_one_shape("K_min", numbers("K_min", K_min), numbers("K_max", K_max))[::-1]
    top, a = in_one_shape("length", top, numbers("length", length, 0.0, open_low=True))
    bottom = np.broadcast_to(bottom, top.shape)
    if np.any(bottom > top):
        raise InputError("K_min", "must not be larger than K_max")
    return top, bottom, a


def checked_law(law: object) -> GrowthLaw:
    """Check a law of growth."""
    if not isinstance(law, GrowthLaw):
        raise InputError("law", f"must be a law of growth, such as fastpin.cracks.Walker, not {as_toml(law)}")
    return law


@dataclass(frozen=True)
class Walker(GrowthLaw):
    """da/dN = C [dK (1 - R)^(g - 1)/unit]^m. The exponent g = 1 is Paris's law, and g = 1/2 takes sqrt(K_max dK).

    A crack that is closed does not feel its load: K counts as 0 below 0, in dK and in R.

    Parameters
    ----------
    C : float
        Growth in a cycle under the range `unit`, m. So it is the usual C in m per cycle and MPa sqrt(m).
    m : float
        Exponent.
    exponent : float
        g, from 0 to 1.
    threshold_range : float
        Threshold dK_th of long cracks at R = 0, Pa sqrt(m). At R it is dK_th (1 - R)^h sqrt(a/(a + a0)).
    threshold_exponent : float, optional
        h; 1 - g unless given, so that the same dK (1 - R)^(g - 1) counts for the rate and the threshold.
    intrinsic_length : float
        El Haddad's a0, m, see :func:`intrinsic_length`; 0 for the threshold of long cracks at all lengths.
    toughness : float, optional
        K_max at which the plate breaks, Pa sqrt(m).
    unit : float
        Pa sqrt(m). In a dimensionless problem it counts in F/sqrt(R), as all ranges do.
    source : str
        Where the constants come from.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    C: float
    m: float
    exponent: float = 1.0
    threshold_range: float = 0.0
    threshold_exponent: float | None = None
    intrinsic_length: float = 0.0
    toughness: float | None = None
    unit: float = 1e6
    source: str = ""

    def __post_init__(self) -> None:
        check_fields(self, string, "source")
        check_fields(self, positive, "C m unit")
        check_fields(self, not_negative, "threshold_range intrinsic_length")
        check_fields(self, number, "exponent", 0.0, 1.0)
        check_fields(self, number, "threshold_exponent", 0, 2, optional=True)
        check_fields(self, positive, "toughness", optional=True)

    @property
    def fracture_toughness(self) -> float:
        return math.inf if self.toughness is None else self.toughness

    def _threshold(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        power = 1.0 - self.exponent if self.threshold_exponent is None else self.threshold_exponent
        long = self.threshold_range * _rest(K_max, K_min) ** power
        return np.asarray(long * np.sqrt(length / (length + self.intrinsic_length)))

    def _rate_above(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        driving = self._range(K_max, K_min) * _rest(K_max, K_min) ** (self.exponent - 1.0)
        return np.asarray(self.C * (driving / self.unit) ** self.m)


def paris(C: float, m: float, threshold_range: float = 0.0, intrinsic_length: float = 0.0) -> Walker:
    """Paris's law da/dN = C (dK/MPa sqrt(m))^m: :class:`Walker` with the exponent 1, for any stress ratio."""
    return Walker(C, m, threshold_range=threshold_range, intrinsic_length=intrinsic_length)


def _rest(K_max: np.ndarray, K_min: np.ndarray) -> np.ndarray:
    """1 - R of the open part of a cycle; 1 for a crack that never opens."""
    top, bottom = np.maximum(K_max, 0.0), np.maximum(K_min, 0.0)
    return np.divide(top - bottom, top, out=np.ones_like(top), where=top > 0.0)


@dataclass(frozen=True)
class Nasgro(GrowthLaw):
    """da/dN = C [(1 - f)/(1 - R) dK/unit]^n (1 - dK_th/dK)^p/(1 - K_max/K_c)^q, the form of the NASGRO equation.

    f is Newman's opening K_op/K_max and holds the closure: R and dK = K_max - K_min count the negative K, too.
    dK_th = dK_0 sqrt(a/(a + a0))/[(1 - f)/((1 - A_0)(1 - R))]^(1 + C_th R).

    Parameters
    ----------
    C, n : float
        Growth in a cycle under the effective range `unit`, m, and its exponent.
    p, q : float
        Exponents near the threshold and near the toughness, at least 0.
    threshold_range : float
        Threshold dK_0 at R = 0, Pa sqrt(m).
    toughness : float
        K_c, Pa sqrt(m).
    threshold_slope, compressive_slope : float
        C_th for R >= 0 and for R < 0.
    constraint : float
        alpha, from 1 (plane stress) to 3 (plane strain).
    stress_level : float
        Largest stress over the flow stress, from 0 to 1, exclusive of 1.
    intrinsic_length : float
        a0, m.
    unit : float
        Pa sqrt(m).
    source : str
        Where the constants come from.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    C: float
    n: float
    p: float
    q: float
    threshold_range: float
    toughness: float
    threshold_slope: float = 0.0
    compressive_slope: float = 0.0
    constraint: float = 2.0
    stress_level: float = 0.3
    intrinsic_length: float = 0.0
    unit: float = 1e6
    source: str = ""

    def __post_init__(self) -> None:
        check_fields(self, string, "source")
        check_fields(self, positive, "C n toughness unit")
        check_fields(self, not_negative, "p q threshold_range intrinsic_length")
        check_fields(self, number, "threshold_slope compressive_slope", -10.0, 10.0)
        check_fields(self, number, "constraint", 1.0, 3.0)
        check_fields(self, number, "stress_level", 0.0, 0.99)

    @property
    def fracture_toughness(self) -> float:
        return self.toughness

    def _range(self, K_max: np.ndarray, K_min: np.ndarray) -> np.ndarray:
        top = np.maximum(K_max, 0.0)
        return (1.0 - self._ratio(K_max, K_min)) * top

    def _threshold(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        R = self._ratio(K_max, K_min)
        slope = np.where(R >= 0.0, self.threshold_slope, self.compressive_slope)
        closed = (1.0 - self.opening(R)) / ((1.0 - self._coefficients[0]) * (1.0 - R))
        long = self.threshold_range / closed ** (1.0 + slope * R)
        return np.asarray(long * np.sqrt(length / (length + self.intrinsic_length)))

    def _rate_above(self, K_max: np.ndarray, K_min: np.ndarray, length: np.ndarray) -> np.ndarray:
        R, swing = self._ratio(K_max, K_min), self._range(K_max, K_min)
        driving = (1.0 - self.opening(R)) * np.maximum(K_max, 0.0)
        above = np.maximum(1.0 - self._threshold(K_max, K_min, length) / swing, 0.0)
        below = np.maximum(1.0 - K_max / self.toughness, 0.0)
        return np.asarray(self.C * (driving / self.unit) ** self.n * above**self.p / below**self.q)

    def opening(self, R: ArrayLike) -> np.ndarray:
        """Newman's f = K_op/K_max at the stress ratios R from -2 to 1.

        Raises
        ------
        InputError
            If a ratio lies elsewhere.
        """
        R = numbers("R", R, -MOST_COMPRESSION, 1.0)
        A_0, A_1, A_2, A_3 = self._coefficients
        return np.where(R >= 0.0, np.maximum(R, A_0 + R * (A_1 + R * (A_2 + R * A_3))), A_0 + A_1 * R)

    @property
    def _coefficients(self) -> tuple[float, float, float, float]:
        alpha, S = self.constraint, self.stress_level
        A_0 = (0.825 - 0.34 * alpha + 0.05 * alpha**2) * math.cos(0.5 * math.pi * S) ** (1.0 / alpha)
        A_1 = (0.415 - 0.071 * alpha) * S
        A_3 = 2.0 * A_0 + A_1 - 1.0
        return A_0, A_1, 1.0 - A_0 - A_1 - A_3, A_3

    def _ratio(self, K_max: np.ndarray, K_min: np.ndarray) -> np.ndarray:
        """R, at least -2; 0 for a crack that never opens."""
        top = np.maximum(K_max, 0.0)
        R = np.divide(K_min, top, out=np.zeros_like(top), where=top > 0.0)
        return np.clip(R, -MOST_COMPRESSION, 1.0 - 1e-9)  # at 1 both the range and the opening are 0


KnownLaw = Walker | Nasgro
"""The laws that materials, case files and results can hold."""

LAWS: dict[str, tuple[type[Walker] | type[Nasgro], tuple[str, ...], tuple[str, ...]]] = {
    "paris": (Walker, tuple(each.name for each in fields(Walker) if "exponent" not in each.name), ("C", "m")),
    "walker": (Walker, tuple(each.name for each in fields(Walker)), ("C", "m")),
    "nasgro": (
        Nasgro,
        tuple(each.name for each in fields(Nasgro)),
        ("C", "n", "p", "q", "threshold_range", "toughness"),
    ),
}
"""The laws of case files by name: the class, all constants, and the constants that must be given."""


def law_entries(law: KnownLaw) -> dict[str, Any]:
    """Return the name of a law and its constants, as a case file gives them. Constants with their default are left out.

    Paris's law is that of Walker with the exponent 1.
    """
    name = "nasgro" if isinstance(law, Nasgro) else "walker"
    values = ((each, getattr(law, each.name)) for each in fields(law))
    return {"law": name} | {each.name: value for each, value in values if value != each.default}


def law_from(entries: dict[str, Any]) -> KnownLaw:
    """Return the law of such entries.

    Raises
    ------
    InputError
        If the law is unknown, a constant is missing, belongs to another law, or is out of range.
    """
    name = entries.get("law")
    if not isinstance(name, str) or name not in LAWS:
        raise InputError("law", f"must be one of {', '.join(LAWS)}, not {as_toml(name)}")
    make, allowed, needed = LAWS[name]
    for key in entries:
        if key not in (*allowed, "law"):
            raise InputError(key, f"is no constant of the law {name}; it has {', '.join(allowed)}")
    for key in needed:
        if key not in entries:
            raise InputError(key, f"is missing; the law {name} needs {', '.join(needed)}")
    return make(**{key: value for key, value in entries.items() if key != "law"})


def known_law(field: str, law: object) -> KnownLaw:
    """Check a law that can be stored."""
    if not isinstance(law, Walker | Nasgro):
        words = "must be a law with constants, fastpin.cracks.Walker, paris or Nasgro"
        raise InputError(field, f"{words}, not {as_toml(law)}; a law of your own is an argument of fastpin.cracks")
    return law
