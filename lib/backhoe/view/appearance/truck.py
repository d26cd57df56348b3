"""The dump truck, drawn and as boxes for contacts."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.view.appearance.visual import BLUE, DARK, GLASS, LIGHT, RUBBER, STEEL, Visual, visual
from backhoe.view.shapes import Mesh, box, cylinder, prism


class Truck(Protocol):
    """What is drawn: place of the bed's middle, its inside, and heights above the ground [m]."""

    x: float
    y: float
    bed_length: float
    bed_width: float
    floor: float
    wall: float


WALL = 0.09
"""Thickness of the bed's walls and floor [m]."""

CAB_GAP, CAB_LENGTH = 0.45, 1.75
"""From the bed to the cab, and the cab along the truck [m]."""


def truck_boxes(truck: Truck | None) -> tuple[tuple[NDArray, NDArray], ...]:
    """The truck as boxes for contacts: lower and upper corners (3,) in the world [m].

    The floor of the bed, its four walls and the cab, as they are drawn.
    """
    if truck is None:
        return ()
    place = np.array([truck.x, truck.y, 0.0])
    return tuple((place + lower, place + upper) for lower, upper in _bed_and_cab(truck))


def _bed_and_cab(truck: Truck) -> tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]:
    half, width, wall = truck.bed_length / 2, truck.bed_width / 2, WALL
    board, floor, top = width + wall, truck.floor, truck.wall
    cab = half + CAB_GAP
    return (
        ((-half - wall, -board, floor - wall), (half + wall, board, floor)),
        ((-half - wall, width, floor), (half + wall, board, top)),
        ((-half - wall, -board, floor), (half + wall, -width, top)),
        ((half, -board, floor), (half + wall, board, top + 0.35)),
        ((-half - wall, -board, floor), (-half, board, top - 0.25)),
        ((cab, -width, 0.5 * floor), (cab + CAB_LENGTH, width, floor + 1.5)),
    )


def truck_visuals(truck: Truck | None) -> tuple[Visual, ...]:
    """The dump truck's meshes in the world frame; none for no truck."""
    if truck is None:
        return ()
    half, width, wall = truck.bed_length / 2, truck.bed_width / 2, WALL
    floor, top = truck.floor, truck.wall
    wheel = 0.46 * floor
    cab = half + CAB_GAP
    nose = cab + CAB_LENGTH
    board = width + wall
    bed = [
        *[box(lower, upper) for lower, upper in _bed_and_cab(truck)[:-1]],
        *[
            box((x - 0.05, s * board, floor - wall), (x + 0.05, s * (board + 0.06), top))
            for x in np.linspace(-half, half, 5)
            for s in (-1, 1)
        ],
    ]
    cab_outline = [
        (cab, 0.75 * floor),
        (cab, floor + 1.45),
        (nose - 0.45, floor + 1.5),
        (nose - 0.12, floor + 0.65),
        (nose, floor + 0.55),
        (nose, 0.5 * floor),
    ]
    window = [
        (cab + 0.55, floor + 0.62),
        (cab + 0.55, floor + 1.25),
        (nose - 0.5, floor + 1.28),
        (nose - 0.2, floor + 0.62),
    ]
    axles = (-half + 0.5, -half + 0.5 + 2.25 * wheel, cab + 0.75)
    parts = (
        visual(BLUE, *bed),
        visual(
            LIGHT,
            _upright(cab_outline, -width, width),
        ),
        visual(
            GLASS,
            _upright(window, -width - 0.012, width + 0.012),
            _upright(
                [
                    (nose - 0.402, floor + 1.41),
                    (nose - 0.132, floor + 0.71),
                    (nose - 0.182, floor + 0.70),
                    (nose - 0.452, floor + 1.40),
                ],
                -width + 0.12,
                width - 0.12,
            ),
        ),
        visual(
            DARK,
            *[
                box(
                    (-half, s * 0.45 - 0.1, 0.55 * floor),
                    (nose - 0.3, s * 0.45 + 0.1, floor - wall),
                )
                for s in (-1, 1)
            ],
            box((nose - 0.1, -width, 0.4 * floor), (nose + 0.08, width, 0.62 * floor)),
            cylinder(
                (cab - 0.12, -0.8 * width, floor), (cab - 0.12, -0.8 * width, floor + 1.9), 0.07
            ),
        ),
        visual(
            RUBBER,
            *[
                cylinder((x, s * (width - 0.38), wheel), (x, s * (width + 0.02), wheel), wheel, 18)
                for x in axles
                for s in (-1, 1)
            ],
        ),
        visual(
            STEEL,
            *[
                box(
                    (nose - 0.05, s * 0.78 * width - 0.13, 0.66 * floor),
                    (nose + 0.015, s * 0.78 * width + 0.13, 0.80 * floor),
                )
                for s in (-1, 1)
            ],
            box(
                (nose - 0.05, -0.45 * width, 0.72 * floor),
                (nose + 0.012, 0.45 * width, floor + 0.35),
            ),
            *[
                cylinder((x, s * width, wheel), (x, s * (width + 0.035), wheel), 0.45 * wheel, 12)
                for x in axles
                for s in (-1, 1)
            ],
        ),
    )
    place = np.array([truck.x, truck.y, 0.0])
    return tuple(Visual(part.vertices + place, part.faces, part.colour) for part in parts)


def _upright(outline: ArrayLike, near: float, far: float) -> Mesh:
    """An outline in the (x, z) plane of the world, from y = near to far."""
    vertices, faces = prism(outline, near, far)
    return vertices[:, [0, 2, 1]], faces[:, ::-1]
