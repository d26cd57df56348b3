"""The inertial measurement unit against rotations of SciPy, differences and statistics."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from backhoe.localisation import imu

G = 9.81
IDEAL = imu.Board(100.0, np.inf, np.inf)


def attitudes(count=200, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform([-3, -1.5, -3], [3, 1.5, 3], (count, 3))


def test_rotation_is_yaw_after_pitch_after_roll():
    angles = attitudes()
    expected = Rotation.from_euler("ZYX", angles[:, ::-1]).as_matrix()
    np.testing.assert_allclose(imu.rotation(angles), expected, atol=1e-15)


def test_at_rest_and_level_the_accelerometer_shows_gravity_upwards():
    np.testing.assert_allclose(imu.specific_force([0, 0, 0], [0, 0, 2.0], G), [0, 0, G])
    np.testing.assert_allclose(imu.specific_force([0, 0, -G], [0.3, 0.2, 0], G), 0, atol=1e-15)
    nose_down = imu.specific_force([0, 0, 0], [0, 0.1, 0], G)
    assert nose_down[0] < 0


def test_accelerating_forward_shows_forward():
    force = imu.specific_force([0, 2.0, 0], [0, 0, np.pi / 2], G)
    np.testing.assert_allclose(force, [2.0, 0, G], atol=1e-15)


def test_422_mended_returns_every_attitude():
    angles = attitudes()
    force = imu.specific_force(np.zeros((200, 3)), angles)
    np.testing.assert_allclose(imu.attitude_from_gravity(force), angles[:, :2], atol=1e-12)


def test_423_is_the_derivative_of_the_attitude():
    h = 1e-5
    rng = np.random.default_rng(1)
    for angles in attitudes(30):
        omega = rng.normal(size=3)
        turned = [
            (
                Rotation.from_euler("ZYX", angles[::-1]) * Rotation.from_rotvec(s * h * omega)
            ).as_euler("ZYX")[::-1]
            for s in (1, -1)
        ]
        ahead, behind = np.unwrap(np.array(turned), axis=0)
        expected = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(imu.euler_rates(angles, omega), expected, rtol=1e-6, atol=1e-7)


def test_423_refuses_a_pitch_of_90_degrees_and_the_rotation_passes_it():
    with pytest.raises(ValueError, match="pitch must not be 90 degrees"):
        imu.euler_rates([0.1, np.pi / 2, 0], [0, 0, 1])
    through = imu.integrate([0, 0, 0], np.tile([0, 0.5, 0], (400, 1)), 0.01)
    expected = Rotation.from_rotvec([0, 2.0, 0]).as_matrix()
    np.testing.assert_allclose(imu.rotation(through[-1]), expected, atol=1e-12)


def test_integrate_is_the_product_of_the_rotations():
    rng = np.random.default_rng(3)
    omega, R = rng.normal(size=(50, 3)), Rotation.from_euler("ZYX", [0.3, 0.2, 0.1])
    for w in omega:
        R = R * Rotation.from_rotvec(0.02 * w)
    found = imu.integrate([0.1, 0.2, 0.3], omega, 0.02)
    assert found.shape == (51, 3)
    np.testing.assert_allclose(imu.rotation(found[-1]), R.as_matrix(), atol=1e-13)


def test_integrated_yaw_keeps_its_turns():
    found = imu.integrate([0, 0, 0], np.tile([0, 0, 1.0], (2000, 1)), 0.01)
    assert found[-1, 2] == pytest.approx(20.0)


def test_an_ideal_board_shows_the_truth():
    rng = np.random.default_rng(4)
    omega, force = rng.normal(size=(2, 100, 3))
    shown = imu.measure(omega, force, IDEAL, 0)
    np.testing.assert_array_equal(shown.gyro, omega)
    np.testing.assert_array_equal(shown.accelerometer, force)
    assert not shown.gyro_saturated.any()
    assert shown.time[[0, -1]].tolist() == [0.0, pytest.approx(0.99)]


def test_boards_have_the_printed_ranges():
    for board, speed, g in ((imu.BOARD_1, 120, 1.5), (imu.BOARD_2, 500, 6)):
        assert np.rad2deg(board.gyro_range) == pytest.approx(speed)
        assert board.accelerometer_range / 9.80665 == pytest.approx(g)


def test_a_reading_stops_at_its_range_and_says_so():
    fast = np.tile([0, 0, np.deg2rad(200)], (50, 1))
    force = np.tile([0, 0, 2 * G], (50, 1))
    one, two = (imu.measure(fast, force, board, 5) for board in (imu.BOARD_1, imu.BOARD_2))
    np.testing.assert_array_equal(one.gyro[:, 2], imu.BOARD_1.gyro_range)
    assert one.gyro_saturated[:, 2].all() and not one.gyro_saturated[:, :2].any()
    assert one.accelerometer_saturated[:, 2].all()
    assert not (two.gyro_saturated.any() or two.accelerometer_saturated.any())


def test_readings_come_in_steps_of_the_resolution():
    shown = imu.measure(np.zeros((500, 3)), np.zeros((500, 3)), imu.BOARD_1, 6)
    steps = shown.gyro / imu.BOARD_1.gyro_resolution
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert len(np.unique(np.rint(steps))) > 10


def test_noise_bias_and_walk_have_the_stated_size():
    board = imu.Board(100.0, np.inf, np.inf, gyro_noise=0.2, gyro_bias=0.3, gyro_bias_walk=0.1)
    zeros = np.zeros((400, 101, 3))
    shown = imu.measure(zeros, zeros, board, 7)
    assert not shown.accelerometer.any()
    within = 4 / np.sqrt(2 * 1200)
    assert shown.gyro_bias[:, 0].std() == pytest.approx(0.3, rel=within)
    walked = shown.gyro_bias[:, 100] - shown.gyro_bias[:, 0]
    assert walked.std() == pytest.approx(0.1, rel=within)
    assert (shown.gyro - shown.gyro_bias).std() == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize("part", ["gyro_noise", "gyro_bias", "gyro_bias_walk"])
def test_yaw_drifts_as_predicted(part):
    board = imu.Board(100.0, np.inf, np.inf, **{part: 0.05})
    runs, steps = 1500, 500
    zeros = np.zeros((runs, steps, 3))
    yaw = imu.measure(zeros, zeros, board, 8).gyro[..., 2].sum(axis=-1) * board.dt
    expected = float(imu.yaw_drift(board, steps * board.dt))
    assert yaw.std() == pytest.approx(expected, rel=4 / np.sqrt(2 * runs))


def test_the_same_seed_gives_the_same_readings():
    zeros = np.zeros((20, 3))
    one, two = (imu.measure(zeros, zeros, imu.BOARD_1, 9) for _ in range(2))
    np.testing.assert_array_equal(one.gyro, two.gyro)
    other = imu.measure(zeros, zeros, imu.BOARD_1, 10)
    assert (one.gyro != other.gyro).any()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: imu.Board(0.0, 1.0, 1.0), "rate must be one number above 0, got 0.0"),
        (
            lambda: imu.Board(100.0, 1.0, 1.0, gyro_noise=-1.0),
            "gyro_noise must be one number at least 0, got -1.0",
        ),
        (lambda: imu.Board(np.nan, 1.0, 1.0), "rate must be one number above 0, got nan"),
        (lambda: imu.Board(1.0, np.nan, 1.0), "gyro_range must be one number above 0, got nan"),
        (
            lambda: imu.rotation([0, 0]),
            r"attitude must end in 3 angles \(roll, .* got shape \(2,\)",
        ),
        (lambda: imu.attitude_from_gravity([0, 0, 0]), "in free fall"),
        (lambda: imu.attitude_from_gravity([0, np.nan, 0]), "force must be finite"),
        (lambda: imu.euler_rates([0, 0], [0, 0, 0]), "roll, pitch, yaw"),
        (
            lambda: imu.integrate([0, 0, 0], [[0, 0, 1]], 0.0),
            r"dt must be one number above 0 \[s\]",
        ),
        (
            lambda: imu.integrate([[0, 0, 0]], [[0, 0, 1]], 0.1),
            r"attitude must be angles .*shape \(3,\), got shape \(1, 3\)",
        ),
        (
            lambda: imu.measure(np.zeros((5, 3)), np.zeros((4, 3)), IDEAL, 0),
            r"omega and force must be alike, got shapes \(5, 3\), \(4, 3\)",
        ),
        (
            lambda: imu.measure([0, 0, 0], [0, 0, 0], IDEAL, 0),
            r"omega must have shape \(..., N, 3\)",
        ),
        (
            lambda: imu.measure([[0, 0, 0]], [[0, 0, 0]], IDEAL, None),
            "rng must be a seed of 0 or more or a numpy Generator",
        ),
        (lambda: imu.yaw_drift(IDEAL, -1.0), "t must be 0 s or more, got -1"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_a_board_is_no_name_of_one():
    with pytest.raises(TypeError, match="board must be a Board, got str: such as"):
        imu.measure([[0, 0, 0]], [[0, 0, 0]], "BOARD_1", 0)
