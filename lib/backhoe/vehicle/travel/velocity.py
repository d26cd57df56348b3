"""The velocity control of the tracks: a PI for the forward speed and one for the turning speed.

Both tracks get the translational loop's force, and the rotational one's with opposite signs,

    u_left = u_v - u_omega,    u_right = u_v + u_omega.                                      (3.35)

A PI on each track's own error e_v -+ l/2 e_omega (3.37) is the same with u_omega times the lever
l/2, half the gauge. The thesis leaves the lever out of (3.35): its rotational gains have taken it
in. On a gauge of 2 m, where the lever is 1 m, both agree to the last bit; that of this machine is
1.19 m, and (3.37) turns it with a fifth more force.

Source: Mastalli 2013, eqs. (3.35) to (3.37) and Table 3.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, positive
from backhoe.machine import BACKHOE, Machine


class Gains(NamedTuple):
    """Gains of the translational and the rotational loop.

    Attributes:
        kp: shape (2,) [N s/m, N s/rad].
        ki: shape (2,) [N/m, N/rad].
    """

    kp: tuple[float, float]
    ki: tuple[float, float]


GAINS = Gains(kp=(120e3, 120e3), ki=(90e3, 90e3))
"""Table 3.2; a test holds it to `data/published`."""


class VelocityPI:
    """Forces of the tracks from wanted and measured speeds; each integral stops at the limit.

    The drives give only so much. Turning comes first: the forward loop gets what is left of
    `limit`, so that a hard start does not cost the heading. While a loop is cut, its integral does
    not grow (clamping).

    Args:
        kp: gains of the translational [N s/m] and rotational loop [N s/rad], shape (2,); default
            Table 3.2.
        ki: the same of the integrals [N/m] and [N/rad], shape (2,); default Table 3.2.
        limit: largest force of one track [N]; default what the machine's drives give, inf for none.
        lever: factor of the rotational loop: 1 for (3.35), half the gauge for (3.37).
        machine: whose drives count.

    Raises:
        ValueError: gains that are not two numbers of 0 or more, a limit or lever not positive.
    """

    def __init__(
        self,
        kp: ArrayLike = GAINS.kp,
        ki: ArrayLike = GAINS.ki,
        *,
        limit: float | None = None,
        lever: float = 1.0,
        machine: Machine = BACKHOE,
    ) -> None:
        self.kp, self.ki = _gains(kp, "kp"), _gains(ki, "ki")
        limit = machine.tracks.max_traction if limit is None else limit
        self.limit = number(limit, "limit", "N", above=0.0, finite=False)
        self.lever = positive(lever, "lever")
        self.reset()

    def reset(self) -> None:
        """Forget the integrals."""
        self.integral = np.zeros(2)

    def __call__(
        self, v_ref: float, omega_ref: float, v: float, omega: float, dt: float
    ) -> tuple[float, float]:
        """Forces of the tracks for one sample.

        Args:
            v_ref, omega_ref: wanted forward and turning speed [m/s, rad/s].
            v, omega: measured ones [m/s, rad/s].
            dt: time since the last call [s].

        Returns:
            Forces of the left and right track [N], within the limit.

        Raises:
            ValueError: a speed is not finite, or dt is not positive.
        """
        e_v = number(v_ref, "v_ref", "m/s") - number(v, "v", "m/s")
        e_omega = number(omega_ref, "omega_ref", "rad/s") - number(omega, "omega", "rad/s")
        dt = positive(dt, "dt", "s")
        error = np.array([e_v, e_omega])
        integral = self.integral + error * dt
        wanted = (self.kp * error + self.ki * integral) * (1.0, self.lever)
        u_v, u_omega = given = limited(*wanted.tolist(), self.limit)
        kept = (given == wanted) | (wanted * error <= 0)
        self.integral = np.where(kept, integral, self.integral)
        return float(u_v - u_omega), float(u_v + u_omega)


def limited(u_v: float, u_omega: float, limit: float) -> NDArray:
    """What two tracks can give of a push ahead and of one against each other, the turn first.

    Args:
        u_v: wanted of both tracks [N].
        u_omega: wanted of the right track, and against it of the left one [N].
        limit: largest force of one track, either way [N].

    Returns:
        u_v and u_omega that can be given, shape (2,) [N].

    Raises:
        ValueError: a wish that is not finite, or a limit that is not above 0.
    """
    u_v, u_omega = number(u_v, "u_v", "N"), number(u_omega, "u_omega", "N")
    limit = number(limit, "limit", "N", above=0.0, finite=False)
    turn = min(max(u_omega, -limit), limit)
    left = limit - abs(turn)
    return np.array([min(max(u_v, -left), left), turn])


def tractions(force: float, moment: float, gauge: float) -> NDArray:
    """Forces of the left and right track that add up to a force and a yaw moment, shape (2,) [N].

    Args:
        force: along the vehicle [N].
        moment: about its vertical, to the left [N m].
        gauge: between the tracks [m].

    Raises:
        ValueError: a force or moment that is not finite, or a gauge that is not above 0.
    """
    half = number(force, "force", "N") / 2
    difference = number(moment, "moment", "N m") / positive(gauge, "gauge", "m")
    return np.array([half - difference, half + difference])


def _gains(gains: ArrayLike, name: str) -> NDArray:
    pair = numbers(gains, name, (2,), meaning="gains (translational, rotational)")
    return np.array([not_negative(gain, name) for gain in pair])
