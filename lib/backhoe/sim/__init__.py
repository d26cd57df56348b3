"""The simulated machine: PyBullet where it is installed, the exact equations where it is not.

    with sim.open_world() as world:
        world.step(torque)

`protocol.Simulation` lists all that a world offers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from backhoe.machine import BACKHOE, Machine
from backhoe.sim.protocol import Simulation
from backhoe.sim.scene import FLAT, LOADING, Scene

if TYPE_CHECKING:
    from backhoe.sim.loop import Loop

__all__ = ["BACKENDS", "FLAT", "LOADING", "Simulation", "open_world"]

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
    soil: bool = True,
    base: str = "tracks",
    friction: bool = True,
) -> Loop:
    """Open a simulation; use it in a `with` statement or close it yourself.

    Args:
        machine: the machine's numbers.
        backend: "pybullet", "analytic", or "auto" for PyBullet where it is installed; the fallback
            says so in one line, the first time.
        scene: the ground's heaps and the truck.
        seed: of the bumps on the heaps; the same seed and inputs repeat bit for bit.
        q: joint angles at the start, shape (4,) [rad]; default arm forward and folded.
        soil: whether the ground can be dug.
        base: "tracks" for a machine held by the friction of its tracks, "fixed" for one that
            cannot move, as in the lesson on dynamics.
        friction: whether the joints have the machine's viscous and Coulomb friction.

    Returns:
        The simulation; `protocol.Simulation` lists what it offers.

    Raises:
        TypeError: machine or scene is something else.
        ValueError: an unknown backend or base, q not 4 finite angles, seed not a whole number.
        ImportError: PyBullet is asked for and not installed.
    """
    if backend not in BACKENDS:
        raise ValueError(f"unknown backend {backend!r}: the backends are {', '.join(BACKENDS)}")
    if backend == "auto":
        from backhoe.sim import bullet

        try:
            bullet.pybullet()
            backend = "pybullet"
        except ImportError:
            announce_fallback()
            backend = "analytic"
    if backend == "pybullet":
        from backhoe.sim.world import BulletWorld as World
    else:
        from backhoe.sim.analytic import AnalyticWorld as World
    return World(machine, scene, seed, q, soil, base, friction)
