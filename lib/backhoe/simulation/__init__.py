"""The simulated machine: PyBullet where it is installed, the exact equations where it is not.

    with simulation.open_world() as world:
        world.step(torque)

`protocol.World` lists all that a world offers. `open_rover` opens a robot on four wheels.
"""

from backhoe.simulation.backends import BACKENDS, open_rover, open_world
from backhoe.simulation.protocol import World
from backhoe.simulation.scene import FLAT, LOADING, Scene
from backhoe.simulation.standing import Least, Tipped
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.simulation.whole_body_plant import WholeBodyPlant

__all__ = [
    "BACKENDS",
    "FLAT",
    "LOADING",
    "Least",
    "Scene",
    "Tipped",
    "TrackedPlant",
    "WholeBodyPlant",
    "World",
    "open_rover",
    "open_world",
]
