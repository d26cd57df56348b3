"""Exercises 1.1 to 1.3: angles that one sees, the teeth from the side, how deep a machine digs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, Machine, replace

OFFSETS = np.array([link.angle_offset for link in BACKHOE.links])
_LENGTHS = np.array([link.length for link in BACKHOE.links])
_HINGE = np.array([BACKHOE.swing.offset, BACKHOE.base.height + BACKHOE.swing.height, 0.0])


def joint_angles(direction: float, pitches: ArrayLike) -> NDArray:
    """q from the arm's direction (0 forward, positive to the left) and the links' pitches [rad]."""
    turns = np.diff(pitches, prepend=0.0)
    offsets = [link.angle_offset for link in BACKHOE.links]
    return np.append(direction - np.pi / 2, turns - offsets)


def _angle_cases(rng: np.random.Generator) -> list[tuple]:
    ends = [(0.0, np.zeros(3)), (-np.pi / 2, np.array([0.5, -1.0, 0.5])), (np.pi, -np.ones(3))]
    low, high = (-0.6, -2, -4), (1, -1, -0.5)
    return [*ends, *((rng.uniform(-1.5, 3.0), rng.uniform(low, high)) for _ in range(40))]


def _plus_offsets(times: float) -> Callable[[float, NDArray], NDArray]:
    return lambda *given: joint_angles(*given) + times * np.append(0.0, OFFSETS)


ANGLES = Exercise(
    number="1.1",
    title="From what you see to what you set",
    reference=joint_angles,
    oracle="seen_by_the_forward_kinematics",
    cases=_angle_cases,
    mistakes={
        "a joint turns its link relative to the link before it: take the difference of pitches": (
            lambda direction, pitches: joint_angles(direction, np.cumsum(pitches))
        ),
        "q* = q + offset, so q = q* - offset: you have added the offsets": _plus_offsets(2),
        "these are q*, the angles of the table: take the offsets off to get q": _plus_offsets(1),
        "at q1 = 0 the arm points left, not forward: q1* = q1 + pi/2": (
            lambda direction, pitches: joint_angles(direction + np.pi / 2, pitches)
        ),
        "the swing is off by half a turn: q1 = direction - pi/2, not + pi/2": (
            lambda direction, pitches: joint_angles(direction + np.pi, pitches)
        ),
        "these are degrees: everything inside the course is in radians": (
            lambda *given: np.degrees(joint_angles(*given))
        ),
    },
    hints=(
        "Find q2* first: the boom is the first link, so its pitch is q2* itself. Then the stick.",
        "q* = (pitch_boom, pitch_stick - pitch_boom, pitch_bucket - pitch_stick); q = q* - offset.",
    ),
    tested_on="43 directions and pitches, zero and the ends among them",
)


def side_view(q: ArrayLike) -> NDArray:
    """Teeth: distance from the swing axis [m], height [m]; and the bucket's pitch [rad]."""
    r, z = BACKHOE.swing.offset, BACKHOE.base.height + BACKHOE.swing.height
    pitch = 0.0
    for angle, link in zip(q[1:], BACKHOE.links, strict=True):
        pitch += angle + link.angle_offset
        r += link.length * np.cos(pitch)
        z += link.length * np.sin(pitch)
    return np.array([r, z, pitch])


def _side(
    pitches: Callable = lambda q: np.cumsum(q[1:] + OFFSETS), lengths: NDArray = _LENGTHS
) -> Callable[[NDArray], NDArray]:
    def view(q: NDArray) -> NDArray:
        seen = pitches(q)
        return np.add(_HINGE, (lengths @ np.cos(seen), lengths @ np.sin(seen), seen[-1]))

    return view


def _less(rho: float, z: float) -> Callable[[NDArray], NDArray]:
    return lambda q: side_view(q) - (rho, z, 0.0)


SIDE_VIEW = Exercise(
    number="1.2",
    title="The teeth seen from the side",
    reference=side_view,
    oracle="tip_in_the_plane_of_the_arm",
    cases=lambda rng: [
        (q,)
        for q in (*rng.uniform(BACKHOE.lower, BACKHOE.upper, (60, 4)), np.zeros(4), BACKHOE.upper)
    ],
    mistakes={
        "each link is pitched by the sum of all q* up to it, not by its own q* alone": (
            _side(lambda q: q[1:] + OFFSETS)
        ),
        "the offsets of Table A.1 are missing: q* = q + offset": _side(lambda q: np.cumsum(q[1:])),
        "the height counts from the ground: add the base's height L0": (
            _less(0.0, BACKHOE.base.height)
        ),
        "the boom's joint is L0 + L1 above the ground: add both": _less(0.0, _HINGE[1]),
        "the boom's joint is b1 away from the swing axis: start rho there": _less(_HINGE[0], 0.0),
        "rho counts from the swing axis, which is b0 ahead of the base's origin: leave b0 out": (
            _less(-BACKHOE.base.offset, 0.0)
        ),
        "right but for whole turns of the pitch: leave it as the sum of the q*, do not wrap it": (
            lambda q: np.append(side_view(q)[:2], wrap(side_view(q)[2]))
        ),
        "sine and cosine are swapped: pitch 0 is level": (
            lambda q: _HINGE + (side_view(q) - _HINGE)[[1, 0, 2]]
        ),
        "that is the bucket's pin: one more length L4 leads to the teeth": (
            _side(lengths=_LENGTHS * (1, 1, 0))
        ),
    },
    hints=(
        "Start at the boom's joint, (b1, L0 + L1), and add three arrows, one a link.",
        "The arrow of a link is its length times (cos pitch, sin pitch); np.cumsum adds the q*.",
    ),
    tested_on="62 postures within the limits",
)


def dig_depth(machine: Machine) -> float:
    """How far below the ground the teeth get within the joint limits [m]."""
    ranges = zip(machine.lower[1:], machine.upper[1:], strict=True)
    grid = np.meshgrid(*(np.linspace(low, high, 31) for low, high in ranges), indexing="ij")
    q = np.stack((np.zeros_like(grid[0]), *grid), axis=-1)
    height = kinematics.forward_kinematics(q, machine=machine)[..., 2, 3]
    return -height.min()


def nearly_deep_enough(answer: float, reference: float, machine: Machine) -> bool | str:
    """Compare depths to 3 cm; a search that only just misses is told so."""
    if np.shape(answer) != ():
        return "one depth for the machine is asked, a single number [m]"
    if 0.03 < reference - answer < 0.15:
        return "nearly: some postures between yours reach a little deeper, so try more of them"
    return abs(answer - reference) <= 0.03


def _other_machine(rng: np.random.Generator, kind: int = 0) -> Machine:
    """Other lengths and limits: of 1 to 5 stick or bucket cannot hang down, 6 stays in the air."""
    boom, stick, bucket = (
        replace(link, length=link.length * rng.uniform(0.75, 1.3)) for link in BACKHOE.links
    )
    ranges = (
        (rng.uniform(-45, -25), 60) if kind < 6 else (30, 60),
        ((-60, 60), (-60, rng.uniform(-15, 5)), (rng.uniform(30, 45), 60))[kind % 3],
        ((-40, 120), (-40, rng.uniform(20, 80)))[kind // 3 % 2],
    )
    links = (
        replace(link, joint=replace(link.joint, lower=low, upper=high))
        for link, (low, high) in zip((boom, stick, bucket), np.radians(ranges), strict=True)
    )
    return replace(BACKHOE, **dict(zip(("boom", "stick", "bucket"), links, strict=True)))


def _height(machine: Machine) -> float:
    return machine.base.height + machine.swing.height


def _depth_with(name: str, change: Callable) -> Callable[[Machine], float]:
    """Depth of the machine with one link changed."""
    return lambda machine: dig_depth(replace(machine, **{name: change(getattr(machine, name))}))


def _turning(low: float, high: float) -> Callable[[object], object]:
    return lambda link: replace(link, joint=replace(link.joint, lower=low, upper=high))


_stiff, _free = _turning(-1e-9, 1e-9), _turning(-np.pi, np.pi)


def _hanging(machine: Machine) -> float:
    boom, stick, bucket = machine.links
    lowest = boom.length * np.sin(machine.lower[1] + boom.angle_offset)
    return stick.length + bucket.length - lowest - _height(machine)


def _at_the_limits(machine: Machine) -> float:
    q = np.stack(np.meshgrid(0.0, *zip(machine.lower[1:], machine.upper[1:], strict=True)), -1)
    return -kinematics.forward_kinematics(q, machine=machine)[..., 2, 3].min()


DEPTH = Exercise(
    number="1.3",
    title="How deep does it dig?",
    reference=dig_depth,
    oracle="lowest_of_all_within_the_limits",
    cases=lambda rng: [(_other_machine(rng, kind),) for kind in range(7)],
    mistakes={
        "the boom does not hang straight down: keep every joint within its limits": (
            lambda machine: sum(link.length for link in machine.links) - _height(machine)
        ),
        "stick and bucket cannot always hang straight down: they have limits of their own": (
            _hanging
        ),
        "the stick has limits, too: machine.lower[2] and machine.upper[2]": (
            _depth_with("stick", _free)
        ),
        "the bucket has limits, too: machine.lower[3] and machine.upper[3]": (
            _depth_with("bucket", _free)
        ),
        "the deepest posture may lie between the limits: try angles between them, too": (
            _at_the_limits
        ),
        "that is BACKHOE's own depth each time: use the machine that you are given": (
            lambda machine: dig_depth(BACKHOE)
        ),
        (
            "the limits are the given machine's, the lengths are not: pass machine=machine to "
            "forward_kinematics"
        ): lambda machine: _depth_with("boom", lambda link: replace(link, joint=machine.joints[1]))(
            BACKHOE
        ),
        "that is the depth of the bucket's pin: the teeth reach further": (
            _depth_with("bucket", lambda link: replace(link, length=1e-9))
        ),
        "that is the depth below the boom's joint: the ground is L0 + L1 below it": (
            lambda machine: dig_depth(machine) + _height(machine)
        ),
        "that is a height: the depth below the ground is positive": (
            lambda machine: -dig_depth(machine)
        ),
        "the bucket joint stays at zero in your search: let it turn as well": (
            _depth_with("bucket", _stiff)
        ),
        "the stick joint stays at zero in your search: let it turn as well": (
            _depth_with("stick", _stiff)
        ),
    },
    hints=(
        "Try many postures between machine.lower and machine.upper: thirty angles a joint will do.",
        "np.meshgrid gives q of shape (..., 4); forward_kinematics(q, machine=machine)[..., 2, 3].",
    ),
    compare=nearly_deep_enough,
    rtol=0.0,
    atol=0.03,
    timeout=30.0,
    tested_on="7 machines with other links and limits, to 3 cm",
)
