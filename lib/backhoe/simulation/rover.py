"""A robot on four wheels that turns by slipping: motors, wheel controllers, one plant for trackers.

Once a millisecond each wheel's controller sets its motor's voltage; the motor turns the wheel
against the friction of the ground. Wheel speeds are states of their own, with the rotor behind its
gear, as the belts of the tracks are. The friction is the library's (`skid_steer.slipping`): smooth
Coulomb, one friction for both directions. In PyBullet (`rover_bullet`) it pushes a body of Bullet,
whose contacts give each wheel's load; here, without PyBullet, the loads are those of statics.

PyBullet's own friction is there for comparison (`contacts="bullet"`). Its force has Coulomb's size,
mu N at every heading, but not the direction of the slip: along each of two axes that stay put in
the world it takes the impulse that would stop the slip, slip times the mass that the contact feels
along that axis, and scales the pair down. Along a wheel only wheel and rotor resist, across it the
whole robot. So the effective half track of a Husky that turns in place goes from 0.50 to 0.60 m
with its heading, where Coulomb's law gives 0.515 m; in a curve of 1 m/s and 0.5 rad/s from 0.44 to
0.58 m, not 0.49 m. A rotor behind another gear changes it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, function, instance, number, numbers, positive
from backhoe.simulation.clock import STEP, ticks
from backhoe.simulation.rover_urdf import rover_urdf
from backhoe.vehicle import motor as motors
from backhoe.vehicle.motor import Motor, WheelGains
from backhoe.vehicle.skid_steer import Vehicle, engine
from backhoe.vehicle.tracking import Limits

DRIVEN = {"all": (1.0, 1.0, 1.0, 1.0), "front": (1.0, 1.0, 0.0, 0.0)}
"""Which wheels have a motor."""

GROUP = 5
"""Steps of the wheels for one of a body in PyBullet, if the sample time allows."""

_TOLERANCE = 1e-6
"""Of the wheels' friction over one step."""

_USABLE = 0.9
"""Share of a motor's speed without load that a vehicle can use."""

_CALL = "wheel_controller(reference (4,), measured (4,)) -> voltage (4,)"


class Rover:
    """A four-wheeled robot; a backend may bring a body that the wheels move.

    Wheels are in the order of `skid_steer.WHEELS`: front left, front right, rear left, rear right.

    Args:
        vehicle: its description.
        driven: wheels with a motor, "all" or "front"; the others roll along.
        dt: sample time of `step`, a whole multiple of 1 ms [s].
        pose: x, y, heading at the start, shape (3,) [m, m, rad].
        motor: of each driven wheel; default `motor.ROVER`.
        gains: of the wheels' speed control; default `motor.tune_wheel` on the vehicle's own load.
        wheel_controller: your own in its place: called each millisecond with wanted and measured
            speeds (4,) [rad/s], it returns voltages (4,) [V].
        half_track: that turns omega into wheel speeds; default the vehicle's own, which takes no
            slip into account [m].

    Raises:
        TypeError: vehicle is none, or wheel_controller cannot be called.
        ValueError: driven, dt, pose or half_track is malformed, or gains and wheel_controller are
            both given.
    """

    backend = "none"
    _grouped = True

    def __init__(
        self,
        vehicle: Vehicle,
        driven: str = "all",
        dt: float = 0.02,
        pose: ArrayLike | None = None,
        motor: Motor | None = None,
        gains: WheelGains | None = None,
        wheel_controller: Callable | None = None,
        half_track: float | None = None,
    ) -> None:
        self.vehicle = instance(vehicle, "vehicle", Vehicle)
        self.driven = choice(driven, "driven", DRIVEN)
        self.motor = motors.ROVER if motor is None else motor
        self._motored = np.array(DRIVEN[driven])
        self._ticks = ticks(dt)
        self._group = GROUP if self._ticks % GROUP == 0 and self._grouped else 1
        self.dt = self._ticks * STEP
        half_track = vehicle.half_track if half_track is None else half_track
        self._half_track = positive(half_track, "half_track", "m")
        self._control = self._controller(gains, wheel_controller)
        self._start = _pose(np.zeros(3) if pose is None else pose).copy()
        self._closed = False
        self._open()
        try:
            self.reset()
        except ValueError:
            self.close()
            raise

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._count * STEP

    @property
    def pose(self) -> NDArray:
        """x, y of the centre of mass and heading, (3,) [m, m, rad]; counts on through turns."""
        return self._state[:3].copy()

    @property
    def twist(self) -> NDArray:
        """Forward and turning speed, shape (2,) [m/s, rad/s]."""
        return self._state[[3, 5]]

    @property
    def velocity(self) -> NDArray:
        """Forward, leftward and turning speed, shape (3,) [m/s, m/s, rad/s]."""
        return self._state[3:6].copy()

    @property
    def lateral_speed(self) -> float:
        """Speed of the centre of mass to the left [m/s]."""
        return float(self._state[4])

    @property
    def wheel_speeds(self) -> NDArray:
        """Speeds of the wheels, shape (4,) [rad/s]."""
        return self._state[6:].copy()

    @property
    def wheel_angles(self) -> NDArray:
        """How far the wheels have turned since the start, shape (4,) [rad]."""
        return self._angles.copy()

    @property
    def voltage(self) -> NDArray:
        """Voltages of the motors in the last millisecond, shape (4,) [V]."""
        return self._voltage.copy()

    @property
    def wheel_torque(self) -> NDArray:
        """Torques of the drives on the wheels at the end of the last millisecond, (4,) [N m]."""
        return self._drive - self._damping * self._state[6:]

    @property
    def loads(self) -> NDArray:
        """Weight on each wheel, shape (4,) [N]."""
        return self._loads.copy()

    @property
    def limits(self) -> Limits:
        """Speeds that the wheels can drive; `tracking.follow` keeps to them, turning first."""
        fastest = _USABLE * self.motor.no_load_speed
        return Limits(fastest, self.vehicle.wheel_radius, self._half_track)

    @property
    def urdf(self) -> str:
        """The robot's description as URDF."""
        return rover_urdf(self.vehicle)

    def step(self, v: float, omega: float) -> None:
        """Drive for one sample with wanted forward and turning speed [m/s, rad/s].

        Raises:
            ValueError: v or omega is not finite, or the wheel controller returns no 4 voltages.
            RuntimeError: the rover is closed.
        """
        self._check_open()
        v, omega = number(v, "v", "m/s"), number(omega, "omega", "rad/s")
        turn = self._half_track * omega
        left, right = ((v + side * turn) / self.vehicle.wheel_radius for side in (-1, 1))
        reference = np.array([left, right, left, right])
        self._damping = self._motored * self.motor.damping
        rotors = self._motored * self.motor.rotor_inertia
        for _ in range(self._ticks // self._group):
            start = self._state.copy()
            for _ in range(self._group):
                self._voltage = self._motored * self._control(reference, self._state[6:].copy())
                self._drive = self.motor.torque_per_volt * self._voltage
                self._tick(rotors)
            self._move(start, self._group * STEP)

    def push(self, torque: ArrayLike) -> None:
        """Advance by one step of 1 ms with torques on the bare wheels, without any motor.

        Args:
            torque: shape (4,) [N m].

        Raises:
            ValueError: not 4 finite torques.
            RuntimeError: the rover is closed.
        """
        self._check_open()
        torque = _of_wheels(torque, "torque")
        self._drive, self._damping, self._voltage = torque.copy(), np.zeros(4), np.zeros(4)
        start = self._state.copy()
        self._tick(np.zeros(4))
        self._move(start, STEP)

    def reset(self, pose: ArrayLike | None = None) -> None:
        """Start again at time 0 and at rest.

        Args:
            pose: x, y, heading, shape (3,) [m, m, rad]; default where the rover started.

        Raises:
            ValueError: pose is malformed.
            RuntimeError: the rover is closed.
        """
        self._check_open()
        pose = self._start if pose is None else _pose(pose)
        self._count = 0
        self._state = np.concatenate([pose, np.zeros(7)])
        self._angles, self._voltage = np.zeros(4), np.zeros(4)
        self._drive, self._damping = np.zeros(4), np.zeros(4)
        self._loads = self.vehicle.loads.copy()
        self._fleet, self._length = engine.fleet([self.vehicle]), np.full(1, STEP)
        for controller in self._controllers:
            if callable(getattr(controller, "reset", None)):
                controller.reset()
        self._place()

    def close(self) -> None:
        """Release what the simulation holds; a second call does nothing."""
        if not self._closed:
            self._closed = True
            self._shut()

    def __enter__(self) -> Rover:
        self._check_open()
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    # What a backend brings.

    def _move(self, start: NDArray, seconds: float) -> None:
        """Move the body as the state (10,) went from `start` to the present one."""

    def _place(self) -> None:
        """Put the robot at self._state, at rest."""

    def _open(self) -> None:
        """Prepare the backend."""

    def _shut(self) -> None:
        """Release the backend."""

    def _tick(self, rotors: NDArray) -> None:
        """One step of wheels and body, with rotors of this inertia (4,) at the wheels."""
        before = self._state[6:].copy()
        self._advance(rotors)
        self._angles += STEP / 2 * (before + self._state[6:])
        self._count += 1

    def _advance(self, rotors: NDArray) -> None:
        fleet, state, drive = self._fleet, self._state[None], self._drive[None]
        fleet.damping[0], fleet.load[0] = self._damping, self._loads
        fleet.spin[0] = self.vehicle.wheel_inertia + rotors
        engine.advance(state, drive, fleet, STEP, self._length, _TOLERANCE)

    def _controller(self, gains: WheelGains | None, own: Callable | None) -> Callable:
        if own is not None:
            if gains is not None:
                raise ValueError("give gains or wheel_controller, not both")
            self._controllers = [function(own, "wheel_controller", _CALL)]
            return lambda reference, measured: _of_wheels(
                own(reference.copy(), measured), f"the answer of {_CALL}"
            )
        if gains is None:
            driven = int(self._motored.sum())
            gains = motors.tune_wheel(self.motor, motors.vehicle_load(self.vehicle, driven))
        pids = self._controllers = [motors.wheel_pid(self.motor, gains) for _ in range(4)]

        def control(reference: NDArray, measured: NDArray) -> NDArray:
            pairs = zip(pids, reference.tolist(), measured.tolist(), strict=True)
            return np.array([pid(*pair) for pid, *pair in pairs])

        return control

    def _check_open(self) -> None:
        if self._closed:
            raise RuntimeError("this rover is closed: open a new one with simulation.open_rover()")


class AnalyticRover(Rover):
    """A `Rover` that moves in the plane by the slipping model alone; arguments as there."""

    backend = "analytic"


_pose = partial(numbers, name="pose", shape=(3,), meaning="x, y, heading")
_of_wheels = partial(numbers, shape=(4,), meaning="one a wheel")
