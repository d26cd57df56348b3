"""Undercarriage and house: what carries the arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.machine import Machine
from backhoe.view.appearance.visual import DARK, GLASS, RUBBER, STEEL, YELLOW, Visual, visual
from backhoe.view.shapes import Mesh, beam, box, cylinder, join, mirror, prism


def undercarriage(machine: Machine) -> tuple[Visual, ...]:
    tracks, base = machine.tracks, machine.base
    y, half_shoe = tracks.gauge / 2, tracks.shoe_width / 2
    radius = tracks.height / 2
    belt = _side(_stadium(tracks.length / 2, radius), y - half_shoe, y + half_shoe)
    frame = _side(
        _stadium(tracks.length / 2, radius * 0.55), y - 0.7 * half_shoe, y + 1.12 * half_shoe
    )
    hubs = [
        cylinder((x, y + 1.1 * half_shoe, radius), (x, y + 1.3 * half_shoe, radius), 0.4 * radius)
        for x in (-tracks.length / 2, tracks.length / 2)
    ]
    grousers = [
        box((x, y - 1.04 * half_shoe, z), (x + 0.06, y + 1.04 * half_shoe, z + 0.05))
        for x in np.linspace(-tracks.length / 2, tracks.length / 2 - 0.06, 9)
        for z in (-0.02, tracks.height - 0.03)
    ]
    ring = (base.offset, 0.0)
    middle = box(
        (-0.32 * tracks.length, -y, 0.45 * tracks.height),
        (0.45 * tracks.length, y, 0.95 * tracks.height),
    )
    bearing = cylinder((*ring, 0.9 * tracks.height), (*ring, base.height), 0.3 * tracks.gauge, 20)
    return (
        visual(RUBBER, mirror(join(belt, *grousers), 1)),
        visual(DARK, mirror(frame, 1), middle, bearing),
        visual(STEEL, mirror(join(*hubs), 1)),
    )


def _stadium(half_length: float, radius: float, arc: int = 7) -> NDArray:
    centre = np.sign(half_length) * half_length
    angle = np.linspace(-np.pi / 2, np.pi / 2, arc)
    front = np.c_[centre + radius * np.cos(angle), np.sin(angle) * radius]
    return np.vstack([front, -front])


def _side(outline: NDArray, near: float, far: float) -> Mesh:
    """An outline in the (x, z) plane around the track's axle height, from y = near to far."""
    vertices, faces = prism(outline, near, far)
    raised = vertices[:, 1] - outline[:, 1].min()
    return np.c_[vertices[:, 0], vertices[:, 2], raised], faces[:, ::-1]


def house(machine: Machine) -> tuple[Visual, ...]:
    swing, tracks = machine.swing, machine.tracks
    axis, floor = -swing.offset, -swing.height + 0.04
    deck = floor + 0.28
    side = (tracks.gauge + tracks.shoe_width) / 2
    rear, front = axis - 0.85 * tracks.length, axis + 0.42 * tracks.length
    boom = 0.16 * tracks.gauge
    angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 9)
    tail = np.c_[rear + 0.45 + 0.45 * np.cos(angle), side * np.sin(angle)]
    hood_front = axis - 0.1 * tracks.length
    counterweight = np.vstack([[[rear + 0.62, side]], tail, [[rear + 0.62, -side]]])
    cab_outline = [
        (axis - 0.12, deck),
        (axis - 0.12, deck + 1.62),
        (axis + 0.55, deck + 1.66),
        (front - 0.28, deck + 1.5),
        (front, deck + 0.62),
        (front, deck),
    ]
    cab_in, cab_out = -boom - 0.08, -side
    glass_side = [
        (axis - 0.02, deck + 0.72),
        (axis - 0.02, deck + 1.5),
        (axis + 0.55, deck + 1.54),
        (front - 0.34, deck + 1.42),
        (front - 0.09, deck + 0.72),
    ]
    bracket = [(axis + 0.25, floor), (-0.3, 0.2), (0.0, 0.24), (0.22, 0.05), (0.24, floor)]
    exhaust = (hood_front - 0.35, 0.62 * side)
    return (
        visual(
            YELLOW,
            box((rear + 0.62, deck, -side), (hood_front, deck + 0.82, side)),
            _level(counterweight, floor, deck + 0.86),
            prism(cab_outline, cab_out, cab_in),
            mirror(prism(bracket, boom + 0.01, boom + 0.07), 2),
            box((hood_front, deck, boom + 0.12), (front - 0.3, deck + 0.42, side)),
        ),
        visual(
            DARK,
            box((rear + 0.6, floor, -side + 0.02), (front - 0.05, deck, side - 0.02)),
            cylinder((axis, -swing.height, 0), (axis, floor + 0.01, 0), 0.32 * tracks.gauge, 20),
            cylinder(
                (exhaust[0], deck + 0.8, exhaust[1]), (exhaust[0], deck + 1.3, exhaust[1]), 0.06
            ),
            prism(
                [(x, y + 0.06) for x, y in cab_outline[1:4]] + cab_outline[3:0:-1],
                cab_out - 0.02,
                cab_in + 0.02,
            ),
            *[
                box((x, deck + 0.3, side - 0.01), (x + 0.06, deck + 0.66, side + 0.012))
                for x in np.linspace(rear + 0.8, hood_front - 0.3, 7)
            ],
        ),
        visual(
            GLASS,
            prism(glass_side, cab_out - 0.012, cab_out + 0.02),
            prism(glass_side, cab_in - 0.02, cab_in + 0.012),
            beam(
                [(front - 0.265, deck + 1.47), (front + 0.012, deck + 0.66)],
                [(front - 0.31, deck + 1.44), (front - 0.04, deck + 0.64)],
                cab_out + 0.08,
                cab_in - 0.08,
            ),
        ),
    )


def _level(outline: ArrayLike, lower: float, upper: float) -> Mesh:
    """An outline in the (x, z) plane of a link's frame, from y = lower to upper."""
    vertices, faces = prism(outline, lower, upper)
    return vertices[:, [0, 2, 1]], faces[:, ::-1]
