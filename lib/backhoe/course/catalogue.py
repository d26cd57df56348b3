"""The exercises of every lesson, loaded lesson by lesson when they are first asked for.

A lesson adds its exercises by its name here; `backhoe.lessons.<name>.exercises` has a tuple
`EXERCISES`.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.util import find_spec

from backhoe.lessons.exercise import Exercise

LESSONS = {
    "0": "tour",
    "1": "kinematics",
    "2": "dynamics",
    "3": "lyapunov_pid",
    "4": "skid_steer",
    "5": "path_tracking",
    "6": "odometry",
    "7": "ekf",
    "8": "stereo",
    "9": "voxel_map",
    "10": "primitives",
    "11": "planning",
    "12": "mobile_manipulation",
    "14": "autonomy",
}


def written() -> list[str]:
    """Numbers of the lessons whose module of exercises exists."""
    return [
        number for number, name in LESSONS.items() if find_spec(f"backhoe.lessons.{name}.exercises")
    ]


@cache
def lesson(number: str) -> dict[str, Exercise]:
    """The exercises of one lesson by their number, in the order of the lesson.

    Raises:
        ValueError: no such lesson, an exercise is numbered for another lesson, or twice.
    """
    if number not in written():
        raise ValueError(f"no exercises for lesson {number!r}: there are {', '.join(written())}")
    exercises: dict[str, Exercise] = {}
    for exercise in import_module(f"backhoe.lessons.{LESSONS[number]}.exercises").EXERCISES:
        if exercise.number.split(".")[0] != number or exercise.number in exercises:
            raise ValueError(f"lesson {number}: exercise number {exercise.number} is misplaced")
        exercises[exercise.number] = exercise
    return exercises


def find(number: str) -> Exercise:
    """The exercise of that number, such as "1.2".

    Raises:
        ValueError: there is none; the message lists the numbers near it.
    """
    if not isinstance(number, str):
        raise ValueError(f'the number of an exercise is text, such as "1.2", got {number!r}')
    start = number.strip().split(".")[0]
    if start not in written():
        lessons = ", ".join(f"{name}.1, ..." for name in written())
        raise ValueError(f"there is no exercise {number!r}: exercises are numbered {lessons}")
    known = lesson(start)
    if number.strip() not in known:
        raise ValueError(f"there is no exercise {number!r}: lesson {start} has {', '.join(known)}")
    return known[number.strip()]
