"""The backhoe in numbers: geometry, masses, limits, tracks and bucket, each once.

Everything else reads them from here: kinematics, dynamics, the URDF, the pictures, the lessons.
SI units and radians. Reference: Mastalli 2013, Tables A.1 and A.2, in the reading in which the
stick hangs at q3 = 0 (lesson 02 shows why); what the thesis leaves out is our choice. Module
`provenance` gives the symbol, unit and source of every number.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from math import hypot, pi, radians

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import instance, not_negative, number, numbers, positive
from backhoe.basics.named import named, shown_by_name

JOINTS = ("swing", "boom", "stick", "bucket")


def _keep(owner: object, check: Callable[[float, str], float], *names: str) -> None:
    """Check numbers and keep them as floats, whatever type of number came."""
    for name in names:
        value = check(getattr(owner, name), f"{type(owner).__name__}.{name}")
        object.__setattr__(owner, name, value)


def _require_part(owner: object, kind: type, *names: str) -> None:
    for name in names:
        advice = f"change one with replace(machine.{name}, ...)"
        instance(getattr(owner, name), f"{type(owner).__name__}.{name}", kind, advice)


@dataclass(frozen=True)
class Joint:
    """What one joint can do: range [rad], speed [rad/s], torque [N m] and friction.

    Friction is `viscous` [N m s/rad] and `coulomb` [N m], the F_v and F_s of eq. (2.11).

    Raises:
        ValueError: a value is not finite, speed or torque not positive, friction negative, or lower
            not below upper.
    """

    lower: float
    upper: float
    speed: float
    torque: float
    viscous: float
    coulomb: float

    def __post_init__(self) -> None:
        _keep(self, number, "lower", "upper")
        _keep(self, positive, "speed", "torque")
        _keep(self, not_negative, "viscous", "coulomb")
        if self.lower >= self.upper:
            raise ValueError(
                f"Joint.lower must be below Joint.upper, got {self.lower!r} and {self.upper!r} rad"
            )


@dataclass(frozen=True)
class Base:
    """Row 0 of Table A.1: from the ground between the tracks to the swing axis [m]."""

    height: float
    offset: float

    def __post_init__(self) -> None:
        _keep(self, number, "height", "offset")


@dataclass(frozen=True)
class Swing:
    """The house on its swing ring: row 1 of Table A.1 and the mass properties of the turret.

    Lengths in m, mass in kg, inertia about the vertical in kg m^2; the centre of mass lies at
    `com_radius` from the swing axis, `com_angle` [rad] from the arm's direction, `com_height` above
    the swing ring.

    Raises:
        ValueError: a value is not finite, or a mass or inertia is not positive.
        TypeError: joint is no Joint.
    """

    height: float
    offset: float
    mass: float
    com_radius: float
    com_angle: float
    com_height: float
    inertia: float
    joint: Joint

    def __post_init__(self) -> None:
        _keep(self, positive, "mass", "inertia")
        _keep(self, number, "height", "offset", "com_radius", "com_angle", "com_height")
        _require_part(self, Joint, "joint")


@dataclass(frozen=True)
class Link:
    """Boom, stick or bucket: a row of Table A.1 and its mass properties from Table A.2.

    `length` [m] joint to joint; `angle_offset` [rad] with q* = q + angle_offset; the centre of mass
    at `com_radius` [m] from the joint in direction q + `com_angle` [rad]; `mass` [kg]; `inertia`
    [kg m^2] about every axis through the centre of mass.

    Raises:
        ValueError: a value is not finite, or a length, mass or inertia is not positive.
        TypeError: joint is no Joint.
    """

    length: float
    angle_offset: float
    mass: float
    com_radius: float
    com_angle: float
    inertia: float
    joint: Joint

    def __post_init__(self) -> None:
        _keep(self, positive, "length", "mass", "inertia")
        _keep(self, number, "angle_offset", "com_radius", "com_angle")
        _require_part(self, Joint, "joint")


@dataclass(frozen=True)
class Tracks:
    """Undercarriage: two tracks `gauge` apart [m], each `length` x `shoe_width` on the ground [m].

    `mass` [kg] of the undercarriage alone, `max_speed` [m/s] and `acceleration` [m/s^2] of the
    belts, Coulomb friction coefficients of track on soil along and across the belt. Driven by a
    force, one belt is a `belt_mass` [kg], equivalent to chain, sprocket and drive together; its
    drive gives at most `max_traction` [N], and `rolling_resistance` is over the weight.

    Raises:
        ValueError: a value is not finite and positive.
    """

    gauge: float
    length: float
    shoe_width: float
    height: float
    sprocket_radius: float
    max_speed: float
    acceleration: float
    mass: float
    friction_longitudinal: float
    friction_lateral: float
    belt_mass: float
    rolling_resistance: float
    max_traction: float

    def __post_init__(self) -> None:
        _keep(self, positive, *(field.name for field in fields(self)))

    @property
    def com_height(self) -> float:
        """Of the undercarriage's centre of mass above the ground [m]: half the tracks' height."""
        return self.height / 2

    @property
    def yaw_inertia(self) -> float:
        """About the middle, upwards [kg m^2]: two slender tracks, half a gauge off."""
        return self.mass * (self.length**2 / 12 + self.gauge**2 / 4)


@dataclass(frozen=True)
class Shell:
    """The bucket's inside: a profile swept over the width.

    `profile` lists (x, y) points [m] in the frame of the bucket's tip (x from the pin through the
    teeth, y towards the back plate), from the teeth along the floor and back to the top lip; the
    mouth closes it. `width` and `plate` (thickness) in m.

    Raises:
        ValueError: width or plate not positive, or a profile that is no points or without area.
    """

    width: float
    plate: float
    profile: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        _keep(self, positive, "width", "plate")
        points = numbers(self.profile, "Shell.profile", ("n", 2), meaning="(x, y) points [m]")
        object.__setattr__(self, "profile", tuple(map(tuple, points.tolist())))
        if self.section_area <= 0:
            raise ValueError("Shell.profile must enclose an area, teeth first, then the floor")

    @cached_property
    def section_area(self) -> float:
        """Area inside the profile, closed by the mouth [m^2]."""
        x, y = np.asarray(self.profile, dtype=float).T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)

    @property
    def struck_capacity(self) -> float:
        """Volume held when filled level with the mouth [m^3]."""
        return self.section_area * self.width

    @property
    def heaped_capacity(self) -> float:
        """Rated volume [m^3]: heaped with slope 1 from all edges of the mouth (ISO 7451)."""
        (x0, y0), (x1, y1) = self.profile[0], self.profile[-1]
        short, long = sorted((self.width, hypot(x1 - x0, y1 - y0)))
        return self.struck_capacity + short**2 * (long / 4 - short / 12)


@shown_by_name
@dataclass(frozen=True)
class Machine:
    """One tracked backhoe; make a variant with `replace(BACKHOE, stick=replace(...))`.

    Raises:
        ValueError: gravity is not finite.
        TypeError: a part is of another type.
    """

    base: Base
    swing: Swing
    boom: Link
    stick: Link
    bucket: Link
    tracks: Tracks
    shell: Shell
    gravity: float

    def __post_init__(self) -> None:
        _keep(self, number, "gravity")
        _require_part(self, Base, "base")
        _require_part(self, Swing, "swing")
        _require_part(self, Link, "boom", "stick", "bucket")
        _require_part(self, Tracks, "tracks")
        _require_part(self, Shell, "shell")

    def __getstate__(self) -> dict[str, object]:
        """The numbers alone: a copy makes its own read-only arrays of them."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @property
    def links(self) -> tuple[Link, Link, Link]:
        """Boom, stick and bucket."""
        return (self.boom, self.stick, self.bucket)

    @property
    def joints(self) -> tuple[Joint, Joint, Joint, Joint]:
        """The four joints in the order of `JOINTS`."""
        return (self.swing.joint, self.boom.joint, self.stick.joint, self.bucket.joint)

    @cached_property
    def lower(self) -> NDArray:
        """Lower joint limits, shape (4,) [rad]."""
        return self._of_joints("lower")

    @cached_property
    def upper(self) -> NDArray:
        """Upper joint limits, shape (4,) [rad]."""
        return self._of_joints("upper")

    @cached_property
    def speed_limit(self) -> NDArray:
        """Largest joint speeds, shape (4,) [rad/s]."""
        return self._of_joints("speed")

    @cached_property
    def torque_limit(self) -> NDArray:
        """Largest joint torques, shape (4,) [N m]."""
        return self._of_joints("torque")

    @cached_property
    def viscous(self) -> NDArray:
        """Viscous friction coefficients, shape (4,) [N m s/rad]."""
        return self._of_joints("viscous")

    @cached_property
    def coulomb(self) -> NDArray:
        """Coulomb friction torques, shape (4,) [N m]."""
        return self._of_joints("coulomb")

    def _of_joints(self, name: str) -> NDArray:
        values = np.array([getattr(joint, name) for joint in self.joints])
        values.flags.writeable = False
        return values

    @property
    def mass(self) -> float:
        """Mass of the whole machine [kg]."""
        return self.tracks.mass + self.swing.mass + sum(link.mass for link in self.links)


BACKHOE = named(
    "BACKHOE",
    Machine(
        base=Base(height=1.1811, offset=0.4),
        swing=Swing(
            height=0.2756,
            offset=0.6241,
            mass=7018.4,
            com_radius=0.0982,
            com_angle=pi,
            com_height=0.6,
            inertia=10693.4,
            joint=Joint(-pi, pi, speed=1.1, torque=80e3, viscous=2000.0, coulomb=1500.0),
        ),
        boom=Link(
            length=5.1243,
            angle_offset=radians(13.1),
            mass=4293.5,
            com_radius=1.9204,
            com_angle=radians(26.7),
            inertia=11704.6,
            joint=Joint(
                radians(-50), radians(60), speed=0.7, torque=420e3, viscous=8000.0, coulomb=4000.0
            ),
        ),
        stick=Link(
            length=1.9129,
            angle_offset=-radians(88.1),
            mass=1151.2,
            com_radius=0.7281,
            com_angle=-radians(86.2),
            inertia=921.0,
            joint=Joint(
                radians(-60), radians(60), speed=1.0, torque=220e3, viscous=3000.0, coulomb=2000.0
            ),
        ),
        bucket=Link(
            length=1.484,
            angle_offset=-radians(104.1),
            mass=531.5,
            com_radius=0.8348,
            com_angle=-radians(78.6),
            inertia=130.7,
            joint=Joint(
                radians(-40), radians(120), speed=1.5, torque=130e3, viscous=1000.0, coulomb=800.0
            ),
        ),
        tracks=Tracks(
            gauge=2.38,
            length=3.65,
            shoe_width=0.6,
            height=0.85,
            sprocket_radius=0.35,
            max_speed=1.5,
            acceleration=1.0,
            mass=8500.0,
            friction_longitudinal=0.8,
            friction_lateral=0.6,
            belt_mass=1300.0,
            rolling_resistance=0.06,
            max_traction=100e3,
        ),
        shell=Shell(
            width=1.2,
            plate=0.025,
            profile=(
                (0.0, 0.0),
                (-0.30, 0.22),
                (-0.62, 0.46),
                (-0.90, 0.56),
                (-1.16, 0.48),
                (-1.30, 0.28),
                (-1.34, 0.05),
            ),
        ),
        gravity=9.81,
    ),
)
