"""Strict priorities: what comes first is never disturbed, the next is done as far as it can be."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import lsq_linear, minimize

from backhoe.whole_body import minimum_norm, null_projector, strict_priorities


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def tasks_of(rng, *rows, n=6):
    return [(rng.normal(size=(m, n)), rng.normal(size=m)) for m in rows]


def best(A, b):
    """Least |A x - b| there is."""
    return np.linalg.norm(A @ lsq_linear(A, b).x - b)


def test_tasks_that_fit_are_all_done(rng):
    tasks = tasks_of(rng, 2, 3, 1)
    v = strict_priorities(tasks)
    for J, b in tasks:
        assert_allclose(J @ v, b, atol=1e-10)


def test_one_task_is_the_minimum_norm_and_its_null_space(rng):
    [(J, b)] = tasks_of(rng, 3)
    v0 = rng.normal(size=6)
    assert_allclose(strict_priorities([(J, b)]), minimum_norm(J, b), atol=1e-12)
    assert_allclose(strict_priorities([(J, b)], v0), minimum_norm(J, b, v0), atol=1e-12)


def test_of_tasks_that_clash_the_first_wins_and_the_second_does_its_best(rng):
    for _ in range(20):
        (J1, b1), (J2, b2), (J3, b3) = tasks_of(rng, 3, 5, 2)
        v = strict_priorities([(J1, b1), (J2, b2), (J3, b3)])
        assert_allclose(J1 @ v, b1, atol=1e-9)

        def missing(x, J2=J2, b2=b2):
            return ((J2 @ x - b2) ** 2).sum()

        first = {"type": "eq", "fun": lambda x, J1=J1, b1=b1: J1 @ x - b1}
        other = minimize(
            missing, v + 0.1, constraints=first, options={"ftol": 1e-14, "maxiter": 300}
        )
        assert other.success
        assert missing(v) == pytest.approx(other.fun, rel=1e-6, abs=1e-10)
        swapped = strict_priorities([(J2, b2), (J1, b1)])
        assert np.linalg.norm(J2 @ swapped - b2) < np.linalg.norm(J2 @ v - b2) - 1e-3
        assert np.linalg.norm(J1 @ swapped - b1) > 1e-3


def test_a_first_task_that_no_velocity_does_is_done_as_well_as_any_does_it(rng):
    J = rng.normal(size=(3, 6))
    J[2] = J[0] - 2 * J[1]
    b, second = rng.normal(size=3), tasks_of(rng, 2)[0]
    v = strict_priorities([(J, b), second])
    assert np.linalg.norm(J @ v - b) == pytest.approx(best(J, b), rel=1e-9)
    assert_allclose(second[0] @ v, second[1], atol=1e-9)


@pytest.mark.parametrize("damping", [0.0, 1e-3, 0.3, [0.0, 0.1]])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e-6, 1e-9, 0.0])
def test_the_first_is_not_disturbed_near_a_singularity_of_the_second(rng, damping, size):
    """J2 sees outside the rows of J1 only `size` of a direction."""
    for _ in range(10):
        (J1, b1) = tasks_of(rng, 3)[0]
        J2 = rng.normal(size=(2, 3)) @ J1
        J2[1] += size * (null_projector(J1) @ rng.normal(size=6))
        J2[0] += null_projector(J1) @ rng.normal(size=6)
        v = strict_priorities([(J1, b1), (J2, rng.normal(size=2))], damping=damping)
        assert_allclose(J1 @ v, b1, atol=1e-12 * max(np.linalg.norm(v), 100))


def along_a_singularity(s, **options):
    """v and what the second task misses where J2 N1 has the singular value s."""
    J1, J2 = np.array([[1.0, 0, 0]]), np.array([[1.0, s, 0]])
    v = strict_priorities([(J1, [0.0]), (J2, [1.0])], **options)
    return v, 1.0 - J2 @ v


def test_undamped_the_answer_jumps_across_a_singularity_of_the_second():
    for s in (1e-2, 1e-4, 1e-6):
        v, missing = along_a_singularity(s)
        assert_allclose(v, [0, 1 / s, 0], rtol=1e-9)
        assert_allclose(missing, 0, atol=1e-9)
        assert_allclose(along_a_singularity(-s)[0], -v)
    v, missing = along_a_singularity(0.0)
    assert_allclose([*v, *missing], [0, 0, 0, 1])


@pytest.mark.parametrize("damping", [0.01, 0.2])
def test_damped_it_is_continuous_bounded_and_misses_what_is_said(damping):
    last = None
    for s in np.linspace(-1, 1, 2001):
        v, missing = along_a_singularity(s, damping=damping)
        assert_allclose(missing, damping**2 / (s**2 + damping**2), atol=1e-9)
        assert np.abs(v).max() <= 0.5 / damping + 1e-12
        if last is not None:
            assert np.abs(v - last).max() <= 0.001 / damping**2 + 1e-12
        last = v


def test_what_is_truncated_stays_missing():
    v, missing = along_a_singularity(0.05, least=0.1)
    assert_allclose([*v, *missing], [0, 0, 0, 1])
    v, missing = along_a_singularity(0.2, least=0.1)
    assert_allclose(missing, 0, atol=1e-12)


def test_a_third_task_does_not_disturb_the_second(rng):
    first, second, third = tasks_of(rng, 2, 2, 4)
    two = strict_priorities([first, second])
    three = strict_priorities([first, second, third])
    for J, _ in (first, second):
        assert_allclose(J @ two, J @ three, atol=1e-11)
    assert np.linalg.norm(third[0] @ three - third[1]) < np.linalg.norm(third[0] @ two - third[1])


def test_many_at_once(rng):
    J1, J2 = rng.normal(size=(4, 3, 2, 6)), rng.normal(size=(4, 3, 3, 6))
    b1, b2, v0 = rng.normal(size=(4, 3, 2)), rng.normal(size=(4, 3, 3)), rng.normal(size=(4, 3, 6))
    v = strict_priorities([(J1, b1), (J2, b2)], v0)
    for at in np.ndindex(4, 3):
        one = strict_priorities([(J1[at], b1[at]), (J2[at], b2[at])], v0[at])
        assert_allclose(v[at], one, atol=1e-11)
    assert strict_priorities([(J1[:0], b1[:0])]).shape == (0, 3, 6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda J, b: strict_priorities([]), "tasks must be a list of one or more"),
        (lambda J, b: strict_priorities([(J, b, b)]), r"tasks\[0\] must be a pair"),
        (lambda J, b: strict_priorities([(J, b), (J[:, 1:], b)]), r"J of tasks\[1\] must"),
        (lambda J, b: strict_priorities([(J, b[1:])]), r"b of tasks\[0\] must"),
        (lambda J, b: strict_priorities([(J, b)], damping=-1), "damping must be 0 or more"),
        (lambda J, b: strict_priorities([(J, b)], damping=[0, 1]), "damping .* for each task"),
        (lambda J, b: strict_priorities([(J, b)], least=0), "least must"),
        (lambda J, b: strict_priorities([(J, b)], np.ones(5)), "preferred must"),
    ],
)
def test_bad_input_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call(np.eye(3, 6), np.ones(3))
