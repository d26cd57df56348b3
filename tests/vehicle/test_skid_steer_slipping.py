"""The slipping model, its integrator, batches of runs and the plant."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, SkidSteerPlant, engine, replace, simulate

UNEVEN = replace(
    HUSKY, front=0.2, rear=0.35, friction_longitudinal=0.5, friction_lateral=0.3, rolling=0.05
)
FREE = replace(HUSKY, rolling=0.0)


@pytest.fixture
def rng():
    return np.random.default_rng(14)


def moving(rng, *shape):
    return rng.normal(size=(*shape, 10)) * ([1, 1, 2] + [0.5, 0.2, 0.5] + [3.0] * 4)


def driven(v, omega, seconds, dt=0.02, vehicle=HUSKY, **options):
    n = round(seconds / dt)
    return simulate(np.full(n, float(v)), np.full(n, float(omega)), dt, vehicle, **options)


# The equations


def lagrangian_rate(state, torque, vehicle):
    """Accelerations in the world's frame, forces wheel by wheel from their definition."""
    theta, v, omega = state[2], complex(state[3], state[4]), state[5]
    ahead = np.exp(1j * theta)
    force, moment, spin = 0j, 0.0, []
    for i, (x, y) in enumerate(vehicle.positions):
        slip = v + 1j * omega * complex(x, y) - vehicle.wheel_radius * state[6 + i]
        size = 2 / np.pi * np.arctan(vehicle.smoothing * abs(slip)) * vehicle.loads[i]
        mu_x, mu_y = vehicle.friction_longitudinal, vehicle.friction_lateral
        pull = -size * complex(mu_x * slip.real, mu_y * slip.imag) / abs(slip)
        force += pull
        moment += (complex(x, -y) * pull).imag
        r = vehicle.wheel_radius
        rolling = vehicle.loads[i] * vehicle.rolling * r**2 * state[6 + i]
        spin.append((torque[i] - r * pull.real - rolling) / vehicle.wheel_inertia)
    world = force * ahead / vehicle.mass
    own = world / ahead - 1j * omega * v  # d(v e^i theta)/dt = world
    pose = v * ahead
    return [pose.real, pose.imag, omega, own.real, own.imag, moment / vehicle.inertia, *spin]


@pytest.mark.parametrize("vehicle", [HUSKY, UNEVEN])
def test_the_equations_are_newton_s_in_the_world(vehicle, rng):
    for state in moving(rng, 30):
        torque = rng.normal(size=4)
        expected = lagrangian_rate(state, torque, vehicle)
        assert skid_steer.state_rate(state, torque, vehicle) == pytest.approx(expected)


@pytest.mark.parametrize("vehicle", [HUSKY, UNEVEN])
def test_the_compiled_rates_are_those_of_the_equations(vehicle, rng):
    damping, rotor = np.array([1.0, 2.0, 0.0, 3.0]), 0.3
    fleet, found = engine.fleet([FREE, vehicle], damping, rotor), np.empty(10)
    for state in moving(rng, 30):
        drive = rng.normal(size=4)
        engine.rate(state, drive, fleet, 1, found)
        torque = drive - damping * state[6:]
        expected = skid_steer.state_rate(state, torque, vehicle, rotor_inertia=rotor)
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_the_compiled_rates_hold_on_the_last_micrometres_of_slip():
    vehicle = replace(HUSKY, rolling=0.0)
    fleet, found = engine.fleet([vehicle]), np.empty(10)
    for slip in (0.0, 1e-12, 1e-9, 0.99e-6, 1.01e-6):
        state = np.array([0.0, 0.0, 0.3, 0.5, 0.4 * slip, 0.0, *np.full(4, 0.5 + slip)])
        state[6:] /= vehicle.wheel_radius
        engine.rate(state, np.zeros(4), fleet, 0, found)
        expected = skid_steer.state_rate(state, np.zeros(4), vehicle)
        assert found[3:] == pytest.approx(expected[3:], rel=1e-5, abs=1e-12)


def test_friction_never_adds_energy_and_torque_adds_torque_times_speed(rng):
    for vehicle in (HUSKY, UNEVEN):
        state, torque = moving(rng, 500), rng.normal(size=(500, 4))
        rate = skid_steer.state_rate(state, torque, vehicle)
        spin = [vehicle.wheel_inertia] * 4
        weights = np.r_[vehicle.mass, vehicle.mass, vehicle.inertia, spin]
        change = (weights * state[:, 3:] * rate[:, 3:]).sum(-1)
        lost = skid_steer.friction_power(state, vehicle)
        assert (lost < 0).all()
        assert change == pytest.approx((torque * state[:, 6:]).sum(-1) + lost)


def advanced(state, drive, dt, vehicle=HUSKY, damping=0.0, rotor_inertia=0.0, tolerance=1e-5):
    """One state brought forward by the engine."""
    states, fleet = state[None].copy(), engine.fleet([vehicle], damping, rotor_inertia)
    engine.advance(states, drive[None], fleet, dt, np.full(1, dt), tolerance)
    return states[0]


def test_a_vehicle_let_go_only_loses_energy_and_comes_to_rest(rng):
    spin = [UNEVEN.wheel_inertia] * 4
    weights = np.r_[UNEVEN.mass, UNEVEN.mass, UNEVEN.inertia, spin] / 2
    for state in moving(rng, 10):
        energies = [weights @ state[3:] ** 2]
        for _ in range(150):
            state = advanced(state, np.zeros(4), 0.05, UNEVEN)
            energies.append(weights @ state[3:] ** 2)
        assert (np.diff(energies) < 1e-9).all()
        assert energies[-1] < 1e-2 * energies[0]


def test_a_turned_picture_moves_the_same(rng):
    state = moving(rng)
    turned = state + np.r_[0, 0, 1.1, np.zeros(7)]
    drive = rng.normal(size=4)
    one, two = (advanced(s, drive, 0.3, tolerance=1e-9) for s in (state, turned))
    assert two[3:] == pytest.approx(one[3:], abs=1e-7)
    moved = [complex(*(end - begin)[:2]) for end, begin in ((one, state), (two, turned))]
    assert moved[1] == pytest.approx(moved[0] * np.exp(1.1j), abs=1e-7)


def test_left_and_right_are_mirror_images(rng):
    state, drive = moving(rng), rng.normal(size=4)
    flip = np.array([1, -1, -1, 1, -1, -1, 1, 1, 1, 1])
    swap = [0, 1, 2, 3, 4, 5, 7, 6, 9, 8]
    one = advanced(state, drive, 0.2)
    two = advanced((flip * state)[swap], drive[[1, 0, 3, 2]], 0.2)
    assert two == pytest.approx((flip * one)[swap], abs=1e-9)


# The integrator


def reference(state, drive, dt, vehicle=HUSKY, damping=0.0, rotor_inertia=0.0):
    def f(_, y):
        torque = drive - damping * y[6:]
        return skid_steer.state_rate(y, torque, vehicle, rotor_inertia=rotor_inertia)

    return solve_ivp(f, (0, dt), state, method="LSODA", rtol=1e-12, atol=1e-13).y[:, -1]


def test_the_linear_equations_of_a_step_are_solved_with_the_true_jacobian(rng):
    fleet, room = engine.fleet([UNEVEN], 2.0, 0.1), np.empty(engine.ROOM)
    state, drive, right = moving(rng), rng.normal(size=4), rng.normal(size=10)
    jacobian = np.empty((10, 10))
    for j, e in enumerate(1e-6 * np.eye(10)):
        ends = np.empty((2, 10))
        engine.rate(state + e, drive, fleet, 0, ends[0])
        engine.rate(state - e, drive, fleet, 0, ends[1])
        jacobian[:, j] = (ends[0] - ends[1]) / 2e-6
    engine._factorise(state, 40.0, fleet, 0, room)
    heading = np.cos(state[2]), np.sin(state[2])
    engine._solve(state, *heading, 40.0, right, room, found := np.empty(10))
    assert found == pytest.approx(np.linalg.solve(40 * np.eye(10) - jacobian, right), rel=1e-6)


def test_the_rule_is_of_third_order(rng):
    fleet, room = engine.fleet([HUSKY], 8.0), np.empty(engine.ROOM)
    start, drive = moving(rng), rng.normal(size=4)
    exact, errors = reference(start, drive, 0.01, damping=8.0), []
    for steps in (16, 32, 64):
        state = start.copy()
        for _ in range(steps):
            engine.step(state, drive, fleet, 0, 0.01 / steps, 1.0, room)
            state = room[engine.NEW :][:10].copy()
        errors.append(np.abs(state - exact).max())
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([3.0, 3.0], abs=0.15)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_the_error_follows_the_tolerance(tolerance, rng):
    """RODAS3 is written once, compiled: LSODA on the plain equations judges it."""
    start, drive = moving(rng), 5 * rng.normal(size=4)
    exact = reference(start, drive, 0.5, UNEVEN, damping=8.0, rotor_inertia=0.2)
    found = advanced(start, drive, 0.5, UNEVEN, damping=8.0, rotor_inertia=0.2, tolerance=tolerance)
    assert np.abs(found - exact).max() < 10 * tolerance


def test_a_stiff_contact_costs_no_more_steps():
    """From k_s = 100 to 1e5 s/m the fastest rate grows a thousandfold; the work hardly does."""
    counts = []
    for k_s in (1e2, 1e5):
        fleet = engine.fleet([replace(HUSKY, smoothing=k_s)], 8.0)
        room = np.empty(engine.ROOM)
        y = np.zeros(10)
        drive = np.full(4, 8.0 / HUSKY.wheel_radius)
        left, length, count = 3.0, 0.02, 0
        while left > 1e-9:
            h = min(length, left)
            error = engine.step(y, drive, fleet, 0, h, 1e-5, room)
            count += 1
            if error <= 1:
                y, left = room[engine.NEW :][:10].copy(), left - h
            length = h * min(max(0.9 * error ** (-1 / 3), 0.2), 5.0)
        counts.append(count)
    assert counts[1] < 5 * counts[0]


# Against closed forms


@pytest.mark.parametrize("mu", [0.2, 0.6])
@pytest.mark.parametrize("k_s", [20.0, 100.0, 1000.0])
def test_turning_in_place_has_the_half_track_of_the_closed_form(mu, k_s):
    vehicle = replace(FREE, friction_longitudinal=mu, friction_lateral=mu, smoothing=k_s)
    run = driven(0.0, 1.0, 10.0, vehicle=vehicle)
    left, right, *_ = run.wheels[-1]
    found = vehicle.wheel_radius * (right - left) / (2 * run.velocity[-1, 2])
    assert found == pytest.approx(skid_steer.turning_half_track(vehicle), rel=1e-6)
    assert found == pytest.approx(vehicle.half_track + vehicle.front**2 / vehicle.half_track)


def test_friction_that_holds_better_along_turns_with_less_slip():
    vehicle = replace(FREE, friction_longitudinal=0.8, friction_lateral=0.6)
    run = driven(0.0, 1.0, 10.0, vehicle=vehicle)
    left, right, *_ = run.wheels[-1]
    found = vehicle.wheel_radius * (right - left) / (2 * run.velocity[-1, 2])
    assert found == pytest.approx(skid_steer.turning_half_track(vehicle), rel=1e-6)
    assert found < skid_steer.turning_half_track(FREE)


def test_the_closed_form_is_near_what_the_real_robot_s_controller_is_told():
    from backhoe.lessons import published

    told = published.load("husky_description")["wheel_separation_multiplier"]
    assert skid_steer.turning_half_track(HUSKY) / HUSKY.half_track == pytest.approx(told, rel=0.05)


def test_straight_on_it_is_the_linear_model_with_the_wheels_inertia():
    """Without slip, wheels add J/r^2 each; k_s large makes slip small."""
    vehicle = replace(HUSKY, friction_longitudinal=5.0, smoothing=1e5)
    r = vehicle.wheel_radius
    rolling_mass = vehicle.mass + 4 * vehicle.wheel_inertia / r**2
    drive = 4 * vehicle.speed_gain / r**2 / rolling_mass
    drag = vehicle.mass * vehicle.gravity * vehicle.rolling / rolling_mass
    run = driven(1.0, 0.0, 0.4, 0.01, vehicle, tolerance=1e-8)
    expected = drive / (drive + drag) * -np.expm1(-(drive + drag) * run.time)
    assert run.velocity[:, 0] == pytest.approx(expected, abs=2e-4)
    steady = driven(1.0, 0.0, 20.0)
    assert steady.velocity[-1, 0] == pytest.approx(skid_steer.steady_state(1.0, 0.0)[0], rel=1e-6)


def test_wheels_cannot_pull_harder_than_friction():
    run = driven(3.0, 0.0, 1.0, 0.01)
    limit = HUSKY.friction_longitudinal * HUSKY.gravity
    gained = np.diff(run.velocity[:, 0]) / 0.01
    assert 0.95 * limit < gained.max() < limit


def test_gentle_turning_puts_the_centre_of_rotation_where_the_linear_law_says():
    """m v omega = m g K |v_y| for slip far below 1/k_s, so x_ICR = -v_y/omega = v/(g K)."""
    vehicle = replace(FREE, smoothing=1.0)
    run = driven(0.1, 0.02, 60.0, vehicle=vehicle)
    v, v_y, omega = run.velocity[-1]
    expected = v / (vehicle.gravity * skid_steer.slope(vehicle.friction_lateral, 1.0))
    assert -v_y / omega == pytest.approx(expected, rel=1e-3)


def test_slip_widens_the_circle_and_the_effective_half_track_brings_it_back():
    def circle(**options):
        v_x, v_y, omega = driven(1.0, 0.5, 20.0, **options).velocity[-1]
        return np.hypot(v_x, v_y) / omega

    kinematic = 1.0 / 0.5
    assert circle() > 2 * kinematic
    corrected = circle(half_track=skid_steer.turning_half_track(HUSKY))
    assert kinematic < corrected < 1.2 * kinematic


def test_harder_rubber_turns_more_slowly_and_with_the_same_half_track():
    soft, hard = (replace(FREE, friction_longitudinal=mu, friction_lateral=mu) for mu in (0.2, 0.6))
    assert skid_steer.turning_half_track(soft) == skid_steer.turning_half_track(hard)
    turned = [driven(0.0, 1.0, 5.0, vehicle=vehicle).velocity[-1, 2] for vehicle in (soft, hard)]
    assert turned[1] < turned[0]


# Batches


@pytest.fixture
def commands(rng):
    v, omega = rng.uniform(-1, 1, (2, 40, 4))
    return np.repeat(v, 25, axis=1), np.repeat(omega, 25, axis=1)


@pytest.mark.parametrize("model", ["kinematic", "linear", "slipping"])
def test_a_batch_gives_each_run_what_it_gets_alone(model, commands, rng):
    v, omega = commands
    vehicles = [replace(HUSKY, x_icr=x) for x in rng.uniform(-0.1, 0.1, len(v))]
    starts = rng.normal(size=(len(v), 3))
    batch = simulate(v, omega, 0.02, vehicles, model=model, start=starts)
    for k in (0, 31, 32, 39):  # both sides of a block's end
        alone = simulate(v[k], omega[k], 0.02, vehicles[k], model=model, start=starts[k])
        assert np.array_equal(batch.pose[k], alone.pose)
        assert np.array_equal(batch.wheels[k], alone.wheels)
        assert np.array_equal(batch.twist[k], alone.velocity[:, [0, 2]])


@pytest.mark.parametrize("model", ["kinematic", "linear", "slipping"])
def test_the_plant_drives_as_the_batch(model, commands):
    v, omega = (x[0] for x in commands)
    vehicle = replace(HUSKY, x_icr=0.05)
    plant = SkidSteerPlant(vehicle, 0.02, model, pose=(1.0, 2.0, 3.0))
    run = simulate(v, omega, 0.02, vehicle, model=model, start=(1.0, 2.0, 3.0))
    for _ in range(2):
        for k in range(len(v)):
            assert plant.pose == pytest.approx(run.pose[k], abs=1e-12)
            assert plant.velocity == pytest.approx(run.velocity[k], abs=1e-12)
            plant.step(v[k], omega[k])
        assert plant.twist == pytest.approx(run.twist[-1], abs=1e-12)
        assert plant.time == pytest.approx(run.time[-1])
        plant.reset()


def test_a_plant_can_be_put_somewhere_else():
    plant = SkidSteerPlant(model="slipping")
    plant.step(1.0, 0.0)
    plant.reset((4.0, 5.0, 1.0))
    assert plant.pose.tolist() == [4.0, 5.0, 1.0]
    assert not plant.velocity.any()
    assert plant.time == 0.0


def test_the_kinematic_model_drives_the_arcs_of_26(commands):
    v, omega = (x[0] for x in commands)
    vehicle = replace(HUSKY, x_icr=0.1)
    run = simulate(v, omega, 0.02, vehicle, model="kinematic")
    pose = np.zeros(3)
    for k in range(0, 100, 25):
        pose = solve_ivp(
            lambda _, q, k=k: skid_steer.pose_rate(q[2], [v[k], omega[k]], 0.1),
            (0, 0.5),
            pose,
            rtol=1e-10,
            atol=1e-12,
        ).y[:, -1]
        assert run.pose[k + 25] == pytest.approx(pose, abs=1e-8)


def test_the_linear_model_drives_the_step_response_and_the_path_of_26(commands):
    run = driven(1.0, 0.5, 12.5, model="linear")
    closed = skid_steer.step_response(run.time, 1.0, 0.5)
    assert run.velocity[:, 0] == pytest.approx(closed[:, 1], abs=1e-12)
    assert run.pose[:, 2] == pytest.approx(closed[:, 2], abs=1e-12)

    def rate(t, q):
        return skid_steer.pose_rate(q[2], skid_steer.step_response(t, 1.0, 0.5)[[1, 3]])

    path = solve_ivp(rate, (0, 12.5), np.zeros(3), rtol=1e-11, atol=1e-12).y[:, -1]
    assert run.pose[-1] == pytest.approx(path, abs=1e-8)


def test_the_slipping_batch_is_what_scipy_integrates():
    v, omega, c, r = 0.8, -0.6, HUSKY.half_track, HUSKY.wheel_radius
    run = driven(v, omega, 0.6, 0.02, UNEVEN, tolerance=1e-8)
    rim = np.array([v - c * omega, v + c * omega] * 2) / r
    exact = reference(np.zeros(10), HUSKY.speed_gain * rim, 0.6, UNEVEN, damping=HUSKY.speed_gain)
    assert np.r_[run.pose[-1], run.velocity[-1], run.wheels[-1]] == pytest.approx(exact, abs=1e-6)


def test_fewer_entries_are_a_choice_of_the_same():
    full, thin = (driven(1.0, 0.5, 2.0, every=k) for k in (1, 10))
    assert np.array_equal(thin.time, full.time[::10])
    assert np.array_equal(thin.pose, full.pose[::10])


# Motors


def test_motors_hold_the_wheels_speed_where_the_proportional_law_does_not():
    run = driven(0.5, 0.3, 4.0, motor=motor.ROVER)
    left, right = skid_steer.wheel_speeds([0.5, 0.3])
    assert run.wheels[-1] == pytest.approx([left, right, left, right], rel=1e-4)
    plain = driven(0.5, 0.3, 4.0)
    assert np.abs(plain.wheels[-1] - run.wheels[-1]).max() > 0.1
    assert np.abs(run.voltage).max() <= motor.ROVER.voltage
    assert plain.voltage is None


def test_wheels_without_a_motor_roll_along():
    run = driven(0.3, 0.0, 3.0, motor=motor.ROVER, driven="front")
    assert not run.voltage[:, 2:].any()
    assert run.wheels[-1, 2:] == pytest.approx(run.wheels[-1, :2], rel=0.01)
    pushed = driven(0.3, 0.0, 3.0, driven="front")
    assert pushed.velocity[-1, 0] == pytest.approx(0.3, rel=0.05)


def test_the_plant_with_motors_drives_as_the_batch():
    plant = SkidSteerPlant(model="slipping", motor=motor.ROVER, driven="front")
    run = driven(0.4, 0.4, 0.5, motor=motor.ROVER, driven="front")
    for _ in range(25):
        plant.step(0.4, 0.4)
    assert plant.pose == pytest.approx(run.pose[-1], abs=1e-12)
    plant.reset()
    for _ in range(25):
        plant.step(0.4, 0.4)
    assert plant.pose == pytest.approx(run.pose[-1], abs=1e-12)


# Bad input


GAINS = motor.WheelGains(1.0, 1.0)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: simulate([1.0], [1.0, 2.0], 0.02), r"alike, got shapes \(1,\), \(2,\)"),
        (lambda: simulate(1.0, 0.0, 0.02), r"v_ref must have the shape \(n,\) or \(runs, n\)"),
        (lambda: simulate([], [], 0.02), "v_ref must have the shape"),
        (lambda: simulate([1.0], [np.nan], 0.02), "omega_ref must be finite"),
        (lambda: simulate(["a"], [0.0], 0.02), "v_ref must be numbers"),
        (lambda: simulate([1.0], [0.0], 0.0), "dt must be one number above 0"),
        (lambda: simulate([1.0], [0.0], 0.02, model="magic"), "one of kinematic, linear, slipping"),
        (lambda: simulate([1.0], [0.0], 0.02, every=2), "every must divide the 1 samples, got 2"),
        (lambda: simulate([1.0], [0.0], 0.02, every=0.5), "every must be one whole number"),
        (lambda: simulate([1.0], [0.0], 0.02, [HUSKY, HUSKY]), "each of the 1 runs, got 2"),
        (lambda: simulate([1.0], [0.0], 0.02, start=(0, 0)), "start must end in 3 values"),
        (lambda: simulate([1.0], [0.0], 0.02, start=np.zeros((2, 3))), r"one pose \(3,\) or"),
        (lambda: simulate([1.0], [0.0], 0.02, tolerance=-1.0), "tolerance must be one number"),
        (lambda: simulate([1.0], [0.0], 0.02, driven="rear"), "driven must be one of all, front"),
        (lambda: simulate([1.0], [0.0], 0.02, gains=GAINS), "give a motor as well"),
        (lambda: simulate([1.0], [0.0], 0.02, half_track=-1.0), "half_track must be one number"),
        (
            lambda: simulate([1.0], [0.0], 0.02, model="linear", motor=motor.ROVER),
            "the linear model has no wheels that slip",
        ),
        (
            lambda: simulate([1.0], [0.0], 0.0125, motor=motor.ROVER),
            "whole multiple of 0.001 s",
        ),
        (lambda: SkidSteerPlant(model="magic"), "model must be one of"),
        (lambda: SkidSteerPlant(dt=-1), "dt must be one number above 0"),
        (lambda: SkidSteerPlant(pose=(0, 0)), r"pose must be X, Y, theta, shape \(3,\)"),
        (lambda: SkidSteerPlant(half_track=0.5), "the kinematic model has no wheels"),
        (lambda: SkidSteerPlant(model="slipping", gains=GAINS), "give a motor as well"),
        (lambda: SkidSteerPlant(model="slipping", driven="rear"), "driven must be one of"),
        (lambda: SkidSteerPlant().step(np.nan, 0.0), "v must be one finite number"),
        (lambda: SkidSteerPlant().step(0.0, "left"), "omega must be one finite number"),
        (lambda: SkidSteerPlant().reset((np.inf, 0, 0)), "pose must be finite"),
        (lambda: skid_steer.contact_forces(np.zeros((3, 2))), r"slip must .* got shape \(3, 2\)"),
        (lambda: skid_steer.state_rate(np.zeros(9), np.zeros(4)), "state must end in 10"),
        (lambda: skid_steer.state_rate(np.zeros(10), np.zeros(3)), "torque must end in 4"),
        (lambda: skid_steer.friction_power(np.full(10, np.nan)), "state must be finite"),
        (lambda: skid_steer.turning_half_track(UNEVEN), "needs front = rear"),
        (
            lambda: skid_steer.turning_half_track(replace(HUSKY, friction_longitudinal=0.0)),
            "needs friction along the wheels",
        ),
        (
            lambda: skid_steer.simulate(np.ones(3), np.ones(3), 0.02, 3),
            r"vehicle must be one Vehicle, or one for each of the 1 runs, got 1 \(int\)",
        ),
    ],
)
def test_wrong_arguments_are_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()


def test_a_plant_wants_a_vehicle():
    with pytest.raises(TypeError, match=r"must be a Vehicle, got str: such as skid_steer\.HUSKY"):
        SkidSteerPlant("husky")
    with pytest.raises(TypeError, match="motor must be a Motor, got int"):
        SkidSteerPlant(model="slipping", motor=3)
