"""How the machine and the truck look: coloured triangle meshes, sized from the machine's numbers.

Each mesh lives in the Denavit-Hartenberg frame of its link (the undercarriage in the vehicle
frame), so a pose of that frame places it: the renderer, the replay and the plots all read these.
In the frames of swing, boom, stick and bucket x runs along the link, y upwards and z to the right
when the arm points forward. The shapes are our drawing; the joints lie where the machine has them.
"""

from __future__ import annotations

from backhoe.machine import BACKHOE, Machine
from backhoe.view.appearance import arm, carrier
from backhoe.view.appearance.arm import struts
from backhoe.view.appearance.load import bucket_load
from backhoe.view.appearance.rover import rover_body, rover_wheel
from backhoe.view.appearance.truck import truck_boxes, truck_visuals
from backhoe.view.appearance.visual import Strut, Visual

__all__ = [
    "Strut",
    "Visual",
    "bucket_load",
    "rover_body",
    "rover_wheel",
    "struts",
    "truck_boxes",
    "truck_visuals",
    "visuals",
]


def visuals(machine: Machine = BACKHOE) -> dict[str, tuple[Visual, ...]]:
    """The machine's meshes by link: undercarriage, swing, boom, stick, bucket.

    The undercarriage is in the vehicle frame (x forward, z up), the others in frames 1 to 4.
    """
    return {
        "undercarriage": carrier.undercarriage(machine),
        "swing": carrier.house(machine),
        "boom": arm.boom(machine),
        "stick": arm.stick(machine),
        "bucket": arm.bucket(machine),
    }
