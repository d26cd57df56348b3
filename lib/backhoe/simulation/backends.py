"""Opening a simulation: in PyBullet where it is installed, else on the exact equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from backhoe.basics.inputs import choice
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation import bullet
from backhoe.simulation.protocol import World
from backhoe.simulation.scene import LOADING, Scene
from backhoe.simulation.soil import SoilParameters
from backhoe.vehicle.motor import Motor, WheelGains
from backhoe.vehicle.skid_steer import HUSKY, Vehicle

if TYPE_CHECKING:
    from backhoe.simulation.rover import Rover

BACKENDS = ("auto", "pybullet", "analytic")

FALLBACK = (
    "PyBullet is not installed: going on with the analytic backend "
    "(same dynamics and soil; no contacts, no cameras)."
)

_announced = False


def announce_fallback() -> None:
    """Say, once in a program, that PyBullet is missing and what goes on without it."""
    global _announced
    if not _announced:
        print(FALLBACK)
    _announced = True


def open_world(
    machine: Machine = BACKHOE,
    *,
    backend: str = "auto",
    scene: Scene = LOADING,
    seed: int = 0,
    q: ArrayLike | None = None,
    soil: bool | str | SoilParameters = True,
    base: str = "tracks",
    friction: bool = True,
) -> World:
    """Open a simulation; use it in a `with` statement or close it yourself.

    Args:
        machine: the machine's numbers.
        backend: "pybullet", "analytic", or "auto" for PyBullet where it is installed; the fallback
            says so in one line, the first time.
        scene: the ground's heaps and the truck.
        seed: of the bumps on the heaps; the same seed and inputs repeat bit for bit.
        q: joint angles at the start, shape (4,) [rad]; default arm forward and folded.
        soil: True for a moist sandy loam, a name in `soil.SOILS` such as "clay loam", or
            `soil.SoilParameters` of your own; False for ground that cannot be dug.
        base: "tracks" for a machine held by the friction of its tracks, "fixed" for one that
            cannot move, as in the lesson on dynamics.
        friction: whether the joints have the machine's viscous and Coulomb friction.

    Returns:
        The simulation; `protocol.World` lists what it offers.

    Raises:
        TypeError: machine or scene is something else.
        ValueError: an unknown backend, base or soil, q not 4 finite angles, seed not a whole
            number.
        ImportError: PyBullet is asked for and not installed.
    """
    backend = _backend(backend)
    if backend == "pybullet":
        from backhoe.simulation.world import BulletWorld as Opened
    else:
        from backhoe.simulation.analytic import AnalyticWorld as Opened
    return Opened(machine, scene, seed, q, soil, base, friction)


def open_rover(
    vehicle: Vehicle = HUSKY,
    *,
    driven: str = "all",
    backend: str = "auto",
    contacts: str = "library",
    dt: float = 0.02,
    pose: ArrayLike | None = None,
    motor: Motor | None = None,
    gains: WheelGains | None = None,
    wheel_controller: Callable | None = None,
    half_track: float | None = None,
) -> Rover:
    """Open a robot on four wheels, generated from its description, on flat ground.

    Args:
        vehicle: its description.
        driven: wheels with a motor, "all" or "front".
        backend: "pybullet", "analytic", or "auto" for PyBullet where it is installed.
        contacts: whose friction turns it in PyBullet: "library" for the slipping model's, "bullet"
            for PyBullet's own, for comparison (see `rover`).
        dt: sample time of `Rover.step`, a whole multiple of 1 ms [s].
        pose: x, y, heading at the start, shape (3,) [m, m, rad].
        motor, gains, wheel_controller, half_track: as for `rover.Rover`.

    Returns:
        The rover: a plant for trackers, with `pose`, `twist`, `time`, `dt`, `step(v, omega)`.

    Raises:
        TypeError: vehicle is none, or wheel_controller cannot be called.
        ValueError: an unknown backend or kind of contacts, PyBullet's contacts without PyBullet, or
            an argument of `rover.Rover` that is malformed.
        ImportError: PyBullet is asked for and not installed.
    """
    choice(contacts, "contacts", ("library", "bullet"))
    backend = _backend(backend)
    if backend == "analytic":
        if contacts == "bullet":
            raise ValueError('contacts="bullet" needs PyBullet: the analytic backend has none')
        from backhoe.simulation.rover import AnalyticRover as Opened
    elif contacts == "bullet":
        from backhoe.simulation.rover_bullet import ContactRover as Opened
    else:
        from backhoe.simulation.rover_bullet import BulletRover as Opened
    return Opened(vehicle, driven, dt, pose, motor, gains, wheel_controller, half_track)


def _backend(backend: str) -> str:
    """The backend's name, "auto" resolved.

    Raises:
        ValueError: there is no such backend.
    """
    choice(backend, "backend", BACKENDS)
    if backend != "auto":
        return backend
    try:
        bullet.pybullet()
        return "pybullet"
    except ImportError:
        announce_fallback()
        return "analytic"
