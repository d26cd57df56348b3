"""A certificate for PID gains: every condition with its two sides, and what it leaves.

LaSalle's argument. V > 0 but in the goal, and dV/dt <= 0 while ||q~|| stays below `region`. There
dV/dt is zero only where q~ = dq = 0. A motion that stays at that has ddq = 0, so K_i w = 0 by
(3.7), so w = 0: the goal. A motion that never leaves the region therefore ends in the goal;
`attraction` says from where none leaves. The bound is on the position error, in rad, not on the
speed.

Source: Mastalli 2013, (3.12), (3.13), (3.17) and (3.22) to (3.30), with (3.22) to (3.24) corrected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backhoe.arm.lyapunov.conditions import least, lowest, route_named
from backhoe.arm.lyapunov.extremes import Constants, constants_of
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import positive

_NAMES = {
    "scalar": (
        "lambda_min(K_p) > k_g",
        "lambda_min(K_d) > a lambda_max^2/lambda_min(M), a = lambda_max(K_i)/(lambda_min(K_p)-k_g)",
        "alpha > lambda_max(K_i)/(lambda_min(K_p)-k_g)",
        "alpha < lambda_min(K_d) lambda_min/lambda_max^2(M)",
    ),
    "matrix": (
        "K_p > k_g I",
        "K_d > alpha M(q) for all q, at the lowest alpha",
        "alpha (K_p - k_g I) > K_i",
        "K_d > alpha M(q) for all q",
    ),
    "exact": (
        "K_p + dg/dq(x) > 0 for all x",
        "K_d > alpha M(q) for all q, at the lowest alpha",
        "alpha (K_p + dg/dq(x)) > K_i for all x",
        "K_d > alpha M(q) for all q",
    ),
}


@dataclass(frozen=True)
class Condition:
    """One inequality: `left` `relation` `right` [`unit`], the source's `equation`, the verdict."""

    name: str
    equation: str
    left: float
    relation: str
    right: float
    unit: str
    holds: bool

    def __str__(self) -> str:
        verdict = "must be" if not self.holds else "is"
        return (
            f"{self.name} {self.equation}: {self.left:.6g} {verdict} {self.relation} "
            f"{self.right:.6g} {self.unit}"
        )


@dataclass(frozen=True)
class Certificate:
    """What the conditions of one route say of gains.

    `alpha_low`, `alpha_high` [1/s] bound the open interval of alpha that the gains leave (infinite
    or 0 when nothing is left; `alpha_high` with the wanted error counted in). `region` [rad] is the
    largest ||q~|| up to which dV/dt <= 0, at `alpha` or, with alpha None, as alpha comes close to
    `alpha_low`; 0 when a condition on alpha fails.
    """

    route: str
    conditions: tuple[Condition, ...]
    alpha: float | None
    alpha_low: float
    alpha_high: float
    region: float
    constants: Constants

    @property
    def failed(self) -> tuple[Condition, ...]:
        """The conditions that do not hold."""
        return tuple(condition for condition in self.conditions if not condition.holds)

    @property
    def holds(self) -> bool:
        """Whether all conditions hold."""
        return not self.failed

    def table(self) -> str:
        """The conditions as lines of text, with both sides, unit and verdict."""
        rows = [
            (c.name, c.equation, f"{c.left:.4g} {c.relation} {c.right:.4g} {c.unit}", c.holds)
            for c in self.conditions
        ]
        names, equations = (max(len(row[i]) for row in rows) for i in (0, 1))
        sides = max(len(row[2]) for row in rows)
        lines = [f"{self.route} conditions, constants {self.constants.recipe} over {self._where()}"]
        lines += [
            f"{'holds' if holds else 'FAILS'}  {name:<{names}}  {equation:<{equations}}  "
            f"{text:<{sides}}".rstrip()
            for name, equation, text, holds in rows
        ]
        interval = f"{self.alpha_low:.4g} < alpha < {self.alpha_high:.4g} 1/s"
        left = interval if self.alpha_low < self.alpha_high else f"none ({interval})"
        lines.append(f"alpha: {left}; dV/dt <= 0 for ||q~|| < {self.region:.4g} rad")
        return "\n".join(lines)

    def require(self) -> Certificate:
        """This certificate, if all conditions hold.

        Raises:
            ValueError: some do not; each is named with its numbers.
        """
        if self.holds:
            return self
        broken = "; ".join(map(str, self.failed))
        raise ValueError(
            f"the gains are not certified by the {self.route} conditions over {self._where()}: "
            f"{broken}. Lower K_i, or raise what falls short"
        )

    def _where(self) -> str:
        if self.constants.domain == "postures":
            return f"{len(self.constants.q)} given postures (nothing is proved between them)"
        return {"box": "the joint box", "torus": "all angles"}[self.constants.domain]


def check_gains(
    gains: Gains,
    *,
    constants: Constants | None = None,
    route: str = "scalar",
    error: float | None = None,
    alpha: float | None = None,
) -> Certificate:
    """Judge PID gains by the conditions of one route.

    Source: Mastalli 2013, (3.30) and (3.24), the latter corrected: it bounds ||q~||.

    Args:
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        constants: of the arm, and over which postures; None for the tight ones of the joint box.
            Numbers changed by `replace` count where the route uses them: all of them in "scalar",
            kg and kc1 in "matrix", none in "exact".
        route: "scalar" as the thesis, from extreme eigenvalues; "matrix" with K_d > alpha M(q) and
            gains as they are, joint by joint; "exact" without k_g and k_C1. Each implies the next.
        error: size of the position error up to which dV/dt <= 0 is asked [rad]; None for any.
        alpha: number of the analysis to judge at [1/s]; None to ask whether there is one.

    Returns:
        Certificate.

    Raises:
        ValueError: a gain of another shape, not finite, not symmetric or not positive definite; an
            unknown route; error or alpha not positive.
        TypeError: gains are no Gains, or constants no Constants.
    """
    gains = gain_matrices(gains)
    judge = route_named(route)
    c = constants_of(constants)
    radius = 0.0 if error is None else positive(error, "error", "rad")
    chosen = None if alpha is None else positive(alpha, "alpha", "1/s")
    low = judge.alpha_low(gains, c)
    high = judge.alpha_positive(gains, c)
    at = low if chosen is None else chosen
    region = judge.region(gains, c, at) if at < high and low <= at else 0.0
    conditions = [
        _condition("K_i > 0", "(3.30)", lowest(gains.ki), ">", 0.0, "N m/(rad s)"),
        _stiffness(route, gains, c),
    ]
    if chosen is None:
        conditions.append(_damping(route, gains, c, low))
    else:
        conditions += [
            _condition(_NAMES[route][2], "(3.13)", chosen, ">", low, "1/s"),
            _condition(_NAMES[route][3], "(3.17)", chosen, "<", high, "1/s"),
        ]
    if error is not None:
        name = "largest ||q~|| with dV/dt <= 0"
        conditions.append(_condition(name, "(3.24) corrected", region, ">", radius, "rad"))
        high = min(high, judge.alpha_decay(gains, c, radius))
    return Certificate(route, tuple(conditions), chosen, low, high, region, c)


def _stiffness(route: str, gains: Gains, c: Constants) -> Condition:
    left = route_named(route).stiffness(gains, c)
    over = 0.0 if route == "exact" else c.kg
    return _condition(_NAMES[route][0], "(3.30)", left + over, ">", over, "N m/rad")


def _damping(route: str, gains: Gains, c: Constants, low: float) -> Condition:
    """Whether K_d leaves room above the lowest alpha."""
    if route == "scalar":
        left, right = lowest(gains.kd), low * c.ratio
    else:
        left, right = _margin(gains, c, low), 0.0
    return _condition(_NAMES[route][1], "(3.30)", left, ">", right, "N m s/rad")


def _margin(gains: Gains, c: Constants, alpha: float) -> float:
    """Smallest eigenvalue of K_d - alpha M(q), positive exactly where V's quadratic form is."""
    if not np.isfinite(alpha):
        return -np.inf
    return alpha * least(gains.kd / alpha, c.over, c.machine)


def _condition(
    name: str, equation: str, left: float, relation: str, right: float, unit: str
) -> Condition:
    holds = left > right if relation == ">" else left < right
    return Condition(name, equation, float(left), relation, float(right), unit, bool(holds))
