"""A skid-steer vehicle as URDF text, generated from its description and never kept as a file.

A box body on four cylinders. Collision is by a sphere inside each cylinder: it touches the ground
in one point, below the wheel's middle, as an ideal wheel does; a cylinder touches with both ends
of a line and is the harder to turn for it. Axes as in `skid_steer`; the robot's frame lies on the
ground below its centre of mass.
"""

from __future__ import annotations

from math import pi

from backhoe.basics.inputs import choice
from backhoe.vehicle.skid_steer.vehicle import WHEELS, Vehicle


def body_middle(vehicle: Vehicle) -> tuple[float, float, float]:
    """Centre of mass of the body in the robot's frame [m]: the wheels' is made up for."""
    wheels = 2 * (vehicle.front - vehicle.rear) * vehicle.wheel_mass
    return 0.0 - wheels / vehicle.body_mass, 0.0, vehicle.clearance + vehicle.body_height / 2


def rover_urdf(vehicle: Vehicle, *, wheels: str = "continuous") -> str:
    """URDF of the vehicle.

    The body's inertia is that of a box of its shape, scaled so that the whole vehicle has its
    stated yaw inertia; a wheel's other two are those of a flat ring of its axle's inertia.

    Args:
        vehicle: its description.
        wheels: kind of the wheels' joints, "continuous" or "fixed".

    Returns:
        The XML text: link "body", and a link and joint for each name of `skid_steer.WHEELS`.

    Raises:
        ValueError: an unknown kind, or wheels that alone have more inertia than the whole.
    """
    choice(wheels, "wheels", ("continuous", "fixed"))
    p = vehicle
    across = p.wheel_inertia / 2 + p.wheel_mass * p.wheel_width**2 / 12
    x_body = body_middle(p)[0]
    arms = p.wheel_mass * (p.positions**2).sum() + p.body_mass * x_body**2
    yaw = p.inertia - arms - 4 * across
    if yaw <= 0:
        raise ValueError(
            f"Vehicle.inertia {p.inertia} kg m^2 is less than that of its wheels, {p.inertia - yaw}"
        )
    L, W, H = p.body_length, p.body_width, p.body_height
    scale = yaw / (L**2 + W**2)
    body = scale * (W**2 + H**2), scale * (L**2 + H**2), yaw
    parts = [
        link_urdf("body", body_middle(p), p.body_mass, body, f'<box size="{L!r} {W!r} {H!r}"/>'),
        *(
            _wheel(p, name, at, wheels, across)
            for name, at in zip(WHEELS, p.positions, strict=True)
        ),
    ]
    return "\n".join(['<?xml version="1.0"?>', '<robot name="rover">', *parts, "</robot>"])


def _wheel(p: Vehicle, name: str, at: tuple, kind: str, across: float) -> str:
    solid = f'<sphere radius="{p.wheel_radius!r}"/>'
    inertia = across, p.wheel_inertia, across
    x, y = (float(value) for value in at)
    return (
        link_urdf(name, (0.0, 0.0, 0.0), p.wheel_mass, inertia, solid, f' rpy="{pi / 2!r} 0 0"')
        + f'\n<joint name="{name}" type="{kind}"><parent link="body"/><child link="{name}"/>'
        f'<origin xyz="{x!r} {y!r} {p.wheel_radius!r}"/><axis xyz="0 1 0"/>'
        '<dynamics damping="0" friction="0"/></joint>'
    )


def link_urdf(
    name: str, middle: tuple, mass: float, inertia: tuple, solid: str = "", turned: str = ""
) -> str:
    """A link as URDF text.

    Args:
        name: of the link.
        middle: its centre of mass, and of the solid, in its frame, shape (3,) [m].
        mass: [kg].
        inertia: about the axes through there, shape (3,) [kg m^2].
        solid: that collides, as URDF text; none if empty.
        turned: attribute that turns the solid.
    """
    xx, yy, zz = (float(value) for value in inertia)
    at = " ".join(repr(float(value)) for value in middle)
    shape = f'<origin xyz="{at}"{turned}/><geometry>{solid}</geometry>'
    return (
        f'<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass!r}"/>'
        f'<inertia ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
        f"{f'<collision>{shape}</collision>' if solid else ''}</link>"
    )
