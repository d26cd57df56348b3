"""Velocities within limits: the whole task is scaled, none is broken, conflicts are named."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import linprog, minimize

from backhoe.machine import BACKHOE as MACHINE
from backhoe.machine import variants
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    engine,
    jacobian,
    joint_bounds,
    limited_velocity,
    loops,
    margin_rows,
    minimum_norm,
    null_projector,
    track_rows,
)
from backhoe.whole_body.limits import SMALL, WITHIN
from backhoe.whole_body.stability import (
    centre_of_mass,
    centre_of_mass_jacobian,
    distances,
    margin,
    support_polygon,
    zero_moment_point,
)


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def postures(rng, robot, *shape):
    return rng.uniform(-1.2, 1.2, (*shape, 3 + robot.joints))


def test_without_a_limit_in_the_way_the_task_is_done_in_full(rng):
    J, b = jacobian(postures(rng, BACKHOE)), rng.normal(size=3) / 10
    v, s = limited_velocity(J, b, np.full(6, -50.0), np.full(6, 50.0))
    assert s == pytest.approx(1, abs=1e-12)
    assert_allclose(v, minimum_norm(J, b), atol=1e-9)


def test_a_limit_scales_the_whole_task_and_keeps_its_direction(rng):
    for _ in range(50):
        J, b = jacobian(postures(rng, BACKHOE)), rng.normal(size=3)
        top = rng.uniform(0.05, 0.4, 6)
        A, c = rng.normal(size=(2, 6)), rng.uniform(0.01, 0.2, 2)
        v, s = limited_velocity(J, b, -top, top, A=A, c=c)
        assert_allclose(J @ v, s * b, atol=1e-9)
        assert (np.abs(v) <= top).all() and (A @ v <= c + 1e-9).all() and 0 <= s <= 1


def test_the_programme_is_solved_as_another_solver_solves_it(rng):
    for _ in range(10):
        J, b, top = jacobian(postures(rng, BACKHOE)), rng.normal(size=3), rng.uniform(0.1, 0.5, 6)
        v0 = rng.normal(size=6) / 10
        v, s = limited_velocity(J, b, -top, top, preferred=v0, small=0.01)

        def cost(x, v0=v0):
            return 1 - x[6] + 0.01 * (((x[:6] - v0) ** 2).sum() + (1 - x[6]) ** 2)

        other = minimize(
            cost,
            np.zeros(7),
            method="SLSQP",
            bounds=[*zip(-top, top, strict=True), (0, 1)],
            constraints={"type": "eq", "fun": lambda x, J=J, b=b: J @ x[:6] - x[6] * b},
            options={"maxiter": 500, "ftol": 1e-14},
        )
        assert other.success
        assert_allclose([*v, s], other.x, atol=2e-5)
        assert cost(np.r_[v, s]) <= other.fun + 1e-9


def test_limits_that_exclude_each_other_are_named():
    J, b, top = np.eye(3, 5), np.ones(3), np.ones(5)
    with pytest.raises(
        ValueError, match=r"other: velocity 1 must be at least -1; row 1 of A must be at most -9"
    ):
        limited_velocity(J, b, -top, top, A=np.eye(5)[:2], c=[1.0, -9.0])
    with pytest.raises(
        ValueError, match=r"lower must not be above upper, got 2\.0 and 1.0 for vel"
    ):
        limited_velocity(J, b, 2 * np.eye(5)[3], top)


def test_joint_bounds_keep_the_angles_in_range(rng):
    low, high, fastest = np.array([-1.0, 0.0]), np.array([1.0, 0.5]), np.array([2.0, 1.0])
    for q in rng.uniform(low, high, (100, 2)):
        for bound in joint_bounds(q, low, high, fastest, 0.1):
            assert (np.abs(bound) <= fastest).all()
            assert (q + 0.1 * bound >= low - 1e-12).all() and (
                q + 0.1 * bound <= high + 1e-12
            ).all()
    lower, upper = joint_bounds([2.0, 0.2], low, high, fastest, 0.1)
    assert lower[0] == upper[0] == -2.0


def largest_share(J, b, lower, upper, A, c):
    """Largest s with J v = s b within the limits, by another solver."""
    m, n = J.shape
    found = linprog(
        np.r_[np.zeros(n), -1.0],
        A_ub=np.c_[A, np.zeros(len(A))] if len(A) else None,
        b_ub=c if len(A) else None,
        A_eq=np.c_[J, -b],
        b_eq=np.zeros(m),
        bounds=[*zip(lower, upper, strict=True), (0, 1)],
    )
    return found.x[-1] if found.status == 0 else None


@pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])
def test_the_hand_is_as_fast_as_any_velocity_within_the_limits_makes_it(robot, rng):
    n, slowed, exact = 2 + robot.joints, 0, 0
    for _ in range(150):
        J, b = jacobian(postures(rng, robot), robot), rng.normal(size=3)
        lower, upper = -rng.uniform(0, 1, n), rng.uniform(0, 1, n)
        A, c = rng.normal(size=(3, n)), rng.uniform(0, 0.5, 3)
        v0, most = rng.normal(size=n), largest_share(J, b, lower, upper, A, c)
        v, s = limited_velocity(J, b, lower, upper, A=A, c=c, preferred=v0)
        dearer = (np.maximum(np.abs(lower - v0), np.abs(upper - v0)) ** 2).sum() - (
            (v - v0) ** 2
        ).sum()
        assert most - SMALL * dearer <= s <= most + 1e-8
        exact += abs(s - most) < 1e-8
        wary = limited_velocity(J, b, lower, upper, A=A, c=c, preferred=v0, small=1e-7)
        assert wary.s == pytest.approx(most, abs=1e-5)
        assert_allclose(J @ v, s * b, atol=1e-10)
        assert (lower <= v).all() and (v <= upper).all() and (A @ v <= c + 1e-10).all()
        slowed += s < 1
    assert slowed > 50 and exact > 130


def test_of_all_velocities_as_fast_it_is_the_nearest_to_the_preferred(rng):
    for _ in range(30):
        J, b, top = jacobian(postures(rng, BACKHOE)), rng.normal(size=3), rng.uniform(0.1, 0.6, 6)
        v0, weights = rng.normal(size=6) / 4, rng.uniform(0.3, 3, 6)
        v, s = limited_velocity(J, b, -top, top, preferred=v0, weights=weights)
        for _ in range(30):
            other = v + 0.1 * null_projector(J) @ rng.normal(size=6)
            other = v + (other - v) * min(1.0, room(v, other - v, top))
            assert_allclose(J @ other, s * b, atol=1e-9)
            cost, than = (weights @ (x - v0) ** 2 for x in (v, other))
            assert cost <= than + 1e-9


def room(v, way, top):
    """How far one may go from v along a way until a bound is met."""
    return min(((np.sign(way) * top - v) / np.where(way == 0, 1e-30, way)).min(), 1.0)


def test_the_direction_is_kept_where_clipping_loses_it(rng):
    lost = []
    for _ in range(100):
        J, b, top = jacobian(postures(rng, BACKHOE)), rng.normal(size=3), rng.uniform(0.05, 0.4, 6)
        v, _ = limited_velocity(J, b, -top, top)
        assert_allclose(np.cross(J @ v, b), 0, atol=1e-9)
        clipped = J @ np.clip(minimum_norm(J, b), -top, top)
        lost.append(np.linalg.norm(np.cross(clipped, b)) / np.linalg.norm(b) ** 2)
    assert np.median(lost) > 0.05


def singular(rng):
    """J whose hand cannot move along `lost`, and that direction."""
    J, lost = rng.normal(size=(3, 6)), rng.normal(size=3)
    lost /= np.linalg.norm(lost)
    return J - np.outer(lost, lost @ J), lost


def test_the_plain_loops_are_the_compiled_ones(rng):
    J, b, v0 = rng.normal(size=(5, 3, 6)), rng.normal(size=(5, 3)), rng.normal(size=(5, 6))
    J[3, 2] = J[3, 1] + 1e-4 * J[3, 2]
    v = np.empty((5, 6))
    assert loops.solve(J, b, v0, np.zeros(5), v, np.empty((3, 3)), np.empty(3)) == -1
    assert_allclose(v, minimum_norm(J, b, v0), rtol=1e-9)
    given = J[0], b[0], -np.ones(6), np.ones(6), v0[0], np.full(6, 2.0), J[1], b[1]
    both = []
    for kind in (loops, engine):
        filled = [np.full(shape, 7.0) for shape in ((7, 7), 7, (7, 20), 20)]
        assert kind.programme(*given, *filled)
        x = np.r_[2 * v0[1], 1.1]
        s, missed = kind.within(J[0], b[0], -np.ones(6), np.ones(6), x, v[0])
        both.append([*map(np.ravel, filled), v[0].copy(), s, missed])
        spoilt = [np.full_like(one, np.nan) for one in given]
        for k in range(8):
            assert not kind.programme(*given[:k], spoilt[k], *given[k + 1 :], *filled)
    for plain, compiled in zip(*both, strict=True):
        assert_allclose(plain, compiled, rtol=1e-14, atol=1e-14)


def test_where_no_velocity_moves_the_hand_along_it_stands(rng):
    for _ in range(30):
        J, lost = singular(rng)
        v0 = rng.normal(size=6) / 10
        v, s = limited_velocity(J, lost + rng.normal(size=3), *rng_box(), preferred=v0)
        assert s == 0.0 or s < 1e-9
        assert_allclose(J @ v, 0, atol=1e-10)
        assert_allclose(v, null_projector(J) @ v0, atol=1e-9)


def rng_box():
    return -np.ones(6), np.ones(6)


def test_a_singular_j_does_what_it_can_do_exactly(rng):
    """b in its range: the equations depend on each other and are true all the same."""
    for _ in range(30):
        J, _ = singular(rng)
        b = J @ rng.normal(size=6) / 4
        v, s = limited_velocity(J, b, *rng_box())
        assert s == pytest.approx(largest_share(J, b, *rng_box(), np.zeros((0, 6)), []), abs=1e-8)
        assert_allclose(J @ v, s * b, atol=1e-10)
        twice = np.r_[J, J[:1]], np.r_[b, b[:1]]
        assert_allclose(limited_velocity(*twice, *rng_box()).v, v, atol=1e-9)


def test_near_a_singularity_the_hand_slows_down_without_a_jump(rng):
    J, lost = singular(rng)
    last = None
    for size in np.geomspace(1, 1e-12, 200):
        row = np.outer(lost, np.eye(6)[0])
        v, s = limited_velocity(J + size * row, lost, *rng_box())
        assert_allclose((J + size * row) @ v, s * lost, atol=1e-10)
        assert last is None or last + 1e-9 >= s >= 0.7 * last - 1e-9
        last = s
    assert last < 1e-9


def test_no_wanted_velocity_leaves_the_preferred_one(rng):
    J, v0 = jacobian(postures(rng, BACKHOE)), rng.normal(size=6) / 10
    v, s = limited_velocity(J, np.zeros(3), *rng_box(), preferred=v0)
    assert s == 1.0
    assert_allclose(v, null_projector(J) @ v0, atol=1e-10)


def test_bounds_that_leave_one_velocity_alone(rng):
    J, b = jacobian(postures(rng, BACKHOE)), rng.normal(size=3) / 10
    lower, upper = rng_box()
    lower[3] = upper[3] = 0.2
    v, s = limited_velocity(J, b, lower, upper)
    assert v[3] == 0.2
    assert_allclose(J @ v, s * b, atol=1e-10)


def test_what_excludes_each_other_is_named_and_nothing_else():
    J = np.array([[1.0, 1, 0], [0, 0, 1]])
    b, lower, upper = np.ones(2), -np.ones(3), np.ones(3)
    A, c = [[1.0, 0, 0], [0, 1, 0], [-1, 0, 0]], [0.5, 0.5, -0.7]
    with pytest.raises(ValueError, match=r"other: row 0 of A .* 0\.5; row 2 of A .* -0\.7$"):
        limited_velocity(J, b, lower, upper, A=A, c=c)
    lower[:2] = 0.3  # both move, so the hand moves along x; along y, as b wants too, it must not
    upper[2] = 0.0
    way = (
        r"other: the hand must stay on its way, J v = s b; velocity 0 .* least 0\.3; .* 2 .* most 0"
    )
    with pytest.raises(ValueError, match=way) as told:
        limited_velocity(J, b, lower, upper)
    assert "row" not in str(told.value)


def test_a_joint_beyond_its_range_comes_back_while_the_hand_stays_on_its_way(rng):
    q, T = np.array([0.3, -0.5, 1.1, 0.4]), 0.01
    low, high, fastest = np.full(4, -1.0), np.ones(4), np.full(4, 0.5)
    J, b = jacobian(np.r_[0, 0, 0, q]), np.array([0.1, 0.0, 0.05])
    lower, upper = joint_bounds(q, low, high, fastest, T)
    v, s = limited_velocity(J, b, np.r_[-1, -1, lower], np.r_[1, 1, upper])
    assert v[4] == -0.5
    assert_allclose(J @ v, s * b, atol=1e-10)
    assert s > 0.5


def test_no_limit_is_broken_on_a_way_that_runs_into_them():
    """A loaded backhoe that is told to reach out too far, for 30 s: it slows down and creeps."""
    q, T, least = np.array([0.0, 0, 0, 0.2, 0.4, -0.6, -0.4]), 0.1, 0.3
    belts, shares, margins, room_left = track_rows(), [], [], []
    for _ in range(300):
        lower, upper = joint_bounds(q[3:], MACHINE.lower, MACHINE.upper, MACHINE.speed_limit, T)
        lower, upper = np.r_[-0.02, -0.01, lower], np.r_[0.02, 0.01, upper]
        balance = margin_rows(q[3:], least, 2.0, load=900.0)
        A, c = np.r_[belts.A, balance.A], np.r_[belts.c, balance.c]
        v, s = limited_velocity(jacobian(q), [0.3, 0.5, -0.2], lower, upper, A=A, c=c)
        q = q + T * np.r_[v[0] * np.cos(q[2]), v[0] * np.sin(q[2]), v[1:]]
        shares.append(s)
        margins.append(margin(q[3:], load=900.0).distance)
        room_left.append(min((q[3:] - MACHINE.lower).min(), (MACHINE.upper - q[3:]).min()))
    assert -1e-12 < min(room_left) < 1e-9
    assert least - 1e-6 < min(margins) < least + 1e-3
    assert shares[0] == pytest.approx(1) and 0 < shares[-1] < 0.05


@pytest.mark.parametrize("machine", [MACHINE, variants.scaled(0.7)])
def test_belts_run_no_faster_than_they_can(machine, rng):
    A, c = track_rows(machine)
    for v in rng.normal(size=(50, 6)):
        right, left = (v[0] + side * v[1] * machine.tracks.gauge / 2 for side in (1, -1))
        assert_allclose(A @ v, [left, right, -left, -right])
    assert_allclose(c, machine.tracks.max_speed)
    assert track_rows(machine, 2).A.shape == (4, 2)


@pytest.mark.parametrize("load", [0.0, 700.0])
def test_the_centre_of_mass_moves_as_its_jacobian_says(load, rng):
    q, h = rng.uniform(-1.2, 1.2, (4, 5, 4)), 1e-6
    steps = h * np.eye(4)
    found = centre_of_mass_jacobian(q, load)
    moved = [(centre_of_mass(q + e, load) - centre_of_mass(q - e, load)) / (2 * h) for e in steps]
    assert_allclose(found, np.stack(moved, axis=-1), atol=1e-8)
    assert_allclose(centre_of_mass_jacobian(q[0, 0], load), found[0, 0], atol=1e-14)


@pytest.mark.parametrize(("load", "slope", "uphill"), [(0, 0, 0), (400, 0.25, 0.6), (0, 0.3, 2.5)])
def test_balance_may_fall_by_rate_times_its_excess(load, slope, uphill, rng):
    h = 1e-6

    def inside(x):
        """Distances from the edges by the yaw and the joints."""
        pushed = {"load": load, "slope": slope, "uphill": uphill - x[0]}
        return distances(zero_moment_point(x[1:], **pushed), support_polygon())

    for q in rng.uniform(-1, 1, (10, 4)):
        x, steps = np.r_[0.0, q], h * np.eye(5)
        moved = np.stack([(inside(x + e) - inside(x - e)) / (2 * h) for e in steps], axis=-1)
        A, c = margin_rows(q, 0.2, 4.0, load=load, slope=slope, uphill=uphill)
        assert_allclose(-A[:, 1:], moved, atol=1e-8)
        assert_allclose(A[:, 0], 0)
        assert_allclose(c, 4 * np.maximum(inside(x) - 0.2, 0), atol=1e-12)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"J": np.full((3, 6), np.nan)}, "J must be finite"),
        ({"J": np.ones(6)}, "J must be a matrix"),
        ({"b": np.ones(2)}, "b must .*a row of J"),
        ({"b": [np.inf, 0, 0]}, "b must be finite"),
        ({"lower": -1.0}, "lower must"),
        ({"upper": np.full(6, -2.0)}, "lower must not be above upper, got -1.0 and -2.0"),
        ({"upper": np.full(6, 1e12)}, "upper must be within 1e.09"),
        ({"preferred": np.full(6, np.nan)}, "preferred must be finite"),
        ({"weights": np.r_[0.0, np.ones(5)]}, "weights must be positive, got 0.0"),
        ({"A": np.ones((2, 6))}, "c must"),
        ({"c": np.ones(2)}, "c must .*row of A"),
        ({"A": np.ones((2, 5)), "c": np.ones(2)}, "A must"),
        ({"A": np.ones((2, 6)), "c": [1.0, np.nan]}, "c must be finite"),
        ({"small": 0.0}, "small must"),
    ],
)
def test_bad_input_of_the_programme_is_told(given, message):
    good = {"J": np.eye(3, 6), "b": np.ones(3), "lower": -np.ones(6), "upper": np.ones(6)}
    with pytest.raises(ValueError, match=message):
        limited_velocity(**{**good, **given})
    assert WITHIN == 1e9


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: track_rows(velocities=1), "velocities must"),
        (lambda: margin_rows(np.zeros((2, 4)), 0.1, 1.0), r"q must be one posture.*\(2, 4\)"),
        (lambda: margin_rows(np.zeros(4), -0.1, 1.0), "least must"),
        (lambda: margin_rows(np.zeros(4), 0.1, 0.0), "rate must"),
        (lambda: margin_rows(np.zeros(4), 0.1, 1.0, load=-1), "load must"),
        (lambda: margin_rows(np.zeros(4), 0.1, 1.0, slope=1.5), "slope must"),
        (lambda: joint_bounds([0.0], [1.0], [0.0], [1.0], 0.1), "lowest must not be above"),
        (lambda: joint_bounds([0.0], [0.0], [1.0], [0.0], 0.1), "fastest must be positive"),
    ],
)
def test_bad_input_of_limits_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call()
