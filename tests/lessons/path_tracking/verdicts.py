"""What decides each verdict on D'Angelo's tracking: properties, and likely misprints.

Places are complex, x + iy: dividing by e^(i theta) looks at them from the heading theta.
"""

from itertools import pairwise
from math import factorial

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm, solve_discrete_lyapunov
from scipy.optimize import brentq, fsolve, linprog
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from backhoe.lessons import published
from backhoe.lessons.path_tracking import printed
from backhoe.vehicle import tracking

T0, RHO_0 = 0.1, 0.2
RNG = np.random.default_rng(5)
POSES, WAYS = RNG.uniform(-7, 7, (40, 3)), RNG.uniform(-1, 1, (40, 2))
GOALS, WISHES = POSES[:, :2] + WAYS, RNG.uniform(0.3, 2.0, (40, 2))
AHEAD = [(np.append(pose[:2], np.arctan2(*way[::-1]) + 0.2), pose[:2] + way)
         for pose, way in zip(POSES, abs(WAYS) + 0.1, strict=True)]  # fmt: skip
WEIGHTS = (1.0, 0.015, 2.0, 0.03)


def _goal(place):
    return tracking.Goal(np.array(place), np.array(place), 0.5, np.eye(2), T0)


def _moved(pose, V, W, T):
    """The pose after T seconds: the exponential of a twist in the group of motions SE(2)."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    here = np.array([[c, -s, pose[0]], [s, c, pose[1]], [0, 0, 1]])
    end = here @ expm(T * np.array([[0, -W, V], [W, 0, 0], [0, 0, 0]]))
    return np.array([*end[:2, 2], pose[2] + W * T])


def _seen(pose, place):
    return complex(*(np.array(place) - pose[:2])) / np.exp(1j * pose[2])


def _squares(pose, goal, T, weights):
    """A and b of the cost |A u - b|^2 of the command u, the heading turned the short way."""
    k1, k2, k3, k4 = np.sqrt(weights)
    way = _seen(pose, goal)
    A = np.array([[k1 * T, 0], [0, 0], [k2, 0], [0, k3 * T], [0, k4]])
    return A, np.array([k1 * way.real, k1 * way.imag, 0, k3 * np.angle(way), 0])


# (5.1) errors of a pose


def alpha_turns_parallel_to_the_way_beyond(errors):
    for pose, goal, on in zip(POSES, GOALS, WAYS[::-1], strict=True):
        rho, *_, dy, alpha = errors(pose, goal, goal + on)
        seen = _seen(pose, goal)
        assert np.allclose((rho, dy), (abs(seen), seen.imag))
        assert np.isclose(np.exp(1j * (pose[2] + alpha)), complex(*on) / np.hypot(*on))
        assert abs(alpha) <= np.pi


# Section 5.1: speed limits


def of_all_that_the_wheels_can_do_the_turn_is_served_first(limited):
    wheels = np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]])
    for v, omega in RNG.uniform(-3, 3, (15, 2)):
        r, c, top = 0.2, 0.4, 6.0
        can = {"A_ub": wheels * (1, c), "b_ub": np.full(4, r * top)}
        asked = sorted((0, v)), sorted((0, omega))
        turn = linprog((0, -np.sign(omega)), **can, bounds=asked).x[1]
        speed = linprog((-np.sign(v), 0), **can, bounds=(asked[0], (turn, turn))).x[0]
        assert np.allclose(limited(v, omega, r, c, top), (speed, turn), atol=1e-7)


def limited(v, omega, r, c, top):
    return tracking.Limits(top, r, c).apply(v, omega)


def limits_51(v, omega, r, c, top):
    omega = np.clip(omega, -r / c * top, r / c * top)
    return np.clip(v, -(r * top - c * abs(omega)), r * top - c * abs(omega)), omega


def limits_51_without_the_modulus(v, omega, r, c, top):
    _, omega = limits_51(v, omega, r, c, top)
    return np.clip(v, -abs(r * top - c * omega), abs(r * top - c * omega)), omega


# Section 5.2: measures


def measures_are_those_of_a_wave_beside_a_straight_line(measures):
    x = np.linspace(0, 4, 4001)
    y = 0.1 + 0.05 * np.sin(3 * x)
    length = quad(lambda s: np.hypot(1, 0.15 * np.cos(3 * s)), 0, 4)[0]
    spread = np.sqrt((y**2).mean() - y.mean() ** 2)
    found = measures(np.column_stack((x, y)), np.array([[0.0, 0.0], [4.0, 0.0]]))
    assert np.allclose(found, (y.mean(), spread, y.max(), length / 4), rtol=1e-5)


def measures_52(actual, path, samples=40_001):
    lengths = [np.hypot(*np.diff(points, axis=0).T) for points in (actual, path)]
    arc = np.append(0, np.cumsum(lengths[1]))
    at = np.linspace(0, arc[-1], samples)
    d, _ = KDTree(np.column_stack([np.interp(at, arc, axis) for axis in path.T])).query(actual)
    return d.mean(), d.std(), d.max(), lengths[0].sum() / lengths[1].sum()


def measures_to_the_way_points_alone(actual, path):
    return measures_52(actual, path, samples=len(path))


# Code 5.1 and Table 5.1


def passes_each_way_point_in_order_within_rho_0(drive):
    points = tracking.square(2.0).points @ (1, 1j)
    run, passed = iter(drive(points, 4.0)), 0
    for place in run:
        while passed < len(points) and abs(points[passed] - place) <= RHO_0:
            passed += 1
    assert passed == len(points) and abs(points[-1] - place) <= RHO_0


def followed(points, gain):
    path = tracking.Path(np.column_stack((points.real, points.imag)))
    tracker = tracking.PIDTracker((1.0,), (gain,), (1.0,))
    return tracking.follow(tracker, tracking.IdealPlant(0.05), path).pose @ (1, 1j, 0)


def code_51(points, gain, first=0, T=0.05):
    """Code 5.1 with P controllers on a vehicle that obeys; i counts the points reached."""
    run, theta, i = [0j], 0.0, first
    while i < len(points):
        way = (points[i - first] - run[-1]) / np.exp(1j * theta)
        if abs(way) < RHO_0:
            i += 1
        else:
            on = points[min(i - first + 1, len(points) - 1)] - points[i - first]
            near = abs(way) <= 0.4 and on != 0
            turn = T * (gain * way.imag + near * np.angle(on / np.exp(1j * theta)))
            run.append(
                run[-1] + abs(way) * T * np.exp(1j * (theta + turn / 2)) * np.sinc(turn / 2 / np.pi)
            )
            theta += turn
    return np.array(run)


def code_51_counted_from_1(points, gain):
    return code_51(points, gain, first=1)


def numbers_come_from_the_gains(mean_distance_on_the_circle):
    circle = tracking.circle().points @ (1, 1j)
    for gain in (3.0, 6.0):
        run, starts, ways = code_51(circle, gain), circle[:-1], np.diff(circle)
        seen = (run[:, None] - starts) / ways
        feet = starts + ways * np.clip(seen.real, 0, 1)
        d = abs(run[:, None] - feet).min(axis=1)
        assert np.isclose(mean_distance_on_the_circle(gain), d.mean(), atol=1e-6)


def p_on_the_circle(gain):
    circle = tracking.circle()
    run = followed(circle.points @ (1, 1j), gain)
    return tracking.metrics(np.column_stack((run.real, run.imag)), circle.points).d_mean


def table_51_whatever_the_gain(gain):
    return published.load("dangelo_2022_table_51")["P"]["circle"]["d_mean"]


# Table 5.2


def p_in_matlab_has_the_numbers_of_table_51(caption):
    first, second = (published.load(f"dangelo_2022_table_5{n}") for n in (1, 2))
    if caption.endswith("MATLAB"):
        assert all(second[path] == first["P"][path] for path in ("circle", "square"))


CAPTION_52 = published.load("dangelo_2022_table_52")["caption"].replace("MATLAB", "Gazebo")


# Section 5.2: the ideal ratio on the circle


def ideal_is_the_way_out_and_once_round(ratio):
    assert np.allclose([ratio(0.5), ratio(1.5)], 1 + 1 / (2 * np.pi), rtol=1e-5)


def ratio_of_a_perfect_run(radius):
    circle = tracking.circle(radius, points=2000).points
    return tracking.metrics(np.vstack(([0.0, 0.0], circle)), circle).d_ratio


def ratio_of_1(radius):
    return 1.0


# Code 5.2


def integral_supplies_the_steady_turn(steady_error):
    assert steady_error(2.0) < 0.5 * steady_error(0.0)


def error_in_a_bend(integral, reset=False):
    """Mean of |Delta y| on a circle that is entered along its tangent [m]."""
    path = tracking.circle(1.5, centre=(0, 1.5), start_angle=-np.pi / 2)
    pid = tracking.PIDTracker((1.0,), (4.0, integral), (0.0,), reset_at_waypoints=reset)
    run = tracking.follow(pid, tracking.IdealPlant(0.05), path)
    seen = ((run.goal - run.pose[:, :2]) @ (1, 1j)) / np.exp(1j * run.pose[:, 2])
    return abs(seen.imag[len(seen) // 3 :]).mean()


def error_in_a_bend_with_code_52(integral):
    return error_in_a_bend(integral, reset=True)


# Section 5.4: what helps against noise


def noise_moves_it_least(controller, v=0.3, ahead=0.24, T=0.05):
    """Variance aside of a straight line, from the Lyapunov equation of the loop."""
    for k, k_i in ((2.0, 1.0), (4.0, 1.0), (6.0, 1.5), (6.0, 4.0)):
        aside = {}
        for name, integral in (("P", 0.0), ("PI", k_i)):
            seen = np.array([-1.0, -ahead, 0.0])  # Delta y of place aside, heading, integral
            omega = (k + integral * T) * seen + (0, 0, integral)
            A = np.eye(3) + np.outer((v * T**2 / 2, T, 0), omega) + np.outer((0, 0, T), seen)
            A[0, 1] += v * T
            B = -np.array([v * T**2 / 2, T, 0]) * (k + integral * T) - (0, 0, T)
            size = 3 if integral else 2
            A, B = A[:size, :size], B[:size]
            aside[name] = solve_discrete_lyapunov(A, np.outer(B, B))[0, 0]
        assert controller(k, k_i) == min(aside, key=aside.get)


def least_moved(k, k_i):
    line = tracking.from_points([(0, 0), (120, 0)]).with_times(0.3)
    spread = {}
    for name, gains in (("P", (k,)), ("PI", (k, k_i))):
        pid, rng = tracking.PIDTracker((1.25,), gains, (0.0,)), np.random.default_rng(7)

        def noisy(pose, *others, pid=pid, rng=rng):
            return pid(np.add(pose, (0, 0.02 * rng.normal(), 0)), *others)

        run = tracking.follow(noisy, tracking.IdealPlant(0.05), line, mode="trajectory")
        spread[name] = run.pose[:, 1].std()
    return min(spread, key=spread.get)


def recommended_in_noise(k, k_i):
    return "PI"


# Section 5.4.1: two distances


def measured_down_to_it_and_no_further(least):
    v, T = 0.5, 0.05
    starts = np.linspace(1.0, 1.1, 500)[:, None] - v * T * np.arange(60)
    before = np.c_[np.ones(500, bool), starts[:, :-1] >= RHO_0]
    assert np.isclose(starts[before].min(), least(v, T), atol=1e-3)


def rho_0_less_a_sample(v, T):
    return RHO_0 - v * T


def rho_0_itself(v, T):
    return RHO_0


def goal_is_no_nearer_than_the_path(distances):
    path, goal = tracking.square(2.0).points, np.array([1.25, 0.0])
    for place in RNG.uniform(-1, 3, (50, 2)):
        to_goal, to_path = distances(place, goal, path)
        assert np.isclose(to_goal, abs(complex(*(goal - place)))) and to_goal >= to_path


def to_goal_and_path(place, goal, path):
    return np.hypot(*(goal - place)), tracking.distances([place], path)[0]


def to_goal_and_path_of_samples(place, goal, path):
    return np.hypot(*(goal - place)), tracking.distances_to_samples([place], path, 5000)[0]


def to_goal_and_corners(place, goal, path):
    corners = path[[0, 8, 16, 24]]
    return np.hypot(*(goal - place)), np.hypot(*(corners - place).T).min()


# Section 6.1: the goal interpolated


def goal_has_gone_with_the_velocities_of_the_segments(place):
    points, times = np.cumsum(WAYS[:6], axis=0), np.cumsum([0.2, 1.0, 0.5, 2.0, 0.7, 1.1])
    durations = np.diff(times)
    for t in np.linspace(times[0], times[-1] - 1e-6, 23):
        driven = np.clip((t - times[:-1]) / durations, 0, 1)
        assert np.allclose(place(t, points, times), points[0] + driven @ np.diff(points, axis=0))


def goal_on_the_trajectory(t, points, times):
    return tracking.Path(points, times).position(t)


def interpolated(t, points, times, share=lambda t, a, b: (t - a) / (b - a)):
    k = np.searchsorted(times, t, "right") - 1
    return points[k] + share(t, times[k], times[k + 1]) * (points[k + 1] - points[k])


def interpolated_from_the_far_end(t, points, times):
    return interpolated(t, points, times, lambda t, a, b: (b - t) / (b - a))


def vehicle_turns_hardly_more_than_the_path(turned):
    """The circle turns by 2 pi, the way out to it and round the corner by less than pi."""
    assert turned(tracking.circle(points=30).with_times(0.1)) < 3 * np.pi


def turned_by_a_moving_goal(path):
    run = tracking.follow(
        tracking.TRACKERS["P"](), tracking.IdealPlant(0.05), path, mode="trajectory"
    )
    return abs(np.diff(run.pose[:, 2])).sum()


def turned_by_a_goal(path, hops=False, T=0.05):
    here, theta, turned = 0j, 0.0, 0.0
    for t in np.arange(0, path.times[-1] - 2 * T, T):
        at = path.times[np.searchsorted(path.times, t + T, "right")] if hops else t + T
        x, y = (np.interp(at, path.times, axis) for axis in path.points.T)
        way = (complex(x, y) - here) / np.exp(1j * theta)
        turn = T * 6.0 * way.imag
        here += 1.25 * abs(way) * T * np.exp(1j * (theta + turn / 2))
        theta, turned = theta + turn, turned + abs(turn)
    return turned


def turned_by_a_goal_that_hops(path):
    return turned_by_a_goal(path, hops=True)


# (6.1) the differential equation


def rates_along_it_are_h_and_it_starts_at_y_0(solution, step=1e-4):
    for pose, (V, W) in zip(POSES[:8], WISHES, strict=False):
        assert np.allclose(solution(pose, V, W, 0.0), pose)
        before, here, after = (solution(pose, V, W, 0.7 + d) for d in (-step, 0, step))
        h = V * np.cos(here[2]), V * np.sin(here[2]), W
        assert np.allclose((after - before) / (2 * step), h, atol=1e-5)


def driven(pose, V, W, t):
    plant = tracking.IdealPlant(max(t, 1e-12) / 7, pose)
    for _ in range(7):
        plant.step(V, W)
    return plant.pose


def solved_61(pose, V, W, t):
    h = lambda _, y: (V * np.cos(y[2]), V * np.sin(y[2]), W)  # noqa: E731
    return solve_ivp(h, (0, t), pose, rtol=1e-10, atol=1e-11).y[:, -1]


def solved_61_from_the_origin(pose, V, W, t):
    return solved_61(0 * pose, V, W, t)


# (6.2) Taylor's polynomial


def polynomial_equals_the_function(taylor):
    for m in (1, 2, 3):
        value = taylor(lambda k, t: 2**k * np.sin(2 * t + k * np.pi / 2), m, 0.3, 0.8)
        assert np.isclose(value, np.sin(1.6), atol=1e-9)


def taylor_with_its_remainder(derivative, m, t0, t):
    rest = quad(lambda s: derivative(m + 1, s) * (t - s) ** m / factorial(m), t0, t)[0]
    return printed.taylor_62(derivative, m, t0, t) + rest


# (6.3), (6.4), (6.10), (9.2) to (9.4) steps of first order


def error_of_a_step_falls_with_the_square_of_the_sample(step):
    for pose, (V, W) in zip(POSES, WISHES, strict=True):
        coarse, fine = (abs(step(pose, V, W, T) - _moved(pose, V, W, T)) for T in (0.02, 0.01))
        assert np.all(fine <= 0.3 * coarse + 1e-6)


def first_order_of_the_arc(pose, V, W, T):
    return pose + T * (tracking.arc(pose, V, W, 1e-6) - pose) / 1e-6


def step_610(pose, V, W, T):
    return pose + T * np.array([V * np.cos(pose[2]), V * np.sin(pose[2]), W])


def step_63_without_the_sample_time(pose, V, W, T):
    return step_610(pose, V, W, 1.0)


def step_64_without_its_input(pose, V, W, T):
    return step_610(pose, 0.0, 0.0, T)


def step_610_at_the_next_rates(pose, V, W, T):
    return step_610(pose, V, W, T) + step_610(pose * (0, 0, 1), V, W, T) * (1, 1, 0)


def step_92_with_the_sample_squared(pose, V, W, T):
    return pose + (step_610(pose, V, W, T) - pose) * (T, 1, 1)


def step_93_with_the_rate_of_x(pose, V, W, T):
    return pose + (step_610(pose, V, W, T) - pose)[[0, 0, 2]]


def step_94_without_the_sample_time(pose, V, W, T):
    return pose + (step_610(pose, V, W, T) - pose) / (1, 1, T)


# (6.5) to (6.7) linear interpolation


def line_leads_evenly_from_sample_to_sample(line):
    T, n, y0, y1 = 0.4, 3, np.array([1.0, -2.0]), np.array([1.7, 0.5])
    at = np.array([line(y0, y1, T, n, (n + s) * T) for s in (0, 0.25, 0.5, 0.75, 1)])
    assert np.allclose(at[[0, -1]], (y0, y1)) and np.allclose(np.diff(at, 2, axis=0), 0)


def line_of_a_path(y0, y1, T, n, t):
    return tracking.Path([y0, y1], [n * T, (n + 1) * T]).position(t)


def line_65(y0, y1, T, n, t):
    return y0 + (y1 - y0) / T * (t - n * T)


def line_65_without_the_sample_time(y0, y1, T, n, t):
    return y0 + (y1 - y0) * (t - n * T)


def ends_where_the_group_of_motions_does(after):
    for pose, (V, W) in zip(POSES, WISHES, strict=True):
        assert np.allclose(after(pose, V, W, 0.8), _moved(pose, V, W, 0.8), atol=1e-8)


def integral_66(pose, V, W, T):
    x = quad(lambda t: V * np.cos(pose[2] + W * t), 0, T)[0]
    y = quad(lambda t: V * np.sin(pose[2] + W * t), 0, T)[0]
    return pose + np.array([x, y, W * T])


def integral_66_without_y_n(pose, V, W, T):
    return integral_66(pose, V, W, T) - pose


def held_order_ends_on_the_goal(command):
    for pose, goal in AHEAD[:12]:
        assert np.allclose(_moved(pose, *command(pose, goal, T0), T0)[:2], goal, atol=1e-7)


def linear_tracker(pose, goal, T):
    return tracking.ScagliaLinear(1.0, 1.0)(pose, (0, 0), _goal(goal), T)


def solved_67(pose, goal, T):
    miss = lambda u: integral_66(pose, *u, T)[:2] - goal  # noqa: E731
    return fsolve(miss, (np.hypot(*(goal - pose[:2])) / T, np.angle(_seen(pose, goal)) / T))


def half_the_turn_of_67(pose, goal, T):
    return solved_67(pose, goal, T) * (1, 0.5)


# (6.8) Runge and Kutta's rule


def error_of_a_step_falls_with_the_cube_of_the_sample(step):
    def rate(y, u, t):
        return -y + u

    exact = {T: np.exp(-T) * 0.3 + (1 - np.exp(-T)) * 2.0 for T in (0.1, 0.05)}
    errors = [abs(step(rate, [0.3], 2.0, 2.0, 0.0, T)[0] - y) for T, y in exact.items()]
    assert np.log2(errors[0] / errors[1]) > 2.9


def step_68_with_its_input(h, y, u, u_next, t, T):
    start = np.asarray(h(np.asarray(y), u, t))
    return y + T / 2 * (start + h(y + T * start, u_next, t + T))


# (6.9), (9.5) to (9.7) the unicycle


def rates_are_the_limit_of_difference_quotients(rates, T=1e-6):
    for pose, (V, W) in zip(POSES, WISHES, strict=True):
        quotient = (_moved(pose, V, W, T) - _moved(pose, V, W, -T)) / (2 * T)
        assert np.allclose(rates(pose, V, W), quotient, atol=1e-6)


def rates_of_the_arc(pose, V, W, T=1e-5):
    return (tracking.arc(pose, V, W, T) - tracking.arc(pose, V, W, -T)) / (2 * T)


def rates_69(pose, V, W):
    return np.array([V * np.cos(pose[2]), V * np.sin(pose[2]), W])


def rates_69_with_the_axes_swapped(pose, V, W):
    return rates_69(pose, V, W)[[1, 0, 2]]


def rates_95_backwards(pose, V, W):
    return rates_69(pose, V, W) * (-1, 1, 1)


def rates_96_with_the_cosine(pose, V, W):
    return rates_69(pose, V, W)[[0, 0, 2]]


def rates_97_with_half_the_turn(pose, V, W):
    return rates_69(pose, V, W) * (1, 1, 0.5)


# (6.11) = (9.10), (9.8), (9.9), (9.11) the heading that would do


def heading_looks_along_the_way(heading):
    for way in WAYS:
        assert np.isclose(np.exp(1j * heading(*way)), complex(*way) / np.hypot(*way))


def heading_of_the_taylor_tracker(dx, dy):
    return tracking.ScagliaTaylor(1, 1)((0, 0, 0), (0, 0), _goal((dx, dy)), T0)[1] * T0


def velocity_ends_on_the_goal(velocity):
    for pose, goal in zip(POSES, GOALS, strict=True):
        assert np.allclose(pose[:2] + T0 * velocity(pose, goal, T0), goal)


def velocity_of_the_taylor_tracker(pose, goal, T):
    V, W = dead_beat(pose, goal, T)
    return V * np.array([np.cos(pose[2] + W * T), np.sin(pose[2] + W * T)])


def velocity_98(pose, goal, T):
    return (goal - pose[:2]) / T


def velocity_98_without_the_sample_time(pose, goal, T):
    return velocity_98(pose, goal, T) * (T, 1)


def velocity_99_turned_round(pose, goal, T):
    return velocity_98(pose, goal, T) * (1, -1)


def speed_covers_the_distance_and_the_turn_ends_on_its_direction(command):
    for pose, goal in zip(POSES, GOALS, strict=True):
        V, W = command(pose, goal, T0)
        way = complex(*(goal - pose[:2]))
        assert np.isclose(V * T0 * np.exp(1j * (pose[2] + W * T0)), way) and V > 0


def dead_beat(pose, goal, T):
    return tracking.ScagliaTaylor(1, 1)(pose, (0, 0), _goal(goal), T)


def command_911(pose, goal, T, direction=1):
    (x, y), heading = (goal - pose[:2]) / T, np.arctan2(*(goal - pose[:2])[::-1])
    V = x * np.cos(heading) + direction * y * np.sin(heading)
    return V, (heading - pose[2]) / T


def command_911_with_a_minus(pose, goal, T):
    return command_911(pose, goal, T, direction=-1)


# (6.12) to (6.14), (9.12) to (9.15) the cost and its least


def cost_is_a_sum_of_squares_with_the_least_of_least_squares(cost):
    for pose, goal in AHEAD:
        A, b = _squares(pose, goal, T0, WEIGHTS)
        best, (rest, *_) = np.linalg.lstsq(A, b)[:2]
        assert np.isclose(cost(*best, pose, goal, T0, WEIGHTS), rest)
        assert np.isclose(cost(1.0, -2.0, pose, goal, T0, WEIGHTS), sum((A @ (1, -2) - b) ** 2))


def cost_612_of_the_states(V, W, pose, goal, T, weights, power=2):
    k1, k2, k3, k4 = weights
    after, rates = step_610(pose, V, W, T), rates_69(pose, V, W)
    theta_d = np.arctan2(*(goal - pose[:2])[::-1])
    place = k1 * ((goal[0] - after[0]) ** 2 + (goal[1] - after[1]) ** 2)
    effort = k2 * (rates[0] ** 2 + rates[1] ** 2) + k4 * abs(rates[2]) ** power
    return place + effort + k3 * (theta_d - after[2]) ** 2


def cost_612_with_the_turn_not_squared(*given):
    return cost_612_of_the_states(*given, power=1)


def command_is_that_of_least_squares(command):
    for pose, goal in AHEAD:
        gains = [_share(*pair, T0) for pair in (WEIGHTS[:2], WEIGHTS[2:])]
        best = np.linalg.lstsq(*_squares(pose, goal, T0, WEIGHTS))[0]
        assert np.allclose(command(pose, goal, T0, *gains), best)


def _share(k_error, k_effort, T):
    """What least squares cover in a sample of a way of 1, error against effort."""
    A = np.sqrt([[k_error * T**2], [k_effort]])
    return np.linalg.lstsq(A, np.array([np.sqrt(k_error), 0]))[0][0] * T


def least_cost_tracker(pose, goal, T, kv2, kw2):
    return tracking.ScagliaTaylor(kv2, kw2, optimum=True)(pose, (0, 0), _goal(goal), T)


def gains_are_the_shares_that_least_squares_cover(gains):
    for weights in RNG.uniform(0.01, 3, (20, 4)):
        shares = [_share(*pair, 0.3) for pair in (weights[:2], weights[2:])]
        assert np.allclose(gains(weights, 0.3), shares)


def gains_of_the_ratios(weights, T):
    ratios = weights[0] / weights[1], weights[2] / weights[3]
    at = [lambda k, r=r: np.log(tracking.weight_ratio(k, T) / r) for r in ratios]
    return [brentq(f, 1e-9, 1 - 1e-9, xtol=1e-14) for f in at]


def gains_614_with_the_sample_on_the_wrong_side(weights, T):
    return printed.gains_614(weights, 1 / T)


def weights_in_that_ratio_have_that_gain(ratio):
    assert np.allclose([_share(ratio(0.4, T), 1.0, T) for T in (0.05, 0.1, 0.2)], 0.4)


def ten_times(k2, T):
    return 10.0


def slopes_are_those_of_differences(gradient, step=1e-5):
    for (pose, goal), u in zip(AHEAD, WISHES, strict=True):
        A, b = _squares(pose, goal, T0, WEIGHTS)
        J = [[sum((A @ (u + s * e) - b) ** 2) for s in (step, -step)] for e in np.eye(2)]
        assert np.allclose(gradient(*u, pose, goal, T0, WEIGHTS), -np.diff(J)[:, 0] / (2 * step))


def gradient_with_its_minus(V, W, pose, goal, T, weights):
    spent = 2 * np.array([weights[1] * V, weights[3] * W])
    return 2 * spent - printed.gradient_913(V, W, pose, goal, T, weights)


def without_a_weight_on_the_error_it_stands(gone):
    A, b = _squares(*AHEAD[0], T0, (0.0, *WEIGHTS[1:]))
    V, _ = np.linalg.lstsq(A, b)[0]
    assert np.isclose(gone(100), abs(V) * T0 * 100, atol=1e-6)


def gone_without_k_1(samples):
    tracker, plant = tracking.ScagliaTaylor(1e-12, 0.4), tracking.IdealPlant(T0, AHEAD[0][0])
    for _ in range(samples):
        plant.step(*tracker(plant.pose, plant.twist, _goal(AHEAD[0][1]), T0))
    return np.hypot(*(plant.pose - AHEAD[0][0])[:2])


def gone_as_it_diverges(samples):
    return np.inf


# Fig. 6.3


def share_left_after_a_second_is_a_power_of_the_samples(left):
    for T in (0.05, 0.1, 0.2):
        assert np.isclose(left(0.4, T), 0.6 ** (1 / T), atol=1e-9)


def left_after_a_second(gain, T):
    plant, far = tracking.IdealPlant(T), np.exp(0.5j) * 1e9
    for _ in range(round(1 / T)):
        goal = _goal((far.real, far.imag))
        plant.step(0.0, tracking.ScagliaTaylor(gain, gain)(plant.pose, (0, 0), goal, T)[1])
    return 1 - plant.pose[2] / 0.5


def left_whatever_the_sample(gain, T):
    return 1 - gain


# (7.1) and its listings


def held_order_settles_on_the_speed(command):
    pose, V = np.array([-0.07, 0.0, 0.0]), 0.5
    for k in range(200):
        V, _ = command(pose, (V, 0.0), (0.5 * T0 * (k + 1), 0.0), T0)
        pose = _moved(pose, V, 0.0, T0)
        assert abs(V) < 2.0
    assert np.isclose(V, 0.5, atol=1e-3)


def held_order_turns_to_the_goal_and_stops(command):
    theta, W = 0.1, 0.0
    for _ in range(200):
        W = command((0, 0, theta), (0.0, W), (1.0, 0.0), T0)[1]
        theta += W * T0
    assert np.allclose((theta, W), 0, atol=1e-6)


def turn_ends_along_the_new_velocity(command):
    for pose, goal, (V, W) in zip(POSES, GOALS, WISHES, strict=True):
        turn = (command(pose, (V, W), goal, T0)[1] / 0.5 + W) * T0 / 2
        new = 0.4 * 2 / T0 * complex(*(goal - pose[:2])) - V * np.exp(1j * pose[2])
        assert np.isclose(np.exp(1j * (pose[2] + turn)), new / abs(new))


def mended(pose, twist, goal, T):
    return tracking.ScagliaRungeKutta(0.4, 0.5)(pose, twist, _goal(goal), T)


def as_in_71_with_atan2(pose, twist, goal, T):
    return tracking.ScagliaRungeKutta.printed(0.4, 0.5)(pose, twist, _goal(goal), T)


def turning_rate_is_bounded_however_often_it_has_turned(command):
    for turns, pose, goal in zip(range(-20, 20), POSES, GOALS, strict=True):
        _, W = command(np.add(pose, (0, 0, 2 * np.pi * turns)), (0.5, 0.3), goal, T0)
        assert abs(W) <= 0.5 * (2 * np.pi / T0 + 0.3)
    turn_ends_along_the_new_velocity(command)


def update_controller(pose, twist, goal, T, wrap=lambda a: np.angle(np.exp(1j * a))):
    (error_x, error_y), (vel, twist_z), yaw = np.subtract(goal, pose[:2]), twist, pose[2]
    theta = np.arctan2(
        0.4 * 2 / T * error_y - vel * np.sin(yaw), 0.4 * 2 / T * error_x - vel * np.cos(yaw)
    )
    linear = 0.4 * 2 / T * (error_x * np.cos(theta) + error_y * np.sin(theta))
    return linear - vel * np.cos(theta - yaw), 0.5 * (2 / T * wrap(theta - yaw) - twist_z)


def update_controller_without_wrap(pose, twist, goal, T):
    return update_controller(pose, twist, goal, T, wrap=float)


def error_handed_over_can_be_read(reading):
    try:
        read = reading((0.3, -0.1))
    except TypeError:
        read = None
    assert read == (0.3, -0.1)


def both_errors(pose_error):
    return pose_error[0], pose_error[1]


def both_errors_of_the_first_item(pose_error_tuple):
    error_position = pose_error_tuple[0]
    return error_position[0], error_position[1]


def state_is_that_of_the_motion(state):
    for pose, (V, W) in zip(POSES * (1, 1, 0.4), WISHES, strict=True):
        poses = [pose, _moved(pose, V, W, 1e-3)]
        messages = [
            {"position": {"x": p[0], "y": p[1]}, "orientation": Rotation.from_euler("z", p[2])}
            for p in poses
        ]
        x, y, yaw, vel, twist_z = state(messages, 1e-3)
        assert np.allclose((x, y, vel, twist_z), (*poses[1][:2], V, W), atol=2e-3)
        assert np.isclose(np.exp(1j * yaw), np.exp(1j * poses[1][2]))


def state_of_two_poses(messages, T):
    before, now = (_code_71(message) for message in messages)
    errors = tracking.pose_errors(now, before[:2])
    turn = tracking.pose_errors((0, 0, before[2]), (1, 0), (1 + np.cos(now[2]), np.sin(now[2])))
    return *now, errors.rho / T, turn.alpha / T


def _code_71(message):
    """x, y, yaw; the last of the three angles that `euler_from_quaternion` returns."""
    return *message["position"].values(), message["orientation"].as_euler("xyz")[2]


def state_of_code_71(messages, T, vel=0.0, twist_z=0.0):
    """Each message overwrites the place and the yaw; the two speeds stay what they were."""
    for message in messages:
        x, y, yaw = _code_71(message)
    return x, y, yaw, vel, twist_z


# Section 6.3: farther off or shorter at higher speeds


def at_twice_the_speed_it_is_so(expected):
    """P, and Taylor's rule, written in complex numbers, round an eight on an ideal vehicle."""
    eight = tracking.figure_eight(1.5).points
    for law in (lambda seen: (1.25 * abs(seen), 6.0 * seen.imag),
                lambda seen: (2.0 * abs(seen), 2.0 * np.angle(seen))):  # fmt: skip
        runs = [_round(law, eight @ (1, 1j), v) for v in (0.1, 0.2, 0.4)]
        for slow, fast in pairwise(runs):
            assert expected(slow, fast, eight)


def _round(law, path, v, T=0.05):
    arc = np.append(0, np.cumsum(abs(np.diff(path))))
    here, heading, run = 0j, np.pi / 4, [0j]
    for n in range(1, round(arc[-1] / v / T) + 1):
        goal = np.interp(n * T * v, arc, path)
        V, W = law((goal - here) / np.exp(1j * heading))
        here += V * T * np.sinc(W * T / 2 / np.pi) * np.exp(1j * (heading + W * T / 2))
        heading += W * T
        run.append(here)
    return np.column_stack((np.real(run), np.imag(run)))


def farther_off_or_shorter(slow, fast, path):
    slow, fast = (tracking.metrics(run, path) for run in (slow, fast))
    return fast.d_mean > slow.d_mean or fast.d_ratio < slow.d_ratio


def farther_or_shorter_63(slow, fast, path):
    fine = KDTree(tracking.Path(path).resample(0.002).points)
    off = [fine.query(run)[0].mean() for run in (slow, fast)]
    return off[1] > off[0] or shorter_63(slow, fast, path)


def shorter_63(slow, fast, path):
    slow, fast = (abs(np.diff(run @ (1, 1j))).sum() for run in (slow, fast))
    return fast < slow
