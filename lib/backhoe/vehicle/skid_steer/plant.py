"""One vehicle, driven sample by sample: what a tracker of lesson 05 steers.

The same models as `simulation`, with the same answers, for commands that depend on what happened.
"""

from __future__ import annotations

from math import cos, exp, expm1, isfinite, sin
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.vehicle.skid_steer.kinematics import half_track_of
from backhoe.vehicle.skid_steer.linear_model import rates
from backhoe.vehicle.skid_steer.simulation import MODELS, NO_OPTIONS
from backhoe.vehicle.skid_steer.vehicle import DRIVEN, HUSKY, Vehicle

if TYPE_CHECKING:
    from backhoe.vehicle.motor import Motor, WheelGains

_NODES, _WEIGHTS = (tuple(x.tolist()) for x in np.polynomial.legendre.leggauss(4))


class Plant:
    """A vehicle at rest at a pose, waiting for commands.

    Args:
        vehicle: its numbers.
        dt: time that a step takes [s].
        model: "kinematic", "linear" or "slipping".
        pose: X, Y, theta at the start, shape (3,) [m, m, rad].
        half_track, motor, gains, driven: of the slipping model, as for `simulate`.
        tolerance: of the slipping model's integrator, see `slipping.advance`.

    Attributes:
        time: since the start [s].

    Raises:
        ValueError: a model that there is not, a pose that is not 3 finite numbers, dt not positive,
            or wheels asked of a model that has none.
        TypeError: vehicle is no Vehicle.
    """

    def __init__(
        self,
        vehicle: Vehicle = HUSKY,
        dt: float = 0.02,
        model: str = "kinematic",
        *,
        pose: ArrayLike = (0.0, 0.0, 0.0),
        half_track: float | None = None,
        motor: Motor | None = None,
        gains: WheelGains | None = None,
        driven: str = "all",
        tolerance: float = 1e-5,
    ) -> None:
        if not isinstance(vehicle, Vehicle):
            raise TypeError(f"vehicle must be a Vehicle, such as skid_steer.HUSKY, got {vehicle!r}")
        if model not in MODELS:
            raise ValueError(f"model must be one of {', '.join(MODELS)}, got {model!r}")
        for name, value in (("dt", dt), ("tolerance", tolerance)):
            if not (np.ndim(value) == 0 and isfinite(value) and value > 0):
                raise ValueError(f"{name} must be a positive number, got {value!r}")
        options = (half_track, motor, gains, driven)
        if model != "slipping" and options != NO_OPTIONS:
            raise ValueError(
                f"the {model} model has no wheels that slip or take torque: half_track, motor, "
                'gains and driven go with model="slipping"'
            )
        self.vehicle, self.dt, self.model = vehicle, float(dt), model
        makers = {"kinematic": _Arc, "linear": _Lag, "slipping": _Slip}
        self._motion = makers[model](vehicle, self.dt, *options, tolerance)
        self._start = _pose(pose)
        self.reset()

    def reset(self, pose: ArrayLike | None = None) -> None:
        """Put the vehicle at rest at a pose, the first one unless told, at time 0."""
        first = self._start if pose is None else _pose(pose)
        self.time, self._steps = 0.0, 0
        self._motion.reset(*first.tolist())

    def step(self, v: float, omega: float) -> None:
        """Drive for dt with commanded speeds v [m/s] and omega [rad/s].

        Raises:
            ValueError: a command is not a finite number.
        """
        if not (isfinite(v) and isfinite(omega)):
            raise ValueError(f"v and omega must be finite numbers, got {v!r} and {omega!r}")
        self._motion.step(float(v), float(omega))
        self._steps += 1
        self.time = self._steps * self.dt

    @property
    def pose(self) -> NDArray:
        """X, Y, theta, shape (3,) [m, m, rad], the angle not wrapped."""
        return np.array(self._motion.state[:3])

    @property
    def velocity(self) -> NDArray:
        """v_x, v_y, omega in the vehicle's axes, shape (3,) [m/s, m/s, rad/s]."""
        return np.array(self._motion.state[3:6])

    @property
    def twist(self) -> NDArray:
        """v_x, omega, shape (2,) [m/s, rad/s]."""
        return np.array(self._motion.state[3:6:2])

    @property
    def wheel_speeds(self) -> NDArray:
        """Speeds in the order of `WHEELS`, shape (4,) [rad/s]."""
        return self._motion.wheels()


class _NoSlip:
    """What the kinematic and the linear model share: wheels that only roll."""

    def __init__(self, vehicle: Vehicle, dt: float, *_) -> None:
        self.vehicle, self.dt = vehicle, dt

    def reset(self, x: float, y: float, theta: float) -> None:
        self.state = [x, y, theta, 0.0, 0.0, 0.0]

    def wheels(self) -> NDArray:
        turn = self.vehicle.half_track * self.state[5]
        left, right = self.state[3] - turn, self.state[3] + turn
        return np.array([left, right, left, right]) / self.vehicle.wheel_radius

    def _keep(self, moved: complex, theta: float, v: float, omega: float) -> None:
        x, y, before = self.state[:3]
        x_icr = self.vehicle.x_icr
        x += moved.real - x_icr * (cos(theta) - cos(before))
        y += moved.imag - x_icr * (sin(theta) - sin(before))
        self.state = [x, y, theta, v, -x_icr * omega, omega]


class _Arc(_NoSlip):
    """The twist is the command: an arc of a circle a step."""

    def step(self, v: float, omega: float) -> None:
        theta, turn = self.state[2], omega * self.dt
        chord = v * self.dt * (2 * sin(turn / 2) / turn if turn else 1.0)
        middle = theta + turn / 2
        self._keep(complex(chord * cos(middle), chord * sin(middle)), theta + turn, v, omega)


class _Lag(_NoSlip):
    """The twist follows its command with the linear model's lags and errors."""

    def __init__(self, vehicle: Vehicle, dt: float, *_) -> None:
        super().__init__(vehicle, dt)
        k = rates(vehicle)
        self.rate = k.drive_v + k.drag_v, k.drive_omega + k.drag_omega
        self.gain = k.drive_v / self.rate[0], k.drive_omega / self.rate[1]
        times = [dt / 2 * (1 + node) for node in _NODES]
        self.nodes = [
            (dt / 2 * weight, t, exp(-self.rate[0] * t), -expm1(-self.rate[1] * t) / self.rate[1])
            for weight, t in zip(_WEIGHTS, times, strict=True)
        ]
        self.decay = exp(-self.rate[0] * dt), exp(-self.rate[1] * dt)

    def step(self, v: float, omega: float) -> None:
        theta = self.state[2]
        v, omega = self.gain[0] * v, self.gain[1] * omega
        more_v, more_omega = self.state[3] - v, self.state[5] - omega
        x = y = 0.0
        for weight, t, left, run in self.nodes:
            angle = theta + omega * t + more_omega * run
            moved = weight * (v + more_v * left)
            x += moved * cos(angle)
            y += moved * sin(angle)
        theta += omega * self.dt + more_omega * (1 - self.decay[1]) / self.rate[1]
        new = v + more_v * self.decay[0], omega + more_omega * self.decay[1]
        self._keep(complex(x, y), theta, *new)


class _Slip:
    """Friction at each wheel, with proportional wheel control or with motors."""

    def __init__(self, vehicle, dt, half_track, motor, gains, driven, tolerance) -> None:
        from backhoe.vehicle.skid_steer import kernels
        from backhoe.vehicle.skid_steer.motorised import Drives

        if driven not in DRIVEN:
            raise ValueError(f"driven must be one of {', '.join(DRIVEN)}, got {driven!r}")
        if motor is None and gains is not None:
            raise ValueError("gains are those of the motors' PIDs: give a motor as well")
        self.vehicle, self.dt, self.tolerance = vehicle, dt, tolerance
        self.c = half_track_of(vehicle, half_track)
        self.gain = vehicle.speed_gain * np.array(DRIVEN[driven])
        self.advance, self.room = kernels.advance, kernels.room()
        self.record = kernels.record([vehicle], self.gain)[0]
        self.make_drives = motor and (lambda: Drives([vehicle], motor, gains, driven, dt))

    def reset(self, x: float, y: float, theta: float) -> None:
        self.state = np.zeros(10)
        self.state[:3] = x, y, theta
        self.length = np.full(1, self.dt)
        self.drives = self.make_drives and self.make_drives()

    def step(self, v: float, omega: float) -> None:
        left, right = v - self.c * omega, v + self.c * omega
        reference = np.array([left, right, left, right]) / self.vehicle.wheel_radius
        if self.drives:
            self.drives.advance(self.state[None], reference[None], self.tolerance)
        else:
            drive = self.gain * reference
            self.advance(
                self.state, drive, self.record, self.dt, self.length, self.tolerance, self.room
            )

    def wheels(self) -> NDArray:
        return self.state[6:].copy()


def _pose(pose: ArrayLike) -> NDArray:
    array = real_array(pose, "pose must be numbers")
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"pose must be 3 finite numbers X, Y, theta, got {pose!r}")
    return array
