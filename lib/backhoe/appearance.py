"""How the machine and the truck look: coloured triangle meshes, sized from the machine's numbers.

Each mesh lives in the Denavit-Hartenberg frame of its link (the undercarriage in the vehicle
frame), so a pose of that frame places it: the renderer, the replay and the plots all read these.
In the frames of swing, boom, stick and bucket x runs along the link, y upwards and z to the right
when the arm points forward. The shapes are our drawing; the joints lie where the machine has them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.kinematics import link_transforms
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.shapes import Mesh, beam, box, cylinder, join, mirror, prism
from backhoe.sim.scene import Truck

__all__ = ["Strut", "Visual", "bucket_load", "struts", "truck_visuals", "visuals"]

Colour = tuple[float, float, float, float]
YELLOW: Colour = (0.96, 0.71, 0.08, 1.0)
DARK: Colour = (0.17, 0.18, 0.20, 1.0)
RUBBER: Colour = (0.10, 0.10, 0.11, 1.0)
STEEL: Colour = (0.46, 0.47, 0.49, 1.0)
GLASS: Colour = (0.42, 0.60, 0.68, 1.0)
SOIL: Colour = (0.52, 0.40, 0.28, 1.0)
BLUE: Colour = (0.15, 0.33, 0.53, 1.0)
WALL, CAB_GAP, CAB_LENGTH = 0.09, 0.45, 1.75
LIGHT: Colour = (0.88, 0.89, 0.87, 1.0)


@dataclass(frozen=True)
class Visual:
    """A mesh of one colour: vertices (n, 3) [m], faces (m, 3), rgba in 0..1."""

    vertices: NDArray
    faces: NDArray
    colour: Colour


@dataclass(frozen=True)
class Strut:
    """A hydraulic cylinder between a point of one link's frame and a point of another's, (3,) [m].

    The barrel lies along +x from `base`, the rod along -x from `tip`: place each at its point with
    x in the direction from `base` to `tip`.
    """

    base_link: str
    base: NDArray
    tip_link: str
    tip: NDArray
    barrel: Visual
    rod: Visual


def visuals(machine: Machine = BACKHOE) -> dict[str, tuple[Visual, ...]]:
    """The machine's meshes by link: undercarriage, swing, boom, stick, bucket.

    The undercarriage is in the vehicle frame (x forward, z up), the others in frames 1 to 4.
    """
    return {
        "undercarriage": _undercarriage(machine),
        "swing": _house(machine),
        "boom": _boom(machine),
        "stick": _stick(machine),
        "bucket": _bucket(machine),
    }


def _visual(colour: Colour, *meshes: Mesh) -> Visual:
    return Visual(*join(*meshes), colour)


def struts(machine: Machine = BACKHOE) -> tuple[Strut, ...]:
    """The hydraulic cylinders: two of the boom, one of the stick, one of the bucket."""
    width = 0.13 * machine.tracks.gauge + 0.07
    knee = (-0.54 * machine.boom.length, 0.125 * machine.boom.length)
    foot = (0.42, -0.16)
    size = machine.boom.length / 5.1
    return (
        *[
            _strut(
                "swing", (*foot, side * width), "boom", (*knee, side * width), 0.085 * size, machine
            )
            for side in (-1, 1)
        ],
        _strut(
            "boom",
            (*_stick_cylinder_mount(machine), 0.0),
            "stick",
            (*_stick_tail(machine), 0.0),
            0.085 * size,
            machine,
        ),
        _strut(
            "stick",
            (*_bucket_cylinder_mount(machine), 0.0),
            "bucket",
            (*_bucket_lug(machine), 0.0),
            0.07 * size,
            machine,
        ),
    )


def _strut(
    base_link: str, base: tuple, tip_link: str, tip: tuple, radius: float, machine: Machine
) -> Strut:
    moved = JOINTS.index(tip_link)
    q = np.zeros((25, 4))
    q[:, moved] = np.linspace(machine.lower[moved], machine.upper[moved], len(q))
    T = dict(zip(JOINTS, np.moveaxis(link_transforms(q, machine=machine), -3, 0), strict=True))
    ends = T[tip_link] @ [*tip, 1.0] - T[base_link] @ [*base, 1.0]
    shortest = float(np.linalg.norm(ends, axis=-1).min())
    barrel = _visual(DARK, cylinder((-0.1 * shortest / 2, 0, 0), (0.92 * shortest, 0, 0), radius))
    rod = _visual(STEEL, cylinder((-0.9 * shortest, 0, 0), (0.02, 0, 0), 0.55 * radius, 10))
    return Strut(base_link, np.array(base), tip_link, np.array(tip), barrel, rod)


def _stick_cylinder_mount(machine: Machine) -> NDArray:
    """Where the stick's cylinder stands on the boom, in the boom's frame (x, y) [m]."""
    return np.array([-0.56, 0.235]) * machine.boom.length


def _stick_tail(machine: Machine) -> NDArray:
    """Where the stick's cylinder pulls, in the stick's frame (x, y) [m]."""
    return np.array([-1.25, 0.11]) * machine.stick.length


def _bucket_cylinder_mount(machine: Machine) -> NDArray:
    """Where the bucket's cylinder stands on the stick, in the stick's frame (x, y) [m]."""
    return np.array([-0.94, 0.31]) * machine.stick.length


def _bucket_lug(machine: Machine) -> NDArray:
    """Where the bucket's cylinder pushes, in the bucket's frame (x, y) [m]."""
    return np.array([-machine.bucket.length - 0.17, 0.17])


def _undercarriage(machine: Machine) -> tuple[Visual, ...]:
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
        _visual(RUBBER, mirror(join(belt, *grousers), 1)),
        _visual(DARK, mirror(frame, 1), middle, bearing),
        _visual(STEEL, mirror(join(*hubs), 1)),
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


def _house(machine: Machine) -> tuple[Visual, ...]:
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
        _visual(
            YELLOW,
            box((rear + 0.62, deck, -side), (hood_front, deck + 0.82, side)),
            _level(counterweight, floor, deck + 0.86),
            prism(cab_outline, cab_out, cab_in),
            mirror(prism(bracket, boom + 0.01, boom + 0.07), 2),
            box((hood_front, deck, boom + 0.12), (front - 0.3, deck + 0.42, side)),
        ),
        _visual(
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
        _visual(
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


def _boom(machine: Machine) -> tuple[Visual, ...]:
    length, rise = machine.boom.length, 0.15 * machine.boom.length
    width = 0.13 * machine.tracks.gauge
    s = np.linspace(0.0, 1.0, 13)
    knee, start, end = np.array([0.40 * length, 2 * rise]), np.array([-length, 0.0]), np.zeros(2)
    bend = start + knee
    centre = np.outer((1 - s) ** 2, start) + np.outer(2 * s * (1 - s), bend) + np.outer(s**2, end)
    half = np.interp(s, [0, 0.08, 0.42, 0.9, 1.0], [0.13, 0.20, 0.33, 0.17, 0.13]) * length / 5.1
    tangent = np.gradient(centre, axis=0)
    normal = np.c_[-tangent[:, 1], tangent[:, 0]] / np.linalg.norm(tangent, axis=1)[:, None]
    top, bottom = centre + half[:, None] * normal, centre - half[:, None] * normal
    lug = _stick_cylinder_mount(machine)
    return (
        _visual(YELLOW, beam(top, bottom, -width, width)),
        _visual(
            DARK,
            _pin((-length, 0.0), 0.19 * length / 5.1, 1.14 * width),
            _pin((0.0, 0.0), 0.15 * length / 5.1, 1.5 * width),
            _pin(centre[6], 0.10 * length / 5.1, 1.25 * width),
            mirror(
                prism(
                    lug + np.array([[-0.2, -0.22], [-0.07, 0.1], [0.07, 0.1], [0.2, -0.22]]),
                    0.35 * width,
                    0.6 * width,
                ),
                2,
            ),
        ),
        _visual(STEEL, _pin(lug, 0.055 * length / 5.1, 0.7 * width)),
    )


def _pin(at: ArrayLike, radius: float, half_width: float) -> Mesh:
    return cylinder((*at, -half_width), (*at, half_width), radius)


def _stick(machine: Machine) -> tuple[Visual, ...]:
    length, width = machine.stick.length, 0.10 * machine.tracks.gauge
    tail = 0.28 * length
    x = np.array([-length - tail, -length - 0.5 * tail, -length, -0.72 * length, 0.0])
    top = np.c_[x, np.array([0.16, 0.20, 0.21, 0.20, 0.085]) * length]
    bottom = np.c_[x, np.array([0.06, -0.06, -0.11, -0.12, -0.075]) * length]
    pins = [(-length, 0.0), (0.0, 0.0), _stick_tail(machine)]
    mount = _bucket_cylinder_mount(machine)
    lug = mount + np.array([[-0.09, -0.13], [-0.05, 0.04], [0.05, 0.04], [0.09, -0.13]]) * length
    return (
        _visual(YELLOW, beam(top, bottom, -width, width)),
        _visual(
            DARK,
            *[_pin(pin, 0.07 * length, 1.4 * width) for pin in pins],
            mirror(prism(lug, 0.4 * width, 0.7 * width), 2),
        ),
        _visual(STEEL, _pin(mount, 0.03 * length, 0.8 * width)),
    )


def _bucket(machine: Machine) -> tuple[Visual, ...]:
    shell, length = machine.shell, machine.bucket.length
    inside = np.asarray(shell.profile, dtype=float)
    outside = inside + shell.plate * _outward_normals(inside)
    half, plate = shell.width / 2, shell.plate
    top = inside[np.argmax(inside[:, 1])]
    tooth = 0.11 * length
    teeth = [
        beam(
            [(-0.6 * tooth, 0.4 * tooth), (0.0, 0.0)],
            [(-0.6 * tooth - plate, 0.4 * tooth + 1.2 * plate), (0.0, 0.012)],
            z - 0.045,
            z + 0.045,
        )
        for z in np.linspace(-half + 0.06, half - 0.06, 5)
    ]
    edge = beam(
        [(0.2 * tooth * -1, 0.15 * tooth), inside[1]],
        [(-0.2 * tooth, 0.15 * tooth + plate), outside[1] + [0.0, plate]],
        -half - plate,
        half + plate,
    )
    ear, lug = 0.12 * machine.tracks.gauge, _bucket_lug(machine)
    ears = prism(
        [
            (-length - 0.09, -0.07),
            (-length + 0.02, -0.12),
            (inside[-1, 0] + 0.12, 0.0),
            (top[0] + 0.1, top[1]),
            (top[0] - 0.25, top[1] + 0.06),
            (lug[0] - 0.02, lug[1] + 0.08),
            (lug[0] - 0.09, lug[1]),
        ],
        ear,
        ear + 0.05,
    )
    return (
        _visual(
            DARK,
            beam(inside, outside, -half, half),
            mirror(prism(inside, half, half + plate), 2),
            mirror(ears, 2),
        ),
        _visual(
            STEEL,
            edge,
            *teeth,
            _pin((-length, 0.0), 0.07, ear + 0.07),
            _pin(lug, 0.055, ear + 0.06),
        ),
    )


def _outward_normals(profile: NDArray) -> NDArray:
    tangent = np.gradient(profile, axis=0)
    normal = np.c_[-tangent[:, 1], tangent[:, 0]]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle = profile.mean(axis=0)
    return normal * np.sign(((profile - middle) * normal).sum(axis=1, keepdims=True))


def bucket_load(volume: float, machine: Machine = BACKHOE) -> Visual | None:
    """Soil in the bucket as a mesh in the bucket's frame, or None when there is too little to see.

    Args:
        volume: soil in the bucket [m^3]; above the struck capacity it stands as a heap.
    """
    shell = machine.shell
    inside = np.asarray(shell.profile, dtype=float)
    area = volume / shell.width
    if area < 1e-3:
        return None
    lip = inside[-1] / np.linalg.norm(inside[-1])
    depth_axis = np.array([lip[1], -lip[0]])
    depth_axis *= np.sign((inside @ depth_axis).sum())
    if area >= shell.section_area:
        heap = 2 * (area - shell.section_area) / np.linalg.norm(inside[-1])
        section = np.vstack([inside, inside[-1] / 2 - heap * depth_axis])
    else:
        section = _filled_section(inside, depth_axis, area)
    return Visual(*prism(section, -shell.width / 2, shell.width / 2), SOIL)


def _filled_section(inside: NDArray, depth_axis: NDArray, area: float) -> NDArray:
    """The part of the profile deeper than the level that leaves `area` below it."""
    depth = inside @ depth_axis
    low, high = 0.0, float(depth.max())
    for _ in range(40):
        level = (low + high) / 2
        section = _deeper_than(inside, depth, level)
        x, y = section.T
        if abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2 > area:
            low = level
        else:
            high = level
    return section


def _deeper_than(points: NDArray, depth: NDArray, level: float) -> NDArray:
    kept = []
    for i in range(len(points)):
        j = (i + 1) % len(points)
        if depth[i] >= level:
            kept.append(points[i])
        if (depth[i] >= level) != (depth[j] >= level):
            share = (level - depth[i]) / (depth[j] - depth[i])
            kept.append(points[i] + share * (points[j] - points[i]))
    return np.array(kept)


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
        _visual(BLUE, *bed),
        _visual(
            LIGHT,
            _upright(cab_outline, -width, width),
        ),
        _visual(
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
        _visual(
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
        _visual(
            RUBBER,
            *[
                cylinder((x, s * (width - 0.38), wheel), (x, s * (width + 0.02), wheel), wheel, 18)
                for x in axles
                for s in (-1, 1)
            ],
        ),
        _visual(
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
