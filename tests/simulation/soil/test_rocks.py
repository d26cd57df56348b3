"""Rocks: what the bucket feels of them, against the energy of the spring, and that none is dug."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from backhoe import simulation
from backhoe.machine import BACKHOE
from backhoe.simulation.scene import FLAT, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM, Ground, Rock, Terrain
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.rocks import STIFFNESS, Rocks

ROCK = Rock(5.0, 0.2, -0.4, 0.5)
STILL = (0.0, 0.0, 0.0)


def felt(tip, pitch=-1.3, velocity=STILL, rate=0.0, rock=ROCK):
    rocks = Rocks([rock], BACKHOE, mass=600.0, hold=0.001)
    return np.array(rocks.push(BucketPose(tuple(tip), (1.0, 0.0), pitch), velocity, rate))


def energy(tip, pitch):
    """Of the spring: nearest point of the shell by brute force, over its width and its profile."""
    corners = np.array(BACKHOE.shell.profile)
    c, s = np.cos(pitch), np.sin(pitch)
    part = np.linspace(0, 1, 4001)[:, None]
    line = np.concatenate([a + part * (b - a) for a, b in pairwise(corners)])
    u, z = line[:, 0] * c - line[:, 1] * s, line[:, 0] * s + line[:, 1] * c
    half = BACKHOE.shell.width / 2
    aside = np.clip(ROCK.y, tip[1] - half, tip[1] + half) - ROCK.y
    away = np.sqrt((tip[0] + u - ROCK.x) ** 2 + aside**2 + (tip[2] + z - ROCK.z) ** 2).min()
    return STIFFNESS / 2 * max(ROCK.radius - away, 0.0) ** 2


@pytest.mark.parametrize(
    ("tip", "pitch"),
    [
        ((5.3, 0.0, -0.15), -1.3),  # the teeth
        ((5.3, 1.0, -0.15), -1.3),  # beside the middle: the end of the edge
        ((4.5, 0.0, 0.0), -2.9),  # the belly
        ((4.6, 0.5, 0.05), -2.6),
    ],
)
def test_the_push_is_that_of_the_spring_at_the_nearest_point(tip, pitch):
    push, step = felt(tip, pitch), 1e-4
    assert np.linalg.norm(push[:3]) > 1e5
    for k in range(3):
        there = np.eye(3)[k] * step
        slope = (energy(tip + there, pitch) - energy(tip - there, pitch)) / (2 * step)
        assert push[k] == pytest.approx(-slope, rel=2e-3, abs=2e2)
    turned = (energy(tip, pitch + step) - energy(tip, pitch - step)) / (2 * step)
    assert push[3] == pytest.approx(-turned, rel=5e-3, abs=2e3)


def test_a_damper_takes_power_and_never_pulls():
    tip = (5.3, 0.0, -0.15)
    still = felt(tip)
    outwards = still[:3] / np.linalg.norm(still[:3])
    into, out = (felt(tip, velocity=tuple(v * outwards)) for v in (-0.5, 0.5))
    assert into[:3] @ outwards > still[:3] @ outwards > out[:3] @ outwards
    assert (felt(tip, velocity=tuple(50 * outwards)) == 0).all()
    assert felt(tip, rate=0.3)[0] == pytest.approx(still[0])  # the teeth are where it turns


def test_a_turning_belly_feels_its_own_speed():
    tip, pitch = (4.5, 0.0, 0.0), -2.9
    still = felt(tip, pitch)
    assert still[3] > 0  # the rock raises the pitch, so a rising pitch leaves it
    assert np.linalg.norm(felt(tip, pitch, rate=0.2)[:3]) < np.linalg.norm(still[:3])


def test_a_bucket_that_stands_beside_feels_nothing():
    assert (felt((5.0, 0.0, 1.6)) == 0).all()
    assert (felt((5.0, 3.0, -0.4)) == 0).all()


def test_a_turned_machine_feels_the_same():
    rocks = Rocks([Rock(-0.2, 5.0, -0.4, 0.5)], BACKHOE, 600.0, 0.001)
    x, y, z, moment = rocks.push(BucketPose((0.0, 5.3, -0.15), (0.0, 1.0), -1.3), STILL, 0.0)
    np.testing.assert_allclose((y, -x, z, moment), felt((5.3, 0.0, -0.15)), atol=1e-6)


def test_no_rock_is_dug_and_soil_keeps_its_volume():
    scene = replace(FLAT, rocks=(ROCK,))
    ground = untouched_ground(scene, BACKHOE, 0, 0.001, SANDY_LOAM)
    top, whole = ROCK.top_at(*scene.grid()), ground.total_volume
    assert ground.terrain.height_at((5.0, 0.2)) == pytest.approx(0.1, abs=0.03)  # it sticks out
    for k in range(120):
        now = BucketPose((6.0 - 0.02 * k, 0.0, -0.2), (1.0, 0.0), -1.3)
        ground.move(now, (-2.0, 0.0, 0.0), 0.01)
    assert (ground.terrain.heights >= top - 1e-12).all()
    assert ground.bucket_volume > 0.2
    assert ground.total_volume == pytest.approx(whole, abs=1e-9)
    assert ground.terrain.heights[top == -np.inf].min() == pytest.approx(-0.2, abs=0.02)


def test_the_world_feels_a_rock_each_millisecond_and_repeats():
    scene = replace(FLAT, rocks=(Rock(5.6, 0.0, 0.3, 0.6),))
    q = np.radians([-90.0, 5.0, -80.0, -20.0])
    with simulation.open_world(backend="analytic", scene=scene, q=q) as world:
        forces = []
        for _ in range(1500):
            world.step([0.0, -5e4, -2e4, 0.0])
            forces.append(world.soil_force[2])
            if abs(forces[-1]) > 1e4:
                break
        assert abs(forces[-1]) > 1e4
        snapshot, after = world.snapshot(), []
        for _ in range(2):
            world.restore(snapshot)
            pushes = []
            for _ in range(60):
                world.step([0.0, -5e4, -2e4, 0.0])
                pushes.append(world.soil_force)
            after.append(np.array(pushes))
        assert (after[0] == after[1]).all()
        assert len(np.unique(after[0][:, 2])) > 20
        assert (np.abs(after[0][:9, 2]) > 1e4).all()  # between two visits to the soil as well


def test_a_floor_may_lie_under_some_cells_only():
    floor = np.full((4, 5), -np.inf)
    floor[1, 2] = -0.5
    terrain = Terrain(np.zeros((4, 5)) + 0.1, 0.5, floor=floor)
    assert terrain.volume == pytest.approx((19 * 0.1 + 0.6) * 0.25)
    floor[1, 2] = np.nan
    with pytest.raises(ValueError, match="below the floor"):
        Terrain(np.zeros((4, 5)), 0.5, floor=floor)


def test_bad_rocks_are_named():
    with pytest.raises(ValueError, match=r"Rock\.radius"):
        Rock(0, 0, 0, 0)
    with pytest.raises(ValueError, match=r"Rock\.x, y and z"):
        Rock(0, np.nan, 0, 1)
    with pytest.raises(TypeError, match=r"each of Scene\.rocks must be a Rock"):
        replace(FLAT, rocks=((1, 2, 3, 4),))
    assert Ground(Terrain.flat((0, 1), (0, 1), 0.1)).total_volume == 0.0
