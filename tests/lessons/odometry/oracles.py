"""What proves the answers of lesson 06's exercises."""

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

from backhoe.localisation.odometry import Wheels, square
from backhoe.machine import BACKHOE

EQUAL = {
    "6.3": {
        "the result at [0] is never negative": "the first wheel drives across x: its v_x is 0",
        "radius is never negative": "a wheel's radius is a length",
        "distance is never negative": "the distance of a wheel from the middle is a length",
    },
    "6.5": {"dt is never negative": "time goes forwards"},
    "6.6": {
        "counts is never negative": "a counter's readings begin at 0",
        "bits: abs": "a counter has at least one bit",
    },
    "6.8": {
        "dt is never negative": "time goes forwards",
        "gauge is never negative": "a gauge is a length",
    },
    "6.9": {
        "radius is never negative": "a wheel's radius is a length",
        "the result is never negative": "a gauge is a length",
    },
}
"""Mutants of a reference that change nothing for what can be asked, with the reason."""


def area_under_straight_lines(answer, t, v):
    """SciPy integrates the straight lines from sample to sample."""
    area = make_interp_spline(t, v, k=1).antiderivative()
    np.testing.assert_allclose(answer, area(t) - area(t[0]), atol=1e-12)


def nothing_left_that_follows_the_step(answer, steps, errors):
    """With the best slope, what is left of log error does not correlate with log step."""
    step = np.log(steps) - np.log(steps).mean()
    left = np.log(errors) - answer * np.log(steps)
    np.testing.assert_allclose(left @ step, 0.0, atol=1e-10)


def rims_as_fast_as_their_places(answer, radius, distance):
    """A rim runs as its place in the turning body does, along the way in which the wheel drives."""
    for twist in np.eye(3):
        speeds = []
        for angle in np.radians((0.0, 120.0, 240.0)):
            place = distance * np.exp(1j * angle)
            velocity = twist[0] + 1j * twist[1] + 1j * twist[2] * place
            speeds.append((velocity * np.exp(-1j * (angle + np.pi / 2))).real / radius)
        np.testing.assert_allclose(answer @ speeds, twist, atol=1e-12)


def turn_at_the_old_rate_then_average(answer, x, u_old, u_new, dt, f):
    """A robot's rates at both ends in closed form, the last heading from the rate at the start."""
    (v_old, _, turn_old), (v_new, _, turn_new) = f(np.zeros(3), u_old), f(np.zeros(3), u_new)
    ahead = v_old * np.exp(1j * x[2]) + v_new * np.exp(1j * (x[2] + dt * turn_old))
    moved = dt / 2 * np.array([ahead.real, ahead.imag, turn_old + turn_new])
    np.testing.assert_allclose(answer, x + moved, rtol=1e-12)


def exponential_of_the_twist(answer, pose, v, omega, dt, atol=1e-12):
    """SciPy's matrix exponential of the twist leads from the first pose to the last."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    start = np.array([[c, -s, pose[0]], [s, c, pose[1]], [0.0, 0.0, 1.0]])
    end = start @ expm(dt * np.array([[0.0, -omega, v], [omega, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    np.testing.assert_allclose(answer[:2], end[:2, 2], rtol=0.0, atol=atol)
    np.testing.assert_allclose(answer[2], pose[2] + omega * dt, rtol=1e-12)


def unwrapped_by_numpy(answer, counts, bits):
    """NumPy unwraps readings of any period."""
    np.testing.assert_array_equal(answer, np.diff(np.unwrap(counts, period=2**bits)))


def squares_end_there_again(answer, cw, ccw, side, gauge):
    """With such wheels the squares end where they were seen to, but for second order."""
    found, ratio = answer
    assert found > 0 and ratio > 0
    wheels = Wheels(2 / (1 + ratio), 2 * ratio / (1 + ratio), found)
    seen = np.array([cw[:, 0].mean(), ccw[:, 0].mean()])
    x = [square(wheels, Wheels(1.0, 1.0, gauge), side, way)[0, 0] for way in ("cw", "ccw")]
    np.testing.assert_allclose(x, seen, rtol=0.0, atol=seen @ seen / side)


def exponential_of_the_belts_twist(answer, pose, left, right, dt, gauge):
    """The arc of the twist that gives both belts their speeds; a chord leaves it by 0.01 mm."""
    belts = BACKHOE.tracks.sprocket_radius * np.array([left, right])
    v, omega = np.linalg.solve([[1.0, -gauge / 2], [1.0, gauge / 2]], belts)
    exponential_of_the_twist(answer, pose, v, omega, dt, atol=1e-5)


def heading_is_explained_no_better_beside_it(answer, left, right, heading, radius):
    """SciPy's search over gauges finds no smaller sum of the headings' squared misses."""
    belts = radius * ((right - left) - (right - left)[0])

    def misses(share):
        return np.sum((heading - heading[0] - share * belts) ** 2)

    best = minimize_scalar(misses, (-1.0, 1.0), method="brent", options={"xtol": 1e-12})
    np.testing.assert_allclose(1 / answer, best.x, rtol=1e-6)
