"""The one door: what it lets in, what it refuses and in which words, the same for every caller."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from backhoe.basics import inputs

NO_NUMBERS = [
    None,
    "2",
    b"2",
    True,
    np.True_,
    1j,
    np.array([1j]),
    np.ones(3, bool),
    np.array(["2020-01-01"], dtype="datetime64[D]"),
    [1.0, True],
    [1.0, "2"],
    [1.0, None],
    [[1.0], [1.0, 2.0]],
    {1.0},
    object(),
    [10**400],
    np.ma.masked_array([1.0, 2.0], [0, 1]),
    lambda: 1.0,
]
NAN_OR_NO_NUMBER = [*NO_NUMBERS, float("nan"), [1.0], np.ones(1), 10**400, float("inf")]


def name(value):
    return type(value).__name__


@pytest.mark.parametrize("value", NO_NUMBERS, ids=name)
def test_numbers_refuse_what_is_none_and_name_it(value):
    with pytest.raises(ValueError, match=r"^q must be numbers, got ") as refused:
        inputs.numbers(value, "q")
    assert len(str(refused.value)) < 200


@pytest.mark.parametrize("value", NAN_OR_NO_NUMBER, ids=name)
@pytest.mark.parametrize(
    "check, words",
    [
        (inputs.number, "one finite number"),
        (inputs.positive, r"one number above 0"),
        (inputs.not_negative, r"one number at least 0"),
    ],
)
def test_one_number_refuses_what_is_none_and_says_what_it_should_be(check, words, value):
    with pytest.raises(ValueError, match=rf"^gauge must be {words} \[m\], got ") as refused:
        check(value, "gauge", "m")
    assert len(str(refused.value)) < 200


@given(st.one_of(st.floats(-1e300, 1e300), st.integers(-(10**300), 10**300), st.fractions()))
def test_a_real_number_of_any_type_becomes_the_float_nearest_to_it(value):
    got = inputs.number(value, "x")
    assert type(got) is float and got == float(value)
    assert inputs.number(np.array(got), "x") == got == inputs.numbers(value, "x")


@given(hnp.arrays(st.sampled_from([np.int8, np.uint16, np.float32, np.int64]), (2, 3)))
def test_numbers_keep_values_and_shape_and_do_not_copy_floats(values):
    if not np.isfinite(values).all():
        return
    array = inputs.numbers(values, "q", ("n", 3))
    assert array.dtype == float and (array == values).all()
    assert inputs.numbers(array, "q", (..., 3)) is array
    assert (inputs.numbers(values.tolist(), "q") == array).all()
    assert (inputs.numbers(values.astype(object), "q") == array).all()


@pytest.mark.parametrize(
    "shape, wanted, words",
    [
        ((2, 3), (..., 4), r"end in 4 values, got shape \(2, 3\)"),
        ((), (..., 4), r"end in 4 values, got shape \(\)"),
        ((3,), (4,), r"have shape \(4,\), got shape \(3,\)"),
        ((4, 1), (4,), r"have shape \(4,\), got shape \(4, 1\)"),
        ((0,), ("n",), r"have shape \(n,\), got shape \(0,\)"),
        ((2, 3), ("n", 2), r"have shape \(n, 2\), got shape \(2, 3\)"),
        ((3,), ("n", 3), r"have shape \(n, 3\), got shape \(3,\)"),
        ((5, 0, 2), (..., "n", 2), r"have shape \(\.\.\., n, 2\), got shape \(5, 0, 2\)"),
        ((1,), (), r"have shape \(\), got shape \(1,\)"),
    ],
)
def test_a_wrong_shape_is_said_beside_the_right_one(shape, wanted, words):
    with pytest.raises(ValueError, match=f"^q must {words}$"):
        inputs.numbers(np.ones(shape), "q", wanted)


@pytest.mark.parametrize(
    "shape, wanted",
    [
        ((4,), (..., 4)),
        ((5, 0, 4), (..., 4)),
        ((7, 2), ("n", 2)),
        ((9, 1, 2), (..., "n", 2)),
        ((), ()),
        ((0, 3), None),
    ],
)
def test_a_right_shape_passes_unchanged(shape, wanted):
    assert inputs.numbers(np.ones(shape), "q", wanted).shape == shape


def test_the_meaning_of_the_numbers_is_said():
    with pytest.raises(ValueError, match=r"q must end in 4 joints \(swing, boom\), got shape"):
        inputs.numbers([1.0], "q", (..., 4), meaning="joints (swing, boom)")
    with pytest.raises(ValueError, match=r"pose must be x, y, psi, shape \(3,\), got shape"):
        inputs.numbers([1.0], "pose", (3,), meaning="x, y, psi")


def test_the_first_value_that_is_not_finite_is_shown_with_its_place():
    with pytest.raises(ValueError, match=r"^q must be finite, got nan at index \(1, 0\)$"):
        inputs.numbers([[1.0, 2.0], [np.nan, np.inf]], "q")
    with pytest.raises(ValueError, match=r"^t must be finite, got inf at index 1$"):
        inputs.numbers([1.0, np.inf], "t")
    assert np.isnan(inputs.numbers([np.nan], "q", finite=False)).all()


@pytest.mark.parametrize("at, passes", [(0.99, False), (1.0, True), (1.5, True), (2.0, False)])
def test_bounds_are_at_or_beside_as_their_words_say(at, passes):
    if passes:
        assert inputs.number(at, "x", least=1.0, below=2.0) == at
        return
    with pytest.raises(ValueError, match=r"one number at least 1 and below 2, got"):
        inputs.number(at, "x", least=1.0, below=2.0)


def test_an_infinite_limit_passes_only_where_it_is_asked_for():
    assert inputs.number(np.inf, "limit", above=0.0, finite=False) == np.inf
    for value, bounds in ((-np.inf, {"above": 0.0}), (np.inf, {"most": 3.0}), (np.nan, {})):
        with pytest.raises(ValueError, match="limit must be one"):
            inputs.number(value, "limit", finite=False, **bounds)


@pytest.mark.parametrize("value", [1.0, "1", None, True, np.ones(1, int), Fraction(2), 0, 6])
def test_a_whole_number_is_an_integer_within_its_bounds(value):
    assert inputs.whole(np.int64(3), "count", least=1, most=5) == 3
    assert type(inputs.whole(np.array(3), "count")) is int
    words = "count must be one whole number at least 1 and at most 5, got"
    with pytest.raises(ValueError, match=words):
        inputs.whole(value, "count", least=1, most=5)


@pytest.mark.parametrize("value", ["c", None, 1, ["a"], np.array(["a"]), {}])
def test_a_choice_lists_the_choices(value):
    assert inputs.choice("a", "rule", ("a", "b")) == "a"
    with pytest.raises(ValueError, match=r"^rule must be one of a, b, got "):
        inputs.choice(value, "rule", ("a", "b"))


@pytest.mark.parametrize(
    "t, words",
    [
        ([0.0, 1.0, 1.0], "t must rise: 1.0 s at index 1 is followed by 1.0 s"),
        ([0.0, -1.0], "t must rise: 0.0 s at index 0"),
        ([0.0], "a row of 2 or more times, got 1"),
        ([[0.0, 1.0]], r"times in a row \[s\], shape \(n,\), got shape \(1, 2\)"),
        ([0.0, np.nan], "t must be finite"),
    ],
)
def test_times_rise(t, words):
    np.testing.assert_array_equal(inputs.times([0, 1, 2.5]), [0.0, 1.0, 2.5])
    with pytest.raises(ValueError, match=words):
        inputs.times(t)


@pytest.mark.parametrize("dt", [0.0, -0.1, [0.1, 0.0], [0.1], [[0.1, 0.1]], np.nan, "s"])
def test_steps_are_one_time_or_one_for_each_interval(dt):
    assert inputs.steps(0.1, 2).shape == () and inputs.steps([0.1, 0.2], 2).shape == (2,)
    with pytest.raises(ValueError, match=r"^dt must be"):
        inputs.steps(dt, 2)


def test_alike_names_what_differs():
    inputs.alike(left=np.ones(3), right=np.zeros(3))
    with pytest.raises(ValueError, match=r"left and right must be alike, got shapes \(3,\), \(\)"):
        inputs.alike(left=np.ones(3), right=np.zeros(()))


@pytest.mark.parametrize(
    "value, words",
    [
        (np.eye(3), r"a covariance of shape \(2, 2\), got shape \(3, 3\)"),
        ([[1.0, 0.5], [0.4, 1.0]], "must be symmetric"),
        ([[1.0, 2.0], [2.0, 1.0]], "must be positive definite, its lowest eigenvalue is -1"),
        ([[1.0, 1.0], [1.0, 1.0]], "must be positive definite"),
        ([[1.0, np.nan], [np.nan, 1.0]], "must be finite"),
    ],
)
def test_a_covariance_is_symmetric_and_definite(value, words):
    with pytest.raises(ValueError, match=f"^P .*{words}" if "must" in words else words):
        inputs.covariance(value, "P", 2, definite=True)


def test_a_covariance_may_be_a_number_semidefinite_or_one_for_each_run():
    assert inputs.covariance(2.0, "R", 1).tolist() == [[2.0]]
    assert inputs.covariance(np.ones((2, 2)), "P", 2).shape == (2, 2)
    assert inputs.covariance(np.tile(np.eye(2), (5, 1, 1)), "P", 2, runs=5).shape == (5, 2, 2)
    value = np.eye(2)
    assert inputs.covariance(value, "P", 2) is not value


def test_indices_are_whole_and_within_the_vector():
    assert inputs.indices(np.array([0, 2]), "angles", 3) == (0, 2)
    for value in ((3,), (-1,), (0.0,), "0", 1, None):
        with pytest.raises(ValueError, match=r"^angles must be indices"):
            inputs.indices(value, "angles", 3)


def test_a_generator_is_taken_or_made_from_a_seed():
    rng = np.random.default_rng(3)
    assert inputs.generator(rng) is rng
    assert inputs.generator(3).random() == np.random.default_rng(3).random()
    for value in (-1, 1.5, None, "seed", True):
        with pytest.raises(
            ValueError, match=r"^rng must be a seed of 0 or more or a numpy Generator"
        ):
            inputs.generator(value)


def test_kinds_and_functions_are_told_by_type():
    assert inputs.instance(3, "n", int) == 3
    with pytest.raises(TypeError, match=r"^path must be a list or tuple, got str: as from_points"):
        inputs.instance("x", "path", (list, tuple), "as from_points gives")
    assert inputs.function(len, "f", "f(x)") is len
    for value in (3, int, None):
        with pytest.raises(TypeError, match=r"^f must be a function or an object to call: f\(x\)"):
            inputs.function(value, "f", "f(x)")
    with pytest.raises(TypeError, match=r"got a class: make one, int\(\.\.\.\)$"):
        inputs.function(int, "f", "f(x)")


def test_the_ends_of_a_range_belong_to_it_or_not():
    for limits in ({"above": 1.0}, {"below": 1.0}):
        with pytest.raises(ValueError, match="got 1"):
            inputs.number(1.0, "x", **limits)
    for limits in ({"least": 1.0}, {"most": 1.0}):
        assert inputs.number(1.0, "x", **limits) == 1.0
    with pytest.raises(ValueError, match="above 0, got 0"):
        inputs.positive(0.0, "x")
    assert inputs.not_negative(0.0, "x") == 0.0


def test_a_covariance_that_is_slightly_indefinite_is_refused():
    with pytest.raises(
        ValueError, match=r"positive semidefinite, its lowest eigenvalue is -0\.001"
    ):
        inputs.covariance(np.diag([1.0, -1e-3]), "P", 2)
    inputs.covariance(np.diag([1.0, -1e-12]), "P", 2)  # rounding


@pytest.mark.parametrize(
    "value", [np.ones((3, 4)), np.ones((3, 4, 3), np.uint8), [[1, 2]], None, np.zeros(0, np.uint8)]
)
def test_only_grey_pictures_pass_as_such(value):
    with pytest.raises(ValueError, match="left must be a grey picture"):
        inputs.picture(value, "left")
    with pytest.raises(ValueError, match="left must have a pixel"):
        inputs.picture(np.zeros((0, 4), np.uint8), "left")
    grey = np.ones((6, 8), np.uint8)
    assert inputs.picture(grey, "left") is grey and inputs.picture(grey[:, ::2], "left").all()


@pytest.mark.parametrize("value", [np.zeros((2, 3)), [[0, 1]], "yes", [True, False], [[]], None])
def test_only_truth_values_of_the_shape_pass_as_such(value):
    with pytest.raises(ValueError, match="inside must be truth values, shape"):
        inputs.truths(value, "inside", ("rows", "columns"))


def test_truth_values_pass_as_they_are():
    mask = np.eye(3, dtype=bool)
    assert inputs.truths(mask, "inside", (3, "n")) is mask
    assert inputs.truths([[True, False]], "inside", (1, 2)).tolist() == [[True, False]]


@pytest.mark.parametrize("value", [None, 1, 0, "yes", np.zeros(1, bool)])
def test_a_flag_is_true_or_false(value):
    with pytest.raises(ValueError, match="plain must be True or False, got"):
        inputs.flag(value, "plain")
    assert inputs.flag(np.True_, "plain") is True and inputs.flag(False, "plain") is False


@pytest.mark.parametrize("value", [(0, 4), (4, 2.5), (4, 10**9), (4, np.nan), 7, None, (1, 2, 3)])
def test_a_picture_has_a_width_and_a_height(value):
    with pytest.raises(ValueError, match="size must be"):
        inputs.image_size(value)
    assert inputs.image_size((np.int64(4), 3.0)) == (4, 3)


def test_a_pose_is_a_rotation_and_a_translation():
    T = np.eye(4)
    T[:3] = [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]
    np.testing.assert_array_equal(inputs.pose([T, T], "T"), [T, T])
    wrong = [np.diag([1.0, 1, -1, 1]), 2 * T, np.diag([1.0, 1, 1, 2]), T[:3], T * np.nan]
    for value in (*wrong, np.diag([1e200, 1, 1, 1]), T + 1e-5):
        with pytest.raises(ValueError, match=r"^T must be"):
            inputs.pose(value, "T")


def test_a_list_of_one_kind_names_the_one_that_is_not():
    assert inputs.instances((1, 2), "paints", int) == [1, 2]
    with pytest.raises(TypeError, match=r"paints\[1\] must be a int, got str"):
        inputs.instances([1, "2"], "paints", int)
    for value in (None, 3, "12", {1: 2}, np.ones(2)):
        with pytest.raises(TypeError, match="paints must be a list or tuple of int, got"):
            inputs.instances(value, "paints", int)


def test_numbers_may_be_bound():
    np.testing.assert_array_equal(inputs.numbers([-2, 1], "x", ("n",), within=2), [-2, 1])
    with pytest.raises(ValueError, match="x must be within 2, got 3"):
        inputs.numbers([-3, 1], "x", ("n",), within=2)
