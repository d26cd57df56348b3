"""What a mass under a PI does at a step: overshoot, settling time, and which mass gives them.

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
from math import cos, exp, inf, isfinite, log, pi, sin
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.basics.inputs import real_array
from backhoe.machine import BACKHOE, Machine, replace
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.vehicle.travel.velocity import GAINS, VelocityPI

if TYPE_CHECKING:
    import control

_SAMPLES = 20_000


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
        for name in ("inertia", "kp", "ki", "damping"):
            value = getattr(self, name)
            least = "positive" if name in ("inertia", "kp") else "0 or more"
            if not isfinite(value) or value < 0 or (value == 0 and least == "positive"):
                raise ValueError(f"StepModel.{name} must be {least} and finite, got {value!r}")

    @cached_property
    def poles(self) -> NDArray:
        """Poles of the closed loop, the faster one first, shape (2,), complex [1/s]."""
        roots = np.roots([self.inertia, self.damping + self.kp, self.ki]).astype(complex)
        return roots[np.argsort(roots.real, kind="stable")]

    def response(self, t: ArrayLike) -> NDArray:
        """The answer to a step of 1 at t = 0, from rest, shape of t.

        Raises:
            ValueError: a time is negative or not finite.
        """
        return 1.0 - self._error(_times(t))

    def effort(self, t: ArrayLike) -> NDArray:
        """What the PI asks for during the step [N or N m for 1 m/s or 1 rad/s], shape of t."""
        t = _times(t)
        fast, slow = self._apart
        turn = self.damping / self.inertia
        slope = (
            fast * (fast + turn) * np.exp(fast * t) - slow * (slow + turn) * np.exp(slow * t)
        ) / (fast - slow)
        return self.damping * (1.0 - self._error(t)) - self.inertia * slope.real

    @cached_property
    def overshoot(self) -> float:
        """M_p: by how much the response exceeds the step, as a share of it; 0 if it does not."""
        peak = self._peak_time()
        return 0.0 if peak is None else max(0.0, -float(self._error(np.array(peak))))

    def settling_time(self, band: float = 0.02) -> float:
        """t_s: time after which the response stays within `band` of the step [s].

        Inf if it never does, as without an integral against damping.

        Raises:
            ValueError: band is not between 0 and 1.
        """
        if not 0 < band < 1:
            raise ValueError(f"band must be a share between 0 and 1, got {band!r}")
        if self.ki == 0 and self.damping / (self.damping + self.kp) > band:
            return inf
        rate = -self.poles.real.max() if self.ki > 0 else -self.poles.real.min()
        t = np.linspace(0.0, (log(1 / band) + 6.0) / rate, _SAMPLES)
        outside = np.flatnonzero(np.abs(self._error(t)) > band)[-1]
        low, high = t[outside], t[outside + 1]
        for _ in range(60):
            middle = (low + high) / 2
            late = abs(float(self._error(np.array(middle)))) > band
            low, high = (middle, high) if late else (low, middle)
        return float(high)

    def transfer(self) -> control.TransferFunction:
        """The closed loop as a named `control.TransferFunction`."""
        import control

        numerator, denominator = [self.kp, self.ki], [self.inertia, self.damping + self.kp, self.ki]
        return control.tf(
            numerator, denominator, inputs=["reference"], outputs=["speed"], name="velocity loop"
        )

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


def model(
    machine: Machine = BACKHOE,
    q: ArrayLike = POSTURE,
    kp: ArrayLike = GAINS.kp,
    ki: ArrayLike = GAINS.ki,
    *,
    damping: tuple[float, float] = (0.0, 0.0),
) -> TravelModel:
    """Both velocity loops of the machine as a mass and an inertia under a PI.

    The machine turns about the middle of its tracks, where their friction holds it, and the belts
    run along. Limits of the drives and Coulomb's friction are left out: with the printed gains a
    step of 1 m/s asks each track for 120 kN, more than drive or ground give.

    Args:
        machine: its numbers.
        q: the arm's posture, shape (4,) [rad]; default `POSTURE`.
        kp, ki: as for `VelocityPI`; default Table 3.2.
        damping: of translation [N s/m] and rotation [N m s/rad].

    Raises:
        ValueError: gains or damping that are negative, or q not 4 finite angles.
    """
    loops = VelocityPI(kp, ki, machine=machine)
    tracks = machine.tracks
    inertia, com = yaw_inertia(q, machine)
    about_tracks = inertia + machine.mass * float(com @ com)
    belts = 2 * tracks.belt_mass
    masses = machine.mass + belts, about_tracks + belts * (tracks.gauge / 2) ** 2
    shares = 2.0, tracks.gauge
    return TravelModel(
        *(
            StepModel(mass, share * float(p), share * float(i), float(d))
            for mass, share, p, i, d in zip(
                masses, shares, loops.kp, loops.ki, damping, strict=True
            )
        )
    )


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
    q = np.asarray(q, dtype=float)
    if q.shape != (4,):
        raise ValueError(f"q must be 4 joint angles, got shape {q.shape}")
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


def inertia_for(
    kp: float,
    ki: float,
    *,
    overshoot: float | None = None,
    settling: float | None = None,
    band: float = 0.02,
) -> float:
    """The smallest inertia whose undamped step has a given overshoot or settling time.

    Args:
        kp, ki: gains as they act on the inertia (twice the printed ones in translation).
        overshoot: M_p as a share of the step; or
        settling: t_s [s], to stay within `band`.

    Returns:
        The inertia [kg or kg m^2].

    Raises:
        ValueError: not exactly one of the two, or no inertia gives it.
    """
    if (overshoot is None) == (settling is None):
        raise ValueError("give either overshoot or settling")
    grid = kp**2 / ki * np.geomspace(1e-4, 1e4, 1601)

    def miss(inertia: float) -> float:
        loop = StepModel(float(inertia), kp, ki)
        if settling is None:
            return loop.overshoot - overshoot
        return loop.settling_time(band) - settling

    values = [miss(inertia) for inertia in grid]
    for below, above, low, high in zip(grid, grid[1:], values, values[1:], strict=False):
        if low <= 0 < high:
            for _ in range(60):
                middle = exp((log(below) + log(above)) / 2)
                below, above = (middle, above) if miss(middle) <= 0 else (below, middle)
            if miss(above) - miss(below) < 1e-3:
                return float(below)
    wanted = f"overshoot {overshoot}" if settling is None else f"settling time {settling} s"
    raise ValueError(f"no inertia gives {wanted} with kp = {kp:g} and ki = {ki:g}")


def _times(t: ArrayLike) -> NDArray:
    t = real_array(t, "t must be times [s]")
    if not np.isfinite(t).all() or (t < 0).any():
        raise ValueError("t must be finite times of 0 s or more")
    return t
