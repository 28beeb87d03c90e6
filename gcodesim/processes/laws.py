"""Cutting-force laws: force on a piece of edge from its chip thickness h and width b.

Both laws give three components on each piece of edge: tangential (against the
cutting velocity), normal (into the tool along the edge's normal) and axial
(along the edge, towards the tip).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import power
from gcodesim.frozen import frozen
from gcodesim.units import DEG, MM, N_PER_MM, N_PER_MM2

Array = NDArray[np.float64]

DEFAULT_NORMAL_RATIO: Final = 0.3
"""Normal over tangential force where a table gives none: the usual ratio for a sharp edge at small positive rake."""

DEFAULT_AXIAL_RATIO: Final = 0.0
"""Axial over tangential force where a table gives none."""


RAKE_SHARE: Final = 0.01
"""By how much forces of cutting fall with a degree of rake: K = 1 - (gamma - gamma0) / 100.

Tabellenbuch Zerspantechnik, 5th ed. 2022, pp. 215-216; Sandvik and Seco say the same 1 % a degree.
"""


class Law(Protocol):
    """What the force kernels need from a law."""

    @property
    def packed(self) -> Array:
        """(3, 3) rows tangential, normal, axial; columns K, p, E [SI]: force per width = K h**p + E, h in m."""
        ...


@frozen
class Kienzle:
    """Kienzle 1952: kc = kc11 (h / 1 mm)**-mc, force = kc h b; no edge (ploughing) force.

    `kc11`, `kn11`, `ka11` [Pa] are the specific forces at 1 mm chip thickness, tangential, normal and axial, with
    exponents `mc`, `mn`, `ma` [-]. Valid in the range of chip thickness that its table was measured in, mostly
    0.05 to 1 mm; forces on thinner chips come out too small.
    """

    kc11: float
    mc: float
    kn11: float
    mn: float
    ka11: float
    ma: float

    @staticmethod
    def from_ratios(
        *,
        kc11: float,
        mc: float,
        normal_ratio: float = DEFAULT_NORMAL_RATIO,
        axial_ratio: float = DEFAULT_AXIAL_RATIO,
    ) -> Kienzle:
        """From a usual table row: `kc11` [Pa], `mc`, and the other components as shares of the tangential one [-]."""
        return Kienzle(kc11=kc11, mc=mc, kn11=normal_ratio * kc11, mn=mc, ka11=axial_ratio * kc11, ma=mc)

    @staticmethod
    def from_table(
        kc11_n_mm2: float,
        mc: float,
        normal_ratio: float = DEFAULT_NORMAL_RATIO,
        axial_ratio: float = DEFAULT_AXIAL_RATIO,
    ) -> Kienzle:
        """As `from_ratios`, with `kc11_n_mm2` [N/mm²] as tables print it."""
        return Kienzle.from_ratios(
            kc11=kc11_n_mm2 * N_PER_MM2, mc=mc, normal_ratio=normal_ratio, axial_ratio=axial_ratio
        )

    @property
    def packed(self) -> Array:
        rows = ((self.kc11, self.mc), (self.kn11, self.mn), (self.ka11, self.ma))
        return np.array([[k * power(MM, m), 1.0 - m, 0.0] for k, m in rows])

    def specific_force(self, chip: float) -> float:
        """Tangential specific cutting force kc [Pa] at chip thickness `chip` [m] > 0."""
        return float(self.kc11 * power(chip / MM, -self.mc))

    def grown(self, factor: float) -> Kienzle:
        """The same with all forces of cutting multiplied."""
        return replace(self, kc11=factor * self.kc11, kn11=factor * self.kn11, ka11=factor * self.ka11)


@frozen
class LinearEdge:
    """Linear-edge law (Altintas 2012, eq. 2.72): force per width = Kc h + Ke.

    `ktc`, `krc`, `kac` [Pa] for cutting, `kte`, `kre`, `kae` [N/m] for the rubbing of the edge; tangential, radial
    (along the normal) and axial. The constants are fits for one tool and one range of feed.
    """

    ktc: float
    kte: float
    krc: float
    kre: float
    kac: float = 0.0
    kae: float = 0.0

    @staticmethod
    def from_table(
        ktc_n_mm2: float,
        kte_n_mm: float,
        krc_n_mm2: float,
        kre_n_mm: float,
        kac_n_mm2: float = 0.0,
        kae_n_mm: float = 0.0,
    ) -> LinearEdge:
        """From table units: cutting coefficients [N/mm²], edge coefficients [N/mm]."""
        return LinearEdge(
            ktc=ktc_n_mm2 * N_PER_MM2,
            kte=kte_n_mm * N_PER_MM,
            krc=krc_n_mm2 * N_PER_MM2,
            kre=kre_n_mm * N_PER_MM,
            kac=kac_n_mm2 * N_PER_MM2,
            kae=kae_n_mm * N_PER_MM,
        )

    @property
    def packed(self) -> Array:
        return np.array([[self.ktc, 1.0, self.kte], [self.krc, 1.0, self.kre], [self.kac, 1.0, self.kae]])

    def specific_force(self, chip: float) -> float:
        """Tangential force over chip section [Pa] at chip thickness `chip` [m] > 0."""
        return self.ktc + self.kte / chip

    def grown(self, factor: float) -> LinearEdge:
        """The same with all forces of cutting multiplied; the rubbing of the edge stays."""
        return replace(self, ktc=factor * self.ktc, krc=factor * self.krc, kac=factor * self.kac)


def rake_factor(rake: float, of_table: float) -> float:
    """By how much forces of cutting differ on an edge with a `rake` [rad] from a table of edges with another one.

    All three forces alike, though the normal one falls faster in truth. Valid some 15 degrees to both sides.
    """
    return 1.0 - RAKE_SHARE * (rake - of_table) / DEG


def with_rake(law: Kienzle | LinearEdge, rake: float | None, of_table: float | None) -> Kienzle | LinearEdge:
    """A law for edges with a `rake` [rad]; as it is where that of the edges or of the table is not known."""
    if rake is None or of_table is None or rake == of_table:
        return law
    return law.grown(rake_factor(rake, of_table))
