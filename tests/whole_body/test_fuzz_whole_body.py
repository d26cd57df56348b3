"""Wrong input at every public function of whole_body: `fuzz` says what is tried and allowed."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe import whole_body
from backhoe.machine import BACKHOE as MACHINE
from backhoe.whole_body import BACKHOE, SLIDES, jacobian, stability
from fuzz import assert_answers_or_names, assert_complete, method, public

RNG = np.random.default_rng(12)
Q = RNG.uniform(-0.5, 0.5, 7)
JOINTS, ARM = Q[3:].copy(), RNG.uniform(-0.5, 0.5, (2, 3))
J, B, V0 = jacobian(Q), RNG.normal(size=3), RNG.normal(size=6)
MANY = jacobian(RNG.uniform(-0.5, 0.5, (2, 6)), SLIDES)
LOW, HIGH = np.full(4, -1.0), np.full(4, 1.5)
PLACE = whole_body.hand(Q)
POSTS, BALLS = RNG.uniform(2, 4, (2, 2)), RNG.uniform(2, 4, (2, 3))
RESULTS = "Robot Limited Rows Clearance Ellipsoid Following".split()
RESULTS += "Margin Tipping LiftingChart".split()
"""Made by functions, not by hand, or a form."""


def plant() -> whole_body.KinematicPlant:
    return whole_body.KinematicPlant(SLIDES, np.zeros(6), dt=0.1)


def slides_path() -> whole_body.HandPath:
    return whole_body.circle_path(whole_body.hand(np.zeros(6), SLIDES), 2.0, radius=0.05)


def calls() -> dict[str, tuple]:
    """A function and its arguments under its name, every one of them."""
    pushed = {
        "load": 100.0,
        "yaw_rate": 0.1,
        "acceleration": np.full(3, 0.1),
        "soil": np.full(4, 10.0),
        "slope": 0.1,
        "uphill": 0.2,
        "machine": MACHINE,
    }
    rates = {"q": JOINTS, "dq": np.full(4, 0.1), "ddq": np.full(4, 0.1)}
    timed = {"heading": 0.1, "soft": 1.0, "duration": 20.0, "start": PLACE}
    table = {
        whole_body.SlidesRobot: {"a": 0.2, "h": 0.4, "l2": 0.3, "l3": 0.3},
        whole_body.Excavator: {"machine": MACHINE},
        whole_body.hand: {"q": Q, "robot": BACKHOE},
        whole_body.jacobian: {"q": Q, "robot": BACKHOE},
        whole_body.minimum_norm: {
            "J": J, "b": B, "preferred": V0, "weights": np.ones(6), "damping": 0.1
        },
        whole_body.null_projector: {"J": J},
        whole_body.damping_near_singularity: {"J": MANY, "threshold": 0.1, "largest": 0.1},
        whole_body.strict_priorities: {
            "tasks": [(J, B), (np.eye(2, 6), np.ones(2))], "preferred": V0, "damping": 0.1,
            "least": 1e-8,
        },
        whole_body.limited_velocity: {
            "J": J, "b": B, "lower": np.full(6, -1.0), "upper": np.full(6, 1.0), "preferred": V0,
            "weights": np.ones(6), "A": np.eye(2, 6), "c": np.full(2, 0.3), "small": 1e-4,
        },
        whole_body.joint_bounds: {
            "q": JOINTS, "lowest": LOW, "highest": HIGH, "fastest": np.ones(4), "T": 0.1
        },
        whole_body.track_rows: {"machine": MACHINE, "velocities": 6},
        whole_body.margin_rows: {
            "q": JOINTS, "least": 0.1, "rate": 2.0, "load": 100.0, "slope": 0.1, "uphill": 0.2,
            "machine": MACHINE,
        },
        whole_body.wanted_velocity: {
            "h": PLACE, "goal": PLACE + 0.1, "next_goal": PLACE + 0.2, "W": np.full(3, 0.5),
            "T": 0.1, "fastest": 9.0,
        },
        whole_body.manipulability: {"J": MANY, "weights": np.ones(5)},
        whole_body.manipulability_gradient: {
            "q": Q, "robot": BACKHOE, "part": "arm", "weights": np.ones(6)
        },
        whole_body.characteristic_length: {"robot": BACKHOE, "q": Q},
        whole_body.length_weights: {"robot": BACKHOE, "length": 1.0},
        whole_body.ellipsoid: {"J": J, "weights": np.ones(6)},
        whole_body.to_posture: {"q": Q, "wanted": np.zeros(4), "gain": 1.0, "robot": BACKHOE},
        whole_body.to_manipulability: {
            "q": Q, "gain": 1.0, "robot": BACKHOE, "part": "arm", "length": 2.0
        },
        whole_body.from_limits: {
            "q": Q, "lowest": LOW, "highest": HIGH, "gain": 1.0, "robot": BACKHOE
        },
        whole_body.steer_clear: {
            "q": Q, "obstacles": POSTS, "within": 2.0, "brake": 1.0, "turn": 1.0, "size": 0.5,
            "forwards": True, "robot": BACKHOE,
        },
        whole_body.keep_clear: {
            "q": Q, "obstacles": BALLS, "within": 2.0, "speed": 1.0, "size": 0.5, "length": 2.0,
            "robot": BACKHOE,
        },
        whole_body.clearance: {"q": Q, "obstacles": BALLS, "size": 0.1, "robot": BACKHOE},
        whole_body.KinematicPlant: {
            "robot": SLIDES, "q": np.zeros(6), "dt": 0.1, "lag": np.full(5, 0.1),
            "fastest": np.ones(5),
        },
        whole_body.HandPath: {
            "start": PLACE, "drift": np.zeros(3), "cosines": np.eye(2, 3), "sines": np.eye(2, 3),
            "duration": 9.0, "turns": 1.0, "soft": 1.0,
        },
        whole_body.sine_path: {
            **timed, "length": 3.0, "waves": 2.0, "sideways": 0.3, "upwards": 0.1
        },
        whole_body.circle_path: {**timed, "radius": 0.5, "tilt": 0.2, "turns": 1.0},
        whole_body.eight_path: {
            **timed, "length": 1.0, "width": 0.5, "height": 0.3, "turns": 1.0
        },
        stability.centre_of_mass: {"q": JOINTS, "load": 100.0, "machine": MACHINE},
        stability.centre_of_mass_jacobian: {"q": JOINTS, "load": 100.0, "machine": MACHINE},
        stability.zero_moment_point: {**rates, **pushed},
        stability.margin: {**rates, **pushed},
        stability.gravity_on_slope: {"slope": 0.1, "uphill": 0.2, "machine": MACHINE},
        stability.support_polygon: {"machine": MACHINE},
        stability.distances: {"points": POSTS, "polygon": stability.support_polygon()},
        stability.tipping_load: {"q": JOINTS, "slope": 0.1, "uphill": 0.2, "machine": MACHINE},
        stability.lifting_chart: {
            "radius": np.array([3.0, 4.0]), "height": np.array([0.0, 1.0]), "machine": MACHINE
        },
    }  # fmt: skip
    found = {function.__qualname__: (function, given) for function, given in table.items()}
    methods = [
        (lambda: SLIDES, "reach", {"q_arm": ARM}),
        (lambda: SLIDES, "reach_jacobian", {"q_arm": ARM}),
        (lambda: SLIDES, "axes", {"q_arm": ARM}),
        (lambda: BACKHOE, "reach", {"q_arm": JOINTS}),
        (lambda: BACKHOE, "reach_jacobian", {"q_arm": JOINTS}),
        (lambda: BACKHOE, "axes", {"q_arm": JOINTS}),
        (plant, "step", {"v": np.full(5, 0.1)}),
        (plant, "reset", {}),
        (slides_path, "velocity", {"t": np.array([0.1, 0.2])}),
    ]
    for make, name, given in methods:
        found[f"{type(make()).__name__}.{name}"] = method(make, name), given

    def follow(path, W, preferred, lag, duration, fastest):
        return whole_body.follow(
            plant(), path, W=W, preferred=preferred, lag=lag, duration=duration, fastest=fastest
        )

    found["follow"] = follow, {
        "path": slides_path(), "W": np.full(3, 0.9), "preferred": lambda q: np.zeros(5),
        "lag": np.full(5, 0.1), "duration": 0.5, "fastest": 3.0,
    }  # fmt: skip
    return found


TABLE, NAMES = calls(), public([whole_body, stability], RESULTS)

SAID = {"q_arm": ("q",), "tasks": ("J of", "b of"), "preferred": ("v0",), "path": ("places",)}
SAID |= {"slope": ("leading axes",)}
"""Words that stand for an argument in an error."""

SLOW = ("follow", "lifting_chart")
"""Too slow to try each value, and pairs of arguments."""


def test_every_public_function_is_called_with_all_its_arguments():
    assert_complete(TABLE, NAMES)


@pytest.mark.parametrize("name", sorted(NAMES))
@pytest.mark.timeout(300)
def test_wrong_input_is_answered_or_refused_by_name(name):
    assert_answers_or_names(*TABLE[name], SAID, len(name), name in SLOW)
