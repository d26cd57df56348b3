"""What proves the references of lesson 05: the plane as complex numbers, costs and runs.

Places are complex, x + iy; dividing by e^(i theta) looks at them from a heading theta.
"""

from fractions import Fraction

import numpy as np
from numpy.testing import assert_allclose

from backhoe.vehicle import tracking


def places(points):
    return np.asarray(points) @ (1, 1j)


def segments(path):
    """Starts, directions and lengths of the segments."""
    path = places(path)
    ways = np.diff(path)
    return path[:-1], ways / abs(ways), abs(ways)


def apart(points, path):
    """Distance of each point to each segment, and how far along it lies, shapes (K, N)."""
    start, direction, length = segments(path)
    seen = (places(points)[:, None] - start) / direction
    beyond = np.maximum(0, np.maximum(-seen.real, seen.real - length))
    return np.hypot(beyond, seen.imag), seen.real


def a_run_out_and_once_round(answer):
    """The way out and a hundred thousand chords of the circle, less 1.084 times the chords."""
    chords = abs(np.diff(1.5 * np.exp(2j * np.pi * np.linspace(0, 1, 100_001)))).sum()
    assert_allclose(answer, 1.5 + chords - 1.084 * chords, rtol=1e-6)


def distances_in_the_frames_of_the_segments(answer, actual, reference):
    """Each segment is turned onto the x axis; mean, spread and lengths are summed up."""
    d = apart(actual, reference)[0].min(axis=1)
    mean = sum(d) / len(d)
    spread = (sum(d**2) / len(d) - mean**2) ** 0.5
    driven, whole = (segments(points)[2].sum() for points in (actual, reference))
    assert_allclose(answer, (mean, spread, sorted(d)[-1], driven / whole), rtol=1e-9)


def seen_from_the_vehicle(answer, pose, waypoint, next_waypoint):
    """The way-point in the vehicle's frame, and the way on from it turned back by alpha."""
    here, there, beyond = places([pose[:2], waypoint, next_waypoint])
    rho, dy, alpha = answer
    seen = (there - here) / np.exp(1j * pose[2])
    assert_allclose((rho, dy), (abs(seen), seen.imag), rtol=1e-9)
    assert_allclose(np.exp(1j * (pose[2] + alpha)), (beyond - there) / abs(beyond - there))
    assert -np.pi < alpha <= np.pi


def the_nearest_that_the_wheels_can_do(answer, limits, v, omega):
    """No wheel is too fast; who gets less than asked runs on to a limit, and omega comes first."""
    given_v, given_omega = answer
    sides = (
        given_v + limits.half_track * np.array([-given_omega, given_omega])
    ) / limits.wheel_radius
    spare = limits.wheel_speed - abs(sides).max()
    assert spare > -1e-9
    if not np.isclose(given_omega, omega, rtol=1e-9):
        assert abs(given_v) < 1e-9 > spare and 0 < given_omega / omega < 1
    if not np.isclose(given_v, v, rtol=1e-9):
        assert spare < 1e-9 and -1e-9 < given_v / v < 1


def velocities_add_up(answer, time, dt, points, times):
    """The place is where the velocities lead, each for as long as it has been driven."""
    durations = np.diff(times)
    driven = np.clip(time + dt - times[:-1], 0, durations)
    assert_allclose(answer, points[0] + (driven / durations) @ np.diff(points, axis=0), rtol=1e-9)


def the_least_of_the_cost(answer, pose, goal, dt, kv2, kw2):
    """A step of Newton's from there, with differences of the cost (6.12), leads nowhere."""
    way = (places([goal])[0] - places([pose[:2]])[0]) / np.exp(1j * pose[2])
    effort = dt**2 * (1 / np.array([kv2, kw2]) - 1)

    def cost(u):
        miss = abs(way - u[0] * dt) ** 2 + (np.angle(way) - u[1] * dt) ** 2
        return miss + effort @ u**2

    u = np.array(answer)
    behind, here, ahead = (np.array([cost(u + s * e) for e in np.eye(2)]) for s in (-1, 0, 1))
    step = (behind - ahead) / (2 * (ahead - 2 * here + behind))
    assert_allclose(u + step, u, rtol=1e-6)


def the_arc_ends_on_the_point_ahead(answer, pose, path, lookahead, speed):
    """Driven for twice the bearing, the arc ends where a walk along the path ends."""
    d, along = apart([pose[:2]], path)
    near = d[0].argmin()
    start, direction, length = segments(path)
    left = length[:near].sum() + np.clip(along[0, near], 0, length[near]) + lookahead
    walked = np.clip(left - np.append(0, np.cumsum(length[:-1])), 0, length)
    target = start[0] + walked @ direction
    here, heading = places([pose[:2]])[0], np.exp(1j * pose[2])
    v, omega = answer
    turn = 2 * np.angle((target - here) / heading)
    assert_allclose(v, speed)
    if abs(turn) < 1e-12:
        assert abs(omega) < 1e-12
    else:
        end = here + v / (1j * omega) * heading * (np.exp(1j * turn) - 1)
        assert_allclose(end, target, rtol=1e-9)


def it_trails_by_the_rate_over_the_gain(tracker):
    """With a gain of 4 / s it is 0.4 / 4 m late on a line, and looks 0.4 / 4 rad into a circle."""
    line = tracking.from_points([(0, 0), (6, 0)])
    circle = tracking.circle(1.0, centre=(0, 1), start_angle=-np.pi / 2, points=2000)
    late, aside = [], []
    for path in (line, circle):
        run = tracking.follow(
            tracker, tracking.IdealPlant(0.05), path.with_times(0.4), mode="trajectory"
        )
        seen = places(run.goal - run.pose[:, :2]) / np.exp(1j * run.pose[:, 2])
        late.append(abs(seen[-20:-5]))
        aside.append(np.angle(seen[-20:-5]))
    assert_allclose(late[0], 0.1, rtol=1e-3)
    assert_allclose(aside[1], 0.1, rtol=1e-3)
    for side in (1, -1):
        behind = tracking.Goal(
            np.array([-1.0, 0.1 * side]), np.zeros(2), 0.4, np.zeros((2, 2)), 0.0
        )
        v, omega = tracker(np.array([0, 0, 2 * np.pi]), np.zeros(2), behind, 0.05)
        assert_allclose((v, omega), (0, side * 4 * (np.pi - np.arctan(0.1))), rtol=1e-9)


def the_same_is_left_after_many_samples(answer, k, T0, new_T0):
    """As many samples of each as make the same time, and what they leave, one by one."""
    ratio = Fraction(new_T0 / T0).limit_denominator(50)
    left = [1.0, 1.0]
    for _ in range(ratio.numerator):
        left[0] *= 1 - k
    for _ in range(ratio.denominator):
        left[1] *= 1 - answer
    assert_allclose(left[1], left[0], rtol=1e-9, atol=1e-12)


EQUAL = {
    "5.5": {"dt is never negative": "a time step"},
    "5.6": {
        "dt is never negative": "a time step",
        "kv2 is never negative": "a gain, and the other sign drives away",
        "kw2 is never negative": "a gain, and the other sign drives away",
    },
    "5.7": {
        "the result at [0] is never negative": "a speed, and it drives forward",
        "lookahead is never negative": "a distance",
        "speed is never negative": "it drives forward",
    },
    "5.9": dict.fromkeys(
        [f"{name} is never negative" for name in ("T0", "k", "new_T0", "the result")],
        "sample times and gains",
    ),
}
"""Mutants that are the reference in disguise, with the reason."""
