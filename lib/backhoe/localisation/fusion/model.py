"""How the machine moves by its encoders, and what its other sensors see of that.

The increments of the encoders are the input, with their noise; nothing pretends that they measure
the pose. Of the state, `TURNING` is the share of the ideal turn that the slipping tracks give, as
slip lengthens the gauge to gauge/turning, and `BIAS` is the gyro's. `TURNED` is the turn since the
last update by the gyro. The gyro measures this turn, and the encoders' noise that is in it went
into the heading as well: a filter can only know that if the turn is a part of its state.

    s = r (left + right)/2                      way over a step [m]
    d = r (right - left)/l                      turn over a step if nothing slipped [rad]
    x   <- x + s cos(psi + turning d/2)
    y   <- y + s sin(psi + turning d/2)
    psi <- psi + turning d
    turned <- turned + turning d                 and 0 after each update by the gyro

The gyro updates once a second and not in every step. What tells the slip is the turn by the
encoders beside that by the gyro, and the noise of a single step's turn is not small beside the turn
itself: it would be taken for turning that the gyro did not see, and the slip come out too large
(errors in variables). Over a second the noise is 30 times smaller beside the turn, in variance.

Source: Mastalli 2013, eqs. (2.9), (4.2), (4.24) and (4.25) corrected; the rest is ours.
Every function works over leading axes, as the filters of `backhoe.localisation.kalman` ask for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative
from backhoe.localisation.drives import NOISE, SAMPLE_RATE, Noise
from backhoe.machine import BACKHOE, Machine

X, Y, PSI, BIAS, TURNING, TURNED = range(6)
ANGLES = (PSI,)
NAMES = ("x", "y", "psi", "bias", "turning", "turned")


def _selector(*components: int) -> NDArray:
    H = np.zeros((len(components), 6))
    H[range(len(components)), components] = 1.0
    H.flags.writeable = False
    return H


class Model:
    """Motion and sensors, with their covariances, ready for a filter of `kalman`.

    Args:
        machine: its sprocket radius and gauge.
        noise: variances of a sample.
        period: time between two samples [s]: a step that sums n samples has n times the noise of
            one; 0 if each step holds a single sample.
        bias_walk: how fast the gyro's bias wanders [rad/s per sqrt(s)].
        turning_walk: how fast the slip changes [1 per sqrt(s)].

    Raises:
        ValueError: a period or walk is negative or not finite.
    """

    H_YAW = _selector(PSI)
    """Of an absolute yaw."""
    H_POSITION = _selector(X, Y)
    """Of a total station."""

    def __init__(
        self,
        machine: Machine = BACKHOE,
        noise: Noise = NOISE,
        *,
        period: float = 1 / SAMPLE_RATE,
        bias_walk: float = 0.0,
        turning_walk: float = 0.0,
    ) -> None:
        self.machine, self.noise = machine, noise
        self.radius, self.gauge = machine.tracks.sprocket_radius, machine.tracks.gauge
        self.period = not_negative(period, "period", "s")
        self.bias_walk = not_negative(bias_walk, "bias_walk")
        self.turning_walk = not_negative(turning_walk, "turning_walk")

    def _step(self, x: NDArray, u: ArrayLike) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Way s, turn d without slip, and s times cosine and sine of the middle heading."""
        u = np.asarray(u, dtype=float)
        s = self.radius / 2 * (u[..., 0] + u[..., 1])
        d = self.radius / self.gauge * (u[..., 1] - u[..., 0])
        middle = x[..., PSI] + x[..., TURNING] * d / 2
        return s, d, s * np.cos(middle), s * np.sin(middle)

    def f(self, x: NDArray, u: ArrayLike, dt: float) -> NDArray:
        """The motion over a step.

        Args:
            x: state x, y, psi, bias, turning, turned, shape (..., 6)
                [m, m, rad, rad/s, 1, rad].
            u: turns of the left and right sprocket over the step, shape (..., 2) [rad].
            dt: of the step [s].

        Returns:
            The state after it, shape (..., 6).
        """
        _, d, ahead_x, ahead_y = self._step(x, u)
        moved = np.array(np.broadcast_to(x, (*ahead_x.shape, 6)))
        moved[..., X] += ahead_x
        moved[..., Y] += ahead_y
        moved[..., PSI] += x[..., TURNING] * d
        moved[..., TURNED] += x[..., TURNING] * d
        return moved

    def F(self, x: NDArray, u: ArrayLike, dt: float) -> NDArray:
        """Its Jacobian df/dx before the step, shape (..., 6, 6), in the units of x; as for `f`."""
        _, d, ahead_x, ahead_y = self._step(x, u)
        F = np.zeros((*ahead_x.shape, 6, 6))
        F[..., range(6), range(6)] = 1.0
        F[..., X, PSI], F[..., Y, PSI] = -ahead_y, ahead_x
        F[..., X, TURNING], F[..., Y, TURNING] = -ahead_y * d / 2, ahead_x * d / 2
        F[..., PSI, TURNING] = F[..., TURNED, TURNING] = d
        return F

    def Q(self, x: NDArray, u: ArrayLike, dt: float) -> NDArray:
        """What the encoders' noise and the walks add over a step, shape (..., 6, 6), in the units
        of x; arguments as for `f`."""
        s, d, ahead_x, ahead_y = self._step(x, u)
        turning = x[..., TURNING]
        middle = x[..., PSI] + turning * d / 2
        way, turn = np.zeros((*s.shape, 6)), np.zeros((*s.shape, 6))
        way[..., X], way[..., Y] = np.cos(middle), np.sin(middle)
        turn[..., X], turn[..., Y] = -turning * ahead_y / 2, turning * ahead_x / 2
        turn[..., PSI] = turn[..., TURNED] = turning
        side = self.noise.encoder * dt * (self.period or dt) * self.radius**2
        Q = side / 2 * way[..., :, None] * way[..., None, :]
        Q += 2 * side / self.gauge**2 * turn[..., :, None] * turn[..., None, :]
        Q[..., BIAS, BIAS] += self.bias_walk**2 * dt
        Q[..., TURNING, TURNING] += self.turning_walk**2 * dt
        return Q

    @staticmethod
    def H_gyro(since: float) -> NDArray:
        """Of the turn by the gyro since its last update, turned + bias since, shape (1, 6).

        Args:
            since: time since then [s].
        """
        return np.array([[0.0, 0.0, 0.0, since, 0.0, 1.0]])

    def R_gyro(self, since: float, step: float | None = None) -> NDArray:
        """Of that turn, shape (1, 1) [rad^2].

        Args:
            since: time since the gyro's last update [s].
            step: of the filter [s]; matters only if each step holds a single sample.
        """
        return np.array([[self.noise.gyro * since * (self.period or step or since)]])

    @staticmethod
    def restart_turn(filter_: object) -> None:
        """Begin to count the turn anew: to be called after each update by the gyro.

        Args:
            filter_: of `backhoe.localisation.kalman`, single or batch; its x and P are set.
        """
        x, P = np.array(filter_.x), np.array(filter_.P)
        x[..., TURNED], P[..., TURNED, :], P[..., :, TURNED] = 0.0, 0.0, 0.0
        filter_.x, filter_.P = x, P

    def R_yaw(self) -> NDArray:
        """Of a sample of the absolute yaw, shape (1, 1) [rad^2]."""
        return np.array([[self.noise.yaw]])
