"""The rover: its description, its loads, how it turns, its motors; PyBullet against the model."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.simulation import bullet
from backhoe.simulation.rover_urdf import rover_urdf
from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, replace
from backhoe.view import appearance, replay

NOSE_HEAVY = replace(HUSKY, front=0.2, rear=0.31)
WEIGHT = HUSKY.mass * HUSKY.gravity


@pytest.fixture(params=["pybullet", "analytic"])
def backend(request):
    if request.param == "pybullet":
        pytest.importorskip("pybullet")
    return request.param


@pytest.fixture
def rover(backend):
    with simulation.open_rover(backend=backend) as opened:
        yield opened


def drive(rover, seconds, v, omega):
    log = []
    for _ in range(round(seconds / rover.dt)):
        rover.step(v, omega)
        log.append([*rover.pose, *rover.velocity, *rover.wheel_speeds])
    return np.array(log)


def effective_half_track(rover):
    left, right = rover.wheel_speeds[:2]
    return rover.vehicle.wheel_radius * (right - left) / 2 / rover.twist[1]


# The description


@pytest.mark.parametrize("vehicle", [HUSKY, NOSE_HEAVY], ids=["husky", "nose heavy"])
def test_the_urdf_has_the_vehicles_mass_inertia_and_centre_of_mass(vehicle, tmp_path):
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    path = tmp_path / "rover.urdf"
    path.write_text(rover_urdf(vehicle))
    body = pybullet.loadURDF(str(path), flags=2, physicsClientId=client)
    mass, moment, inertia = 0.0, np.zeros(2), 0.0
    for link in range(-1, 4):
        info = pybullet.getDynamicsInfo(body, link, physicsClientId=client)
        if link < 0:
            at, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
        else:
            at = pybullet.getLinkState(body, link, physicsClientId=client)[0]
        mass += info[0]
        moment += info[0] * np.array(at[:2])
        inertia += info[2][2] + info[0] * (at[0] ** 2 + at[1] ** 2)
        principal = np.sort(info[2])
        assert 0 < principal[2] < principal[0] + principal[1]
    pybullet.disconnect(client)
    assert mass == pytest.approx(vehicle.mass)
    np.testing.assert_allclose(moment, 0.0, atol=1e-9)
    assert inertia == pytest.approx(vehicle.inertia)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"wheels": "square"}, "wheels must be one of continuous, fixed, got 'square'"),
        ({"vehicle": replace(HUSKY, inertia=0.5)}, "less than that of its wheels"),
    ],
)
def test_a_description_that_makes_no_robot_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        rover_urdf(**{"vehicle": HUSKY, **arguments})


# Loads


@pytest.mark.parametrize("vehicle", [HUSKY, NOSE_HEAVY], ids=["husky", "nose heavy"])
def test_the_wheels_stand_on_the_loads_of_statics(backend, vehicle):
    with simulation.open_rover(vehicle, backend=backend) as rover:
        np.testing.assert_allclose(rover.loads, vehicle.loads, rtol=1e-3)


def test_hard_braking_shifts_weight_to_the_front_as_statics_says():
    pytest.importorskip("pybullet")
    with simulation.open_rover(backend="pybullet") as rover:
        drive(rover, 2.0, 1.0, 0.0)
        log = []
        for _ in range(300):
            rover.push(np.full(4, -5.0))
            log.append([rover.twist[0], *rover.loads])
        log = np.array(log)[100:]
    slowing = (log[0, 0] - log[-1, 0]) / (0.001 * (len(log) - 1))
    wheels, body = 4 * HUSKY.wheel_mass, HUSKY.body_mass
    middle = HUSKY.clearance + HUSKY.body_height / 2
    height = (wheels * HUSKY.wheel_radius + body * middle) / HUSKY.mass
    shifted = HUSKY.mass * slowing * height / (HUSKY.front + HUSKY.rear)
    front, rear = log[:, 1:3].sum(1).mean(), log[:, 3:].sum(1).mean()
    assert (front - rear) / 2 == pytest.approx(shifted, rel=0.05)
    assert front + rear == pytest.approx(WEIGHT, rel=0.01)


# Motion


def test_pushed_wheels_obey_newtons_law(rover):
    torque, r = 1.5, HUSKY.wheel_radius
    speeds = []
    for _ in range(400):
        rover.push(np.full(4, torque))
        speeds.append(rover.twist[0])
    moved = HUSKY.mass + 4 * HUSKY.wheel_inertia / r**2
    held = WEIGHT * HUSKY.rolling
    t = 0.001 * np.arange(1, 401)
    expected = 4 * torque / r / held * (1 - np.exp(-held / moved * t))
    np.testing.assert_allclose(speeds[100:], expected[100:], rtol=0.02)


def test_no_torque_brings_more_than_the_friction_of_the_ground(rover):
    for _ in range(300):
        rover.push(np.full(4, 60.0))
    limit = HUSKY.friction_longitudinal * HUSKY.gravity * rover.time
    assert rover.twist[0] == pytest.approx(limit, rel=0.03)
    assert (rover.wheel_speeds * HUSKY.wheel_radius > 5 * rover.twist[0]).all()


def test_it_drives_straight_at_the_wanted_speed(rover):
    log = drive(rover, 3.0, 0.8, 0.0)
    assert log[-1, 3] == pytest.approx(0.8, rel=2e-3)
    assert np.abs(log[:, 1:3]).max() < 1e-3


@pytest.mark.parametrize("heading", [0.0, 0.4, np.pi / 4])
def test_it_turns_on_the_half_track_of_the_closed_form_at_every_heading(backend, heading):
    with simulation.open_rover(backend=backend, pose=(1.0, 2.0, heading)) as rover:
        drive(rover, 1.0, 0.0, 0.8)
        half_track = effective_half_track(rover)
        assert half_track == pytest.approx(skid_steer.turning_half_track(HUSKY), rel=5e-3)
        assert np.hypot(*(rover.pose[:2] - [1.0, 2.0])) < 5e-3


def test_pybullets_own_friction_turns_it_by_its_heading():
    pytest.importorskip("pybullet")
    half_tracks = []
    with simulation.open_rover(backend="pybullet", contacts="bullet") as rover:
        for _ in range(300):
            rover.step(0.0, 0.8)
            half_tracks.append(effective_half_track(rover))
    settled = np.array(half_tracks[60:])
    assert (settled.min(), settled.max()) == pytest.approx((0.50, 0.60), abs=0.005)


def test_pybullets_own_friction_turns_too_much_or_too_little_in_a_curve():
    pytest.importorskip("pybullet")
    half_tracks = {}
    for contacts in ("library", "bullet"):
        with simulation.open_rover(backend="pybullet", contacts=contacts) as rover:
            drive(rover, 2.0, 1.0, 0.5)
            log = []
            for _ in range(300):
                rover.step(1.0, 0.5)
                log.append(effective_half_track(rover))
        half_tracks[contacts] = min(log), max(log)
    assert half_tracks["library"] == pytest.approx((0.493, 0.493), abs=0.001)
    assert half_tracks["bullet"] == pytest.approx((0.44, 0.58), abs=0.005)


@pytest.mark.parametrize("cone", [None, 1, 0])
def test_pybullet_holds_a_box_with_mu_n_at_every_heading_unless_its_cone_is_off(cone):
    held = [drag_of_a_box(heading, cone) for heading in (0, 30, 45, 60, 90)]
    square = [1.0, 2**0.5, 2**0.5, 2**0.5, 1.0]
    assert held == pytest.approx(
        square if cone == 0 else np.ones(5), rel=0.04 if cone == 0 else 0.01
    )


def drag_of_a_box(heading_deg, cone, mu=0.3, speed=3.0, seconds=0.3):
    """Mean friction of a flat box that slides on PyBullet's plane, over mu N."""
    pytest.importorskip("pybullet")
    server = bullet.Server()
    server.setTimeStep(1e-3)
    server.setGravity(0, 0, -9.81)
    if cone is not None:
        server.setPhysicsEngineParameter(enableConeFriction=cone)
    plane = server.createMultiBody(0, server.createCollisionShape(server.GEOM_PLANE))
    shape = server.createCollisionShape(server.GEOM_BOX, halfExtents=[0.2, 0.2, 0.05])
    box = server.createMultiBody(1.0, shape, basePosition=[0, 0, 0.05])
    server.changeDynamics(plane, -1, lateralFriction=1.0)
    server.changeDynamics(box, -1, lateralFriction=mu, linearDamping=0, angularDamping=0)
    ahead = np.exp(1j * np.radians(heading_deg))
    speeds = [speed]
    server.resetBaseVelocity(box, [speed * ahead.real, speed * ahead.imag, 0], [0, 0, 0])
    for _ in range(round(seconds / 1e-3)):
        server.stepSimulation()
        (x, y, _), _ = server.getBaseVelocity(box)
        speeds.append((complex(x, y) / ahead).real)
    server.disconnect()
    return (speeds[20] - speeds[-1]) / (1e-3 * (len(speeds) - 21)) / (mu * 9.81)


def felt_masses(rover):
    """What each contact point resists with along the world's x and y, shape (4, 2) [kg].

    Found by pushing it for one step, the robot lifted and all its wheels free.
    """
    server, body, masses = rover._server, rover._body, np.empty((4, 2))
    (x, y, z), turned = server.getBasePositionAndOrientation(body)
    server.setGravity(0, 0, 0)
    for wheel, axis in np.ndindex(4, 2):
        server.resetBasePositionAndOrientation(body, (x, y, z + 1), turned)
        server.resetBaseVelocity(body, (0, 0, 0), (0, 0, 0))
        for joint in range(4):
            server.resetJointState(body, joint, 0.0, 0.0)
        at = np.subtract(server.getLinkState(body, wheel)[0], (0, 0, rover.vehicle.wheel_radius))
        impulse = 1e-3
        force = (impulse / 1e-3 * np.eye(3)[axis]).tolist()
        server.applyExternalForce(body, wheel, force, at.tolist(), server.WORLD_FRAME)
        server.stepSimulation()
        state = server.getLinkState(body, wheel, computeLinkVelocity=1)
        moved = np.add(state[6], np.cross(state[7], np.subtract(at, state[0])))
        masses[wheel, axis] = impulse / moved[axis]
    return masses


@pytest.mark.parametrize("heading", [0.0, 0.4, 0.8])
def test_pybullets_friction_on_a_wheel_is_mu_n_along_slip_times_the_mass_that_it_feels(heading):
    pytest.importorskip("pybullet")
    with simulation.open_rover(
        backend="pybullet", contacts="bullet", pose=(0.0, 0.0, heading)
    ) as rover:
        drive(rover, 2.0, 0.0, 0.1)
        force, loads = np.zeros((4, 2)), np.zeros(4)
        for contact in rover._server.getContactPoints(rover._body, rover._ground):
            along, one, across, other = contact[10:14]
            force[contact[3]] += along * np.array(one[:2]) + across * np.array(other[:2])
            loads[contact[3]] += contact[9]
        c, s = np.cos(rover.pose[2]), np.sin(rover.pose[2])
        slip = skid_steer.contact_velocity(rover.velocity, rover.wheel_speeds)
        slip = slip @ np.array([[c, -s], [s, c]]).T
        masses = felt_masses(rover)
    size = np.linalg.norm(force, axis=1)
    assert size == pytest.approx(HUSKY.friction_longitudinal * loads, rel=1e-3)

    def off(direction):
        return np.degrees(np.angle(-(force @ [1, 1j]) / (direction @ [1, 1j])))

    assert np.abs(off(slip * masses)).max() < 0.2
    if heading == 0.0:
        assert np.abs(off(slip)).min() > 6


def test_a_heavier_rotor_turns_the_heading_s_effect_round():
    """At n = 10 a wheel is lighter along its rim than across, at n = 100 it is heavier."""
    pytest.importorskip("pybullet")
    half_tracks = []
    for gear in (10.0, 100.0):
        geared = motor.replace(motor.ROVER, gear=gear)
        with simulation.open_rover(backend="pybullet", contacts="bullet", motor=geared) as rover:
            drive(rover, 1.5, 0.0, 0.1)
            half_tracks.append(effective_half_track(rover))
    assert half_tracks[0] > 2 * skid_steer.turning_half_track(HUSKY)
    assert half_tracks[1] < 0.9 * skid_steer.turning_half_track(HUSKY)


def test_pybullets_body_and_the_plane_model_drive_alike():
    pytest.importorskip("pybullet")
    logs = []
    for name in ("pybullet", "analytic"):
        with simulation.open_rover(backend=name) as rover:
            logs.append(np.vstack([drive(rover, 2.0, 1.0, 0.4), drive(rover, 1.0, 0.3, -0.8)]))
    bullet, plane = logs
    assert np.hypot(*(bullet[-1, :2] - plane[-1, :2])) < 0.02
    np.testing.assert_allclose(bullet[:, 3:6], plane[:, 3:6], atol=0.05)


def test_the_analytic_rover_is_the_slipping_model_with_motors():
    v = np.r_[np.full(50, 0.8), np.full(50, 0.2)]
    omega = np.r_[np.full(50, 0.3), np.full(50, -0.5)]
    run = skid_steer.simulate(v, omega, 0.02, HUSKY, motor=motor.ROVER)
    with simulation.open_rover(backend="analytic") as rover:
        log = []
        for command in zip(v, omega, strict=True):
            rover.step(*command)
            log.append([*rover.pose, *rover.velocity])
    np.testing.assert_allclose(np.array(log)[:, :3], run.pose[1:], atol=1e-3)
    np.testing.assert_allclose(np.array(log)[:, 3:], run.velocity[1:], atol=1e-3)


def test_a_half_track_that_counts_the_slip_turns_as_wanted(backend):
    half_track = skid_steer.turning_half_track(HUSKY)
    with simulation.open_rover(backend=backend, half_track=half_track) as rover:
        drive(rover, 1.5, 0.0, 0.5)
        assert rover.twist[1] == pytest.approx(0.5, rel=0.01)


def test_two_driven_wheels_turn_it_less_and_leave_the_others_to_roll(backend):
    rates = {}
    for driven in ("all", "front"):
        with simulation.open_rover(backend=backend, driven=driven) as rover:
            drive(rover, 1.5, 0.6, 0.8)
            rates[driven] = rover.twist[1]
            voltage, torque = rover.voltage, rover.wheel_torque
    assert 0 < rates["front"] < 0.8 * rates["all"]
    np.testing.assert_array_equal(voltage[2:], [0.0, 0.0])
    np.testing.assert_array_equal(torque[2:], [0.0, 0.0])
    assert np.abs(torque[:2]).min() > 0.1


def test_voltages_stay_within_the_motors(rover):
    most = 0.0
    for _ in range(20):
        rover.step(5.0, 0.0)
        most = max(most, np.abs(rover.voltage).max())
    assert most == pytest.approx(motor.ROVER.voltage)


def test_your_own_wheel_controller_drives_it_and_may_write_into_its_arguments(backend):
    gains = motor.tune_wheel(motor.ROVER, motor.vehicle_load(HUSKY, 4))
    loops = [motor.wheel_pid(motor.ROVER, gains) for _ in range(4)]

    def mine(reference, measured):
        pairs = zip(loops, reference.tolist(), measured.tolist(), strict=True)
        voltage = [loop(*pair) for loop, *pair in pairs]
        reference[:], measured[:] = np.nan, np.nan
        return voltage

    with (
        simulation.open_rover(backend=backend, wheel_controller=mine) as rover,
        simulation.open_rover(backend=backend) as plain,
    ):
        np.testing.assert_array_equal(drive(rover, 0.3, 0.5, 0.2), drive(plain, 0.3, 0.5, 0.2))


def test_the_wheels_have_turned_as_far_as_their_speeds_say(rover):
    log = drive(rover, 1.0, 0.6, 0.3)
    turned = np.trapezoid(np.vstack([np.zeros(4), log[:, 6:]]), dx=rover.dt, axis=0)
    np.testing.assert_allclose(rover.wheel_angles, turned, rtol=0.02)


def test_the_same_drive_repeats_bit_for_bit(backend):
    logs = []
    for _ in range(2):
        with simulation.open_rover(backend=backend) as rover:
            logs.append(drive(rover, 0.4, 0.8, 0.4))
            for _ in range(5):
                rover.push([40.0, -40.0, 40.0, -40.0])
            rover.reset()
            assert rover.time == 0.0
            logs.append(drive(rover, 0.4, 0.8, 0.4))
    for log in logs[1:]:
        np.testing.assert_array_equal(log, logs[0])


def test_a_drive_from_another_pose_is_the_same_drive_turned(backend):
    pose = np.array([3.0, -2.0, 2.0])
    with (
        simulation.open_rover(backend=backend, pose=pose) as turned,
        simulation.open_rover(backend=backend) as plain,
    ):
        drive(turned, 1.0, 0.6, 0.5)
        drive(plain, 1.0, 0.6, 0.5)
        np.testing.assert_allclose(turned.velocity, plain.velocity, atol=2e-4)
        c, s = np.cos(pose[2]), np.sin(pose[2])
        there = pose[:2] + np.array([[c, -s], [s, c]]) @ plain.pose[:2]
        np.testing.assert_allclose(turned.pose, [*there, pose[2] + plain.pose[2]], atol=2e-4)


def test_the_heading_counts_on_through_full_turns(backend):
    with simulation.open_rover(backend=backend) as rover:
        drive(rover, 5.0, 0.0, 3.0)
        assert rover.pose[2] > 2 * np.pi


# The replay


def test_a_recorded_rover_shows_its_way_and_its_wheels_turning():
    with simulation.open_rover(backend="analytic") as rover:
        recorder = replay.Recorder(rover)
        for _ in range(60):
            recorder.capture()
            rover.step(0.5, 0.4)
        shown = recorder.replay(title="rover", alt="the rover drives a curve").recording
    nodes = {node.name: node for node in shown.nodes}
    assert set(nodes) == {"rover", *skid_steer.WHEELS}
    np.testing.assert_allclose(nodes["rover"].values[-1], rover.pose)
    for name, angle in zip(skid_steer.WHEELS, rover.wheel_angles, strict=True):
        assert nodes[name].values[-1] == pytest.approx(angle)
        axle = nodes[name].before[:3, 2]
        np.testing.assert_allclose(axle, [0.0, 1.0, 0.0], atol=1e-12)
    assert "iframe" in recorder.replay(title="rover", alt="a curve")._repr_html_()


def test_the_rovers_meshes_fit_its_description():
    body = np.vstack([part.vertices for part in appearance.rover_body(HUSKY)])
    wheel = np.vstack([part.vertices for part in appearance.rover_wheel(HUSKY)])
    assert body[:, 2].min() == pytest.approx(HUSKY.clearance)
    assert np.ptp(body[:, 0]) == pytest.approx(HUSKY.body_length, abs=0.1)
    assert np.hypot(*wheel[:, :2].T).max() == pytest.approx(HUSKY.wheel_radius, rel=0.01)
    assert np.ptp(wheel[:, 2]) == pytest.approx(HUSKY.wheel_width, rel=0.1)


# Bad input


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"vehicle": "husky"}, TypeError, "vehicle must be a Vehicle, got str"),
        ({"driven": "rear"}, ValueError, "driven must be one of all, front, got 'rear'"),
        ({"dt": 0.0005}, ValueError, "dt must be a whole multiple of the step, 0.001 s"),
        ({"dt": "0.02"}, ValueError, "dt must be one number above 0"),
        ({"dt": True}, ValueError, "dt must be one number above 0"),
        ({"pose": (0.0, 1.0)}, ValueError, "pose must be x, y, heading"),
        ({"pose": (0.0, 1.0, np.nan)}, ValueError, "pose must be finite"),
        ({"half_track": -0.3}, ValueError, "half_track must be one number above 0"),
        ({"backend": "gazebo"}, ValueError, "backend must be one of auto"),
        ({"contacts": "none"}, ValueError, "contacts must be one of library, bullet, got 'none'"),
        ({"contacts": "bullet"}, ValueError, 'contacts="bullet" needs PyBullet'),
        ({"wheel_controller": 3}, TypeError, "wheel_controller must be a function"),
        (
            {"wheel_controller": lambda r, m: r, "gains": motor.WheelGains(1.0, 1.0)},
            ValueError,
            "gains or wheel_controller, not both",
        ),
    ],
)
def test_what_makes_no_rover_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        simulation.open_rover(**{"vehicle": HUSKY, "backend": "analytic", **arguments})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda rover: rover.step(np.inf, 0.0), "v must be one finite number"),
        (lambda rover: rover.push(np.zeros(3)), "torque must be one a wheel"),
        (lambda rover: rover.push([0.0, 0.0, np.nan, 0.0]), "torque must be finite"),
        (lambda rover: rover.reset((1.0, 2.0)), "pose must be x, y, heading"),
    ],
)
def test_a_malformed_command_is_refused_and_changes_nothing(rover, call, message):
    drive(rover, 0.1, 0.5, 0.1)
    before = rover.pose, rover.time
    with pytest.raises(ValueError, match=message):
        call(rover)
    np.testing.assert_array_equal(rover.pose, before[0])
    assert rover.time == before[1]


@pytest.mark.parametrize("voltage", [np.zeros(3), [np.nan] * 4, "full", None])
def test_a_wheel_controller_that_gives_no_voltages_is_named(voltage):
    with (
        simulation.open_rover(backend="analytic", wheel_controller=lambda r, m: voltage) as rover,
        pytest.raises(ValueError, match="the answer of wheel_controller"),
    ):
        rover.step(0.1, 0.0)


def test_a_closed_rover_says_so(rover):
    rover.close()
    rover.close()
    with pytest.raises(RuntimeError, match="this rover is closed"):
        rover.step(0.1, 0.0)
