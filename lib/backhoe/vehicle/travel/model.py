"""What a mass under a PI does at a step of the wanted speed: response and overshoot.

    inertia y' + damping y = u,    u = kp e + ki int e,    e = 1 - y

Both tracks push with u_v, so in translation the gains count twice; in rotation each acts on the
lever l/2, so they count l times. The thesis prints neither mass nor inertia: those here are the
machine's own, in the arm's posture.

Without damping the integral of e over a step is 0: what the response lacks at first it has too much
later. A PI on a free mass always overshoots.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, log, pi, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.basics.inputs import not_negative, numbers, positive
from backhoe.machine import BACKHOE, Machine, replace
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.vehicle.travel.velocity import GAINS


@dataclass(frozen=True)
class StepModel:
    """A first-order plant under a PI: `inertia` [kg or kg m^2], gains and damping to match.

    Raises:
        ValueError: inertia or kp not positive, ki or damping negative, or a value not finite.
    """

    inertia: float
    kp: float
    ki: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check = positive if name in ("inertia", "kp") else not_negative
            object.__setattr__(self, name, check(value, f"StepModel.{name}"))

    @cached_property
    def poles(self) -> NDArray:
        """Poles of the closed loop, the faster one first, shape (2,), complex [1/s]."""
        roots = np.roots([self.inertia, self.damping + self.kp, self.ki]).astype(complex)
        return roots[np.argsort(roots.real, kind="stable")]

    def response(self, t: ArrayLike) -> NDArray:
        """The answer to a step of 1 m/s or 1 rad/s at t = 0, from rest.

        Args:
            t: times, shape (...) [s].

        Returns:
            Shape (...) [m/s or rad/s].

        Raises:
            ValueError: a time is negative or not finite.
        """
        t = numbers(t, "t")
        if (t < 0).any():
            raise ValueError(f"t must be 0 s or more, got {t.min()}")
        return 1.0 - self._error(t)

    @cached_property
    def overshoot(self) -> float:
        """M_p: by how much the response exceeds the step, as a share of it; 0 if it does not."""
        peak = self._peak_time()
        return 0.0 if peak is None else max(0.0, -float(self._error(np.array(peak))))

    @cached_property
    def _apart(self) -> NDArray:
        """The poles, a double one parted by a millionth, which moves the response by its square."""
        fast, slow = self.poles
        if abs(fast - slow) < 1e-6 * abs(fast):
            return np.array([fast * (1 + 1e-6), slow * (1 - 1e-6)])
        return self.poles

    def _error(self, t: NDArray) -> NDArray:
        fast, slow = self._apart
        apart = fast - slow
        mixed = (fast + self.damping / self.inertia) * np.expm1(apart * t) / apart
        return (np.exp(slow * t) * (1.0 + mixed)).real

    def _peak_time(self) -> float | None:
        """When the response first turns back [s]; None if it never does."""
        fast, slow = self._apart
        turn = self.damping / self.inertia
        ratio = slow * (slow + turn) / (fast * (fast + turn))
        if self.ki == 0 or ratio == 0:
            return None
        if abs(fast.imag) > 0:
            angle = np.angle(ratio) / (fast - slow).imag
            period = pi / abs(fast.imag)
            return float(angle % period)
        return float(log(ratio.real) / (fast - slow).real) if 0 < ratio.real < 1 else None


class TravelModel(NamedTuple):
    """The two loops of the machine: `translation` in m/s and N, `rotation` in rad/s and N m."""

    translation: StepModel
    rotation: StepModel


def model(machine: Machine = BACKHOE, q: ArrayLike = POSTURE) -> TravelModel:
    """Both velocity loops of the machine as a mass and an inertia under the PI of Table 3.2.

    The machine turns about the middle of its tracks, where their friction holds it, and the belts
    run along. Limits of the drives and Coulomb's friction are left out: with the printed gains a
    step of 1 m/s asks each track for 120 kN, more than drive or ground give.

    Args:
        machine: its numbers.
        q: the arm's posture, shape (4,) [rad]; default `POSTURE`.

    Raises:
        ValueError: q is not 4 finite angles.
    """
    tracks = machine.tracks
    inertia, com = yaw_inertia(q, machine)
    about_tracks = inertia + machine.mass * float(com @ com)
    belts = 2 * tracks.belt_mass
    masses = machine.mass + belts, about_tracks + belts * (tracks.gauge / 2) ** 2
    loops = zip(masses, (2.0, tracks.gauge), GAINS.kp, GAINS.ki, strict=True)
    return TravelModel(*(StepModel(mass, share * p, share * i) for mass, share, p, i in loops))


def yaw_inertia(q: ArrayLike = POSTURE, machine: Machine = BACKHOE) -> tuple[float, NDArray]:
    """Yaw inertia of the whole machine about its centre of mass, and where that is.

    Args:
        q: the arm's posture, shape (4,) [rad]; default `POSTURE`.
        machine: its numbers.

    Returns:
        The inertia [kg m^2], and x, y of the centre of mass in the vehicle frame, shape (2,) [m].

    Raises:
        ValueError: q is not 4 finite angles.
    """
    q = numbers(q, "q", (4,), meaning="joints swing, boom, stick, bucket")
    swing, offset = machine.swing, machine.base.offset
    carried = machine.mass - machine.tracks.mass
    above = carried - swing.mass
    reach = dynamics.gravity_torque(q, replace(machine, gravity=1.0))[1] + above * swing.offset
    outward = reach + swing.mass * swing.com_radius * cos(swing.com_angle)
    leftward = swing.mass * swing.com_radius * sin(swing.com_angle)
    heading = q[0] + pi / 2
    moment = np.array(
        [
            carried * offset + outward * cos(heading) - leftward * sin(heading),
            outward * sin(heading) + leftward * cos(heading),
        ]
    )
    about_axis = dynamics.mass_matrix(q, machine)[0, 0]
    about_origin = (
        about_axis
        + 2 * offset * (moment[0] - carried * offset)
        + carried * offset**2
        + machine.tracks.yaw_inertia
    )
    com = moment / machine.mass
    return float(about_origin - machine.mass * com @ com), com
