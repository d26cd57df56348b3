"""What lesson 02 says in words, where no other test stands behind it."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import oracles
from backhoe.arm import dynamics, integrate
from backhoe.lessons import published
from backhoe.lessons.dynamics import bench, printed
from backhoe.machine import BACKHOE, replace
from backhoe.whole_body import stability

CASES = published.load("mastalli_2013_free_fall")
START = np.concatenate([np.radians(CASES["start_deg"]), np.zeros(4)])
BESIDE = np.concatenate([np.radians([0.0, -89.7, 93.9, -100.5]), np.zeros(4)])
REST = np.zeros(4)


def free(t, q, dq):
    return dynamics.forward_dynamics(q, dq, REST)


def change_of_energy(states):
    energy = np.add(*dynamics.energy(states[:, :4], states[:, 4:])) / 1e3
    return energy - energy[0]


def fall(number, seconds, friction=None):
    torque = np.array(CASES[f"case_{number}"]["torque"])

    def rate(t, x):
        return np.concatenate([x[4:], dynamics.forward_dynamics(x[:4], x[4:], torque, friction)])

    return solve_ivp(rate, (0, seconds), START, method="LSODA", rtol=1e-9, atol=1e-9).y[:, -1]


def smooth(dq):
    return dynamics.friction_torque(dq, smoothing=0.01)


# Section 3: gravity


def test_the_boom_needs_most_torque_far_out_where_the_lever_arms_are_nearly_full():
    boom, stick = np.radians(np.meshgrid(np.linspace(-50, 60, 221), np.linspace(-60, 60, 241)))
    q = np.stack((0 * boom, boom, stick, 0 * boom), axis=-1).reshape(-1, 4)
    most = q[dynamics.gravity_torque(q)[:, 1].argmax()]
    for body in ("boom", "stick", "bucket"):
        alone = {name: 1e-9 for name in {"boom", "stick", "bucket"} - {body}}
        machine = _weighing(alone)
        torque = dynamics.gravity_torque(np.vstack((most, q)), machine=machine)[:, 1]
        assert torque[0] > 0.95 * torque.max()


def _weighing(masses):
    links = {name: replace(getattr(BACKHOE, name), mass=mass) for name, mass in masses.items()}
    return replace(BACKHOE, **links)


def test_three_and_a_half_times_the_push_lifts_the_tracks_within_the_drives_limits():
    q = np.radians([0.0, 15.0, 10.0, 20.0])

    def margin(push):
        return stability.margin(q, soil=[0.0, 0.0, push, 0.0]).distance

    assert margin(3.4 * 20e3) > 0 > margin(3.65 * 20e3)
    torque = dynamics.inverse_dynamics(q, REST, REST, tip_force=[0.0, 0.0, -3.65 * 20e3])
    assert (np.abs(torque) < BACKHOE.torque_limit).all()


# Section 5: Coriolis


def test_no_constant_bounds_the_coriolis_torque_from_below():
    """The swing's speed and one across the slope of M11: a product of speeds without a torque."""
    q = np.radians([0.0, 10.0, 20.0, 30.0])
    slope = dynamics.mass_matrix_derivative(q)[1:, 0, 0]
    across = np.array([0.0, -slope[1], slope[0], 0.0])
    assert np.linalg.norm(across) > 1e3
    torque = dynamics.coriolis_matrix(q, np.array([1.0, 0.0, 0.0, 0.0])) @ across
    assert np.abs(torque).max() < 1e-9 * slope @ slope


# Section 7: the printed model


def test_every_printed_entry_of_boom_stick_and_bucket_but_m44_turns_with_the_boom():
    q = np.random.default_rng(3).uniform(-np.pi, np.pi, (500, 4))
    lifted = q + np.array([0.0, 0.5, 0.0, 0.0])
    turns = np.abs(printed.mass_matrix(lifted) - printed.mass_matrix(q)).max(axis=0)[1:, 1:]
    assert (turns[np.triu_indices(3)][:-1] > 100).all() and turns[2, 2] == 0
    exact = dynamics.mass_matrix(lifted)[:, 1:, 1:] - dynamics.mass_matrix(q)[:, 1:, 1:]
    assert np.abs(exact).max() < 1e-9


# Section 9 and 10: falls and friction


def test_the_boom_of_case_3_goes_over_the_top_within_five_seconds():
    assert np.degrees(fall(3, 5.0)[1]) > 120


def test_a_constant_torque_steadies_only_what_hangs_below_the_horizontal():
    """Steady means that energy less work has a least value: the slope of g is positive definite.

    In absolute angles it is diagonal, each entry minus the height of what a joint carries straight
    on: boom with both others at its end, stick with the bucket at its end, bucket.
    """
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (500, 4))
    step = 1e-5 * np.eye(4)
    slope = [dynamics.gravity_torque(q + d) - dynamics.gravity_torque(q - d) for d in step]
    least = np.linalg.eigvalsh(np.moveaxis(slope, 0, -1)[:, 1:, 1:])[:, 0]
    boom, stick, bucket = BACKHOE.links
    angle = np.cumsum(q[:, 1:] + [link.angle_offset for link in BACKHOE.links], axis=1)
    sine = np.sin(angle)
    com = [np.sin(angle[:, i] + link.com_angle - link.angle_offset)
           for i, link in enumerate(BACKHOE.links)]  # fmt: skip
    heights = [
        boom.mass * boom.com_radius * com[0]
        + (stick.mass + bucket.mass) * boom.length * sine[:, 0],
        stick.mass * stick.com_radius * com[1] + bucket.mass * stick.length * sine[:, 1],
        bucket.mass * bucket.com_radius * com[2],
    ]
    hangs = (np.array(heights) < 0).all(axis=0)
    assert 20 < hangs.sum() < 200
    np.testing.assert_array_equal(least > 0, hangs)


def test_smoothed_friction_only_delays_case_3():
    assert np.degrees(fall(3, 1.0, smooth)[1]) < 0.5
    assert np.degrees(fall(3, 10.0, smooth)[1]) == pytest.approx(75.0, abs=1.0)
    assert np.degrees(fall(3, 12.0, smooth)[1]) > 120


def test_the_surplus_of_case_3_is_less_than_the_booms_dry_friction():
    surplus = CASES["case_3"]["torque"][1] - dynamics.gravity_torque(START[:4])[1]
    assert surplus == pytest.approx(2.7e3, abs=50)
    assert surplus < BACKHOE.coulomb[1] == 4e3


def test_the_machines_friction_is_a_few_per_cent_of_its_torque_limits():
    share = dynamics.friction_torque(BACKHOE.speed_limit) / BACKHOE.torque_limit
    assert (0.01 < share).all() and (share < 0.06).all()


def test_a_solver_with_step_control_is_stuck_in_the_first_millisecond_on_plain_sgn():
    class Enough(Exception):
        pass

    torque, times = np.array(CASES["case_1"]["torque"]), []

    def rate(t, x):
        times.append(t)
        if len(times) > 20_000:
            raise Enough
        return np.concatenate([x[4:], dynamics.forward_dynamics(x[:4], x[4:], torque, True)])

    with pytest.raises(Enough):
        solve_ivp(rate, (0, 1), START, rtol=1e-9, atol=1e-9)
    assert max(times[-100:]) < 1e-3


# Section 11: integrators


def test_half_the_step_halves_what_explicit_euler_pumps():
    rate = integrate.motion(free)
    gained = [
        change_of_energy(integrate.euler(rate, BESIDE, dt, round(5 / dt)).x)[-1]
        for dt in (0.002, 0.001)
    ]
    assert gained[1] > 0.1
    assert gained[0] / gained[1] == pytest.approx(2.0, abs=0.2)


def test_pybullet_and_mujoco_gain_the_energy_of_semi_implicit_euler():
    own = integrate.semi_implicit_euler(free, BESIDE, 0.02, 2500).x
    assert change_of_energy(own)[-1] == pytest.approx(10.87, abs=0.01)
    mujoco = pytest.importorskip("mujoco")
    undamped = re.sub(r' damping="[^"]*"', "", oracles.mjcf())
    model = mujoco.MjModel.from_xml_string(undamped)
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    model.opt.timestep = 0.02
    data = mujoco.MjData(model)
    data.qpos[:] = BESIDE[:4]
    mujoco.mj_step(model, data, 2500)
    theirs = np.concatenate([data.qpos, data.qvel])
    np.testing.assert_allclose(theirs, own[-1], atol=1e-6)
    pytest.importorskip("pybullet")
    swung = bench.let_go(BESIDE[:4], REST, 50.0, dt=0.02).x
    np.testing.assert_allclose(swung[-1], own[-1], atol=1e-6)


def test_at_a_millisecond_semi_implicit_euler_is_right_to_a_tenth_of_a_kilojoule_for_20_s():
    change = change_of_energy(integrate.semi_implicit_euler(free, BESIDE, 0.001, 20_000).x)
    assert np.abs(change).max() < 0.1


# Section 12: PyBullet


@pytest.fixture
def world(tmp_path):
    bullet = pytest.importorskip("pybullet")
    client = bullet.connect(bullet.DIRECT)

    def load(text):
        path = tmp_path / f"{hash(text)}.urdf"  # PyBullet does not read a name twice
        path.write_text(text)
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        return bullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)

    yield bullet, load, client
    bullet.disconnect(client)


def test_pybullet_zeroes_an_inertia_that_no_rigid_body_can_have_and_says_so(world, capfd):
    bullet, load, client = world
    wheel = (
        '<robot name="wheel"><link name="base"/><joint name="turn" type="continuous">'
        '<parent link="base"/><child link="disc"/><axis xyz="0 0 1"/></joint>'
        '<link name="disc"><inertial><mass value="10"/>'
        '<inertia ixx="1" iyy="1" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    for izz, kept in ((1.9, 1.9), (3.0, 0.0)):
        body = load(wheel.format(izz))
        assert bullet.getDynamicsInfo(body, 0, physicsClientId=client)[2][2] == kept
    assert "setting inertia to zero" in capfd.readouterr().out


def test_pybullets_inverse_dynamics_refuses_an_asymmetry_in_the_last_bit(world, capfd):
    bullet, load, client = world
    aslant = re.sub(r'(xyz="[0-9.]+ 0.0 0.0")/><mass', r'\1 rpy="0 0.3 0"/><mass', oracles.urdf())
    body = load(aslant)
    with pytest.raises(SystemError):
        bullet.calculateInverseDynamics(body, [0.1] * 4, [0.0] * 4, [0.0] * 4, client)
    said = capfd.readouterr()
    off = float(re.search(r"I\(2,0\)-I\(0,2\)= *(\S+)", said.out + said.err)[1])
    assert 0 < abs(off) < 1e-11
