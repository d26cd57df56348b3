"""The eyes on the house: one stereo pair, and a nodding laser scanner on each side.

A mount places a sensor on a link. The house's axes ("swing") begin at the boom's joint: x forward,
y up, z to the right. A laser's axes at nod 0 are x ahead, along its middle beam, y left and z up;
its beams lie in the plane of x and y, and it nods about y, downwards for a positive angle. A
camera's are x right, y down and z ahead.

Mastalli 2013 (section 5.1) has one stereo camera in the middle and a laser on each side, and gives
no numbers. Ours are those of public scanners where `PUBLIC_SCANNERS` has them. The cameras stand on
the cab's front edge: in the middle the raised boom would fill the picture.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import cos, radians, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, instance, not_negative, number, numbers, positive, whole
from backhoe.machine import JOINTS

PUBLIC_SCANNERS = {
    "SICK LMS1xx": {"noise": 0.012, "bias": 0.030, "divergence": 0.0150, "spot": 0.008},
    "SICK LMS5xx HR": {"noise": 0.007, "bias": 0.025, "divergence": 0.0046, "spot": 0.013},
    "SICK LMS5xx SR": {"noise": 0.006, "bias": 0.025, "divergence": 0.0110, "spot": 0.013},
}
"""What the maker prints of scanners of this kind: statistical and systematic error up to 10 m [m],
growth of the beam's diameter [rad] and the diameter at the front screen [m]. All turn 25 or 50
times a second; the LMS5xx up to 100 times, with beams 1/6 to 1 degree apart."""

SCANNER_SOURCES = {
    "errors": "support.sick.com/sick-knowledgebase, article Measurement Errors LMSxxx",
    "beams": "operating instructions 8012471 (LMS1xx), section 3.6.2; 8013796 (LMS5xx), 3.5, 3.6",
}
"""Where those figures stand."""


@dataclass(frozen=True)
class Mount:
    """Where a sensor sits.

    Attributes:
        link: whose axes: "undercarriage", or one of `machine.JOINTS`.
        T_link_sensor: pose of the sensor in them, shape (4, 4) [1, m].

    Raises:
        ValueError: another link, or a pose that is no rotation and translation.
    """

    link: str
    T_link_sensor: NDArray

    def __post_init__(self) -> None:
        choice(self.link, "Mount.link", ("undercarriage", *JOINTS))
        T = np.array(numbers(self.T_link_sensor, "Mount.T_link_sensor", (4, 4)))
        R = T[:3, :3]
        if np.abs(R @ R.T - np.eye(3)).max() > 1e-9 or np.linalg.det(R) < 0 or any(T[3] != _LAST):
            raise ValueError(f"Mount.T_link_sensor must turn and move, got {T.tolist()}")
        T.flags.writeable = False
        object.__setattr__(self, "T_link_sensor", T)


_LAST = [0.0, 0.0, 0.0, 1.0]


@dataclass(frozen=True)
class Laser:
    """A scanner of one line that nods: angles [rad], lengths [m], times [s].

    Attributes:
        mount: where it sits, at nod 0.
        field_of_view: from the first beam, on its right, to the last.
        beams: in a line.
        line_rate: lines a second [1/s]: turns of the mirror, which goes round at a constant speed.
        nod_middle, nod_amplitude, nod_period: nod = middle - amplitude cos(2 pi t / period).
        noise: standard deviation of a range.
        divergence: growth of the beam's diameter with the range.
        spot: the beam's diameter as it leaves.
        echo: surfaces in one beam nearer to each other than this give one range, their mean.
        least, most: ranges that it measures.

    Raises:
        ValueError: a value that is not finite, not positive (noise, divergence, spot and least may
            be 0, the nod's angles anything), fewer than two beams, a line longer than a turn, or
            `most` not above `least`.
        TypeError: mount is no Mount.
    """

    mount: Mount
    field_of_view: float
    beams: int
    line_rate: float
    nod_middle: float
    nod_amplitude: float
    nod_period: float
    noise: float
    divergence: float
    spot: float
    echo: float
    least: float
    most: float

    def __post_init__(self) -> None:
        instance(self.mount, "Laser.mount", Mount)
        whole(self.beams, "Laser.beams", least=2)
        free = {"nod_middle", "nod_amplitude"}
        for field in fields(self)[1:]:
            name, value = f"Laser.{field.name}", getattr(self, field.name)
            if field.name in free:
                number(value, name, "rad")
            elif field.name in {"noise", "divergence", "spot", "least"}:
                not_negative(value, name)
            else:
                positive(value, name)
        number(self.field_of_view, "Laser.field_of_view", "rad", most=2 * np.pi)
        number(self.most, "Laser.most", "m", above=self.least)

    @property
    def sweep_lines(self) -> int:
        """Lines in a sweep, half a nod: from the highest line to the lowest."""
        return round(self.line_rate * self.nod_period / 2)


@dataclass(frozen=True)
class StereoPair:
    """Two equal cameras side by side.

    Attributes:
        mount: of the left one.
        size: width and height of the pictures [pixels].
        field_of_view: from left to right [rad].
        baseline: to the right camera, along the left one's x [m].

    Raises:
        ValueError: sizes below 1, an angle that is not between 0 and pi, a baseline not above 0.
        TypeError: mount is no Mount.
    """

    mount: Mount
    size: tuple[int, int]
    field_of_view: float
    baseline: float

    def __post_init__(self) -> None:
        instance(self.mount, "StereoPair.mount", Mount)
        numbers(self.size, "StereoPair.size", (2,), meaning="width and height [pixels]")
        for side in self.size:
            whole(side, "StereoPair.size", least=1)
        number(self.field_of_view, "StereoPair.field_of_view", "rad", above=0, below=np.pi)
        positive(self.baseline, "StereoPair.baseline", "m")

    @property
    def right(self) -> Mount:
        """Mount of the right camera."""
        T = self.mount.T_link_sensor.copy()
        T[:3, 3] += self.baseline * T[:3, 0]
        return Mount(self.mount.link, T)


def sensor_pose(T_frame_link: ArrayLike, mount: Mount) -> NDArray:
    """Poses of a sensor from those of its link, as `T` of frame and sensor.

    Args:
        T_frame_link: of the mount's link in any frame, such as the world, shape (..., 4, 4) [1, m].
        mount: where the sensor sits on it.

    Returns:
        Shape (..., 4, 4) [1, m].

    Raises:
        ValueError: another shape, or values that are not finite.
        TypeError: mount is no Mount.
    """
    mount = instance(mount, "mount", Mount)
    return numbers(T_frame_link, "T_frame_link", (..., 4, 4)) @ mount.T_link_sensor


def _on_house(at: tuple[float, float, float], left: float, down: float, camera: bool) -> Mount:
    """A sensor turned to the left and down [rad], at x, y, z in the axes of the house [m]."""
    ahead = np.array([cos(down) * cos(left), -sin(down), -cos(down) * sin(left)])
    to_left = np.array([-sin(left), 0.0, -cos(left)])
    up = np.cross(ahead, to_left)
    axes = (-to_left, -up, ahead) if camera else (ahead, to_left, up)
    T = np.eye(4)
    T[:3] = np.c_[np.stack(axes, axis=1), at]
    return Mount("swing", T)


def _laser(side: float) -> Laser:
    """To the left for side = 1, to the right for -1; `PUBLIC_SCANNERS` has its beam's numbers."""
    beam = PUBLIC_SCANNERS["SICK LMS5xx HR"]
    return Laser(
        mount=_on_house((0.75, 1.95, -1.5 * side), radians(20) * side, 0.0, camera=False),
        field_of_view=radians(140),
        beams=211,
        line_rate=50.0,
        nod_middle=radians(28),
        nod_amplitude=radians(32),
        nod_period=3.2,
        noise=beam["noise"],
        divergence=beam["divergence"],
        spot=beam["spot"],
        echo=1.0,
        least=0.3,
        most=30.0,
    )


LASERS = {"left": _laser(1.0), "right": _laser(-1.0)}
"""The scanners. Places, nod, number of lines and beams (2/3 of a degree apart), echo and ranges are
our choice: a sweep of both, 1.6 s, is 33,760 beams."""

STEREO = StereoPair(
    mount=_on_house((0.75, 1.95, -1.0), 0.0, radians(25), camera=True),
    size=(640, 480),
    field_of_view=radians(60),
    baseline=0.40,
)
"""The cameras, all numbers our choice."""
