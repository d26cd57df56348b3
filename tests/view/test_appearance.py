"""The drawn machine: closed meshes that follow the machine's numbers."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import BACKHOE, JOINTS
from backhoe.simulation.scene import LOADING
from backhoe.vehicle.skid_steer import HUSKY
from backhoe.view import appearance, shapes

LONG = replace(BACKHOE, stick=replace(BACKHOE.stick, length=2.5))


def all_meshes(machine=BACKHOE):
    yield from (part for parts in appearance.visuals(machine).values() for part in parts)
    yield from appearance.truck_visuals(LOADING.truck)


def test_every_mesh_is_closed_and_faces_outwards():
    for part in all_meshes():
        edges = np.concatenate(
            [part.faces[:, [0, 1]], part.faces[:, [1, 2]], part.faces[:, [2, 0]]]
        )
        there = {tuple(edge) for edge in edges}
        assert len(there) == len(edges)
        assert {(b, a) for a, b in there} == there
        assert shapes.volume((part.vertices, part.faces)) > 0


def test_the_machine_takes_few_triangles():
    assert sum(len(part.faces) for part in all_meshes()) < 5000


def test_the_arm_is_drawn_on_its_joints():
    boom, stick, bucket = (
        np.vstack([part.vertices for part in appearance.visuals()[link]])
        for link in ("boom", "stick", "bucket")
    )
    for link, points in (("boom", boom), ("stick", stick), ("bucket", bucket)):
        length = getattr(BACKHOE, link).length
        for joint in (-length, 0.0):
            assert points[:, 0].min() - 0.01 < joint < points[:, 0].max() + 0.2 * length
            assert np.hypot(points[:, 0] - joint, points[:, 1]).min() < 0.13 * length
    assert bucket[:, 0].max() == pytest.approx(0.0, abs=BACKHOE.shell.plate)


def test_tracks_stand_on_the_ground_at_their_gauge():
    belt = appearance.visuals()["undercarriage"][0].vertices
    tracks = BACKHOE.tracks
    assert abs(belt[:, 2].min()) < 0.03
    assert belt[:, 1].max() == pytest.approx(tracks.gauge / 2 + tracks.shoe_width / 2, abs=0.05)
    np.testing.assert_allclose(np.sort(belt[:, 1]), np.sort(-belt[:, 1]), atol=1e-12)


def test_a_longer_stick_is_drawn_longer():
    usual, longer = (
        np.ptp(np.vstack([part.vertices for part in appearance.visuals(machine)["stick"]])[:, 0])
        for machine in (BACKHOE, LONG)
    )
    assert longer / usual == pytest.approx(2.5 / BACKHOE.stick.length, rel=0.02)


def test_hydraulic_cylinders_never_come_apart_nor_poke_through():
    rng = np.random.default_rng(0)
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (500, 4))
    T = dict(zip(JOINTS, np.moveaxis(link_transforms(q), -3, 0), strict=True))
    for strut in appearance.struts():
        base = (T[strut.base_link] @ [*strut.base, 1.0])[:, :3]
        tip = (T[strut.tip_link] @ [*strut.tip, 1.0])[:, :3]
        length = np.linalg.norm(tip - base, axis=1)
        barrel, rod = strut.barrel.vertices[:, 0], strut.rod.vertices[:, 0]
        assert (length < barrel.max() - rod.min()).all()
        assert (length > barrel.max()).all()
        assert (length > -rod.min()).all()


@pytest.mark.parametrize("volume", [0.02, 0.2, 0.5, 0.7])
def test_the_drawn_load_is_as_large_as_the_load(volume):
    load = appearance.bucket_load(volume)
    assert shapes.volume((load.vertices, load.faces)) == pytest.approx(volume, rel=1e-6)


def test_the_load_lies_in_the_bucket_up_to_the_mouth():
    shell = BACKHOE.shell
    load = appearance.bucket_load(0.6 * shell.struck_capacity).vertices
    profile = np.array(shell.profile)
    assert load[:, 0].min() >= profile[:, 0].min() - 1e-9
    assert load[:, 1].max() <= profile[:, 1].max() + 1e-9
    assert np.abs(load[:, 2]).max() == pytest.approx(shell.width / 2)


def test_an_empty_bucket_and_no_truck_draw_nothing():
    assert appearance.bucket_load(0.0) is None
    assert appearance.truck_visuals(None) == ()
    assert appearance.truck_boxes(None) == ()


def test_the_truck_is_drawn_around_the_bed_that_is_filled():
    truck = LOADING.truck
    bed = appearance.truck_visuals(truck)[0].vertices
    assert bed[:, 0].min() < truck.x - truck.bed_length / 2
    assert bed[:, 1].max() > truck.y + truck.bed_width / 2
    inside = (np.abs(bed[:, 0] - truck.x) < truck.bed_length / 2 - 0.01) & (
        np.abs(bed[:, 1] - truck.y) < truck.bed_width / 2 - 0.01
    )
    assert not inside.any()


def span(vertices):
    return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def test_shapes_lie_where_they_were_put():
    outline = np.array([(0.0, 1.0), (2.0, 1.5), (1.0, 3.0)])
    bent = np.add(outline, (0.2, -0.5))
    rim = shapes.prism(outline, -0.5, 2.0)[0]
    assert {tuple(v) for v in rim} >= {(*p, z) for p in outline for z in (-0.5, 2.0)}
    bar = shapes.beam(outline, bent, -0.1, (0.2, 0.3, 0.4))[0]
    corners = [(*p, z) for line in (outline, bent) for p in line for z in (-0.1,)]
    corners += [
        (*p, z) for line in (outline, bent) for p, z in zip(line, (0.2, 0.3, 0.4), strict=True)
    ]
    assert {tuple(v) for v in bar} == set(corners)
    np.testing.assert_array_equal(
        span(shapes.box((1, -2, 5), (0, 3, 4))[0]), [(0, -2, 4), (1, 3, 5)]
    )
    start, end = np.array([1.0, 2.0, -1.0]), np.array([2.0, 0.0, 1.0])
    round_bar = shapes.cylinder(start, end, 0.4)[0] - start
    along = round_bar @ (end - start) / 3.0
    away = np.linalg.norm(round_bar - np.outer(along, end - start) / 3.0, axis=1)
    np.testing.assert_allclose(np.abs(along - 1.5), 1.5)
    assert np.allclose(away[away > 1e-9], 0.4) and (away > 1e-9).sum() == 28
    x, y = np.meshgrid([0.0, 1.0, 2.0], [0.0, 3.0])
    np.testing.assert_array_equal(
        shapes.grid(x, y, x + y)[0].T, [x.ravel(), y.ravel(), (x + y).ravel()]
    )


def test_arm_and_house_lie_about_the_plane_of_the_arm_and_above_the_tracks():
    for link in ("boom", "stick", "bucket", "swing"):
        low, high = span(np.vstack([part.vertices for part in appearance.visuals()[link]]))
        assert low[2] == pytest.approx(-high[2], abs=0.01), link
    assert low[1] + BACKHOE.base.height + BACKHOE.swing.height > BACKHOE.tracks.height


def test_the_truck_is_drawn_as_the_boxes_that_it_is_for_contacts():
    drawn = np.vstack([part.vertices for part in appearance.truck_visuals(LOADING.truck)])
    known = {tuple(vertex) for vertex in np.round(drawn, 6)}
    for lower, upper in appearance.truck_boxes(LOADING.truck)[:-1]:
        assert {tuple(np.round(corner, 6)) for corner in shapes.box(lower, upper)[0]} <= known


def test_the_rover_is_drawn_in_its_measures():
    body, *_, axles = appearance.rover_body(HUSKY)
    half = HUSKY.body_length / 2, HUSKY.body_width / 2
    top = HUSKY.clearance + HUSKY.body_height
    wanted = [(-half[0], -half[1], HUSKY.clearance), (*half, top)]
    np.testing.assert_allclose(span(body.vertices), wanted)
    middle = span(axles.vertices).mean(axis=0)
    np.testing.assert_allclose(middle, ((HUSKY.front - HUSKY.rear) / 2, 0, HUSKY.wheel_radius))
    wheel = np.vstack([part.vertices for part in appearance.rover_wheel(HUSKY)])
    reach = HUSKY.wheel_radius * np.hypot(1.0, 0.09)
    assert np.hypot(*wheel[:, :2].T).max() == pytest.approx(reach)
    np.testing.assert_allclose(span(wheel)[:, 2], np.array([-0.53, 0.53]) * HUSKY.wheel_width)
    for part in (body, axles, *appearance.rover_wheel(HUSKY)):
        assert shapes.volume((part.vertices, part.faces)) > 0
