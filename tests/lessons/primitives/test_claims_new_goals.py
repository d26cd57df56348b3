"""What lesson 10b says in strong words."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.lessons.primitives.exercises.new_goals import moved_cycle, stiff_path
from backhoe.machine import BACKHOE
from backhoe.mission.parts import hand_made_plan, smooth_trajectory
from backhoe.mission.worksite import TICK, Led
from backhoe.planning.dmp import DMP, REMEDIES, demonstration, minimum_jerk, phase, sequence
from backhoe.planning.foresight import foresee
from backhoe.simulation.clock import STEP
from backhoe.simulation.scene import LOADING, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.whole_body import stability

SHIFT = np.array([-3.2, 0.2])
BED = replace(LOADING.truck, x=LOADING.truck.x + SHIFT[0], y=LOADING.truck.y + SHIFT[1])
SCENE = replace(LOADING, truck=BED)


@pytest.mark.parametrize(("K", "kernels"), [(50_000, 100), (50_000, 40), (500_000, 70)])
def test_a_nearer_goal_sends_it_backwards_by_half_the_way_and_it_stops_short(K, kernels):
    t = np.linspace(0, 10, 1001)
    dmp = DMP(kernels, K).learn(minimum_jerk(t / 10)[0], t)
    x = dmp.rollout(goal=[0.2])[1][:, 0]
    predicted = stiff_path(minimum_jerk(t / 10)[0][:, None], phase(t, 10), np.array([0.2]))
    assert x.min() == pytest.approx(-0.48, abs=0.015)
    assert np.abs(x - predicted[:, 0]).max() < 0.03
    assert x[-1] - 0.2 == pytest.approx(0.0052 * 0.8, rel=0.06)


def test_the_phase_has_lost_half_of_its_way_after_an_eighth_of_the_time():
    assert phase(0.132 * 7.0, 7.0) == pytest.approx(0.5, abs=1e-3)


@pytest.fixture(scope="module")
def dig():
    return DMP().learn(*demonstration("dig")[::-1])


def test_a_higher_dig_is_thrown_about_by_scaling_and_shallower_by_all(dig):
    goal = dig.goal + np.array([0, 0, 0.5, 0])
    known = np.vstack([dig.rollout()[1], goal])[:, 2]
    heights = {one: dig.rollout(goal=goal, remedy=one)[1][:, 2] for one in REMEDIES}
    assert heights["scaled"].min() == pytest.approx(-2.40, abs=0.01)
    assert np.ptp(heights["scaled"]) == pytest.approx(
        4.1 * np.ptp(dig.rollout()[1][:, 2]), rel=0.02
    )
    assert heights["none"].max() - known.max() == pytest.approx(0.35, abs=0.01)
    for remedy in ("affine", "minimum_jerk"):
        assert heights[remedy].max() - known.max() < 0.23
    deeper = [heights[one].min() - known.min() for one in ("none", "affine", "minimum_jerk")]
    assert np.sort(deeper) == pytest.approx([0.34, 0.45, 0.49], abs=0.006)


def test_alpha_alone_changes_the_shape_and_tau_does_not(dig):
    base = dig.rollout(dt=0.004)[1]
    assert np.abs(dig.rollout(duration=dig.duration / 2, dt=0.002)[1] - base).max() < 1e-9
    for K, wrong in ((5_000, 0.0415), (50_000, 0.0133)):
        alone = DMP(stiffness=K).learn(*demonstration("dig")[::-1])
        shown = alone.rollout(dt=0.004)[1]
        alone.tau *= 2
        x = alone.rollout(duration=dig.duration / 2, dt=0.002)[1]
        assert np.sqrt(np.mean((x - shown)[:, :3] ** 2)) == pytest.approx(wrong, rel=0.01)


def test_blending_spares_the_joint():
    times, positions = demonstration("dig")
    load = DMP().learn(*demonstration("load")[::-1])
    broken = DMP().learn(positions[times < 11.5], times[times < 11.5])
    peaks = []
    for blend in (0.0, 1.0):
        t, _, v = sequence([broken, load], blend=blend, dt=0.005, remedy="minimum_jerk")
        near = np.abs(t - broken.duration) < 1.2
        peaks.append(np.abs(np.gradient(v, t, axis=0)[near, :3]).max())
    assert peaks[0] > 10 * peaks[1]


def loaded(t, q, dq):
    """Soil in the truck that has moved, of a machine led along joint angles [m^3]."""
    led = Led(0)
    led.ground = untouched_ground(SCENE, BACKHOE, 0, STEP, SANDY_LOAM)
    ticks = np.arange(0, t[-1], TICK)
    rows = [np.column_stack([np.interp(ticks, t, c) for c in one.T]) for one in (q, dq)]
    for angles, speeds in zip(*rows, strict=True):
        led.dig(angles, speeds)
    return led.ground.truck_volume


def test_a_right_answer_loads_the_truck_and_the_hand_made_plan_does_not():
    cycle = moved_cycle(demonstration("dig"), demonstration("load"), SHIFT)
    t, x = np.r_[cycle[0], cycle[0][-1] + 0.8], np.vstack([cycle[1], cycle[1][-1]])
    q = inverse_kinematics(x)
    assert loaded(t, q, np.gradient(q, t, axis=0)) > 0.6
    plan = hand_made_plan(0)
    times = np.cumsum([0.0, *(point.time for point in plan)])
    way = inverse_kinematics(np.array([point.target for point in (plan[0], *plan)]))
    t = np.arange(0, times[-1], TICK)
    assert loaded(t, *smooth_trajectory(times, way, t)) < 0.05


def test_the_stiff_way_to_that_truck_is_out_of_reach_and_the_others_are_not():
    load = DMP().learn(*demonstration("load")[::-1])
    goal = load.goal + np.r_[SHIFT, 0, 0]
    for remedy in REMEDIES:
        t, x, _ = load.rollout(goal=goal, remedy=remedy, dt=0.02)
        seen = foresee(x, t, margin=stability.margin)
        assert seen.ok == (remedy != "none")
        assert remedy != "none" or seen.out_by.max() == pytest.approx(0.55, abs=0.01)
    times, positions = demonstration("load")
    stiff = stiff_path(positions, phase(times, times[-1]), goal)
    with pytest.raises(ValueError, match="needs the stick at"):
        inverse_kinematics(stiff)


def test_goals_moved_as_the_thesis_moves_them_stay_nearer_to_what_was_shown_by_minimum_jerk():
    dig, driven = DMP().learn(*demonstration("dig")[::-1]), 0
    shown = dig.rollout()[1]
    for shift in np.vstack([np.diag([1.0, 1.0, 1.0, 0.5]), -np.diag([1.0, 1.0, 1.0, 0.5])]):
        goal, beyond = dig.goal + shift, []
        low, high = (np.vstack([getattr(shown, end)(axis=0), goal]) for end in ("min", "max"))
        for remedy in ("none", "minimum_jerk"):
            t, x, _ = dig.rollout(goal=goal, remedy=remedy, dt=0.02)
            beyond.append(max(0.0, (low.min(axis=0) - x).max(), (x - high.max(axis=0)).max()))
        assert beyond[1] <= beyond[0] + 1e-3
        driven += foresee(x, t, margin=stability.margin).ok
    assert driven == 7
