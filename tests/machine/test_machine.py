"""The machine's numbers: all sourced, all checked, none changeable in place."""

import copy
import pickle
from dataclasses import FrozenInstanceError, fields, is_dataclass

import numpy as np
import pytest

from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE, JOINTS, Joint, Shell, replace
from backhoe.machine.provenance import (
    DIGGING_MACHINES,
    DIGGING_SOURCES,
    PUBLIC_MACHINES,
    digging,
    provenance,
)


def leaf_paths(owner, path=""):
    if not is_dataclass(owner):
        return {path: owner}
    found = {}
    for field in fields(owner):
        found |= leaf_paths(getattr(owner, field.name), f"{path}.{field.name}".lstrip("."))
    return found


LEAVES = leaf_paths(BACKHOE)
NUMBERS = [path for path, value in LEAVES.items() if not isinstance(value, tuple)]


def with_value(path, value, owner=BACKHOE):
    """The machine with one number changed, by its path."""
    name, _, rest = path.partition(".")
    return replace(
        owner, **{name: with_value(rest, value, getattr(owner, name)) if rest else value}
    )


def test_every_number_has_a_unit_and_a_source():
    rows = {name: rest for name, *rest in provenance()}
    assert set(rows) == set(LEAVES)
    for name, (value, _, unit, source) in rows.items():
        assert value == LEAVES[name]
        assert unit
        assert source.startswith(("Mastalli 2013, Table A.", "ours: "))


def test_provenance_shows_the_numbers_of_a_variant():
    values = {name: value for name, value, *_ in provenance(with_value("stick.length", 2.5))}
    assert values["stick.length"] == 2.5
    assert values["boom.length"] == BACKHOE.boom.length


def test_printed_angles_are_those_of_table_a2_in_degrees():
    offsets = [np.degrees(link.angle_offset) for link in BACKHOE.links]
    np.testing.assert_allclose(offsets, [13.1, -88.1, -104.1])
    com = [np.degrees(link.com_angle) for link in BACKHOE.links]
    np.testing.assert_allclose(com, [26.7, -86.2, -78.6])


@pytest.mark.parametrize("path", NUMBERS)
def test_any_number_can_be_changed_alone(path):
    changed = with_value(path, LEAVES[path] * 0.9 + 1e-3)
    assert leaf_paths(changed)[path] != LEAVES[path]
    others = {name: value for name, value in leaf_paths(changed).items() if name != path}
    assert others == {name: value for name, value in LEAVES.items() if name != path}


@pytest.mark.parametrize("path", NUMBERS)
@pytest.mark.parametrize("value", [np.nan, np.inf, "heavy", None, True])
def test_a_number_that_is_none_is_refused(path, value):
    owner = path.split(".")
    with pytest.raises(ValueError, match=rf"\.{owner[-1]} must be one (finite )?number.*, got"):
        with_value(path, value)


@pytest.mark.parametrize(
    "path",
    [
        path
        for path in NUMBERS
        if path.rpartition(".")[2] in ("mass", "inertia", "speed", "torque")
        or path.startswith("tracks.")
        or path in ("boom.length", "stick.length", "bucket.length", "shell.width", "shell.plate")
    ],
)
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_what_must_be_positive_is_refused_otherwise(path, value):
    name = path.rpartition(".")[2]
    with pytest.raises(ValueError, match=rf"\.{name} must be one number above 0, got {value}"):
        with_value(path, value)


def test_the_tracks_are_like_those_of_the_public_machines():
    """What `provenance` claims: within a twentieth of each figure that their makers print."""
    tracks = BACKHOE.tracks
    ours = {
        "mass": BACKHOE.mass,
        "gauge": tracks.gauge,
        "length": tracks.length,
        "pull": 2 * tracks.max_traction,
    }
    for machine in PUBLIC_MACHINES.values():
        for name in ours.keys() & machine.keys():
            assert ours[name] == pytest.approx(machine[name], rel=0.05)
    assert tracks.shoe_width in {machine["shoe"] for machine in PUBLIC_MACHINES.values()}


def test_the_machine_digs_within_the_range_of_the_cited_machines():
    """Their weakest has a long reach; beside the Caterpillar 320 ours has 60 % of its forces."""
    ours, *cited = digging()
    assert [name for name, *_ in cited] == list(DIGGING_SOURCES) == list(DIGGING_MACHINES)
    for column, name in ((2, "bucket"), (3, "by the bucket"), (4, "by the stick")):
        theirs = [row[column] for row in cited if row[column] is not None]
        assert len(theirs) >= 3, name
        assert min(theirs) < ours[column] < max(theirs), name
    cat = dict((name, row) for name, *row in cited)["Caterpillar 320"]
    shares = np.array(ours[3:5]) / cat[2:4]
    assert shares == pytest.approx(0.61, abs=0.02)
    assert ours[5] / max(row[5] for row in cited if row[5]) == pytest.approx(1.08, abs=0.005)


def test_digging_forces_are_torques_over_lever_arms():
    _, mass, heaped, by_bucket, by_stick, swing = digging()[0]
    q = np.radians([0.0, 0.0, 10.0, 104.1])  # bucket in line with the stick
    joint, tip = (kinematics.forward_kinematics(q, name)[:3, 3] for name in ("boom", "tip"))
    assert by_bucket * BACKHOE.bucket.length == pytest.approx(BACKHOE.torque_limit[3])
    assert by_stick * np.linalg.norm(tip - joint) == pytest.approx(BACKHOE.torque_limit[2])
    assert (mass, swing) == (BACKHOE.mass, BACKHOE.torque_limit[0])
    assert heaped == BACKHOE.shell.heaped_capacity


def test_heaped_capacity_has_a_roof_of_slope_one_on_the_mouth():
    """Summed column by column: as high as it is far from the nearest edge."""
    for width in (1.2, 2.0):
        shell = replace(BACKHOE.shell, width=width)
        long = np.hypot(1.34, 0.05)
        u = (np.arange(2000) + 0.5) / 2000 * long
        v = (np.arange(2000) + 0.5) / 2000 * width
        u, v = np.meshgrid(np.minimum(u, long - u), np.minimum(v, width - v))
        heap = np.minimum(u, v).mean() * long * width
        assert shell.heaped_capacity == pytest.approx(shell.struck_capacity + heap, rel=1e-5)
    assert BACKHOE.shell.heaped_capacity == pytest.approx(0.874, abs=0.001)


def test_limits_the_wrong_way_round_are_refused():
    with pytest.raises(ValueError, match=r"Joint.lower must be below Joint.upper, got 1.0 and 0.5"):
        Joint(1.0, 0.5, 1, 1, 0, 0)


@pytest.mark.parametrize("name", ["viscous", "coulomb"])
def test_negative_friction_is_refused(name):
    with pytest.raises(ValueError, match=rf"Joint\.{name} must be one number at least 0, got -1.0"):
        with_value(f"boom.joint.{name}", -1.0)


@pytest.mark.parametrize(
    ("profile", "message"),
    [
        (((0.0, 0.0), (1.0, 0.0)), "must enclose an area"),
        (((0.0, 0.0, 0.0),) * 3, r"must be \(x, y\) points .*, got shape \(3, 3\)"),
        (((0.0, 0.0), (1.0, np.nan), (1.0, 1.0)), "must be finite"),
        (((0.0, 0.0), (1.0, 0.0), (2.0, 0.0)), "must enclose an area"),
    ],
)
def test_profile_that_is_no_bucket_is_refused(profile, message):
    with pytest.raises(ValueError, match=message):
        Shell(width=1.0, plate=0.02, profile=profile)


def test_struck_capacity_is_the_area_inside_the_profile_times_the_width():
    x, y = np.array(BACKHOE.shell.profile).T
    grid_x, grid_y = np.meshgrid(np.linspace(x.min(), x.max(), 800), np.linspace(0, y.max(), 800))
    inside = np.zeros(grid_x.shape, dtype=bool)
    for x1, y1, x2, y2 in zip(x, y, np.roll(x, -1), np.roll(y, -1), strict=True):
        crosses = (grid_y < y1) != (grid_y < y2)
        with np.errstate(divide="ignore", invalid="ignore"):
            left = grid_x < x1 + (grid_y - y1) / (y2 - y1) * (x2 - x1)
        inside ^= crosses & left
    area = inside.mean() * np.ptp(x) * y.max()
    assert BACKHOE.shell.struck_capacity == pytest.approx(area * BACKHOE.shell.width, rel=0.01)
    assert 0.3 < BACKHOE.shell.struck_capacity < 1.2


def test_limits_come_in_the_order_of_the_joints():
    for index, name in enumerate(JOINTS):
        joint = getattr(BACKHOE, name).joint
        assert joint is BACKHOE.joints[index]
        assert BACKHOE.lower[index] == joint.lower
        assert BACKHOE.upper[index] == joint.upper
        assert BACKHOE.speed_limit[index] == joint.speed
        assert BACKHOE.torque_limit[index] == joint.torque
        assert BACKHOE.viscous[index] == joint.viscous
        assert BACKHOE.coulomb[index] == joint.coulomb


def test_torque_limits_hold_the_arm_with_a_full_bucket_in_every_posture():
    axes = [
        np.linspace(low, high, 25)
        for low, high in zip(BACKHOE.lower[1:], BACKHOE.upper[1:], strict=True)
    ]
    q = np.stack(np.meshgrid([0.0], *axes, indexing="ij"), axis=-1)
    soil = 1800.0 * BACKHOE.shell.struck_capacity
    loaded = with_value("bucket.mass", BACKHOE.bucket.mass + soil)
    share = np.abs(dynamics.gravity_torque(q, loaded)) / BACKHOE.torque_limit
    assert share.max() < 0.9


def test_machine_cannot_be_changed_in_place():
    with pytest.raises(FrozenInstanceError):
        BACKHOE.gravity = 1.0
    with pytest.raises(FrozenInstanceError):
        BACKHOE.stick.length = 3.0
    with pytest.raises(ValueError, match="read-only"):
        BACKHOE.lower[0] = 0.0


def test_a_copy_cannot_be_changed_in_place_either():
    assert not BACKHOE.lower.flags.writeable
    for copied in (pickle.loads(pickle.dumps(BACKHOE)), copy.deepcopy(BACKHOE)):
        assert copied == BACKHOE and hash(copied) == hash(BACKHOE)
        with pytest.raises(ValueError, match="read-only"):
            copied.lower[0] = 0.0


@pytest.mark.parametrize("number", [np.float32(2.5), np.int64(2), 2])
def test_any_type_of_number_is_kept_as_a_float(number):
    variant = replace(BACKHOE, stick=replace(BACKHOE.stick, length=number))
    assert type(variant.stick.length) is float and variant.stick.length == number
    assert dynamics.mass_matrix(np.zeros(4), variant).dtype == float


@pytest.mark.parametrize("make", [list, np.array])
def test_a_profile_of_any_sequence_makes_the_same_machine(make):
    points = make([list(point) for point in BACKHOE.shell.profile])
    variant = replace(BACKHOE, shell=replace(BACKHOE.shell, profile=points))
    assert variant == BACKHOE and hash(variant) == hash(BACKHOE)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda: replace(BACKHOE, stick=2.5),
            "Machine.stick must be a Link, got float: change one with",
        ),
        (lambda: replace(BACKHOE, swing=BACKHOE.boom), "Machine.swing must be a Swing"),
        (lambda: replace(BACKHOE, shell=None), "Machine.shell must be a Shell, got NoneType"),
        (lambda: replace(BACKHOE.boom, joint=0.3), "Link.joint must be a Joint, got float"),
    ],
)
def test_a_part_of_another_type_is_refused(change, message):
    with pytest.raises(TypeError, match=message):
        change()


def test_a_number_beyond_all_floats_is_refused():
    with pytest.raises(ValueError, match=r"Link\.mass must be one number above 0"):
        replace(BACKHOE.stick, mass=10**400)


def test_whole_mass_is_the_sum_of_the_parts():
    parts = sum(value for path, value in LEAVES.items() if path.endswith(".mass"))
    assert BACKHOE.mass == pytest.approx(parts)


def test_everything_follows_a_variant():
    q, rest = np.array([0.1, 0.2, -0.3, 0.4]), np.zeros(4)
    longer = with_value("stick.length", 2.5)
    gap = kinematics.pose(q, longer) - kinematics.pose(q)
    assert np.linalg.norm(gap[:3]) == pytest.approx(2.5 - BACKHOE.stick.length)
    assert dynamics.gravity_torque(q, with_value("gravity", 0.0)).tolist() == [0, 0, 0, 0]
    heavier = with_value("bucket.mass", 1000.0)
    assert dynamics.gravity_torque(q, heavier)[3] / dynamics.gravity_torque(q)[3] == pytest.approx(
        1000.0 / BACKHOE.bucket.mass
    )
    sticky = with_value("boom.joint.coulomb", 9000.0)
    drag = dynamics.friction_torque([0, 0.1, 0, 0], sticky) - dynamics.friction_torque(
        [0, 0.1, 0, 0]
    )
    assert drag[1] == pytest.approx(5000.0)
    assert (
        (dynamics.inverse_dynamics(q, rest, rest, machine=heavier)[1:3]).tolist()
        != (dynamics.inverse_dynamics(q, rest, rest)[1:3]).tolist()
    )


def test_the_tracks_turn_like_two_long_bars_at_their_gauge():
    """By summing over points of two bars."""
    tracks = BACKHOE.tracks
    x = ((np.arange(2000) + 0.5) / 2000 - 0.5) * tracks.length
    squares = x**2 + (tracks.gauge / 2) ** 2
    assert tracks.yaw_inertia == pytest.approx(tracks.mass * squares.mean(), rel=1e-6)
