"""A region of attraction: a level set of V that lies where V falls.

In the ball ||q~|| < radius, V' <= 0 and V >= mu ||q~||^2 / 2. On the ball's edge V is therefore at
least `level` = mu radius^2 / 2: a motion that starts inside with V < level can never reach the
edge, V falls for ever, and by LaSalle (see `certificate`) the motion ends in the goal. The bound mu
comes from (3.8), minimised over w and dq (w = 0, dq = alpha q~):

    V >= q~^T [alpha (K_d - alpha M(q)) + K_p - K_i/alpha - k_g I] q~ / 2.

Source: Mastalli 2013, section 3.1, which names such a region but does not give it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix
from backhoe.arm.lyapunov.candidate import State, function
from backhoe.arm.lyapunov.certificate import Certificate, check_gains
from backhoe.arm.lyapunov.conditions import highest, least, route_named
from backhoe.arm.lyapunov.extremes import Constants, constants_of
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import not_negative, numbers
from backhoe.machine import JOINTS

_ALPHAS = 40
_EVERY = 7


@dataclass(frozen=True)
class Attraction:
    """States from which the motion ends in the `goal` (4,) [rad].

    `radius` [rad] of the ball of position errors, `level` [J] of V inside it, `alpha` [1/s] of V,
    and the `certificate` that V falls. Friction only helps; a torque limit is not counted in.
    """

    goal: NDArray
    alpha: float
    radius: float
    level: float
    certificate: Certificate
    gains: Gains = field(repr=False)

    def contains(self, w: ArrayLike, error: ArrayLike, dq: ArrayLike) -> NDArray:
        """Whether states lie in the region: ||q~|| < radius and V < level.

        Args:
            w, error, dq: states, shape (..., 4) each [rad, rad, rad/s].

        Returns:
            Truth values, shape (...).

        Raises:
            ValueError: shapes do not fit, or a value is not finite.
        """
        machine = self.certificate.constants.machine
        state = State(w, error, dq, self.goal)
        V = function(state, self.gains, self.alpha, machine=machine)
        return (V < self.level) & (np.linalg.norm(error, axis=-1) < self.radius)

    def ball(self, speed: float = 0.0, w: float = 0.0) -> float:
        """Largest ||q~|| that is in the region whatever the directions of q~, dq and w.

        From V's terms by their largest eigenvalues: simple to check, smaller than the region.

        Args:
            speed: bound on ||dq|| [rad/s]; w: bound on ||w|| [rad]; neither negative.

        Returns:
            ||q~|| [rad]; 0 if speed and w alone may already be outside.

        Raises:
            ValueError: speed or w is negative or not finite.
        """
        speed, w = not_negative(speed, "speed", "rad/s"), not_negative(w, "w", "rad")
        c, (Kp, Ki, Kd) = self.certificate.constants, self.gains
        stiff = highest(self.alpha * Kd + Kp - Ki / self.alpha) + c.kg
        mixed = self.alpha * c.lambda_max * speed
        taken = highest(Ki) / self.alpha * w**2 + c.lambda_max * speed**2
        left = 2 * self.level - taken
        if left <= 0:
            return 0.0
        largest = (np.sqrt(mixed**2 + stiff * left) - mixed) / stiff
        return float(min(largest, self.radius))

    @property
    def error(self) -> float:
        """Largest ||q~|| at rest with w = 0 [rad]."""
        return self.ball()

    @property
    def speed(self) -> float:
        """Largest ||dq|| in the goal with w = 0 [rad/s]."""
        return float(np.sqrt(2 * self.level / self.certificate.constants.lambda_max))

    @property
    def w(self) -> float:
        """Largest ||w|| at rest in the goal [rad]."""
        return float(np.sqrt(2 * self.level * self.alpha / highest(self.gains.ki)))


def attraction(
    goal: ArrayLike,
    gains: Gains,
    *,
    constants: Constants | None = None,
    route: str = "matrix",
    alpha: float | None = None,
) -> Attraction:
    """An inner estimate of the region of attraction of a goal.

    Over the joint box the ball ends at the nearest limit of boom, stick or bucket, beyond which the
    constants say nothing; over all angles (`constants(domain="torus")`) nothing ends it.

    Args:
        goal: where the joints should be, shape (4,) [rad].
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        constants: of the arm over a whole domain; None for the tight ones of the joint box.
        route: as for `check_gains`.
        alpha: number of the analysis [1/s]; None for the one that gives the highest level of V.

    Returns:
        Attraction.

    Raises:
        ValueError: the gains are not certified; the goal is outside the joint box or at a limit;
            the constants are those of single postures; a gain or the goal is malformed.
    """
    goal = numbers(goal, "goal", (4,), meaning=f"one angle a joint ({', '.join(JOINTS)})")
    c = constants_of(constants)
    room = _room(goal, c)
    certificate = check_gains(gains, constants=c, route=route, alpha=alpha).require()
    gains = gain_matrices(gains)
    if alpha is None:
        alpha = _best_alpha(gains, c, certificate, room)
        certificate = check_gains(gains, constants=c, route=route, alpha=alpha).require()
    radius = min(certificate.region, room)
    level = max(0.0, _curvature(gains, c, alpha)) * radius**2 / 2
    return Attraction(goal, float(alpha), float(radius), float(level), certificate, gains)


def _room(goal: NDArray, c: Constants) -> float:
    """How far boom, stick and bucket are from the end of the constants' domain [rad]."""
    if c.domain == "torus":
        return np.inf
    if c.domain == "postures":
        raise ValueError(
            "the region of attraction needs constants over a whole domain, got those of "
            f'{len(c.q)} postures: use constants() or constants(domain="torus")'
        )
    machine = c.machine
    room = np.minimum(goal - machine.lower, machine.upper - goal)[1:].min()
    if room <= 0:
        raise ValueError(
            f"goal must lie inside the joint limits, but is {-room:.4g} rad outside: "
            'choose another goal, or constants(domain="torus")'
        )
    return float(room)


def _curvature(gains: Gains, c: Constants, alpha: float) -> float:
    """mu of the module's head [N m/rad]."""
    Kp, Ki, Kd = gains
    fixed = alpha * Kd + Kp - Ki / alpha - c.kg * np.eye(4)
    return alpha**2 * least(fixed / alpha**2, c.over, c.machine)


def _best_alpha(gains: Gains, c: Constants, certificate: Certificate, room: float) -> float:
    """The alpha that gives about the highest level, from some postures of the domain."""
    M = mass_matrix(c.over.q[::_EVERY], c.machine)
    judge, identity = route_named(certificate.route), np.eye(4)
    part = np.linspace(0, 1, _ALPHAS + 2)[1:-1]
    alphas = certificate.alpha_low ** (1 - part) * certificate.alpha_high**part

    def level(alpha: float) -> float:
        fixed = alpha * gains.kd + gains.kp - gains.ki / alpha - c.kg * identity
        curvature = np.linalg.eigvalsh(fixed - alpha**2 * M)[:, 0].min()
        if certificate.route == "scalar":
            radius = judge.region(gains, c, alpha)
        else:
            radius = np.linalg.eigvalsh(gains.kd / alpha - M)[:, 0].min() / c.kc1
        return max(0.0, curvature) * min(max(0.0, radius), room) ** 2

    return float(max(alphas, key=level))
