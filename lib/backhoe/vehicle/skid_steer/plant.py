"""One vehicle, driven sample by sample: what a tracker steers.

The same models as `runs`, with the same answers, for commands that depend on what happened.
"""

from __future__ import annotations

from math import cos, exp, expm1, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers, positive
from backhoe.vehicle.motor import Motor, WheelGains
from backhoe.vehicle.skid_steer import no_slip
from backhoe.vehicle.skid_steer.kinematics import half_track_of
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle
from backhoe.vehicle.skid_steer.wheel_control import WheelControl, check_control, controlled_wheels


class SkidSteerPlant:
    """A vehicle at rest at a pose, waiting for commands.

    Args:
        vehicle: its numbers.
        dt: time that a step takes [s].
        model: "kinematic", "linear" or "slipping".
        pose: X, Y, theta at the start, shape (3,) [m, m, rad].
        half_track, motor, gains, driven, tolerance: of the slipping model, as for `simulate`.

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
        self.vehicle = instance(vehicle, "vehicle", Vehicle, "such as skid_steer.HUSKY")
        self.dt, self.model = positive(dt, "dt", "s"), model
        control = WheelControl(half_track, motor, gains, driven)
        check_control(model, control)
        if model == "slipping":
            self._motion = _Slip(vehicle, self.dt, control, positive(tolerance, "tolerance"))
        else:
            self._motion = _NoSlip(vehicle, self.dt, model)
        self._start = pose
        self.reset()

    def reset(self, pose: ArrayLike | None = None) -> None:
        """Put the vehicle at rest at a pose, at time 0.

        Args:
            pose: X, Y, theta, shape (3,) [m, m, rad]; None for the first one.
        """
        first = numbers(self._start if pose is None else pose, "pose", (3,), meaning="X, Y, theta")
        self.time, self._steps = 0.0, 0
        self._motion.reset(*first.tolist())

    def step(self, v: float, omega: float) -> None:
        """Drive for dt with commanded speeds v [m/s] and omega [rad/s].

        Raises:
            ValueError: a command is not a finite number.
        """
        self._motion.step(number(v, "v", "m/s"), number(omega, "omega", "rad/s"))
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


class _NoSlip:
    """The kinematic and the linear model: wheels that only roll; the formulas are in `no_slip`."""

    def __init__(self, vehicle: Vehicle, dt: float, model: str) -> None:
        gain, rate = no_slip.gain_and_rate([vehicle], model)
        self.gain, (rate_v, rate_omega) = gain.ravel().tolist(), rate.ravel().tolist()
        self.x_icr = vehicle.x_icr
        instants = zip(no_slip.WEIGHTS.tolist(), (dt * (no_slip.NODES + 0.5)).tolist(), strict=True)
        self.nodes = [
            (dt * weight, t, exp(-rate_v * t), -expm1(-rate_omega * t) / rate_omega)
            for weight, t in instants
        ]
        self.end = dt, -expm1(-rate_omega * dt) / rate_omega
        self.decay = exp(-rate_v * dt), exp(-rate_omega * dt)

    def reset(self, x: float, y: float, theta: float) -> None:
        self.state = [x, y, theta, 0.0, 0.0, 0.0]

    def step(self, v: float, omega: float) -> None:
        x, y, before, v_x, _, turning = self.state
        v, omega = self.gain[0] * v, self.gain[1] * omega
        more_v, more_omega = v_x - v, turning - omega
        for weight, t, left, run in self.nodes:
            angle = before + omega * t + more_omega * run
            moved = weight * (v + more_v * left)
            x += moved * cos(angle)
            y += moved * sin(angle)
        theta = before + omega * self.end[0] + more_omega * self.end[1]
        v, omega = v + more_v * self.decay[0], omega + more_omega * self.decay[1]
        x -= self.x_icr * (cos(theta) - cos(before))
        y -= self.x_icr * (sin(theta) - sin(before))
        self.state = [x, y, theta, v, -self.x_icr * omega, omega]


class _Slip:
    """Friction at each wheel, with proportional wheel control or with motors."""

    def __init__(
        self, vehicle: Vehicle, dt: float, control: WheelControl, tolerance: float
    ) -> None:
        self.radius, self.c = vehicle.wheel_radius, half_track_of(vehicle, control.half_track)
        self.fresh_wheels = lambda: controlled_wheels([vehicle], control, dt, tolerance)

    def reset(self, x: float, y: float, theta: float) -> None:
        self.wheels = self.fresh_wheels()
        self.states = np.zeros((1, 10))
        self.states[0, :3] = x, y, theta
        self.state = self.states[0]

    def step(self, v: float, omega: float) -> None:
        turn = self.c * omega
        reference = np.array([[v - turn, v + turn] * 2]) / self.radius
        self.wheels.advance(self.states, reference)
