"""Render machine.png: the second bucket, full and on its way up from the heap."""

from pathlib import Path

from PIL import Image

from backhoe import mission, simulation
from backhoe.arm import pid
from backhoe.machine import BACKHOE

MOMENT = 35.0
"""Time of the picture [s]."""


class Photographer:
    """The library's controller, with a camera that goes off once."""

    def __init__(self, world):
        self.world, self.picture = world, None
        self.controller = pid.PID(*pid.ARM_GAINS, BACKHOE.torque_limit)

    def __call__(self, *state):
        if self.picture is None and self.world.time >= MOMENT:
            self.picture = self.world.render(1000, 500, eye=(9.8, -7.6, 4.2), samples=2)
        return self.controller(*state)


with simulation.open_world() as world:
    photographer = Photographer(world)
    mission.run(world=world, controller=photographer, cycles=2)
Image.fromarray(photographer.picture).save(Path(__file__).with_suffix(".png"), optimize=True)
