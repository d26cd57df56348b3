"""Balance and tipping load against statics by hand, Pinocchio, and a machine that really tips."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe import mission
from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded, scaled
from backhoe.simulation import LOADING
from backhoe.simulation.soil import Ground, Terrain
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.whole_body import stability

FULL = Ground(Terrain(LOADING.heights(), LOADING.cell, LOADING.corner)).fill.heaped * 1600.0
"""Soil in a bucket heaped to its angle of repose [kg]."""

WIDE = replace(BACKHOE, tracks=replace(BACKHOE.tracks, gauge=3.1, shoe_width=0.4, mass=6000.0))
TURNED = replace(BACKHOE, swing=replace(BACKHOE.swing, com_angle=2.0, com_radius=0.6))
MACHINES = {"backhoe": BACKHOE, "wide": WIDE, "turned": TURNED, "small": scaled(0.8)}


RADIUS, HEIGHT = [3.0, 4.0, 5.0, 6.0, 7.0, 9.5], [4.5, 3.0, 0.0, -1.5]


@pytest.fixture(scope="module")
def run():
    return mission.run(cycles=3, backend="analytic")


@pytest.fixture(scope="module")
def chart():
    return stability.lifting_chart(RADIUS, HEIGHT)


@pytest.fixture
def rng():
    return np.random.default_rng(20)


@pytest.fixture(params=MACHINES)
def machine(request):
    return MACHINES[request.param]


def postures(rng, count, machine=BACKHOE):
    return rng.uniform(machine.lower, machine.upper, (count, 4))


def point_masses(q, load, machine):
    """Masses and places of all parts, from the frames of the kinematics and nothing else."""
    tracks, swing = machine.tracks, machine.swing
    found = [(tracks.mass, np.array([0.0, 0.0, tracks.height / 2]))]
    heading = q[0] + np.pi / 2
    at = heading + swing.com_angle
    flat = swing.com_radius * np.array([np.cos(at), np.sin(at)])
    found.append((swing.mass, np.array([*flat, machine.base.height + swing.com_height])))
    found[-1][1][0] += machine.base.offset
    out = np.array([np.cos(heading), np.sin(heading), 0.0])
    joint = np.array([machine.base.offset, 0, machine.base.height + swing.height])
    joint = joint + swing.offset * out
    pitch = 0.0
    for link, angle in zip(machine.links, q[1:], strict=True):
        bend, lean = pitch + angle + link.com_angle, pitch + angle + link.angle_offset
        there = joint + link.com_radius * (np.cos(bend) * out + [0, 0, np.sin(bend)])
        found.append((link.mass + (load if link is machine.bucket else 0.0), there))
        joint = joint + link.length * (np.cos(lean) * out + [0, 0, np.sin(lean)])
        pitch = lean
    tip = kinematics.forward_kinematics(q, machine=machine)[:3, 3]
    assert np.allclose(joint, tip, atol=1e-12)
    return found


def gravity(slope, uphill, machine):
    """Gravity in the axes of a vehicle on a slope, by turning the plane [m/s^2]."""
    axis = np.array([np.sin(uphill), -np.cos(uphill), 0.0])  # level, the ground rises across it
    down = np.array([0.0, 0.0, -machine.gravity])
    c, s = np.cos(slope), np.sin(slope)
    turned = down * c + np.cross(axis, down) * -s + axis * (axis @ down) * (1 - c)
    return turned


class TestStaticsByHand:
    """Three postures, sums of mass times lever done on paper from Table A.2."""

    @pytest.mark.parametrize(
        "q_deg", [(-90, 20, -10, 0), (0, 20, -10, 0), (40, -13.1, 1.2, 60)], ids=str
    )
    def test_the_centre_of_mass(self, q_deg):
        """Sums written out: m_bo 4293.5, m_s 1151.2, m_bu 531.5, m_t 7018.4, m_u 8500 kg."""
        swing, q2, q3, q4 = np.radians(q_deg)
        boom = q2 + np.radians(13.1)
        r2 = 0.6241 + 1.9204 * np.cos(q2 + np.radians(26.7))
        elbow = 0.6241 + 5.1243 * np.cos(boom)
        stick = boom + q3
        r3 = elbow + 0.7281 * np.cos(stick - np.radians(86.2))
        wrist = elbow + 1.9129 * np.cos(stick - np.radians(88.1))
        bucket = stick - np.radians(88.1) + q4
        r4 = wrist + 0.8348 * np.cos(bucket - np.radians(78.6))
        moment = 4293.5 * r2 + 1151.2 * r3 + 531.5 * r4 - 7018.4 * 0.0982
        upper = 4293.5 + 1151.2 + 531.5 + 7018.4
        ahead, aside = -moment * np.sin(swing), moment * np.cos(swing)
        by_hand = np.array([0.4 * upper + ahead, aside]) / (upper + 8500.0)
        assert stability.centre_of_mass(np.radians(q_deg))[:2] == pytest.approx(by_hand, abs=1e-12)


def test_the_centre_of_mass_is_that_of_its_parts(rng, machine):
    for q, load in zip(postures(rng, 40, machine), rng.uniform(0, 3000, 40), strict=True):
        parts = point_masses(q, load, machine)
        total = sum(mass for mass, _ in parts)
        mean = sum(mass * at for mass, at in parts) / total
        assert stability.centre_of_mass(q, load, machine) == pytest.approx(mean, abs=1e-12)
        heavier = stability.centre_of_mass(q, machine=loaded(load, machine))
        assert heavier == pytest.approx(mean, abs=1e-12)


def test_at_rest_the_zero_moment_point_lies_plumb_under_the_centre_of_mass(rng, machine):
    q, load = postures(rng, 60, machine), rng.uniform(0, 2000, 60)
    slope, uphill = rng.uniform(0, 0.5, 60), rng.uniform(-np.pi, np.pi, 60)
    point = stability.zero_moment_point(q, load=load, slope=slope, uphill=uphill, machine=machine)
    com = stability.centre_of_mass(q, load, machine)
    for k in range(60):
        down = gravity(slope[k], uphill[k], machine)
        plumb = com[k] - com[k, 2] / down[2] * down
        assert point[k] == pytest.approx(plumb[:2], abs=1e-9)
    level = stability.zero_moment_point(q, load=load, machine=machine)
    assert level == pytest.approx(com[:, :2], abs=1e-12)


def test_gravity_on_a_slope_points_downhill():
    nose_up = stability.gravity_on_slope(0.3)
    assert nose_up == pytest.approx(9.81 * np.array([-np.sin(0.3), 0.0, -np.cos(0.3)]))
    left_up = stability.gravity_on_slope(0.3, np.pi / 2)
    assert left_up == pytest.approx(9.81 * np.array([0.0, -np.sin(0.3), -np.cos(0.3)]))
    assert stability.gravity_on_slope([0.1, 0.2], 1.0) == pytest.approx(
        np.array([gravity(0.1, 1.0, BACKHOE), gravity(0.2, 1.0, BACKHOE)])
    )


def test_the_ground_s_wrench_is_the_change_of_momentum(rng):
    """Pinocchio's momentum of the arm on a vehicle that drives and turns, gravity apart."""
    pin = pytest.importorskip("pinocchio")
    from oracles import pinocchio_model

    model = pinocchio_model(loaded(700.0))
    data = model.createData()
    weight = np.array([0.0, 0.0, -9.81])
    for _ in range(30):
        q = postures(rng, 1)[0]
        dq, ddq = rng.normal(size=4), 2 * rng.normal(size=4)
        soil = np.r_[rng.normal(size=3) * 2e4, rng.normal() * 2e4]
        pin.computeCentroidalMomentumTimeVariation(model, data, q, dq, ddq)
        mass, com = data.mass[0], data.com[0]
        force = data.dhg.linear - mass * weight
        moment = data.dhg.angular + np.cross(com, force)
        tracks = BACKHOE.tracks
        force = force - tracks.mass * weight
        heading = q[0] + np.pi / 2
        raising = soil[3] * np.array([np.sin(heading), -np.cos(heading), 0.0])
        tip = kinematics.forward_kinematics(q)[:3, 3]
        force, moment = force - soil[:3], moment - np.cross(tip, soil[:3]) - raising
        wanted = np.array([-moment[1], moment[0]]) / force[2]
        found = stability.zero_moment_point(q, dq, ddq, load=700.0, soil=soil)
        assert found == pytest.approx(wanted, abs=1e-9)


def test_a_vehicle_that_drives_and_turns_gives_its_masses_accelerations(rng, machine):
    """Finite differences of the momentum of point masses and turning links in the world."""
    q0, dq, ddq = postures(rng, 1, machine)[0], rng.normal(size=4), rng.normal(size=4)
    speed, change = rng.normal(size=3), rng.normal(size=3)  # x, y, yaw

    def momentum(t):
        """Linear, and angular about the world's origin, by differences of places."""
        h = 1e-4

        def places(t):
            x, y, yaw = speed * t + change * t**2 / 2
            q = q0 + dq * t + ddq * t**2 / 2
            c, s = np.cos(yaw), np.sin(yaw)
            turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            return [
                (m, np.array([x, y, 0.0]) + turn @ at) for m, at in point_masses(q, 300.0, machine)
            ]

        linear = angular = np.zeros(3)
        before, now, after = places(t - h), places(t), places(t + h)
        for (m, low), (_, at), (_, high) in zip(before, now, after, strict=True):
            p = m * (high - low) / (2 * h)
            linear, angular = linear + p, angular + np.cross(at, p)
        rates = dq + ddq * t
        heading = (q0 + dq * t + ddq * t**2 / 2)[0] + (speed * t + change * t**2 / 2)[2] + np.pi / 2
        normal = np.array([np.sin(heading), -np.cos(heading), 0.0])
        turning = sum(link.inertia * rates[1 : k + 2].sum() for k, link in enumerate(machine.links))
        return np.r_[linear, angular + turning * normal]

    h = 1e-3
    push = (momentum(h) - momentum(-h)) / (2 * h)
    masses = point_masses(q0, 300.0, machine)
    weight = [(m * np.array([0, 0, -machine.gravity]), at) for m, at in masses]
    force = push[:3] - sum(f for f, _ in weight)
    moment = push[3:] - sum(np.cross(at, f) for f, at in weight)
    found = stability.zero_moment_point(
        q0, dq, ddq, load=300.0, yaw_rate=speed[2], acceleration=change, machine=machine
    )
    assert found == pytest.approx(np.array([-moment[1], moment[0]]) / force[2], abs=1e-5)


class TestPolygon:
    def test_it_is_what_the_tracks_cover(self):
        corners = stability.support_polygon()
        x, y = 3.65 / 2, (2.38 + 0.6) / 2
        assert corners == pytest.approx(np.array([[x, -y], [x, y], [-x, y], [-x, -y]]))

    def test_distances_are_signed_and_named_in_order(self):
        inside = stability.distances([[1.0, 0.2], [2.0, 0.0]], stability.support_polygon())
        assert inside == pytest.approx(
            np.array([[0.825, 1.29, 2.825, 1.69], [-0.175, 1.49, 3.825, 1.49]])
        )
        assert stability.EDGES == ("front", "left", "rear", "right")

    def test_any_convex_polygon_will_do(self):
        triangle = [[0, 0], [3, 0], [0, 4]]
        assert stability.distances([1.0, 1.0], triangle) == pytest.approx([1.0, 1.0, 1.0])

    @pytest.mark.parametrize(
        ("polygon", "said"),
        [
            ([[0, 0], [1, 0], [2, 0]], "enclose an area"),
            ([[0, 0], [0, 1], [1, 0]], "counter-clockwise"),
            ([[0, 0], [1, 0]], "2 corners"),
            ([[0, 0], [0, 0], [1, 0], [1, 1]], "enclose an area"),
            ([[0, 0], [2, 0], [0.5, 0.5], [0, 2]], "bends inwards at corner 2"),
            ([[0, 0], [np.nan, 0], [1, 1]], "finite"),
        ],
    )
    def test_a_polygon_that_is_none_is_named(self, polygon, said):
        with pytest.raises(ValueError, match=said):
            stability.distances([0.0, 0.0], polygon)


class TestTippingLoad:
    def test_with_it_no_moment_is_left_about_the_edge(self, rng, machine):
        """Moments of all weights about the line of the edge, in three dimensions."""
        corners = stability.support_polygon(machine)
        tried = 0
        for q in postures(rng, 200, machine):
            slope, uphill = rng.uniform(0, 0.2), rng.uniform(-np.pi, np.pi)
            try:
                load, edge = stability.tipping_load(q, slope=slope, uphill=uphill, machine=machine)
            except ValueError:
                continue
            if not edge:
                continue
            k, down = stability.EDGES.index(edge), gravity(slope, uphill, machine)
            start, end = corners[k], corners[(k + 1) % 4]
            along = np.append((end - start) / np.linalg.norm(end - start), 0.0)
            moment = sum(
                np.cross(at - np.append(start, 0.0), mass * down) @ along
                for mass, at in point_masses(q, load, machine)
            )
            scale = sum(mass for mass, _ in point_masses(q, load, machine)) * 9.81
            assert abs(moment) < 1e-9 * scale
            margin = stability.margin(q, load=load, slope=slope, uphill=uphill, machine=machine)
            assert margin.distance == pytest.approx(0.0, abs=1e-9)
            tried += 1
        assert tried > 50

    def test_the_machine_tips_in_pybullet_within_three_per_cent_of_it(self, rng):
        pytest.importorskip("pybullet")
        from free_machine import FreeMachine, random_postures

        edges = set()
        for q in random_postures(rng, 30):
            load, edge = stability.tipping_load(q)
            edges.add(edge)
            for share, tips in ((0.97, False), (1.03, True)):
                with FreeMachine(q, share * load) as free:
                    free.step(2000)
                    assert (free.tilt > np.radians(1.0)) == tips, (np.degrees(q), share)
                    assert tips or free.tilt < np.radians(0.05)
        assert edges >= {"front", "left", "right"}

    def test_the_machine_tips_on_a_slope_in_pybullet_where_it_says(self, rng):
        pytest.importorskip("pybullet")
        from free_machine import FreeMachine, random_postures

        tried = 0
        for q in random_postures(rng, 6):
            slope, uphill = 0.12, rng.uniform(-np.pi, np.pi)
            try:
                load, _ = stability.tipping_load(q, slope=slope, uphill=uphill)
            except ValueError:
                continue
            for share, tips in ((0.95, False), (1.05, True)):
                with FreeMachine(q, share * load, gravity(slope, uphill, BACKHOE)) as free:
                    free.step(2000)
                    assert (free.tilt > np.radians(1.0)) == tips, (np.degrees(q), share)
            tried += 1
        assert tried >= 4

    def test_many_postures_at_once(self, rng):
        q = postures(rng, 300)
        stands = stability.margin(q).distance > 0
        load, edge = stability.tipping_load(q[stands].reshape(-1, 1, 4))
        for k in range(0, stands.sum(), 17):
            one = stability.tipping_load(q[stands][k])
            assert (one.load, one.edge) == (load[k, 0], edge[k, 0])

    def test_a_load_over_the_tracks_tips_nothing(self):
        folded = np.radians([-90.0, 60.0, -60.0, -40.0])
        small = replace(BACKHOE, tracks=replace(BACKHOE.tracks, length=30.0, gauge=30.0))
        assert stability.tipping_load(folded, machine=small) == (np.inf, "")

    def test_a_machine_that_lies_already_is_named(self):
        light = replace(BACKHOE, tracks=replace(BACKHOE.tracks, mass=500.0))
        out = np.radians([[-90, 45, -40, 0], [-90, -10, 55, 30]])
        with pytest.raises(ValueError, match=r"index \(1,\).*lies: 0\.\d\d m beyond its front"):
            stability.tipping_load(out, machine=light)


class TestMargin:
    def test_it_is_the_least_distance_and_names_the_edge(self, rng):
        q, load = postures(rng, 50), rng.uniform(0, 4000, 50)
        distance, edge = stability.margin(q, load=load)
        inside = stability.distances(
            stability.centre_of_mass(q, load)[:, :2], stability.support_polygon()
        )
        assert distance == pytest.approx(inside.min(axis=1), abs=1e-12)
        assert [stability.EDGES.index(name) for name in edge] == inside.argmin(axis=1).tolist()

    def test_leading_axes_are_repeated(self):
        q = np.radians([-90.0, 20.0, -10.0, 0.0])
        many = stability.margin(q, load=np.zeros((3, 5)), slope=np.full(5, 0.1))
        assert many.distance.shape == many.edge.shape == (3, 5)

    @pytest.mark.parametrize(
        ("bad", "said"),
        [
            ({"q": np.zeros(3)}, "4 joints"),
            ({"dq": [np.nan, 0, 0, 0]}, "dq must be finite"),
            ({"load": -1.0}, "load must be 0 or more"),
            ({"slope": -0.1}, r"slope must be from 0 to 38\.7 deg"),
            ({"slope": 0.9}, "tracks slip"),
            ({"slope": 0.62, "uphill": np.pi / 2}, r"from 0 to 31\.0 deg.*got 35\.5 deg"),
            ({"acceleration": [0.0, 0.0]}, "acceleration must"),
            ({"soil": [0.0, 0.0, 3e5, 0.0]}, "lifts the machine.*kN"),
            ({"load": np.zeros(3), "slope": np.zeros(2)}, "leading axes"),
        ],
    )
    def test_bad_input_is_named(self, bad, said):
        with pytest.raises(ValueError, match=said):
            stability.margin(**({"q": np.radians([-90.0, 20.0, -10.0, 0.0])} | bad))


class TestMotionInPyBullet:
    """The centre of pressure of the contacts under a machine that is free to tip."""

    def both(self, q, load, speeds, most, seconds, hold=None):
        """Centre of pressure and zero-moment point, means of 20 ms, and the tilt, step by step."""
        pytest.importorskip("pybullet")
        from free_machine import DT, FreeMachine

        rows = []
        with FreeMachine(q, load) as free:
            free.step(300)
            rock = None if hold is None else free.catch(hold)
            (angles, rates), (v, w) = free.state(), free.base_rates()
            for k in range(round(seconds / DT)):
                free.turn(speeds(k * DT), most)
                free.step()
                soil = np.zeros(4) if rock is None else free.pull_of(rock)
                (new, faster), (new_v, new_w) = free.state(), free.base_rates()
                point, _ = free.carried_at()
                found = stability.zero_moment_point(
                    angles,
                    rates,
                    (faster - rates) / DT,
                    load=load,
                    yaw_rate=w[2],
                    acceleration=[*(new_v - v)[:2] / DT, (new_w - w)[2] / DT],
                    soil=soil,
                )
                rows.append([*point, *found, free.tilt])
                angles, rates, v, w = new, faster, new_v, new_w
        rows, mean = np.array(rows), np.ones(20) / 20
        smooth = np.array([np.convolve(column, mean, "valid") for column in rows.T]).T
        return smooth[:, :2], smooth[:, 2:4], smooth[:, 4]

    @pytest.mark.parametrize("load", [0.0, 1000.0, 2000.0])
    def test_a_swing_that_is_stopped_hard(self, load):
        def speeds(t):
            return [0.6 if 0.2 < t < 1.2 else 0.0, 0.0, 0.0, 0.0]

        q, most = np.radians([-60.0, 15.0, 10.0, 0.0]), [2.5e5, 1e8, 1e8, 1e8]
        pressed, found, tilt = self.both(q, load, speeds, most, 3.0)
        assert tilt.max() < 1e-4
        assert np.ptp(found, axis=0).max() > 0.5
        assert np.abs(pressed - found).max() < 0.02
        assert np.median(np.abs(pressed - found)) < 1e-3

    def test_a_swing_that_is_stopped_harder_lifts_a_track(self):
        def speeds(t):
            return [0.6 if 0.2 < t < 1.2 else 0.0, 0.0, 0.0, 0.0]

        q, most = np.radians([-60.0, 15.0, 10.0, 0.0]), [3e5, 1e8, 1e8, 1e8]
        _, found, tilt = self.both(q, 3000.0, speeds, most, 3.0)
        inside = stability.distances(found, stability.support_polygon()).min(axis=1)
        assert inside.min() < -0.05
        assert tilt.max() > np.radians(0.2)

    @pytest.mark.parametrize(("most", "lifts"), [(25e3, False), (50e3, True)])
    def test_a_bucket_that_is_caught_on_a_rock(self, most, lifts):
        def speeds(t):
            return [0.0, 0.1 * np.clip(5 * (t - 0.2), 0.0, 1.0), 0.0, 0.0]

        q = np.radians([-90.0, -5.0, 10.0, 20.0])
        pressed, found, tilt = self.both(q, 0.0, speeds, 1e8, 0.8, hold=most)
        assert (tilt.max() > 1e-2) == lifts
        assert (stability.distances(found, stability.support_polygon()).min() < 0) == lifts
        if not lifts:
            assert np.ptp(found[:, 0]) > 0.7
            assert np.abs(pressed - found).max() < 0.01


class TestMissions:
    """The rule of ISO 10567: no more than three quarters of the load that tips it."""

    def test_a_full_bucket_over_the_front_and_over_the_side(self, run):
        for swing in (*stability.OVER.values(), *np.radians([-120, -60, -30, 30, 90])):
            q = run.q.copy()
            q[:, 0] = swing
            load, _ = stability.tipping_load(q)
            assert FULL <= 0.75 * load.min()

    def test_where_it_swings_even_on_the_middle_of_the_tracks(self, run):
        """Makers' charts fit a line near the rollers over the side: so narrow a machine stands."""
        carrying = run.bucket_volume > 0.3
        tracks = replace(BACKHOE.tracks, shoe_width=1e-9)
        load, _ = stability.tipping_load(run.q[carrying], machine=replace(BACKHOE, tracks=tracks))
        assert FULL <= 0.75 * load.min()

    def test_in_the_posture_of_travel(self):
        load, _ = stability.tipping_load(
            np.radians([[-90, 0, 0, 0], [0, 0, 0, 0]]) + [0, 1, 1, 1] * POSTURE
        )
        assert FULL <= 0.75 * load.min()

    def test_it_stands_even_while_the_soil_pulls_the_bucket_down(self, run):
        assert 0.15 < run.least.margin <= run.margin.min() + 1e-6
        out_of_the_heap = run.time % (run.time[-1] / run.cycles) > 12.8
        assert run.margin[out_of_the_heap].min() > 0.5


class TestLiftingChart:
    def test_what_it_rates_leaves_a_quarter_of_the_tipping_load(self, chart):
        """A load at the stick's end, tried as point masses of a machine at rest."""
        corners, tried = stability.support_polygon(), 0
        for swing, loads, drives in (
            (-np.pi / 2, chart.front, chart.by_drives_front),
            (0.0, chart.side, chart.by_drives_side),
        ):
            for k, j in zip(*np.nonzero(~np.isnan(loads) & ~drives), strict=True):
                out = np.array([np.cos(swing + np.pi / 2), np.sin(swing + np.pi / 2)])
                at = np.array([BACKHOE.base.offset, 0.0]) + RADIUS[j] * out
                target = [BACKHOE.base.offset + RADIUS[j], 0.0, HEIGHT[k], 0.0]
                q = kinematics.inverse_kinematics(target)
                q[0] = swing
                lean = q[1] + q[2] + BACKHOE.boom.angle_offset + BACKHOE.stick.angle_offset
                plumb = -np.pi / 2 - BACKHOE.bucket.com_angle - lean
                plumb = (plumb + np.pi) % (2 * np.pi) - np.pi
                q[3] = np.clip(plumb, BACKHOE.lower[3], BACKHOE.upper[3])
                com = stability.centre_of_mass(q)[:2]
                hung = loads[k, j] / 0.75
                mean = (BACKHOE.mass * com + hung * at) / (BACKHOE.mass + hung)
                assert stability.distances(mean, corners).min() == pytest.approx(0.0, abs=1e-9)
                tried += 1
        assert tried > 15

    def test_drives_limit_a_weak_machine(self):
        boom = replace(BACKHOE.boom, joint=replace(BACKHOE.boom.joint, torque=300e3))
        weak = stability.lifting_chart([5.0], [3.0], replace(BACKHOE, boom=boom))
        assert weak.by_drives_front.all()
        assert "*" in str(weak)
        q = kinematics.inverse_kinematics([BACKHOE.base.offset + 5.0, 0.0, 3.0, 0.0])
        lean = q[1] + q[2] + BACKHOE.boom.angle_offset + BACKHOE.stick.angle_offset
        q[3] = -np.pi / 2 - BACKHOE.bucket.com_angle - lean
        torque = dynamics.gravity_torque(q)[1]
        lever = 5.0 - BACKHOE.swing.offset
        holds = 300e3 - torque
        assert weak.front[0, 0] == pytest.approx(0.87 * holds / (9.81 * lever))

    def test_it_lifts_less_over_the_side_and_further_out(self, chart):
        reached = ~np.isnan(chart.front)
        assert (chart.side[reached] < chart.front[reached]).all()
        assert np.nanmax(np.diff(chart.front, axis=1)) < 0

    def test_out_of_reach_is_no_number(self, chart):
        assert np.isnan(chart.front[:, -1]).all()
        assert " - " in str(chart)

    def test_it_prints_rows_of_height_and_columns_of_radius(self, chart):
        lines = str(chart).splitlines()
        assert len(lines) == 3 + len(HEIGHT)
        assert (
            lines[1].split() == ["height", *(f"{r} m".split() for r in ())] or "3.0 m" in lines[1]
        )

    def test_bad_input_is_named(self):
        with pytest.raises(ValueError, match="radius"):
            stability.lifting_chart(5.0, [1.0])
        with pytest.raises(ValueError, match="height must be finite"):
            stability.lifting_chart([5.0], [np.inf])
