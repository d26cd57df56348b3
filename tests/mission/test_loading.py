import numpy as np
import pytest

from backhoe import mission, simulation
from backhoe.arm import dynamics, kinematics, pid
from backhoe.machine import BACKHOE, replace
from backhoe.simulation import loop

BUCKET = BACKHOE.shell.struck_capacity


class InPlace(pid.PID):
    """A controller that writes into all it is given."""

    def __call__(self, q_ref, dq_ref, q, dq, dt):
        torque = super().__call__(q_ref, dq_ref, q, dq, dt)
        for argument in (q_ref, dq_ref, q, dq):
            argument[:] = np.nan
        return torque


class OddError(ValueError):
    def __init__(self, first, second):
        super().__init__(first, second)


def fails_oddly(target):
    raise OddError("no", "way")


@pytest.fixture
def short_plan():
    """Two way-points above the ground, half a second each."""
    q = loop.REST + np.radians([[4.0, 0, 0, 0], [4.0, 3, 0, 10]])
    targets = kinematics.pose(q).tolist()
    return lambda cycle: [mission.WayPoint(str(n), 0.5, tuple(x)) for n, x in enumerate(targets)]


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
    assert distance[names.index("empty")] < distance[names.index("tip out")]
    x, y, z, _ = (one_cycle.reached - one_cycle.wanted)[names.index("empty")]
    assert np.hypot(x, y) < 0.05 and z > -0.05
    x, y, z, _ = one_cycle.reached[names.index("swing to the truck")]
    truck = simulation.LOADING.truck
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
        ({"cycles": 0}, "cycles must be one whole number"),
        (
            {"inverse_kinematics": lambda target: np.zeros(3)},
            r"your inverse_kinematics failed: its answer must have shape \(4,\).*It is inverse_k",
        ),
        (
            {"gravity_torque": lambda q: np.full(4, np.nan)},
            "your gravity_torque failed: its answer must be finite",
        ),
        ({"controller": lambda *_: None}, "your controller"),
        ({"plan": lambda cycle: []}, "plan must return a list of WayPoint"),
        ({"trajectory": lambda times, q_way, t: q_way}, r"your trajectory failed: .* shape \(2, "),
        (
            {"trajectory": lambda times, q_way, t: (q_way, q_way)},
            r"your trajectory failed: .* got shape \(2, \d, 4\). It is trajectory",
        ),
        ({"plan": lambda cycle: None}, "plan must return a list of WayPoint.*, got None"),
        ({"plan": lambda: []}, "your plan failed"),
        (
            {"gravity_torque": lambda q: np.full(4, 1j)},
            "your gravity_torque failed: its answer must be numb",
        ),
        ({"inverse_kinematics": fails_oddly}, "your inverse_kinematics failed"),
        ({"ik": kinematics.inverse_kinematics}, "unknown part 'ik': the parts are plan, inverse_"),
        ({"controller": InPlace}, "controller must be a function or an object"),
    ],
)
def test_a_part_that_breaks_its_promise_is_named(arguments, message):
    with pytest.raises((ValueError, TypeError), match=message):
        mission.run(**{"cycles": 1, **arguments})


@pytest.mark.parametrize(
    ("time", "target", "message"),
    [
        (1.0, (9.0, 0.0, 2.0, 0.0), "^at way-point 'far': target .* outside the reach"),
        (1.0, (6.0, 0.0, 2.0), "the target of way-point 'far' must be x, y, z and the bucket"),
        (1.0, "here", "the target of way-point 'far' must be numbers, got 'here'"),
        (
            1.0,
            (6.0, 0.0, np.nan, 0.0),
            "the target of way-point 'far' must be finite, got nan at index 2",
        ),
        (
            "1",
            (6.0, 0.0, 2.0, 0.0),
            "the time of way-point 'far' must be one number above 0 .s., got '1'",
        ),
        (
            np.inf,
            (6.0, 0.0, 2.0, 0.0),
            "the time of way-point 'far' must be one number above 0 .s., got inf",
        ),
    ],
)
def test_a_way_point_that_cannot_be_is_named(time, target, message):
    def plan(cycle):
        return [mission.WayPoint("far", time, target)]

    with pytest.raises(ValueError, match=message):
        mission.run(plan=plan, cycles=1)


def in_degrees(target):
    return np.degrees(kinematics.inverse_kinematics(target))


def a_turn_too_far(target):
    q = kinematics.inverse_kinematics(target)
    return q - [2 * np.pi, 0, 0, 0]


def elbow_down(target):
    return kinematics.inverse_kinematics(target, elbow="down")


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (
            {"inverse_kinematics": in_degrees},
            "^at way-point 'turn to the heap' the swing would be at -90.000 rad, its limits are "
            "-3.142 and 3.142 rad: are these degrees",
        ),
        ({"inverse_kinematics": a_turn_too_far}, "the swing .* back by a whole turn"),
        ({"inverse_kinematics": elbow_down}, "the stick would be at .* rad, .* another posture"),
        (
            {"trajectory": lambda *at: np.degrees(mission.smooth_trajectory(*at))},
            "^your trajectory: at 0.00 s the swing would be at -.* degrees",
        ),
        (
            {
                "trajectory": lambda *at: (
                    mission.smooth_trajectory(*at)[0],
                    np.degrees(mission.smooth_trajectory(*at)[1]),
                )
            },
            "^your trajectory's speeds are not those of its angles: are these degrees",
        ),
    ],
)
def test_advice_on_angles_comes_before_advice_on_time(parts, message):
    with pytest.raises(ValueError, match=message):
        mission.run(cycles=1, backend="analytic", **parts)


def test_an_error_inside_a_part_keeps_its_type_and_names_the_part():
    def divides(q):
        return q / [1, 2, 3][7]

    with pytest.raises(IndexError) as caught:
        mission.run(gravity_torque=divides, cycles=1)
    assert "in your gravity_torque" in caught.value.__notes__[0]


def test_parts_that_write_into_their_arguments_spoil_nothing(short_plan):
    def inverse(target):
        q = kinematics.inverse_kinematics(target)
        target[:] = np.nan
        return q

    def gravity(q):
        torque = dynamics.gravity_torque(q)
        q[:] = np.nan
        return torque

    def trajectory(times, q_way, t):
        result = mission.smooth_trajectory(times, q_way, t)
        times[:], q_way[:], t[:] = np.nan, np.nan, np.nan
        return result

    plain = mission.run(plan=short_plan, cycles=1)
    run = mission.run(
        plan=short_plan,
        inverse_kinematics=inverse,
        gravity_torque=gravity,
        controller=InPlace(*pid.ARM_GAINS, BACKHOE.torque_limit),
        trajectory=trajectory,
        cycles=1,
    )
    for name in ("time", "q", "q_ref", "torque", "wanted", "reached"):
        np.testing.assert_array_equal(getattr(run, name), getattr(plain, name))


def test_lists_are_as_good_as_arrays(short_plan):
    run = mission.run(
        plan=lambda cycle: tuple(short_plan(cycle)),
        inverse_kinematics=lambda target: kinematics.inverse_kinematics(target).tolist(),
        gravity_torque=lambda q: dynamics.gravity_torque(q).tolist(),
        trajectory=lambda *where: [part.tolist() for part in mission.smooth_trajectory(*where)],
        cycles=1,
    )
    np.testing.assert_array_equal(run.q, mission.run(plan=short_plan, cycles=1).q)


def test_a_second_run_in_one_world_is_scored_by_its_own_soil():
    with simulation.open_world(backend="analytic") as world:
        mission.run(world=world, cycles=1)
        second = mission.run(world=world, cycles=1)
        world.step(np.zeros(4))
    assert second.truck_volume[0] > 0.5 * BUCKET
    score = mission.score(second)
    assert score.soil == second.truck_volume[-1] - second.truck_volume[0]


def test_a_run_in_a_students_own_world_is_scored_in_the_same_scene(short_plan):
    bare = replace(simulation.LOADING, heaps=())
    with simulation.open_world(backend="analytic", scene=bare) as world:
        world.backend = "mine"
        run = mission.run(world=world, cycles=1, gravity_torque=dynamics.gravity_torque)
    assert mission.score(run).reference.soil < 0.5 * BUCKET


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
