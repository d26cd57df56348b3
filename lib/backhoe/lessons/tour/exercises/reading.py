"""First answers: a value, a conversion and a yes or no, from the machine's numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE


def arm_mass() -> float:
    """Mass of boom, stick and bucket together [kg]."""
    return sum(link.mass for link in BACKHOE.links)


def to_radians(angles_deg: ArrayLike) -> NDArray:
    """Angles in degrees, any shape, as radians, same shape."""
    return np.asarray(angles_deg) * np.pi / 180


def within_limits(q: ArrayLike) -> bool:
    """Whether every joint of q, shape (4,) [rad], is between its limits or on one."""
    return bool(np.all((q >= BACKHOE.lower) & (q <= BACKHOE.upper)))


def _limit_cases(rng: np.random.Generator) -> list[tuple[NDArray]]:
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (23, 4))
    np.fill_diagonal(q[15:19], BACKHOE.upper + 0.2)
    np.fill_diagonal(q[19:], BACKHOE.lower - 0.2)
    return [(one,) for one in (*q, BACKHOE.lower, BACKHOE.upper, BACKHOE.upper + 0.1)]


def _each_joint(q: NDArray) -> NDArray:
    return (q >= BACKHOE.lower) & (q <= BACKHOE.upper)


READING = (
    Exercise(
        number="0.1",
        title="The mass of the arm",
        reference=arm_mass,
        oracle="printed_table",
        rtol=1e-4,
        tested_on="boom, stick and bucket",
        mistakes={
            "that counts the house as well: the arm is boom, stick and bucket": (
                arm_mass() + BACKHOE.swing.mass
            ),
            "that is the whole machine: the arm is boom, stick and bucket": BACKHOE.mass,
            "the bucket is missing: it is the arm's last link": (
                BACKHOE.boom.mass + BACKHOE.stick.mass
            ),
            "that is the boom alone: stick and bucket are missing": BACKHOE.boom.mass,
            "that is in tonnes: the course counts mass in kilograms": arm_mass() / 1000,
            "that is the weight in newtons: leave gravity out, the mass is asked for": (
                arm_mass() * BACKHOE.gravity
            ),
        },
        hints=(
            "BACKHOE.boom.mass is the mass of the boom; the stick and the bucket have one too",
            "add the three, or write sum(link.mass for link in BACKHOE.links)",
        ),
    ),
    Exercise(
        number="0.2",
        title="Degrees to radians",
        reference=to_radians,
        oracle="numpys_own",
        cases=lambda rng: [(90.0,), *((rng.uniform(-180, 180, 4),) for _ in range(20))],
        tested_on="one angle and 20 random postures",
        mistakes={
            "these are still degrees: half a turn, 180 degrees, should become pi": np.asarray,
            "that is the other way round, from radians to degrees": np.degrees,
            "that is half of it: 2 pi is the full turn of 360 degrees, so pi goes with 180": (
                lambda angles_deg: angles_deg * np.pi / 360
            ),
            "your pi is cut off at 3.14: np.pi has all its digits": (
                lambda angles_deg: angles_deg * 3.14 / 180
            ),
            "negative angles have become positive: keep their sign, no turn must be added": (
                lambda angles_deg: np.radians(angles_deg) % (2 * np.pi)
            ),
            "the sign is lost: an angle to the right stays negative": (
                lambda angles_deg: np.abs(np.radians(angles_deg))
            ),
        },
        hints=(
            "half a turn is 180 degrees, and it is pi radians",
            "multiply by np.pi / 180; it works for a whole array at once",
        ),
    ),
    Exercise(
        number="0.3",
        title="Within the joint limits?",
        reference=within_limits,
        oracle="unchanged_by_clipping",
        cases=_limit_cases,
        tested_on="26 postures inside, outside and on the limits",
        mistakes={
            "the lower limits are not looked at": lambda q: np.all(q <= BACKHOE.upper),
            "the upper limits are not looked at": lambda q: np.all(q >= BACKHOE.lower),
            "one joint within its limits is not enough: all four must be, so np.all": (
                lambda q: np.any(_each_joint(q))
            ),
            "it says True to every posture; degrees in it? q and the limits are in radians": (
                lambda q: np.all(_each_joint(np.radians(q)))
            ),
            "it says False to every posture: does a comparison point the wrong way?": (
                lambda q: False
            ),
            "the two limits of a joint differ: -50 and 60 degrees for the boom, for instance": (
                lambda q: np.all(np.abs(q) <= BACKHOE.upper)
            ),
            "a joint may stand exactly on its limit: use <= and >=": (
                lambda q: np.all((q > BACKHOE.lower) & (q < BACKHOE.upper))
            ),
            "that is an answer for each joint: one for the whole arm is asked, so np.all": (
                _each_joint
            ),
            "it is the wrong way round: True means that the posture is allowed": (
                lambda q: not within_limits(q)
            ),
        },
        hints=(
            "BACKHOE.lower and BACKHOE.upper hold four limits: q <= BACKHOE.upper compares all",
            "join the two comparisons with &, each in brackets, and ask np.all of the result",
        ),
    ),
)
