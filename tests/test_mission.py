import numpy as np
import pytest

from backhoe import dynamics, kinematics, mission, sim
from backhoe.machine import BACKHOE, replace

BUCKET = BACKHOE.shell.struck_capacity


@pytest.fixture(scope="module")
def one_cycle():
    return mission.run(cycles=1)


def test_one_bucket_arrives_in_the_truck(one_cycle):
    assert one_cycle.truck_volume[-1] > 0.8 * BUCKET
    assert one_cycle.bucket_volume[-1] < 0.05 * BUCKET


def test_no_soil_is_made_or_lost(one_cycle):
    assert one_cycle.soil_lost < 1e-6 * BUCKET


def test_the_empty_arm_reaches_its_way_points_and_the_loaded_one_hangs_over_the_bed(one_cycle):
    names = [point.name for point in one_cycle.waypoints]
    distance = np.linalg.norm(one_cycle.reached[:, :3] - one_cycle.wanted[:, :3], axis=-1)
    assert distance[names.index("turn to the heap")] < 0.05
    assert distance[names.index("empty")] < 0.05
    x, y, z, _ = one_cycle.reached[names.index("swing to the truck")]
    truck = sim.LOADING.truck
    assert abs(x - truck.x) < (truck.bed_length - BACKHOE.shell.width) / 2
    assert abs(y - truck.y) < truck.bed_width / 2
    assert z > truck.wall + BACKHOE.bucket.length


def test_joints_stay_inside_their_limits_and_torques_inside_theirs(one_cycle):
    assert (one_cycle.q > BACKHOE.lower).all() and (one_cycle.q < BACKHOE.upper).all()
    assert (np.abs(one_cycle.torque) <= BACKHOE.torque_limit * (1 + 1e-12)).all()


def test_swapping_in_the_librarys_own_parts_changes_nothing(one_cycle):
    again = mission.run(
        cycles=1,
        inverse_kinematics=kinematics.inverse_kinematics,
        gravity_torque=dynamics.gravity_torque,
        plan=mission.hand_made_plan,
        trajectory=mission.smooth_trajectory,
    )
    np.testing.assert_array_equal(again.q, one_cycle.q)
    assert again.truck_volume[-1] == one_cycle.truck_volume[-1]


def test_score_shows_what_a_poor_part_costs():
    def degrees_off(target):
        return kinematics.inverse_kinematics(target) + np.radians([0, 3, 0, 0])

    score = mission.score(mission.run(cycles=1, inverse_kinematics=degrees_off))
    assert score.waypoint_error > 3 * score.reference.waypoint_error
    assert "inverse_kinematics" in str(score) and "library" in str(score)


def test_without_gravity_torque_the_arm_follows_worse():
    weightless = mission.run(cycles=1, gravity_torque=lambda q: np.zeros(4))
    score = mission.score(weightless)
    assert score.tracking > 2 * score.reference.tracking


def test_the_analytic_backend_loads_the_truck_too():
    run = mission.run(cycles=1, backend="analytic")
    assert run.truck_volume[-1] > 0.8 * BUCKET


def test_a_recorded_run_can_be_replayed_and_an_unrecorded_one_says_why_not(one_cycle):
    with pytest.raises(ValueError, match="record=True"):
        one_cycle.replay()


def test_a_longer_stick_still_loads_the_truck():
    longer = replace(BACKHOE, stick=replace(BACKHOE.stick, length=2.1))
    run = mission.run(cycles=1, machine=longer)
    assert run.truck_volume[-1] > 0.5 * BUCKET


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"cycles": 0}, "cycles must be a whole number"),
        (
            {"inverse_kinematics": lambda target: np.zeros(3)},
            r"your inverse_kinematics must return shape \(4,\)",
        ),
        (
            {"gravity_torque": lambda q: np.full(4, np.nan)},
            "your gravity_torque returned a value that is not finite",
        ),
        ({"controller": lambda *_: None}, "your controller"),
        ({"plan": lambda cycle: []}, "plan must return a list of WayPoint"),
        ({"trajectory": lambda times, q_way, t: q_way}, "your trajectory must return two arrays"),
    ],
)
def test_a_part_that_breaks_its_promise_is_named(arguments, message):
    with pytest.raises((ValueError, TypeError), match=message):
        mission.run(**{"cycles": 1, **arguments})


def test_a_part_that_is_not_a_function_is_refused():
    with pytest.raises(TypeError, match="plan must be a function"):
        mission.run(plan=[1, 2, 3])


def test_a_way_point_that_is_too_soon_names_the_joint_and_the_time_it_needs():
    def hasty(cycle):
        return [
            mission.WayPoint(point.name, point.time / 4, point.target)
            for point in mission.hand_made_plan(cycle)
        ]

    with pytest.raises(ValueError, match=r"would turn at .* rad/s, its limit is .*at least"):
        mission.run(plan=hasty, cycles=1)
