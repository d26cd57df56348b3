"""The machine, the rover, the truck and the load as nodes of a replay.

Frames as everywhere: the base frame lies on the ground between the tracks, x forward, z up; each
link's mesh is given in its Denavit-Hartenberg frame (Mastalli 2013, Table A.1).
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import JOINTS, Machine, Shell
from backhoe.view import appearance
from backhoe.view.replay.recording import Mesh, Morph, Node

if TYPE_CHECKING:
    from backhoe.vehicle.skid_steer import Vehicle

BASE = "undercarriage"
ROVER = "rover"
TIP = "bucket"
SOIL = (0.43, 0.30, 0.19, 1.0)
BELIEF = (0.9, 0.62, 0.0, 1.0)


def machine_nodes(
    q: ArrayLike, poses: ArrayLike, machine: Machine, loaded: bool = False
) -> tuple[Node, ...]:
    """Undercarriage, swing, boom, stick and bucket as they move.

    Args:
        q: joint angles, shape (frames, 4) [rad].
        poses: x, y [m] and yaw [rad] of the base, shape (frames, 3).
        machine: its numbers and its looks.
        loaded: whether the bucket shows the soil that the scalar "bucket" tells.
    """
    q, poses = np.asarray(q, dtype=float), np.asarray(poses, dtype=float)
    looks = appearance.visuals(machine)
    base, swing = machine.base, machine.swing
    before = [_translation(base.offset, base.height) @ _turn_z(pi / 2)]
    before += [_turn_z(link.angle_offset) for link in machine.links]
    after = [_translation(swing.offset, swing.height) @ _turn_x(pi / 2)]
    after += [_translation(link.length, 0.0) for link in machine.links]
    nodes = [Node(BASE, None, "planar", poses, meshes=_meshes(looks[BASE]))]
    for i, name in enumerate(JOINTS):
        meshes = _meshes(looks[name])
        if loaded and name == TIP:
            meshes += (load_in_bucket(machine.shell),)
        nodes.append(Node(name, nodes[-1].name, "revolute", q[:, i], before[i], after[i], meshes))
    return tuple(nodes)


def belief_node(poses: ArrayLike, machine: Machine) -> Node:
    """The outline of the tracks on the ground, and an arrow ahead, where it believes to be.

    Args:
        poses: x, y [m] and yaw [rad], shape (frames, 3).
        machine: its tracks.
    """
    tracks = machine.tracks
    half, wide, rim = tracks.length / 2, (tracks.gauge + tracks.shoe_width) / 2, 0.12
    corners = np.array([(half, wide), (-half, wide), (-half, -wide), (half, -wide)])
    inner = corners - rim * np.sign(corners)
    arrow = np.array([(half, 0.5), (half, -0.5), (half + 0.9, 0.0)])
    flat = np.concatenate([corners, inner, arrow])
    ring = [(i, (i + 1) % 4, 4 + i) for i in range(4)]
    ring += [((i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    faces = np.array([*ring, (8, 10, 9)])
    faces = np.concatenate([faces, faces[:, ::-1]])  # seen from both sides
    vertices = np.column_stack([flat, np.full(len(flat), 0.08)])
    mesh = Mesh(vertices, faces, BELIEF)
    return Node("belief", None, "planar", np.asarray(poses, dtype=float), meshes=(mesh,))


def strut_nodes(q: ArrayLike, machine: Machine) -> tuple[Node, ...]:
    """The hydraulic cylinders between the links of `machine_nodes`, barrels and rods.

    Args:
        q: joint angles, shape (frames, 4) [rad].
        machine: its numbers and its looks.
    """
    frames = np.moveaxis(link_transforms(q, machine=machine), -3, 0)
    frames = dict(zip(JOINTS, frames, strict=True))
    nodes = []
    for number, strut in enumerate(appearance.struts(machine)):
        base = frames[strut.base_link] @ [*strut.base, 1.0]
        tip = frames[strut.tip_link] @ [*strut.tip, 1.0]
        for part, link, point, look in (
            ("barrel", strut.base_link, strut.base, strut.barrel),
            ("rod", strut.tip_link, strut.tip, strut.rod),
        ):
            x, y = np.einsum("...ij,...i->j...", frames[link][..., :3, :2], (tip - base)[..., :3])
            at = np.eye(4)
            at[:3, 3] = point
            angle = np.unwrap(np.arctan2(y, x))
            name = f"{part} {number}"
            nodes.append(Node(name, link, "revolute", angle, at, meshes=_meshes([look])))
    return tuple(nodes)


def rover_nodes(angles: ArrayLike, poses: ArrayLike, vehicle: Vehicle) -> tuple[Node, ...]:
    """Body and wheels of a rover as they move.

    Args:
        angles: of the wheels, shape (frames, 4) [rad].
        poses: x, y [m] and heading [rad], shape (frames, 3).
        vehicle: its numbers.
    """
    from backhoe.vehicle.skid_steer import WHEELS

    angles = np.asarray(angles, dtype=float)
    nodes = [Node(ROVER, None, "planar", poses, meshes=_meshes(appearance.rover_body(vehicle)))]
    wheel = _meshes(appearance.rover_wheel(vehicle))
    for i, (x, y) in enumerate(vehicle.positions):
        at = _turn_x(-pi / 2)
        at[:3, 3] = x, y, vehicle.wheel_radius
        nodes.append(Node(WHEELS[i], ROVER, "revolute", angles[:, i], at, meshes=wheel))
    return tuple(nodes)


def truck_node(scene: object) -> tuple[Node, ...]:
    """The truck of a scene as it stands in the world; nothing when the scene has none."""
    if scene is None or getattr(scene, "truck", None) is None:
        return ()
    return (Node("truck", meshes=_meshes(appearance.truck_visuals(scene.truck))),)


def load_in_bucket(shell: Shell) -> Morph:
    """Surface of the soil in the bucket, rising with the scalar "bucket" [m^3].

    Up to the struck capacity the surface is level with the mouth's plane; above it a crown grows,
    to twice the struck capacity at most.
    """
    profile = np.asarray(shell.profile, dtype=float)
    profile = profile[np.argsort(profile[:, 0])]
    x = np.linspace(profile[0, 0], profile[-1, 0], 17)
    z = np.linspace(-0.5, 0.5, 7) * shell.width
    floor = np.interp(x, *profile.T)[:, None]
    mouth = np.interp(x, *profile[[0, -1]].T)[:, None]
    depth = (floor - mouth) * np.ones(len(z))
    crown = np.outer(1 - np.linspace(-1, 1, len(x)) ** 2, 1 - np.linspace(-1, 1, len(z)) ** 2)
    crown *= _volume(depth, x, z) / _volume(crown, x, z)
    soil = [np.maximum(depth - below, 0.0) for below in np.linspace(depth.max(), 0.0, 9)]
    soil += [depth + part * crown for part in (0.25, 0.5, 1.0)]
    grid_x, grid_z = np.broadcast_arrays(x[:, None], z)
    shapes = [
        np.stack([grid_x, floor - thick + 0.01 * (thick <= 0), grid_z], -1).reshape(-1, 3)
        for thick in soil
    ]
    knots = [_volume(thick, x, z) for thick in soil]
    return Morph("bucket", knots, np.array(shapes), _grid_faces(len(x), len(z)), SOIL)


def _volume(thickness: NDArray, x: NDArray, z: NDArray) -> float:
    return float(np.trapezoid(np.trapezoid(thickness, z, axis=1), x))


def _grid_faces(rows: int, columns: int) -> NDArray:
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    first = np.stack([corner, corner + columns, corner + 1], -1)
    second = np.stack([corner + 1, corner + columns, corner + columns + 1], -1)
    return np.concatenate([first, second])


def _meshes(visuals: object) -> tuple[Mesh, ...]:
    return tuple(Mesh(v.vertices, v.faces, v.colour) for v in visuals)


def _translation(x: float, z: float) -> NDArray:
    T = np.eye(4)
    T[0, 3], T[2, 3] = x, z
    return T


def _turn_z(angle: float) -> NDArray:
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return T


def _turn_x(angle: float) -> NDArray:
    T = np.eye(4)
    T[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return T
