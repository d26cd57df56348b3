"""Boom, stick and bucket, and the hydraulic cylinders between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.view.appearance.visual import DARK, STEEL, YELLOW, Strut, Visual, visual
from backhoe.view.shapes import Mesh, beam, cylinder, mirror, prism


def boom(machine: Machine) -> tuple[Visual, ...]:
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
        visual(YELLOW, beam(top, bottom, -width, width)),
        visual(
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
        visual(STEEL, _pin(lug, 0.055 * length / 5.1, 0.7 * width)),
    )


def _pin(at: ArrayLike, radius: float, half_width: float) -> Mesh:
    return cylinder((*at, -half_width), (*at, half_width), radius)


def stick(machine: Machine) -> tuple[Visual, ...]:
    length, width = machine.stick.length, 0.10 * machine.tracks.gauge
    tail = 0.28 * length
    x = np.array([-length - tail, -length - 0.5 * tail, -length, -0.72 * length, 0.0])
    top = np.c_[x, np.array([0.16, 0.20, 0.21, 0.20, 0.085]) * length]
    bottom = np.c_[x, np.array([0.06, -0.06, -0.11, -0.12, -0.075]) * length]
    pins = [(-length, 0.0), (0.0, 0.0), _stick_tail(machine)]
    mount = _bucket_cylinder_mount(machine)
    lug = mount + np.array([[-0.09, -0.13], [-0.05, 0.04], [0.05, 0.04], [0.09, -0.13]]) * length
    return (
        visual(YELLOW, beam(top, bottom, -width, width)),
        visual(
            DARK,
            *[_pin(pin, 0.07 * length, 1.4 * width) for pin in pins],
            mirror(prism(lug, 0.4 * width, 0.7 * width), 2),
        ),
        visual(STEEL, _pin(mount, 0.03 * length, 0.8 * width)),
    )


def bucket(machine: Machine) -> tuple[Visual, ...]:
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
        visual(
            DARK,
            beam(inside, outside, -half, half),
            mirror(prism(inside, half, half + plate), 2),
            mirror(ears, 2),
        ),
        visual(
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
    barrel = visual(DARK, cylinder((-0.1 * shortest / 2, 0, 0), (0.92 * shortest, 0, 0), radius))
    rod = visual(STEEL, cylinder((-0.9 * shortest, 0, 0), (0.02, 0, 0), 0.55 * radius, 10))
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
