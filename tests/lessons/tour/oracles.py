"""What proves the answers of lesson 00's exercises."""

import numpy as np

from backhoe.arm import kinematics
from backhoe.lessons import published
from backhoe.machine import BACKHOE


def printed_table(answer):
    """Table A.2 of Mastalli 2013 as it is stored."""
    masses = published.load("mastalli_2013_table_a2")["masses"]
    np.testing.assert_allclose(answer, masses["m_bo"] + masses["m_s"] + masses["m_bu"])


def numpys_own(answer, angles_deg):
    """NumPy has the conversion."""
    np.testing.assert_allclose(answer, np.deg2rad(angles_deg), rtol=1e-14)


def unchanged_by_clipping(answer, q):
    """A posture is within the limits if bringing it within them changes nothing."""
    assert answer is np.array_equal(np.clip(q, BACKHOE.lower, BACKHOE.upper), q)


def chord_about_each_joint(answer, q):
    """A joint moves the teeth on a circle about its axis: the chord is 2 rho sin(angle / 2)."""
    swing, boom, stick, teeth = kinematics.link_transforms(q)[:, :3, 3]
    radii = [
        np.hypot(*(teeth - [BACKHOE.base.offset, 0.0, 0.0])[:2]),
        *(np.linalg.norm(teeth - hinge) for hinge in (swing, boom, stick)),
    ]
    np.testing.assert_allclose(answer, 2 * np.sin(np.radians(0.5)) * np.array(radii), rtol=1e-9)


def busiest_joint_at_its_share(answer, q_way, share):
    """In each segment the busiest joint's mean speed is just the share of its limit, forwards."""
    used = np.abs(np.diff(q_way, axis=0)) / answer[:, None]
    speeds = [joint.speed for joint in BACKHOE.joints]
    np.testing.assert_allclose((used / speeds).max(axis=1), np.full(len(q_way) - 1, share))


EQUAL = {
    "0.5": {
        "the result is never negative": "durations",
        "share is never negative": "a share of a limit",
    },
}
"""Mutants that are the reference in disguise, with the reason."""
