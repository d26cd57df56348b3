"""Driving on one's own estimate: the library's, a student's, what a poor one costs, calm errors."""

import numpy as np
import pytest

from backhoe import mission
from backhoe.localisation import drives, fusion
from backhoe.machine import BACKHOE
from backhoe.vehicle import tracking

R, L = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
_TURN = np.linspace(-np.pi / 2, np.pi / 2, 60)
BEND = tracking.from_points(
    np.vstack([[0.0, 0.0], np.column_stack([1.0 + 1.5 * np.cos(_TURN), 1.5 + 1.5 * np.sin(_TURN)])])
).with_times(0.5)


def bend(**parts):
    return mission.drive(**{"path": BEND, "backend": "analytic", **parts})


def reckoning(turning=drives.SLIPPING, sine=np.sin, cosine=np.cos, sign=1.0):
    def odometry(pose, left, right, dt):
        v = R * (left + right) / 2
        omega = sign * turning * R * (right - left) / L
        x, y, psi = pose
        middle = psi + omega * dt / 2
        return x + v * dt * cosine(middle), y + v * dt * sine(middle), psi + omega * dt

    return odometry


@pytest.fixture(scope="module")
def on_truth():
    return bend()


@pytest.fixture(scope="module")
def reckoned():
    return bend(odometry="library")


def test_without_an_estimator_the_machine_is_told_the_truth(on_truth):
    assert on_truth.estimate is None and on_truth.estimates == {} and on_truth.swapped == ()
    assert np.isnan(mission.score(on_truth).position_error)
    assert "believed" not in str(mission.score(on_truth))


def test_on_odometry_the_log_keeps_truth_and_estimate_apart(on_truth, reckoned):
    assert reckoned.estimate.shape == reckoned.pose.shape == (len(reckoned.time), 3)
    np.testing.assert_array_equal(reckoned.estimate, reckoned.estimates["odometry"])
    np.testing.assert_array_equal(reckoned.estimate[0], reckoned.pose[0])
    assert np.abs(reckoned.estimate[1:] - reckoned.pose[1:]).max() > 0.005
    rolled = np.diff(reckoned.pose[:, :2], axis=0) / 0.02
    np.testing.assert_allclose(
        np.hypot(*rolled.T)[20:], np.abs(reckoned.twist[20:-1, 0]), atol=0.05
    )
    assert reckoned.metrics.d_mean == pytest.approx(
        tracking.metrics(reckoned.pose[:, :2], BEND.points).d_mean
    )
    assert on_truth.metrics.d_mean < reckoned.metrics.d_mean


def test_the_machine_steers_by_its_estimate(reckoned):
    believed = tracking.metrics(reckoned.estimate[:, :2], BEND.points)
    assert believed.d_mean < 0.05


def test_a_seed_repeats_the_noise_and_another_does_not(reckoned):
    np.testing.assert_array_equal(bend(odometry="library").pose, reckoned.pose)
    assert (bend(odometry="library", seed=1).pose[50] != reckoned.pose[50]).any()


def test_the_librarys_own_parts_handed_in_change_nothing(reckoned):
    again = bend(odometry=fusion.Odometer())
    np.testing.assert_array_equal(again.pose, reckoned.pose)
    assert again.swapped == ("odometry",)
    library = bend(localisation="library", fixes=2.0)
    handed = bend(localisation=fusion.Localiser(), fixes=2.0)
    np.testing.assert_array_equal(library.pose, handed.pose)
    assert handed.swapped == ("localisation",) and library.swapped == ()


def test_a_students_odometry_written_out_agrees_with_the_librarys(reckoned):
    own = bend(odometry=reckoning())
    np.testing.assert_allclose(own.pose, reckoned.pose, atol=1e-4)
    score = mission.score(own)
    assert score.distance == pytest.approx(score.reference.distance, rel=1e-2)
    assert "swapped in: odometry" in str(score) and "library" in str(score)


def test_of_both_the_localisation_counts_and_the_odometry_runs_beside(reckoned):
    both = bend(odometry="library", localisation="library", fixes=2.0)
    np.testing.assert_array_equal(both.estimate, both.estimates["localisation"])
    assert tuple(both.estimates) == ("odometry", "localisation")
    assert (both.estimates["odometry"] != both.estimates["localisation"]).any()


def test_fixes_keep_the_estimate_near_the_truth():
    free, fixed = (bend(localisation="library", fixes=fixes, seed=4) for fixes in (None, 1.0))
    assert mission.score(fixed).position_error < 0.06
    assert mission.score(fixed).position_error < mission.score(free).position_error


def test_a_library_drive_on_its_estimate_stands_beside_one_on_the_truth(reckoned):
    score = mission.score(reckoned)
    assert score.reference.distance < score.distance
    assert "on truth" in str(score)
    assert score.position_error > 0 and np.isnan(score.reference.position_error)
    (place,) = [row for row in str(score).splitlines() if row.startswith("believed place off [cm]")]
    assert place.split()[-1] == "0.0"


# What a poor part costs


@pytest.mark.parametrize(
    ("wrong", "shown_by"),
    [
        (reckoning(sign=-1.0), "heading_error"),  # it spins on the spot: only its heading is lost
        (reckoning(sine=np.cos, cosine=np.sin), "position_error"),
        (lambda pose, left, right, dt: pose, "position_error"),
    ],
    ids=["left and right swapped", "sine and cosine swapped", "stands still"],
)
def test_a_gross_mistake_is_plain_to_see_in_the_score(wrong, shown_by):
    score = mission.score(bend(odometry=wrong))
    library = score.reference
    assert score.distance > 5 * library.distance or score.way < 0.5 * library.way
    assert getattr(score, shown_by) > 2.5 * getattr(library, shown_by)
    assert score.position_error > library.position_error
    assert library.distance < 0.1 and not score.reached


def test_odometry_that_does_not_know_of_the_slip_leaves_the_path():
    score = mission.score(bend(odometry=reckoning(turning=1.0)))
    assert score.heading_error > 0.15 > 3 * score.reference.heading_error
    assert score.farthest > 2 * score.reference.farthest


# Errors


def no_pose(*_):
    return 1.0, 2.0


@pytest.mark.parametrize(
    "arguments, error, message",
    [
        (
            {"odometry": no_pose},
            ValueError,
            r"your odometry failed: .* shape \(3,\), got shape \(2,",
        ),
        ({"odometry": lambda a: a}, TypeError, "your odometry failed: .*It is odometry"),
        (
            {"localisation": lambda *_: (0.0, np.nan, 0.0)},
            ValueError,
            "your localisation failed: its answer must be finite, got nan at index 1. It is local",
        ),
        (
            {"localisation": 3.0},
            TypeError,
            r"localisation must be a function .*: localisation\(left",
        ),
        (
            {"localisation": fusion.Localiser},
            TypeError,
            "localisation must be a function or an object to call",
        ),
        ({"odometry": "mine"}, ValueError, "odometry, if it is no function, must be one of lib"),
        ({"fixes": 1.0}, ValueError, "fixes are for a localisation"),
        ({"odometry": "library", "fixes": 1.0}, ValueError, "fixes are for a localisation"),
        ({"localisation": "library", "fixes": 0.0}, ValueError, "fixes must be one number above 0"),
    ],
)
def test_what_breaks_its_promise_is_named(arguments, error, message):
    with pytest.raises(error, match=message):
        bend(time_limit=0.1, **arguments)


def test_a_part_cannot_change_what_it_is_shown(reckoned):
    def meddling(pose, left, right, dt):
        answer = fusion.Odometer()(pose, left, right, dt)
        pose[:] = np.nan
        return answer

    np.testing.assert_array_equal(bend(odometry=meddling).pose, reckoned.pose)


def test_a_localisation_begins_where_the_machine_stands():
    class Waiting:
        def reset(self, pose):
            self.pose = pose

        def __call__(self, left, right, yaw_rate, fix, dt):
            return self.pose

    start = np.array([1.0, -2.0, 0.5])
    run = bend(localisation=Waiting(), pose=start, time_limit=0.1)
    np.testing.assert_array_equal(run.estimate, np.tile(start, (len(run.time), 1)))


def test_a_plant_without_tracks_has_no_encoders_to_believe():
    from backhoe.vehicle.tracking import IdealPlant

    with pytest.raises(ValueError, match="need encoders on tracks: drive the machine, not a Ideal"):
        mission.drive(path=BEND, plant=IdealPlant(), odometry="library")


def test_a_drive_on_an_estimate_is_replayed():
    run = bend(odometry="library", record=True, time_limit=0.5)
    nodes = {node.name: node for node in run.replay().recording.nodes}
    np.testing.assert_allclose(nodes["undercarriage"].values[-1], run.pose[-1])


def test_the_list_of_parts_tells_both_calls():
    table = mission.parts(mission.DRIVE_PARTS)
    assert "odometry(pose, left, right, dt) -> pose" in table
    assert "localisation(left, right, yaw_rate, fix, dt) -> pose" in table


class Claiming:
    """Stands at the start and claims a covariance."""

    def __init__(self, P):
        self.P, self.heard = P, []

    def reset(self, pose):
        self.pose = pose

    def __call__(self, left, right, yaw_rate, fix, dt):
        self.heard.append(fix)
        return self.pose


def test_the_score_sets_errors_and_surprises_beside_what_is_claimed():
    P = np.diag([0.04, 0.09, 0.01, 7.0])
    mine = Claiming(P)
    run = bend(localisation=mine, fixes=0.1, time_limit=1.0)
    np.testing.assert_array_equal(run.claims, np.tile(P[:3, :3], (len(run.time), 1, 1)))
    score = mission.score(run)
    x, y, psi = (run.pose - run.estimate)[1:].T
    expected = np.mean(x**2 / 0.04 + y**2 / 0.09 + psi**2 / 0.01)
    assert score.nees == pytest.approx(expected, rel=1e-6)
    assert score.claimed == pytest.approx(np.sqrt(0.13))
    fixes = [fix for fix in mine.heard if fix is not None]
    y = np.array(fixes) - run.estimate[0, :2]
    expected = np.mean(y[:, 0] ** 2 / (0.04 + 0.02**2) + y[:, 1] ** 2 / (0.09 + 0.02**2))
    assert score.nis == pytest.approx(expected, rel=1e-9)
    assert len(mine.heard) == len(run.time) - 1, "nobody is asked twice"
    assert "NEES, 3 if honest [1]" in str(score) and "NIS, 2 if honest [1]" in str(score)


def test_a_filter_that_claims_too_much_or_too_little_is_seen_in_the_score():
    scores = [
        mission.score(bend(localisation=Claiming(k * np.eye(3)), fixes=1.0, time_limit=2.0))
        for k in (0.0, 0.01, 1.0)
    ]
    sure, middle, modest = (score.nees for score in scores)
    assert sure > 1e6 > 100 * middle > 9000 * modest > 0


@pytest.mark.parametrize("P", [None, 3.0, "sure", np.eye(2), np.zeros((3, 4))])
def test_a_localisation_without_a_covariance_has_no_claims(P):
    run = bend(localisation=Claiming(P), fixes=0.2, time_limit=0.5)
    score = mission.score(run)
    assert np.isnan(score.nees) and np.isnan(score.nis) and len(run.surprises) == 0
    assert str(score).splitlines()[-1].split()[-2] == "-"


def test_the_replay_shows_where_the_machine_believes_to_be():
    run = bend(localisation="library", fixes=1.0, record=True, time_limit=5.0)
    recording = run.replay().recording
    ghost = {node.name: node for node in recording.nodes}["belief"]
    np.testing.assert_allclose(ghost.values[-1], run.estimate[-1])
    assert len(recording.lines) == 2 + (len(run.pose) - 1) // 100, "path, belief and ellipses"
    told_the_truth = bend(record=True, time_limit=0.5).replay().recording
    assert "belief" not in {node.name for node in told_the_truth.nodes}
    assert len(told_the_truth.lines) == 1
