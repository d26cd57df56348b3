"""A dig as a try, against the full simulation under control, energy, and bad input."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm import dynamics, kinematics, pid
from backhoe.machine import BACKHOE
from backhoe.mission.parts import hand_made_plan
from backhoe.simulation.scene import FLAT, LOADING, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM, SOILS
from backhoe.simulation.trial import TICK, dig, dig_many

WAY = hand_made_plan(0)[:5]
TIMES = np.linspace(0.0, 8.0, 60)
KNOTS = np.cumsum([0.0, *(0.81 * point.time for point in WAY[1:])])


def path_of(lower=0.0):
    from scipy.interpolate import PchipInterpolator

    way = np.array([point.target for point in WAY]) - [0, 0, lower, 0]
    return PchipInterpolator(KNOTS, way)(np.minimum(TIMES, KNOTS[-1]))


PATH = path_of()


@pytest.fixture(scope="module")
def tried():
    return dig(PATH, TIMES)


@pytest.fixture(scope="module")
def simulated(tried):
    """The same dig on the exact equations, driven by the torques of the try and a controller for
    what these miss: soil, torques, margin and angles that are missed, at each visit to the soil."""
    controller = pid.PID(*pid.ARM_GAINS, BACKHOE.torque_limit)
    log = []
    with simulation.open_world(backend="analytic", q=tried.q[0]) as world:
        for k in range(len(tried.time)):
            missed = world.q - tried.q[k]
            log.append((world.ground.bucket_volume, *world.torque, world.margin, *missed))
            for _ in range(10):
                torque = controller(tried.q[k], tried.dq[k], world.q, world.dq, world.dt)
                world.step(torque + tried.torque[k])
        return np.array(log)


def test_the_torques_of_a_try_lead_the_simulated_machine_along_its_path(tried, simulated):
    assert np.abs(simulated[:, 6:]).max() < 0.02
    missed = (tried.torque - simulated[:, 1:5])[50:] / BACKHOE.torque_limit
    assert (np.sqrt((missed**2).mean(axis=0)) < 0.035).all()


def test_a_try_digs_what_the_simulation_digs(tried, simulated):
    assert tried.soil > 0.5
    assert tried.soil == pytest.approx(simulated[-1, 0], rel=0.01)
    assert np.abs(tried.volume - simulated[:, 0]).mean() < 0.01


def test_a_try_stands_as_the_simulation_stands(tried, simulated):
    missed = np.abs(tried.margin - simulated[:, 5])[50:]
    assert np.median(missed) < 0.03
    assert tried.least_margin == pytest.approx(simulated[50:, 5].min(), abs=0.05)


def test_work_in_the_air_becomes_energy_and_heat():
    there = np.array([[4.0, -2.0, 3.5, -0.5], [4.5, 1.0, 4.0, 0.4]])
    s = np.linspace(0, 1, 81)[:, None]
    path = there[0] + (10 * s**3 - 15 * s**4 + 6 * s**5) * (there[1] - there[0])
    one = dig(path, 0.05)
    assert one.soil == one.spilled == one.peak_force == 0.0
    still = np.zeros(4)
    up = sum(dynamics.energy(one.q[-1], still)) - sum(dynamics.energy(one.q[0], still))
    loss = BACKHOE.viscous * one.dq**2 + BACKHOE.coulomb * one.dq * np.tanh(one.dq / 0.01)
    given = (one.torque * one.dq).sum() * TICK
    assert given == pytest.approx(up + loss.sum() * TICK, rel=1e-3)
    assert one.energy >= given


def test_harder_soil_strains_the_machine_longer(tried):
    clay = dig(PATH, TIMES, soil="stiff clay")
    assert tried.saturated == 0.0 and clay.saturated > 0.5
    assert clay.peak_force > 2 * tried.peak_force
    assert (clay.strain > 1).sum() * TICK == pytest.approx(clay.saturated)
    assert tried.tipped is None and clay.tipped is not None
    assert tried.least_margin > 0 > clay.least_margin


def test_tries_side_by_side_are_the_same_as_one_by_one(tried):
    lower = path_of(0.1)
    many = dig_many([PATH, lower], TIMES, processes=2)
    for one, path in zip(many, (PATH, lower), strict=True):
        alone = dig(path, TIMES)
        assert one.soil == alone.soil and (one.torque == alone.torque).all()
    assert many[0].soil == tried.soil != many[1].soil


def test_each_path_may_have_its_own_times():
    short = dig_many([PATH, PATH], [TIMES, TIMES / 2], processes=1)
    assert [one.duration for one in short] == pytest.approx([8.0, 4.0])
    with pytest.raises(ValueError, match="each of 2 paths, got 1"):
        dig_many([PATH, PATH], [TIMES])
    with pytest.raises(TypeError, match="ground"):
        dig_many([PATH], TIMES, ground=None)


def test_a_given_ground_is_dug_on_and_keeps_its_volume():
    ground = untouched_ground(LOADING, BACKHOE, 0, 0.001, SANDY_LOAM)
    before = ground.total_volume
    first = dig(PATH, TIMES, ground=ground)
    again = dig(PATH, TIMES, ground=ground)
    assert again.soil < 0.8 * first.soil
    assert ground.bucket_volume == again.soil
    assert ground.off_map_volume >= first.soil
    assert ground.total_volume == pytest.approx(before, abs=1e-9)


def test_a_machine_that_stands_elsewhere_digs_there():
    turned = np.pi / 2
    scene = simulation.Scene(
        corner=(-6.4, -3.0),
        rows=161,
        columns=161,
        cell=0.08,
        heaps=(simulation.scene.Heap(x=0.0, y=6.0, height=1.0, radius=2.5),),
    )
    one = dig(PATH, TIMES, scene=scene, pose=(0.0, 0.0, turned))
    assert one.soil == pytest.approx(dig(PATH, TIMES).soil, rel=0.1)
    assert np.abs(one.force[:, 1]).max() < 0.05 * one.peak_force


def test_over_flat_ground_nothing_is_dug():
    assert dig(path_of(-0.4), TIMES, scene=FLAT).soil == 0.0


def test_a_dense_soil_weighs_on_the_joints(tried):
    loose = SOILS["sandy loam"]
    heavy = dig(PATH, TIMES, soil=type(loose)(density=2 * loose.density))
    assert heavy.torque[-1, 1] - tried.torque[-1, 1] > 0.8 * tried.soil * 1600 * 9.81 * 5.0


@pytest.mark.parametrize(
    ("path", "times", "message"),
    [
        (PATH[:, :3], TIMES, "path must"),
        (PATH * np.nan, TIMES, "path must"),
        (PATH, TIMES[::-1], "times must rise"),
        (PATH, TIMES[:-1], "path must"),
        (PATH, 0.0, "times must"),
        (PATH, 0.0001, "must last"),
        (PATH + np.array([4.0, 0, 0, 0]), TIMES, "s after its start: .*out"),
    ],
)
def test_bad_paths_are_named(path, times, message):
    with pytest.raises(ValueError, match=message):
        dig(path, times)


def test_bad_worlds_are_named():
    with pytest.raises(ValueError, match="soil must be one of"):
        dig(PATH, TIMES, soil="snow")
    with pytest.raises(TypeError, match="scene must be"):
        dig(PATH, TIMES, scene="LOADING")
    with pytest.raises(TypeError, match="ground must be"):
        dig(PATH, TIMES, ground=LOADING)
    with pytest.raises(ValueError, match="processes must"):
        dig_many([PATH, PATH], TIMES, processes=0)


def test_a_try_says_what_happened(tried):
    text = str(tried)
    assert f"{tried.soil:.2f} m^3" in text and "kN" in text and "least margin" in text
    assert tried.speed_share < 1.0
    weight = BACKHOE.mass * 9.81
    assert 1e4 < tried.energy < weight * 3.0
    assert tried.peak_torque[1] == np.abs(tried.torque[:, 1]).max()
    assert kinematics.pose(tried.q[0]) == pytest.approx(PATH[0])
