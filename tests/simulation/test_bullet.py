"""PyBullet's side of the simulation: the generated URDF, contacts, pictures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from backhoe import simulation
from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE, JOINTS
from backhoe.simulation import bullet
from backhoe.simulation.camera import Camera
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.urdf import T_urdf_dh, urdf
from backhoe.view import appearance

pybullet = pytest.importorskip("pybullet")

VARIANT = replace(
    BACKHOE,
    swing=replace(BACKHOE.swing, com_angle=2.5),
    stick=replace(BACKHOE.stick, length=2.5, com_angle=-1.2, mass=900.0),
)
STIFF = np.array([1.2e6, 1.5e6, 4e5, 1.2e5]), np.array([4e5, 3e5, 6e4, 1.5e4])


@pytest.fixture
def world():
    with simulation.open_world(backend="pybullet") as opened:
        yield opened


def heap(terrain, x, y, volume):
    terrain.lay((x, y), (x, y), volume)
    terrain.relax(SANDY_LOAM.repose)


def bullet_poses(world):
    """Pose of every Denavit-Hartenberg frame as PyBullet has it."""
    server = world._server
    poses = []
    for link in JOINTS:
        state = server.getLinkState(world._body, world._joint[link], computeForwardKinematics=True)
        T = np.eye(4)
        T[:3, :3] = np.reshape(pybullet.getMatrixFromQuaternion(state[5]), (3, 3))
        T[:3, 3] = state[4]
        poses.append(T @ T_urdf_dh(link, world.machine))
    return np.array(poses)


@pytest.mark.parametrize("machine", [BACKHOE, VARIANT], ids=["backhoe", "variant"])
def test_the_urdf_is_the_machine(machine):
    rng = np.random.default_rng(2)
    with simulation.open_world(
        machine, backend="pybullet", soil=False, scene=simulation.FLAT
    ) as world:
        for _ in range(20):
            q, dq, ddq = rng.uniform(-1, 1, (3, 4))
            world.reset(q=q)
            # PyBullet hands poses out with about six digits; its dynamics below has them all.
            np.testing.assert_allclose(
                bullet_poses(world), kinematics.link_transforms(q, machine=machine), atol=5e-6
            )
            rates = ([0.0] * 3 + list(part) for part in (q, dq, ddq))
            got = world._server.calculateInverseDynamics(world._body, *rates)
            wanted = dynamics.inverse_dynamics(q, dq, ddq, machine=machine)
            np.testing.assert_allclose(got[3:], wanted, rtol=1e-9, atol=1e-6)


def test_the_urdf_weighs_what_the_machine_weighs(world):
    masses = [
        world._server.getDynamicsInfo(world._body, index)[0] for index in world._joint.values()
    ]
    assert sum(masses) == pytest.approx(BACKHOE.mass)


def test_the_urdf_has_no_motor_limit_or_damping_of_its_own():
    assert 'damping="0"' in urdf() and 'type="revolute"' not in urdf()


def test_an_unknown_link_is_refused():
    with pytest.raises(ValueError, match="unknown link 'elbow'"):
        T_urdf_dh("elbow")


def test_a_free_fall_converges_to_the_exact_motion_at_first_order():
    from scipy.integrate import solve_ivp

    from backhoe.simulation.world import BulletWorld

    start = np.radians([0.0, 10.0, -10.0, 20.0])
    exact = solve_ivp(
        lambda t, x: np.r_[x[4:], dynamics.forward_dynamics(x[:4], x[4:], np.zeros(4))],
        (0.0, 0.5),
        np.r_[start, np.zeros(4)],
        method="DOP853",
        rtol=1e-11,
        atol=1e-11,
    ).y[:4, -1]
    errors = []
    for dt in (0.002, 0.001, 0.0005):

        class Stepped(BulletWorld):
            pass

        Stepped.dt = dt
        with Stepped(
            scene=simulation.FLAT, q=start, soil=False, base="fixed", friction=False
        ) as world:
            for _ in range(round(0.5 / dt)):
                world.step(np.zeros(4))
            errors.append(np.abs(world.q - exact).max())
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.05)
    assert errors[1] < 0.005


def swing_into_the_truck(world, steps):
    kp, kd = STIFF
    log = []
    for _ in range(steps):
        q_ref = np.radians([-60 + 30 * world.time, 0, -10, 0])
        torque = 0.3 * kp * (q_ref - world.q) - kd * world.dq + dynamics.gravity_torque(world.q)
        world.step(torque)
        log.append([*world.pose, *world.q, *world.twist, *world.dq])
    return np.array(log)


def test_the_bucket_meets_the_truck_and_a_snapshot_there_repeats_bit_for_bit():
    with simulation.open_world(backend="pybullet", soil=False) as world:
        world.reset(q=np.radians([-60, 0, -10, 0]))
        swing_into_the_truck(world, 2500)
        assert world._server.getContactPoints(world._body)
        assert np.degrees(world.q[0]) < 10 - 5
        there = world.snapshot()
        first = swing_into_the_truck(world, 700)
        world.restore(there)
        np.testing.assert_array_equal(swing_into_the_truck(world, 700), first)


def test_a_picture_shows_machine_truck_and_ground(world):
    picture = world.render(160, 120, shadow=False)
    assert picture.shape == (120, 160, 3) and picture.dtype == np.uint8
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    assert ((red > 150) & (green > 100) & (blue < 60)).sum() > 200  # the machine's yellow
    assert ((blue > red + 30) & (blue < 160)).sum() > 30  # the truck's bed
    assert (blue[0] > red[0]).all()  # the sky


def test_shadows_only_darken(world):
    lit, shaded = (world.render(160, 120, shadow=shadow).astype(int) for shadow in (False, True))
    assert (shaded <= lit + 1).all()
    assert (shaded.sum(-1) < 0.8 * lit.sum(-1)).mean() > 0.01


def test_looking_does_not_change_what_happens(world):
    hold = dynamics.gravity_torque(world.q)
    for _ in range(200):
        world.step(hold + 2e4)
    seen = world.q
    world.reset()
    for k in range(200):
        world.step(hold + 2e4)
        if k % 100 == 0:
            world.render(32, 24)
    np.testing.assert_array_equal(world.q, seen)


def test_pictures_follow_machine_soil_and_load(world):
    view = {"width": 160, "height": 120, "shadow": False}
    first = world.render(**view)
    np.testing.assert_array_equal(world.render(**view), first)

    def differs(picture):
        return np.abs(picture.astype(int) - first).max(axis=-1).mean()

    heap(world.ground.terrain, 4.5, -1.5, 1.5)
    heaped = differs(world.render(**view))
    assert heaped > 0.2
    heap(world.ground.bed, 0.8, 5.3, 9.0)
    loaded = differs(world.render(**view))
    assert loaded > heaped
    world.reset(q=np.radians([-60, 30, -30, 0]))
    assert differs(world.render(**view)) > 1.0


def test_the_camera_finds_its_points_again():
    camera = Camera.at((5, -4, 3), (1, 0, 1), 0.8, (40, 60), 0.1, 50.0)
    depth = np.random.default_rng(0).uniform(0.5, 0.99, (40, 60))
    row, column, ahead = camera.project(camera.unproject(depth))
    np.testing.assert_array_equal(row, np.arange(40)[:, None] + np.zeros((1, 60), int))
    np.testing.assert_array_equal(column, np.zeros((40, 1), int) + np.arange(60))
    np.testing.assert_allclose(ahead, camera.distance(depth))


@pytest.mark.parametrize(
    "view, message",
    [
        ({"width": 0}, "width must be one whole number at least 1, got 0"),
        ({"height": 2.5}, "height must be one whole number"),
        ({"field_of_view": 4.0}, "field_of_view must be one number above 0 and below 3.14"),
        ({"eye": (0, 0)}, r"eye must be x, y, z \[m\], shape \(3,\)"),
        ({"eye": (1, 1, 9), "target": (1, 1, 0)}, "straight above"),
    ],
)
def test_impossible_views_are_refused(world, view, message):
    with pytest.raises(ValueError, match=message):
        world.render(**view)


def test_closing_leaves_no_files_behind(world):
    world.render(16, 12, shadow=False)
    folder = Path(world._renderer._folder.name)
    assert folder.exists()
    world.close()
    assert not folder.exists()
    with pytest.raises(RuntimeError, match="closed"):
        world.render(16, 12)


def test_the_boxes_that_collide_are_the_truck_that_is_drawn():
    truck = simulation.LOADING.truck
    drawn = np.vstack([part.vertices for part in appearance.truck_visuals(truck)])
    for lower, upper in appearance.truck_boxes(truck):
        assert (lower > drawn.min(axis=0) - 1e-9).all()
        assert (upper < drawn.max(axis=0) + 1e-9).all()


def test_rays_hit_the_ground_the_heap_and_the_load(world):
    above = np.array([[-1.5, -4.0], [6.0, 0.0], [0.8, 5.3], [5.2, 0.7]])
    rays = np.c_[above, np.full(4, 8.0)], np.c_[above, np.full(4, -3.0)]
    expected = world.ground.terrain.height_at(above)
    expected[2] = world.scene.truck.floor
    np.testing.assert_allclose(world.cast_rays(*rays)[:, 2], expected, atol=0.01)
    heap(world.ground.bed, 0.8, 5.3, 3.0)
    heap(world.ground.terrain, 6.0, 0.0, 1.0)
    hits = world.cast_rays(*rays)[:, 2]
    assert hits[1] == pytest.approx(world.ground.terrain.height_at(above[1]), abs=0.01)
    assert hits[2] == pytest.approx(world.ground.bed.height_at(above[2]), abs=0.01)


def test_rays_hit_the_machine_where_it_is(world):
    over = (0.0, 0.0, 6.0), [(0.0, 0.0, -1.0)]
    assert world.cast_rays(*over)[0, 2] > 1.0
    world.reset(pose=[-12.0, 0.0, 0.0])
    assert world.cast_rays(*over)[0, 2] == pytest.approx(0.0, abs=0.05)


def test_rays_that_hit_nothing_are_nan(world):
    hits = world.cast_rays((0.0, 0.0, 6.0), [(0.0, 0.0, 50.0), (0.0, 0.0, -1.0)])
    assert np.isnan(hits[0]).all() and np.isfinite(hits[1]).all()


def test_rays_beyond_the_map_hit_the_flat_country(world):
    np.testing.assert_allclose(
        world.cast_rays((40.0, 3.0, 6.0), [(40.0, 3.0, -1.0)]), [[40.0, 3.0, 0.0]], atol=1e-4
    )


def test_rays_of_the_wrong_shape_are_refused(world):
    with pytest.raises(ValueError, match=r"start must have shape \(3,\), got shape \(2,\)"):
        world.cast_rays((0.0, 0.0), [(0.0, 0.0, 1.0)])
    with pytest.raises(ValueError, match="start must be finite"):
        world.cast_rays((0.0, 0.0, np.nan), [(0.0, 0.0, 1.0)])


def test_a_quaternion_is_that_of_scipy():
    for R in Rotation.random(50, rng=np.random.default_rng(3)):
        found, wanted = bullet.quaternion(R.as_matrix()), R.as_quat()
        np.testing.assert_allclose(found, np.copysign(1, found @ wanted) * wanted, atol=1e-12)
