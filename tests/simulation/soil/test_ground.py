from math import cos, pi, radians, sin

import numpy as np
import pytest

from backhoe.machine import BACKHOE, replace
from backhoe.simulation.soil import SANDY_LOAM, SOILS, Ground, SoilParameters, Terrain
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.earthmoving import bearing_capacity, failure_angle
from backhoe.simulation.soil.force import SoilForce
from backhoe.simulation.soil.terrain import Contact
from wedge import least, trial

DT = 0.01
LEVEL = radians(-178)
PITCH = radians(-75)
HOLD = 0.001
FLOOR = np.arctan2(0.22, -0.30)
"""Direction of the bucket's floor in its tip frame, from the teeth [rad]."""
FACE = radians(-80) + FLOOR
BELLY = min(x * sin(LEVEL) + y * cos(LEVEL) for x, y in BACKHOE.shell.profile)


def tip_pose(r, z, pitch, heading=0.0):
    """Tip frame r out and z up, in an arm's plane through the origin."""
    (ex, ey), (c, s) = (cos(heading), sin(heading)), (cos(pitch), sin(pitch))
    T = np.eye(4)
    T[:3, 0] = c * ex, c * ey, s
    T[:3, 1] = -s * ex, -s * ey, c
    T[:3, 2] = ey, -ex, 0.0
    T[:3, 3] = r * ex, r * ey, z
    return T


def drive(ground, way, seconds, each=lambda ground, force, velocity: None):
    """Take the tip along straight lines through (r, z, pitch, heading)."""
    way = np.array(way, dtype=float)
    ticks = round(seconds / DT)
    last = None
    for k in range(ticks * (len(way) - 1) + 1):
        leg = min(k // ticks, len(way) - 2)
        T = tip_pose(*(way[leg] + (k / ticks - leg) * (way[leg + 1] - way[leg])))
        velocity = np.zeros(3) if last is None else (T[:3, 3] - last) / DT
        force = ground.advance(T, velocity, DT)
        last = T[:3, 3]
        each(ground, force, velocity)


def heap():
    return Terrain.flat((-3.0, 9.8), (-6.4, 6.4), 0.08).with_heap(6.0, 0.0, 1.0, 2.2)


def truck(cell=0.08):
    return Terrain.bed((0.8, 5.3), 4.4, 2.3, floor=1.1, wall=1.9, cell=cell)


def flat():
    return Terrain.flat((2.0, 9.0), (-2.0, 2.0), 0.08)


def stands(heights):
    """Whether nothing slides in a new terrain of these heights."""
    return Terrain(heights, 0.08).relax(SANDY_LOAM.repose) == 0


STROKE = [
    (7.3, 1.6, radians(-75), 0.0),
    (7.2, 0.5, radians(-80), 0.0),
    (6.0, 0.25, radians(-110), 0.0),
    (5.2, 0.45, radians(-150), 0.0),
    (4.9, 0.9, LEVEL, 0.0),
    (4.7, 2.6, LEVEL, 0.0),
]
DUMP = [(4.7, 2.6, LEVEL, 0.0), (5.0, 3.4, LEVEL, 1.35), (5.0, 3.4, radians(-20), 1.35)]


@pytest.fixture
def ground():
    return Ground(heap(), truck(), hold=HOLD)


def test_soil_goes_from_the_heap_through_the_bucket_into_the_truck(ground):
    whole, before = ground.total_volume, ground.terrain.volume
    drive(ground, STROKE, 1.5)
    carried = ground.bucket_volume
    assert carried > 0.9 * ground.machine.shell.struck_capacity
    assert ground.payload == pytest.approx(carried * SANDY_LOAM.density)
    assert ground.terrain.volume == pytest.approx(before - carried, rel=1e-12)
    drive(ground, DUMP, 2.0)
    drive(ground, DUMP[-1:] * 2, 1.5)
    assert ground.bucket_volume == 0
    assert ground.truck_volume == pytest.approx(carried, rel=1e-12)
    assert ground.total_volume == pytest.approx(whole, rel=1e-12)


def test_volume_is_constant_at_every_tick_of_random_digging(ground):
    rng = np.random.default_rng(3)
    whole = ground.total_volume
    seen = {"bucket": 0.0, "truck": 0.0}

    def each(ground, force, velocity):
        assert ground.total_volume == pytest.approx(whole, rel=1e-9)
        assert 0 <= ground.bucket_volume <= ground.fill.heaped + 1e-12
        assert np.isfinite(force).all()
        seen["bucket"] = max(seen["bucket"], ground.bucket_volume)
        seen["truck"] = max(seen["truck"], ground.truck_volume)

    way = np.column_stack(
        [
            rng.uniform(3.0, 9.5, 60),
            rng.uniform(-0.6, 2.5, 60),
            rng.uniform(-4.0, 1.0, 60),
            rng.uniform(-0.7, 0.7, 60),
        ]
    )
    drive(ground, [*STROKE, *DUMP, way[0]], 1.0, each)
    drive(ground, way, 0.6, each)
    assert seen["bucket"] > 0.3
    assert seen["truck"] > 0.01
    assert np.isinf(ground.terrain.ceiling).all()


def test_dug_slopes_settle_to_the_angle_of_repose_once_the_bucket_has_gone(ground):
    drive(ground, STROKE, 1.5)
    drive(ground, STROKE[-1:] * 2, 3.0)
    assert ground.terrain.settled and stands(ground.terrain.heights)


@pytest.mark.parametrize("speed", [0.3, 2.0, 9.0])
@pytest.mark.parametrize("heading", [0.0, 0.3])
def test_the_edge_leaves_a_trench_along_its_path(speed, heading):
    ground = Ground(Terrain.flat((1.0, 9.0), (-1.5, 4.0), 0.08), hold=HOLD)
    depth, pitch = -0.05, radians(-130)
    start, end = (7.0, depth, pitch, heading), (5.0, depth, pitch, heading)
    ground.advance(tip_pose(*start), np.zeros(3), DT)
    drive(ground, [start, end], 2.0 / speed)
    assert ground.bucket_volume == pytest.approx(2.0 * 1.2 * 0.05, rel=0.05)
    along = np.linspace(5.15, 6.85, 60)
    for across in (-0.4, -0.2, 0.0, 0.2, 0.4):
        x = along * cos(heading) + across * sin(heading)
        y = along * sin(heading) - across * cos(heading)
        trench = ground.terrain.height_at(np.column_stack([x, y]))
        assert trench.max() < depth + 1e-9
        assert trench.min() > depth - 1e-9


def test_outside_the_trench_the_ground_is_as_it_was():
    ground = Ground(flat(), hold=HOLD)
    drive(ground, [(7.0, -0.1, radians(-80), 0.0), (6.0, -0.1, radians(-80), 0.0)], 2.0)
    x, y = ground.terrain.grid()
    far = (np.abs(y) > 1.5) | (x > 8.2)
    assert (ground.terrain.heights[far] == 0).all()


def test_a_shell_pressed_down_leaves_its_print_and_the_soil_beside_it():
    ground = Ground(flat(), hold=HOLD)
    deepest = -0.15
    drive(ground, [(5.0, 1.0, LEVEL, 0.0), (5.0, deepest - BELLY, LEVEL, 0.0)], 2.0)
    sinkage = ground._strength.sinkage
    assert ground.bucket_volume == 0
    assert deepest < ground.terrain.heights.min() < deepest + sinkage + 0.02
    assert ground.terrain.heights.max() > 0.05
    assert ground.total_volume == pytest.approx(0, abs=1e-12)


def test_a_back_pushed_outwards_fills_no_bucket():
    ground = Ground(flat(), hold=HOLD)
    way = [(5.0, 0.2, radians(-100), 0.0), (5.0, -0.15, radians(-100), 0.0)]
    drive(ground, way, 1.0)
    drive(ground, [way[-1], (6.0, -0.15, radians(-100), 0.0)], 2.0)
    assert ground.bucket_volume == 0
    x, _ = ground.terrain.grid()
    assert ground.terrain.heights[x > 6.3].max() > 0.1


def test_a_full_bucket_pushes_soil_ahead():
    ground = Ground(flat(), hold=HOLD)
    pitch = radians(-115)
    drive(ground, [(8.5, -0.35, pitch, 0.0), (4.0, -0.35, pitch, 0.0)], 9.0)
    x, y = ground.terrain.grid()
    ahead = (x > 3.0) & (x < 3.9) & (np.abs(y) < 0.5)
    assert ground.terrain.heights[ahead].max() > 0.2
    assert ground.bucket_volume <= ground.fill.heaped
    assert ground.total_volume == pytest.approx(0, abs=1e-12)


def emptied(pitch, seconds=3.0):
    ground = Ground(flat(), hold=HOLD)
    ground.bucket_volume = ground.fill.heaped
    drive(ground, [(5.0, 3.0, pitch, 0.0)] * 2, seconds)
    return ground


def test_a_level_bucket_keeps_its_heap():
    ground = emptied(radians(-175))
    assert ground.bucket_volume == pytest.approx(ground.fill.heaped, rel=0.02)


@pytest.mark.parametrize("pitch_deg, below", [(-60, 5.0), (-20, 5.0), (30, 5 - 1.34 * 0.866)])
def test_a_tipped_bucket_drops_everything_below_its_lower_lip(pitch_deg, below):
    ground = emptied(radians(pitch_deg))
    assert ground.bucket_volume == 0
    assert ground.terrain.volume == pytest.approx(ground.fill.heaped, rel=1e-12)
    x, y = ground.terrain.grid()
    weight = ground.terrain.heights / ground.terrain.heights.sum()
    assert (weight * x).sum() == pytest.approx(below, abs=0.2)
    assert (weight * y).sum() == pytest.approx(0.0, abs=0.01)


def test_a_half_open_bucket_keeps_what_its_pitch_allows():
    ground = emptied(radians(-130), seconds=4.0)
    assert ground.bucket_volume == pytest.approx(ground.fill.retained(radians(-130)), abs=1e-3)


def test_soil_flows_out_no_faster_than_the_spill_rate():
    ground, flows = Ground(flat(), hold=HOLD), []
    ground.bucket_volume = 0.7
    last = [0.7]

    def each(ground, force, velocity):
        flows.append((last[0] - ground.bucket_volume) / DT)
        last[0] = ground.bucket_volume

    drive(ground, [(5.0, 3.0, radians(-30), 0.0)] * 2, 1.0, each)
    assert max(flows) == pytest.approx(SANDY_LOAM.spill_rate, rel=1e-9)
    assert min(flows) >= 0


def test_an_overfull_truck_keeps_its_heap_and_spills_beside(ground):
    drive(ground, DUMP, 1.0)
    level = 4.4 * 2.3 * 0.8
    whole = ground.total_volume
    for _ in range(40):
        ground.bucket_volume += 0.5
        drive(ground, DUMP[-1:] * 2, 0.7)
    drive(ground, DUMP[-1:] * 2, 3.0)
    assert ground.total_volume == pytest.approx(whole + 20.0, rel=1e-9)
    assert 0.9 * level < ground.truck_volume < 20.0
    bed = ground.bed
    assert bed.top > 2.3
    walls = np.ones(bed.heights.shape, dtype=bool)
    walls[1:-1, 1:-1] = False
    assert (bed.heights[walls] == 1.9).all()
    assert stands(bed.heights[1:-1, 1:-1])
    _, y = ground.terrain.grid()
    assert ground.terrain.heights[y > 3.0].sum() * 0.08**2 > 5.0


def test_soil_dropped_below_the_rim_of_the_bed_falls_past_it():
    ground = Ground(heap(), truck(), hold=HOLD)
    ground.bucket_volume = 0.5
    before = ground.terrain.volume
    drive(ground, [(5.0, 0.9, radians(-20), 1.35)] * 2, 2.0)
    assert ground.truck_volume == 0
    assert ground.terrain.volume == pytest.approx(before + 0.5, rel=1e-9)


def test_soil_dropped_beside_the_map_is_reported_not_lost():
    ground = Ground(flat(), hold=HOLD)
    ground.bucket_volume = 0.5
    drive(ground, [(12.0, 3.0, radians(-30), 0.0)] * 2, 3.0)
    assert ground.off_map_volume == pytest.approx(0.5, rel=1e-12)
    assert ground.total_volume == pytest.approx(0.5, rel=1e-12)
    assert ground.bucket_volume == 0


def felt_at(depth, pitch=PITCH, velocity=(-0.5, 0.0, 0.0), hold=HOLD):
    ground = Ground(flat(), hold=hold)
    ground.advance(tip_pose(6.5, -depth, pitch), velocity, DT)
    ground.advance(tip_pose(6.4, -depth, pitch), velocity, DT)
    return ground.advance(tip_pose(6.3, -depth, pitch), velocity, DT), ground


def test_no_force_out_of_the_ground_and_none_at_rest():
    for depth in (-3.0, -0.05):
        force, ground = felt_at(depth)
        assert (force == 0).all() and ground.moment == 0
    force, _ = felt_at(0.3, velocity=(0.0, 0.0, 0.0))
    assert np.abs(force).max() == 0


@pytest.mark.parametrize("depth", [0.2, 0.3, 0.4])
def test_digging_is_as_hard_as_for_an_excavator(depth):
    ground, pulls = Ground(flat(), hold=HOLD), []
    way = [(7.5, -depth, PITCH, 0.0), (5.5, -depth, PITCH, 0.0)]
    ground.advance(tip_pose(*way[0]), np.zeros(3), DT)
    drive(ground, way, 4.0, lambda g, force, v: pulls.append(force[0]))
    assert 10e3 < np.mean(pulls) < 60e3
    assert max(pulls) < 60e3


def test_the_force_grows_with_depth():
    forces = [felt_at(depth)[0][0] for depth in (0.05, 0.1, 0.2, 0.3, 0.4)]
    assert (np.diff(forces) > 0).all()


def test_the_force_grows_smoothly_from_rest_to_its_full_size():
    _, ground = felt_at(0.3)
    position = np.array([6.3, 0.0, -0.3])
    speeds = np.linspace(0, 2, 400)
    pull = np.array([ground.force(position, [-v, 0, 0])[0] for v in speeds])
    push = np.array([ground.force(position, [v, 0, 0])[0] for v in speeds])
    assert pull[0] == 0
    assert (np.diff(pull) > 0).all()
    assert np.diff(pull).max() < 0.03 * pull[-1]
    assert (push <= 0).all()


def test_digging_takes_power_and_never_gives_any():
    rng = np.random.default_rng(8)
    for pitch_deg in (-60, -90, -130, -170):
        for depth in (0.05, 0.3):
            ground = Ground(flat(), hold=HOLD)
            for x in (6.6, 6.5):
                ground.advance(tip_pose(x, -depth, radians(pitch_deg)), [-0.3, 0, 0], DT)
            assert ground._felt.load == 0
            ground._felt = ground._felt._replace(bearing=0.0)
            for velocity in rng.normal(0, 0.6, (60, 3)):
                force = ground.force([6.5, 0.0, -depth], velocity)
                assert force @ velocity <= 0


def test_a_bucket_set_down_is_carried_by_the_ground():
    """A mass on springs of soil: it comes to rest where the ground bears its weight."""
    ground = Ground(flat(), hold=HOLD)
    mass, z, speed = 2500.0, -BELLY, 0.0
    for tick in range(4000):
        if tick % 10 == 0:
            force = ground.advance(tip_pose(5.0, z, LEVEL), [0, 0, speed], DT)
        else:
            force = ground.force([5.0, 0.0, z], [0, 0, speed])
        speed += (force[2] / mass - 9.81) * 0.001
        z += speed * 0.001
    assert abs(speed) < 1e-3
    assert force[2] == pytest.approx(mass * 9.81, rel=1e-3)
    assert -0.1 < z + BELLY < -0.01


def test_the_ground_carries_where_the_shell_touches_it():
    ground = Ground(flat(), hold=HOLD)
    z = -BELLY - 0.03
    drive(ground, [(5.0, 0.6, LEVEL, 0.0), (5.0, z, LEVEL, 0.0)], 0.3)
    force = ground.force([5.0, 0.0, z], [0.0, 0.0, 0.0])
    assert force[2] > 1000
    assert 0.5 < ground.moment / force[2] < 1.3


def test_setting_down_and_lifting_gives_no_energy_back_beyond_the_spring():
    ground = Ground(flat(), hold=HOLD)
    work = [0.0]

    def each(ground, force, velocity):
        work[0] += force @ velocity * DT

    down, up = (5.0, 0.60, LEVEL, 0.0), (5.0, 0.50, LEVEL, 0.0)
    drive(ground, [down, up] * 4, 0.5, each)
    assert work[0] < 0


@pytest.mark.parametrize("soil", SOILS.values(), ids=SOILS)
@pytest.mark.parametrize("pitch_deg", [-60, -90, -120, -150])
def test_no_motion_of_the_bucket_gets_power_from_the_soil(soil, pitch_deg):
    """Moving, turning and sliding aside: force times velocity and moment times rate together."""
    rng = np.random.default_rng(pitch_deg + 200)
    ground = Ground(flat(), parameters=soil, hold=HOLD)
    for x, v in ((6.6, -0.3), (6.5, -0.3), (6.4, 0.3)):
        ground.advance(tip_pose(x, -0.3, radians(pitch_deg)), [v, 0, 0], DT)
        ground._felt = ground._felt._replace(bearing=0.0, load=0.0)
        for velocity, rate in zip(rng.normal(0, 0.6, (80, 3)), rng.normal(0, 1.0, 80), strict=True):
            force = ground.force([x, 0.0, -0.3], velocity, rate)
            assert force @ velocity + ground.moment * rate <= 1e-9


def felt(soil=SANDY_LOAM, pitch_deg=-75, depth=0.3, volume=0.0, machine=BACKHOE):
    """Resistance to a bucket drawn inwards, as `SoilForce` finds it."""
    pose = BucketPose((6.0, 0.0, -depth), (1.0, 0.0), radians(pitch_deg))
    look = SoilForce(soil, machine, HOLD).resistance
    return look(pose, (-0.5, 0.0, 0.0), Contact(), depth, volume, 0.0, None)


@pytest.mark.parametrize("pitch_deg", [-60, -75, -100, -120])
def test_the_bucket_feels_the_discrete_wedge_ahead_of_its_floor(pitch_deg):
    """Fast and level, so that nothing is softened: both parts of the force, teeth set apart."""
    rake = radians(pitch_deg) + FLOOR
    soil, blade = SANDY_LOAM, felt(pitch_deg=pitch_deg)._replace(teeth=0.0)
    (ahead, up), _ = least(soil, 0.3, rake, 1.2, 0.0, 9.81)
    edges = 2 * 0.025 * 0.3 / sin(rake) * bearing_capacity(0.15, soil, 9.81)
    x, y, z, moment = blade.wrench(-0.3, (-500.0, 0.0, 0.0), 0.0)
    size = np.hypot(ahead, up)
    assert x == pytest.approx(ahead + edges * sin(rake), abs=0.02 * size)
    assert z == pytest.approx(-up - edges * cos(rake), abs=0.02 * size)
    assert y == 0
    lever = -moment / blade.cutting
    assert 0.3 / sin(rake) / 3 <= lever <= 0.3 / sin(rake) / 2 + 1e-12


def test_a_load_in_the_bucket_presses_on_the_soil_ahead():
    """Its weight over the mouth is the wedge's surcharge, on the Earth and on the Moon."""
    mouth = np.hypot(1.34, 0.05)
    for gravity in (9.81, 1.62):
        machine = replace(BACKHOE, gravity=gravity)
        rake, empty, full = (
            radians(-75) + FLOOR,
            felt(machine=machine),
            felt(volume=0.6, machine=machine),
        )
        pressure = SANDY_LOAM.density * gravity * 0.6 / (1.2 * mouth)
        beta = float(failure_angle(rake, SANDY_LOAM))
        with_it, without = (
            np.hypot(*trial(SANDY_LOAM, 0.3, rake, 1.2, q, gravity, beta)) for q in (pressure, 0.0)
        )
        extra = (full.cutting - empty.cutting) / cos(SANDY_LOAM.tool_friction)
        assert extra == pytest.approx(with_it - without, rel=5e-3)


def test_a_push_aside_meets_the_whole_side_of_the_bucket():
    wall = np.hypot(1.34, 0.05), 0.0, 9.81
    (aside, up), _ = least(SANDY_LOAM, 0.3, pi / 2, *wall)
    blade = felt()._replace(teeth=0.0, cutting=0.0, bearing=0.0)._replace(cutting=1e-9)
    for side in (1.0, -1.0):
        _, y, z, _ = blade.wrench(-0.3, (0.0, 500.0 * side, 0.0), 0.0)
        assert y == pytest.approx(-side * aside, rel=0.01)
        assert z == pytest.approx(-up, rel=0.02) and z > 0


def test_the_teeth_bear_along_the_floor_and_only_forwards():
    blade = felt()._replace(cutting=1e-9, rubbing=0.0, sideways=0.0)
    ahead = -np.array([cos(radians(-75) + FLOOR), sin(radians(-75) + FLOOR)])
    x, _, z, _ = blade.wrench(-0.3, (500 * ahead[0], 0.0, 500 * ahead[1]), 0.0)
    area = 5 * 0.09 * 0.04 + (1.2 - 5 * 0.09) * 0.025
    assert [x, z] == pytest.approx(
        -ahead * area * bearing_capacity(0.3, SANDY_LOAM, 9.81), rel=1e-3
    )
    assert blade.wrench(-0.3, (-5 * ahead[0], 0.0, -5 * ahead[1]), 0.0)[0] == pytest.approx(
        0, abs=1
    )


def test_a_bucket_that_curls_back_from_the_soil_is_let_go():
    """The face's own speed counts, not that of the teeth alone."""
    blade = felt()._replace(teeth=0.0)
    still, away, into = (blade.wrench(-0.3, (-0.1, 0, 0), rate)[0] for rate in (0.0, -2.0, 2.0))
    assert away == 0 < still < into


def test_on_a_falling_surface_the_depth_ahead_counts_half():
    falling = Terrain.flat((2.0, 9.0), (-2.0, 2.0), 0.08).with_heap(8.0, 0.0, 1.0, 4.0)
    digger = Ground(falling, hold=HOLD)._digger
    here = BucketPose((6.5, 0.0, 0.1), (1.0, 0.0), PITCH)
    at_teeth = digger.depth(here, -1.5)
    fall = 1.0 / 4.0
    assert at_teeth > 0.4
    assert digger.depth_ahead(here, -1.0) == pytest.approx(at_teeth * (1 - fall / 2), rel=0.03)


@pytest.mark.parametrize("hold", [0.001, 0.01])
@pytest.mark.parametrize("along", ["x", "z"])
def test_a_light_bucket_comes_to_rest_without_chatter(hold, along):
    """The lightest tip of the machine, thrown into the soil, with forces held for `hold`."""
    inertia = BACKHOE.bucket.inertia + BACKHOE.bucket.mass * BACKHOE.bucket.com_radius**2
    mass = 0.87 * inertia / BACKHOE.bucket.length**2
    ground = Ground(flat(), hold=hold)
    for x in (6.6, 6.5):
        ground.advance(tip_pose(x, -0.3, radians(-80)), [-0.2, 0, 0], DT)
    position = np.array([6.5, 0.0, -0.3])
    velocity = np.array([-1.0, 0, 0]) if along == "x" else np.array([0, 0, -1.0])
    speeds = []
    for _ in range(300):
        force = ground.force(position, velocity, 0.0)
        velocity = velocity + force / mass * hold
        speeds.append(np.linalg.norm(velocity))
    assert (np.diff(speeds) <= 1e-12).all()
    assert np.linalg.norm(force) / mass * hold < 1e-3
    if along == "x":
        assert speeds[-1] < 0.01
    else:  # what is left draws the face back, along itself
        assert velocity @ [-sin(FACE), 0.0, cos(FACE)] < 0.01 < speeds[-1] < 0.5


def test_the_force_turns_with_the_machine():
    forces = []
    for heading in (0.0, pi / 2):
        ground = Ground(Terrain.flat((-9.0, 9.0), (-9.0, 9.0), 0.08), hold=HOLD)
        inwards = [-0.5 * cos(heading), -0.5 * sin(heading), 0.0]
        for r in (6.5, 6.4, 6.3):
            force = ground.advance(tip_pose(r, -0.3, PITCH, heading), inwards, DT)
        forces.append(force)
    assert forces[1][1] == pytest.approx(forces[0][0], rel=0.02)
    assert abs(forces[1][0]) < 1e-6


def test_harder_soil_resists_more():
    hard = SoilParameters(cohesion=15e3)
    soft_force, _ = felt_at(0.3)
    ground = Ground(flat(), parameters=hard, hold=HOLD)
    for r in (6.5, 6.4, 6.3):
        force = ground.advance(tip_pose(r, -0.3, PITCH), [-0.5, 0, 0], DT)
    assert force[0] > 1.3 * soft_force[0]


def test_the_same_digging_gives_the_same_soil_bit_for_bit():
    grounds = [Ground(heap(), truck(), hold=HOLD) for _ in range(2)]
    logs = [[], []]
    for ground, log in zip(grounds, logs, strict=True):
        drive(ground, STROKE, 0.8, lambda g, force, v, log=log: log.append(force))
        drive(ground, DUMP, 0.8)
    assert np.array_equal(*logs)
    assert np.array_equal(grounds[0].terrain.heights, grounds[1].terrain.heights)
    assert np.array_equal(grounds[0].bed.heights, grounds[1].bed.heights)


def test_after_restoring_a_snapshot_everything_repeats(ground):
    drive(ground, STROKE[:4], 0.8)
    kept = ground.snapshot()
    ends = []
    for _ in range(2):
        forces = []
        drive(ground, STROKE[3:], 0.8, lambda g, force, v, log=forces: log.append(force))
        drive(ground, DUMP, 0.8)
        ends.append((np.array(forces), ground.terrain.heights.copy(), ground.truck_volume))
        ground.restore(kept)
    for one, two in zip(*ends, strict=True):
        assert np.array_equal(one, two)
    assert ground.bucket_volume == kept["volumes"][0] > 0


def test_the_version_tells_when_the_ground_has_changed(ground):
    still = ground.terrain.version, ground.bed.version
    drive(ground, [(5.0, 3.0, LEVEL, 0.0), (5.0, 2.5, LEVEL, 0.3)], 1.0)
    assert (ground.terrain.version, ground.bed.version) == still
    drive(ground, [(5.0, 2.5, LEVEL, 0.3), *STROKE], 1.0)
    assert ground.terrain.version > still[0]


def test_a_jump_is_refused_until_the_pose_is_forgotten(ground):
    ground.advance(tip_pose(5, 2, LEVEL), np.zeros(3), DT)
    with pytest.raises(ValueError, match="call forget_pose"):
        ground.advance(tip_pose(7, 2, LEVEL), np.zeros(3), DT)
    ground.forget_pose()
    ground.advance(tip_pose(7, 2, LEVEL), np.zeros(3), DT)


LYING = np.array([[1.0, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]])


@pytest.mark.parametrize(
    "T, velocity, dt, message",
    [
        (np.eye(3), np.zeros(3), DT, r"T_tip must have shape \(4, 4\), got shape \(3, 3\)"),
        (np.full((4, 4), np.nan), np.zeros(3), DT, "T_tip must be finite"),
        (tip_pose(5, np.nan, 0.0), np.zeros(3), DT, "T_tip must be finite"),
        (2 * tip_pose(5, 2, 0.0), np.zeros(3), DT, "must be a rotation"),
        (LYING, np.zeros(3), DT, "across an upright arm"),
        (tip_pose(5, 2, 0.0), np.zeros(4), DT, r"tip_velocity must have shape \(3,\)"),
        (tip_pose(5, 2, 0.0), [0, np.inf, 0], DT, "tip_velocity must be finite"),
        (tip_pose(5, 2, 0.0), np.zeros(3), 0.0, "dt must be one number above 0"),
        (tip_pose(5, 2, 0.0), np.zeros(3), np.nan, "dt must be one number above 0"),
    ],
)
def test_bad_motion_is_refused_before_soil_moves(ground, T, velocity, dt, message):
    before = ground.terrain.heights.copy()
    with pytest.raises(ValueError, match=message):
        ground.advance(T, velocity, dt)
    assert np.array_equal(ground.terrain.heights, before)


def test_bad_positions_are_refused_by_force(ground):
    with pytest.raises(ValueError, match=r"tip_position must have shape \(3,\)"):
        ground.force([1.0, 2.0], np.zeros(3))
    with pytest.raises(ValueError, match="tip_velocity must be finite"):
        ground.force(np.zeros(3), [np.nan, 0, 0])


def test_a_ground_of_bad_parts_is_refused():
    with pytest.raises(TypeError, match="terrain must be a Terrain, got ndarray"):
        Ground(np.zeros((10, 10)))
    with pytest.raises(TypeError, match="bed must be a Terrain, got int"):
        Ground(flat(), bed=3)
    with pytest.raises(ValueError, match="hold must be one number above 0"):
        Ground(flat(), hold=0.0)
    with pytest.raises(ValueError, match="another scene"):
        Ground(flat(), hold=HOLD).restore(Ground(heap(), truck()).snapshot())


def test_importing_soil_leaves_numba_alone():
    import subprocess
    import sys

    code = "import sys; from backhoe.simulation import soil; print('numba' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"
