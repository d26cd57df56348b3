"""The rover: a box on four wheels with treads, a deck and a stripe that shows where forward is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from backhoe.view.appearance.visual import DARK, LIGHT, RUBBER, STEEL, YELLOW, Visual, visual
from backhoe.view.shapes import box, cylinder

if TYPE_CHECKING:
    from backhoe.vehicle.skid_steer import Vehicle

_TREADS = 12


def rover_body(vehicle: Vehicle) -> tuple[Visual, ...]:
    """The body in the robot's frame: on the ground below the centre of mass, x forward."""
    p = vehicle
    x, y = p.body_length / 2, p.body_width / 2
    low, high = p.clearance, p.clearance + p.body_height
    deck = box((-0.9 * x, -0.9 * y, high), (0.75 * x, 0.9 * y, high + 0.02))
    nose = box((0.8 * x, -0.5 * y, high), (0.98 * x, 0.5 * y, high + 0.03))
    bumpers = [
        box((side * x, -y, low + 0.04), (side * (x + 0.04), y, low + 0.10)) for side in (-1, 1)
    ]
    axles = [
        cylinder((at, -p.half_track, p.wheel_radius), (at, p.half_track, p.wheel_radius), 0.025)
        for at in (p.front, -p.rear)
    ]
    return (
        visual(YELLOW, box((-x, -y, low), (x, y, high))),
        visual(DARK, deck, *bumpers),
        visual(LIGHT, nose),
        visual(STEEL, *axles),
    )


def rover_wheel(vehicle: Vehicle) -> tuple[Visual, ...]:
    """A wheel in its own frame: z along its axle."""
    r, half = vehicle.wheel_radius, vehicle.wheel_width / 2
    angle = np.arange(_TREADS) * 2 * np.pi / _TREADS
    treads = []
    for a in angle:
        vertices, faces = box((0.93 * r, -0.09 * r, -half), (r, 0.09 * r, half))
        c, s = np.cos(a), np.sin(a)
        treads.append((vertices @ [[c, s, 0], [-s, c, 0], [0, 0, 1]], faces))
    spokes = [
        box((-0.5 * r, -0.07 * r, side * half), (0.5 * r, 0.07 * r, side * 1.06 * half))
        for side in (-1, 1)
    ]
    return (
        visual(RUBBER, cylinder((0, 0, -0.96 * half), (0, 0, 0.96 * half), 0.94 * r, 24), *treads),
        visual(STEEL, cylinder((0, 0, -1.02 * half), (0, 0, 1.02 * half), 0.55 * r, 20)),
        visual(YELLOW, *spokes),
    )
