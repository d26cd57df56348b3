"""What lesson 12b says in strong words."""

import numpy as np
import pytest

from backhoe import mission, whole_body
from backhoe.machine import BACKHOE as MACHINE
from backhoe.whole_body import BACKHOE, SLIDES, SlidesRobot, hand, jacobian

SMALL_ROBOTS = [SLIDES, SlidesRobot(0.0, 0.6, 0.5, 0.2), SlidesRobot(0.4, 0.1, 0.2, 0.6)]


def singular_product(J):
    return np.prod(np.linalg.svd(J, compute_uv=False), axis=-1)


def bend(elbow, robot=SLIDES):
    """Jacobians over elbows, the hand at about one height."""
    q = np.zeros((len(elbow), 6))
    q[:, 4], q[:, 5] = 0.6 - elbow / 2, elbow
    return jacobian(q, robot)


@pytest.mark.parametrize("robot", SMALL_ROBOTS)
def test_a_whole_robot_is_blind_to_a_stretched_arm(robot):
    rng = np.random.default_rng(0)
    q = np.column_stack([rng.uniform(-1, 1, (50, 5)), np.zeros(50)])
    J = jacobian(q, robot)
    assert singular_product(J[..., 2:]).max() < 1e-12
    assert singular_product(J).min() > 1e-4


def test_the_best_elbow_moves_with_the_unit_and_not_with_a_length():
    degrees = np.arange(-150, 151)
    J = bend(np.radians(degrees))

    def best(J):
        return degrees[singular_product(J).argmax()]

    cm = J * [1, 100, 100, 100, 100]
    assert best(J) - best(cm) == 64
    L = whole_body.characteristic_length(SLIDES)
    turns = np.array([0, 1, 1, 1, 1])
    in_m, in_cm = J / L**turns, cm / (100 * L) ** turns
    np.testing.assert_allclose(in_m, in_cm)
    assert abs(degrees[singular_product(J[..., 2:]).argmax()]) == 71


def test_climbing_the_wholes_w_stretches_the_arm_and_the_hand_stands():
    """From a batch of bent elbows: nearly stretched by the whole's, well bent by the arm's."""
    for q0 in ([0, 0, 0, 0, 0.9, -0.6], [0, 0, 0, 0.3, 1.0, -1.0], [0, 0, 0, 0, 0.3, 1.0]):
        for part, gain in (("whole", 2.0), ("arm", 30.0)):
            q = np.array(q0, float)
            stand = hand(q, SLIDES)
            w_before = singular_product(jacobian(q, SLIDES)[:, 2:])
            for _ in range(400):
                wish = gain * whole_body.manipulability_gradient(q, SLIDES, part)
                b = (stand - hand(q, SLIDES)) / 0.05
                v = whole_body.minimum_norm(jacobian(q, SLIDES), b, np.r_[0, 0, wish])
                q = q + 0.05 * np.r_[v[0] * np.cos(q[2]), v[0] * np.sin(q[2]), v[1:]]
            w_after = singular_product(jacobian(q, SLIDES)[:, 2:])
            assert np.linalg.norm(hand(q, SLIDES) - stand) < 1e-6
            assert w_after < 0.4 * w_before if part == "whole" else w_after > 0.99 * w_before


def random_step(rng):
    q = np.r_[0, 0, rng.uniform(-1, 1), rng.uniform(MACHINE.lower, MACHINE.upper)]
    J = np.vstack([jacobian(q, BACKHOE), [0, 0, 0, 1, 1, 1]])
    return J, rng.normal(size=4), rng.normal(size=6), rng.uniform(0.05, 0.5, 6)


def test_a_sum_and_one_system_spoil_the_first_task_and_priority_does_not():
    rng = np.random.default_rng(1)
    plus = np.linalg.pinv
    for _ in range(50):
        J1, b1, _, _ = random_step(rng)
        J2, b2 = np.eye(6)[2:], rng.normal(size=4)
        summed = plus(J1) @ b1 + plus(J2) @ b2
        stacked = plus(np.vstack([J1, J2])) @ np.r_[b1, b2]
        v = whole_body.strict_priorities([(J1, b1), (J2, b2)])
        off = [np.linalg.norm(J1 @ one - b1) for one in (summed, stacked, v)]
        assert min(off[:2]) > 1e-3 and off[2] < 1e-8
        assert np.linalg.norm(J2 @ v - b2) <= np.linalg.norm(J2 @ plus(J1) @ b1 - b2) + 1e-9


def test_clipping_bends_a_task_and_one_factor_does_not():
    rng, bent = np.random.default_rng(2), []
    for _ in range(100):
        J, b, wish, most = random_step(rng)
        v = whole_body.minimum_norm(J, b, wish)
        use = np.max(np.abs(v) / most)
        for one in (v / max(1.0, use), whole_body.limited_velocity(J, b, -most, most).v):
            s = b @ J @ one / (b @ b)
            assert np.linalg.norm(J @ one - s * b) < 1e-8 and (np.abs(one) <= most + 1e-12).all()
        clipped = J @ np.clip(v, -most, most)
        off = np.linalg.norm(clipped - (b @ clipped) / (b @ b) * b)
        bent += [off > 1e-4] if use > 1 else []
    assert len(bent) > 80 and all(bent)


def test_where_a_limit_is_touched_a_factor_is_zero_and_a_programme_goes_on():
    rng, went = np.random.default_rng(3), 0
    for _ in range(100):
        J, b, wish, most = random_step(rng)
        v = whole_body.minimum_norm(J, b, wish)
        lower, upper = -most, most.copy()
        j = int(np.argmax(np.abs(v[2:]))) + 2
        (upper if v[j] > 0 else lower)[j] = 0.0
        shares = np.where(v > 0, upper, lower)[v != 0] / v[v != 0]
        assert min(1.0, *shares) == 0.0
        went += whole_body.limited_velocity(J, b, lower, upper, preferred=wish).s > 1e-3
    assert went > 80


def test_a_joint_at_full_speed_may_be_stopped_within_a_period():
    q = MACHINE.upper - 0.6 * MACHINE.speed_limit * 0.05
    bounds = [
        whole_body.joint_bounds(one, MACHINE.lower, MACHINE.upper, MACHINE.speed_limit, 0.05)
        for one in (q, MACHINE.upper)
    ]
    np.testing.assert_allclose(bounds[0][1], 0.6 * MACHINE.speed_limit)
    np.testing.assert_allclose(bounds[1][1], 0.0, atol=1e-12)


def test_a_heading_off_by_a_tenth_of_a_degree_moves_an_edge_seven_metres_away_by_a_centimetre():
    q = np.r_[0, 0, 0, -np.pi / 2, 0.4, 0.5, 0.0]
    reach = hand(q)[0]
    turned = hand(q + np.radians([0, 0, 0.1, 0, 0, 0, 0]))
    assert 7 * np.linalg.norm(turned - hand(q)) / reach == pytest.approx(0.012, abs=0.001)


def test_a_controller_is_judged_by_what_it_keeps():
    """Exercise 12.8: right answers of other kinds pass; wrong ones of no known kind do not."""
    from backhoe.lessons.mobile_manipulation.exercises.grading import WHOLE_BODY as EXERCISE

    def verdicts(answer):
        return {EXERCISE.compare(answer(*case), None, *case) for case in EXERCISE.inputs()}

    def one_factor(J, b, preferred, lower, upper):
        v = whole_body.minimum_norm(J, b, preferred)
        return v / max(1.0, np.max(np.where(v > 0, v / upper, v / lower)))

    def late(J, b, preferred, lower, upper):
        return 0.5 * one_factor(J, b, preferred, lower, upper)

    def quick(J, b, preferred, lower, upper):
        return 2.0 * one_factor(J, b, preferred, lower, upper)

    def turned(J, b, preferred, lower, upper):
        return one_factor(J, -b, preferred, lower, upper)

    def bent(J, b, preferred, lower, upper):
        return one_factor(J, b * [1, 1, 0.9, 1], preferred, lower, upper)

    def programme(J, b, preferred, lower, upper):
        return whole_body.limited_velocity(J, b, lower, upper, preferred=preferred).v

    assert verdicts(one_factor) == verdicts(programme) == {None}
    assert any("slower" in str(one) for one in verdicts(late))
    assert any("outside its bounds" in str(one) for one in verdicts(quick))
    assert any("against it" in str(one) for one in verdicts(turned))
    assert any("another direction" in str(one) for one in verdicts(bent))
    assert verdicts(lambda *case: np.full(6, np.nan)) == verdicts(lambda *case: np.zeros(5))


def test_usual_mistakes_show_in_the_surface_or_in_broken_limits():
    def clips(J, b, preferred, lower, upper):
        return np.clip(whole_body.minimum_norm(J, b, preferred), lower, upper)

    def minimum_norm(J, b, preferred, lower, upper):
        return whole_body.minimum_norm(J, b, preferred)

    def forgets(J, b, preferred, lower, upper):
        return whole_body.limited_velocity(J, b, lower, upper).v

    def factor(J, b, preferred, lower, upper):
        v = whole_body.minimum_norm(J, b, preferred)
        bound = np.where(v > 0, upper, lower)
        return v * np.min(bound[v != 0] / v[v != 0], initial=1.0)

    def graded(part=None):
        run = mission.grade(whole_body=part, lanes=[0.0], backend="analytic")
        errors = run.design.errors(run.after, run.scene)
        errors = np.abs(errors[np.isfinite(errors)])
        return np.mean(errors <= 0.05), errors.max(), run.violations, run.after

    library, clipped, alone = graded(), graded(clips), graded(minimum_norm)
    assert library[0] > 0.97 and graded(factor)[0] > 0.97
    assert clipped[0] < 0.8 and clipped[2] == library[2] == 0
    assert alone[2] > 0.9 and np.abs(alone[3] - clipped[3]).max() < 1e-9
    assert graded(forgets)[1] > 1.9 * library[1]
