"""The figures of lesson 07: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest

from backhoe.lessons.ekf import figures
from backhoe.localisation import kalman
from backhoe.view.plots import style

TIME = np.linspace(0, 5, 11)
BELIEFS = {"before": [0.5, 0.5, 0.0], "after": [0.1, 0.8, 0.1]}
POSES = np.c_[TIME, np.sin(TIME), TIME / 10]
P = np.array([[0.09, 0.02, 0.0], [0.02, 0.04, 0.0], [0.0, 0.0, 0.01]])
COVARIANCES = np.repeat(P[None], 11, axis=0)


def test_bars_are_the_beliefs_and_the_triangle_is_at_the_true_place():
    fig = figures.beliefs(BELIEFS, there=[0, 1], marked=[2])
    for ax, values, place in zip(fig.axes, BELIEFS.values(), (0, 1), strict=True):
        heights = [bar.get_height() for bar in ax.containers[0]]
        np.testing.assert_allclose(heights, values)
        assert ax.lines[0].get_xdata()[0] == place


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (({},), "panels of one length"),
        (({"a": [1.0], "b": [0.5, 0.5]},), "panels of one length"),
        (({"a": [[1.0]]},), r"shape \(n,\)"),
        ((BELIEFS, [1]), "a place for each of 2 panels"),
    ],
)
def test_beliefs_refuse_what_is_no_belief(arguments, message):
    with pytest.raises(ValueError, match=message):
        figures.beliefs(*arguments)


def test_a_tunnel_is_two_deviations_wide_on_either_side():
    deviation = 0.1 + TIME
    ax = figures.tunnels(TIME, {"error [m]": {"one": (0 * TIME, deviation)}}).axes[0]
    (band,) = ax.collections
    top = band.get_paths()[0].vertices
    assert top[:, 1].max() == pytest.approx(2 * deviation.max())
    assert top[:, 1].min() == pytest.approx(-2 * deviation.max())
    assert ax.get_ylabel() == "error [m]"


def test_many_runs_share_one_tunnel_and_one_label():
    ax = figures.tunnels(TIME, {"error [m]": {"runs": (np.zeros((4, 11)), TIME)}}).axes[0]
    assert len(ax.lines) == 4
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["runs", "2 sigma claimed"]


@pytest.mark.parametrize("errors", [np.zeros(10), np.zeros((2, 2, 11))])
def test_a_tunnel_refuses_errors_that_do_not_fit_the_time(errors):
    with pytest.raises(ValueError, match="n = 11"):
        figures.tunnels(TIME, {"error [m]": {"one": (errors, TIME)}})
    with pytest.raises(ValueError, match="needs a panel"):
        figures.tunnels(TIME, {})
    with pytest.raises(ValueError, match="needs a panel"):
        figures.promises(TIME, {}, "sigma [m]")


def test_consistency_has_its_band_and_a_logarithmic_axis():
    fig = figures.consistency({"a": TIME}, {"a": 3 + TIME}, (2.4, 3.7), "NEES [1]")
    (ax,) = fig.axes
    heights = ax.patches[0].get_bbox()
    assert (heights.y0, heights.y1) == (2.4, 3.7)
    assert ax.get_yscale() == "log"
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 3 + TIME)


@pytest.mark.parametrize(
    ("time", "values", "kinds", "message"),
    [
        ({"a": TIME}, {"b": TIME}, {}, "same labels"),
        ({"a": TIME}, {"a": TIME}, {"c": "printed"}, "same labels"),
        ({"a": TIME}, {"a": TIME[1:]}, {}, "11 times and 10 values"),
    ],
)
def test_consistency_refuses_curves_without_times(time, values, kinds, message):
    with pytest.raises(ValueError, match=message):
        figures.consistency(time, values, (1, 2), "NEES [1]", kinds)


def test_ellipses_are_the_librarys_at_the_marks():
    estimates = {"one": (POSES + 0.1, COVARIANCES), "odometry": (POSES, None)}
    kinds = {"odometry": "reference"}
    ax = figures.drives_with_ellipses(POSES, estimates, [3, 7], kinds).axes[0]
    assert len(ax.patches) == 2
    outline = kalman.ellipse(POSES[3, :2] + 0.1, P[:2, :2])
    np.testing.assert_allclose(ax.patches[0].get_xy()[:60], outline)
    dashed = [line for line in ax.lines if line.get_label() == "odometry"]
    assert dashed[0].get_linestyle() == style.KINDS["reference"]["linestyle"]
    assert ax.get_aspect() == 1.0


def test_drives_refuse_what_is_no_drive():
    with pytest.raises(ValueError, match="no estimate called"):
        figures.drives_with_ellipses(POSES, {}, [1], {"one": "printed"})
    with pytest.raises(ValueError, match="rows of x, y"):
        figures.drives_with_ellipses(POSES[0], {}, [1])


def test_clouds_show_the_points_and_an_ellipse_for_each_filter():
    ax = figures.clouds(POSES, {"EKF": (POSES[0], P), "UKF": (POSES[1], P)}).axes[0]
    np.testing.assert_allclose(ax.lines[0].get_xydata(), POSES[:, :2])
    assert len(ax.patches) == 2
    with pytest.raises(ValueError, match="rows of x, y"):
        figures.clouds([1.0, 2.0], {})
