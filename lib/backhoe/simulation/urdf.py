"""The machine as URDF text, generated from its numbers and never kept as a file.

Joints: base_x, base_y, base_yaw (a plane on which the tracks' friction holds the machine), then
swing, boom, stick, bucket. Each link's frame lies on its joint with x through the centre of mass:
PyBullet then keeps the large inertias symmetric to the last bit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import BACKHOE, JOINTS, Link, Machine

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
ALL_JOINTS = BASE_JOINTS + JOINTS


def urdf(
    machine: Machine = BACKHOE, collision: Mapping[str, Path] | None = None, base: str = "tracks"
) -> str:
    """URDF of the machine.

    Args:
        machine: its numbers.
        collision: an OBJ file in the link's own frame for each link whose convex hull collides;
            links are named like their joints, the undercarriage is "base_yaw". Default: none.
        base: "tracks" for a base that moves in the plane, "fixed" for one without joints.

    Returns:
        The XML text.
    """
    moves = base == "tracks"
    base, swing = machine.base, machine.swing
    links = [
        _UrdfLink("base_x", "world", "prismatic" if moves else "fixed", axis="1 0 0"),
        _UrdfLink("base_y", "base_x", "prismatic" if moves else "fixed", axis="0 1 0"),
        _UrdfLink(
            "base_yaw",
            "base_y",
            "continuous" if moves else "fixed",
            mass=machine.tracks.mass,
            inertia=machine.tracks.yaw_inertia,
        ),
        _UrdfLink(
            "swing",
            "base_yaw",
            position=(base.offset, 0.0, base.height + swing.com_height),
            rpy=(0.0, 0.0, pi / 2 + swing.com_angle),
            mass=swing.mass,
            inertia=swing.inertia,
            com=swing.com_radius,
        ),
        _arm_link(
            "boom",
            "swing",
            machine.boom,
            position=(*_polar(swing.offset, -swing.com_angle), swing.height - swing.com_height),
            rpy=(pi / 2, -machine.boom.com_angle, -swing.com_angle),
        ),
    ]
    for name, parent in (("stick", "boom"), ("bucket", "stick")):
        link, before = getattr(machine, name), getattr(machine, parent)
        bend = before.angle_offset - before.com_angle
        links.append(
            _arm_link(
                name,
                parent,
                link,
                position=(*_polar(before.length, bend), 0.0),
                rpy=(0.0, 0.0, bend + link.com_angle),
            )
        )
    body = [link.xml((collision or {}).get(link.name)) for link in links]
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<robot name="backhoe">',
            '<link name="world"/>',
            *body,
            "</robot>",
        ]
    )


def T_urdf_dh(link: str, machine: Machine = BACKHOE) -> NDArray:
    """Pose of a link's Denavit-Hartenberg frame in its URDF frame, shape (4, 4).

    Args:
        link: "base_yaw" (whose frame is the vehicle's), "swing", "boom", "stick" or "bucket".

    Raises:
        ValueError: there is no link of that name.
    """
    if link not in ("base_yaw", *JOINTS):
        raise ValueError(f"unknown link {link!r}: the links are base_yaw, {', '.join(JOINTS)}")
    T = np.eye(4)
    if link == "swing":
        swing = machine.swing
        c, s = cos(-swing.com_angle), sin(-swing.com_angle)
        T[:3, :3] = [[c, 0, s], [s, 0, -c], [0, 1, 0]]
        T[:3, 3] = c * swing.offset, s * swing.offset, swing.height - swing.com_height
    elif link in JOINTS:
        part = getattr(machine, link)
        bend = part.angle_offset - part.com_angle
        c, s = cos(bend), sin(bend)
        T[:2, :2] = [[c, -s], [s, c]]
        T[:2, 3] = c * part.length, s * part.length
    return T


@dataclass(frozen=True)
class _UrdfLink:
    """A link with the joint of the same name that carries it; `com` is its c.m. along x [m]."""

    name: str
    parent: str
    kind: str = "continuous"
    axis: str = "0 0 1"
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mass: float = 0.0
    inertia: float = 0.0
    com: float = 0.0

    def xml(self, collision: Path | None) -> str:
        inertia = " ".join(
            f'i{a}{b}="{self.inertia if a == b else 0.0!r}"'
            for a, b in ("xx", "xy", "xz", "yy", "yz", "zz")
        )
        shape = (
            f'<collision><geometry><mesh filename="{collision}"/></geometry></collision>'
            if collision
            else ""
        )
        limit = (
            ' <limit lower="1" upper="-1" effort="0" velocity="0"/>'
            if self.kind == "prismatic"
            else ""
        )
        return (
            f'<link name="{self.name}"><inertial><origin xyz="{self.com!r} 0 0"/>'
            f'<mass value="{self.mass!r}"/><inertia {inertia}/></inertial>{shape}</link>\n'
            f'<joint name="{self.name}" type="{self.kind}"><parent link="{self.parent}"/>'
            f'<child link="{self.name}"/>'
            f'<origin xyz="{_text(self.position)}" rpy="{_text(self.rpy)}"/>'
            f'<axis xyz="{self.axis}"/>{limit}<dynamics damping="0" friction="0"/></joint>'
        )


def _arm_link(name: str, parent: str, link: Link, **placed: tuple[float, ...]) -> _UrdfLink:
    return _UrdfLink(
        name, parent, mass=link.mass, inertia=link.inertia, com=link.com_radius, **placed
    )


def _polar(radius: float, angle: float) -> tuple[float, float]:
    return radius * cos(angle), radius * sin(angle)


def _text(numbers: tuple[float, ...]) -> str:
    return " ".join(repr(float(number)) for number in numbers)
