"""What every simulated world offers: the whole interface, readable in a minute.

A third backend is a class with these names; `loop.Loop` brings all but the integration.
"""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike, NDArray

from backhoe.machine import Machine
from backhoe.simulation.scene import Scene
from backhoe.simulation.soil import Ground
from backhoe.simulation.standing import Least


class World(Protocol):
    """One simulated machine. SI units, angles in rad; world frame with x forward, y left, z up."""

    backend: str  # "pybullet" or "analytic"
    machine: Machine
    scene: Scene
    seed: int  # of the bumps on the heaps
    dt: float  # one step [s]
    ground: Ground | None  # None without soil

    @property
    def time(self) -> float:
        """Simulated time [s]."""

    @property
    def q(self) -> NDArray:
        """Joint angles swing, boom, stick, bucket, shape (4,) [rad]."""

    @property
    def dq(self) -> NDArray:
        """Joint speeds, shape (4,) [rad/s]."""

    @property
    def pose(self) -> NDArray:
        """Vehicle's x, y, yaw, shape (3,) [m, m, rad]; yaw counts on through full turns."""

    @property
    def twist(self) -> NDArray:
        """Rates of the pose, in the world frame, shape (3,) [m/s, m/s, rad/s]."""

    @property
    def belts(self) -> NDArray:
        """Speed of the left and right belt, shape (2,) [m/s]."""

    @property
    def traction(self) -> NDArray:
        """Forces that the drives gave the tracks in the last step, left and right, (2,) [N]."""

    @property
    def torque(self) -> NDArray:
        """Joint torques that the actuators gave in the last step, shape (4,) [N m]."""

    @property
    def soil_force(self) -> NDArray:
        """Force of the soil on the bucket's tip in the last step, world frame, shape (3,) [N]."""

    @property
    def zero_moment_point(self) -> NDArray:
        """Where the ground carried the machine in the last step, in its own axes, (2,) [m]; NaN
        where nothing presses on the tracks."""

    @property
    def margin(self) -> float:
        """From that point to the nearest edge of the tracks' support polygon [m]; see
        `whole_body.stability`."""

    @property
    def edge(self) -> str:
        """Which edge that is: "front", "left", "rear" or "right"."""

    @property
    def least_margin(self) -> Least:
        """The least margin since the start [m], when and to which edge."""

    def step(
        self,
        torque: ArrayLike,
        belts: ArrayLike = (0.0, 0.0),
        *,
        traction: ArrayLike | None = None,
    ) -> None:
        """Advance by one `dt` with wanted joint torques, shape (4,) [N m], and belts.

        The belts, left and right, run at speeds, shape (2,) [m/s]; or `traction` drives them, (2,)
        [N].
        """

    def reset(self, q: ArrayLike | None = None, pose: ArrayLike | None = None) -> None:
        """Start again at time 0, at rest, on untouched ground.

        Joint angles q, shape (4,) [rad]; pose x, y, yaw, shape (3,) [m, m, rad].
        """

    def snapshot(self) -> object:
        """Everything that the future depends on."""

    def restore(self, snapshot: object) -> None:
        """Go back to a snapshot of this simulation; what follows repeats bit for bit."""

    def render(self, width: int = 640, height: int = 480, **view: object) -> NDArray:
        """A picture, shape (height, width, 3) [1]; RuntimeError in a backend without cameras."""

    def close(self) -> None:
        """Release what the simulation holds; closing twice is allowed."""

    def __enter__(self) -> World: ...

    def __exit__(self, *error: object) -> None: ...
