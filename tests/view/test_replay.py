"""The replay: what is recorded comes back, in few and always the same bytes."""

import re
from dataclasses import replace as variant
from hashlib import sha256
from html.parser import HTMLParser
from importlib.resources import files
from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.arm import kinematics
from backhoe.arm.kinematics import link_transforms
from backhoe.machine import BACKHOE, JOINTS
from backhoe.simulation.soil.terrain import Terrain
from backhoe.view import appearance, replay
from backhoe.view.replay import stage
from backhoe.view.replay.integer_codec import pack, unpack
from backhoe.view.replay.recording import (
    HEIGHT_STEP,
    HeightField,
    Line,
    Mesh,
    Morph,
    Node,
    Recording,
    Scalar,
)
from backhoe.view.replay.recording_file import (
    ANGLE_STEP,
    LENGTH_STEP,
    SCALAR_STEP,
    TIME_STEP,
    decode,
    encode,
)

TRIANGLE = Mesh([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
SAID = {"title": "wave", "alt": "The arm waves."}


def cells(terrain):
    """The grid of a terrain with heights of its own that a test may change."""
    grid = {name: getattr(terrain, name) for name in ("floor", "cell", "origin")}
    return SimpleNamespace(heights=terrain.heights.copy(), **grid)


class SmallWorld:
    """A stand-in for a simulation: joints that move, a ground that is dug, a bed that fills."""

    def __init__(self, seed=0, shape=(40, 50)):
        rng = np.random.default_rng(seed)
        self.machine, self.scene, self.time = BACKHOE, None, 0.0
        self.q, self.pose = np.zeros(4), np.zeros(3)
        self.rng = rng
        self.ground = SimpleNamespace(
            terrain=cells(Terrain(0.1 * rng.random(shape), 0.08, (3.0, -2.0))),
            bed=cells(Terrain.bed((0.0, 4.0), 1.2, 0.8, 1.1, 1.9)),
            bucket_volume=0.0,
            truck_volume=0.0,
        )

    def step(self, dt=0.01):
        self.time += dt
        self.q = np.sin(self.time * np.array([0.3, 0.5, 0.7, 0.9]))
        self.pose = np.array([0.2 * self.time, 0.0, 0.4 * self.time])
        row, column = self.rng.integers(0, 30, 2)
        self.ground.terrain.heights[row : row + 6, column : column + 6] -= 0.01
        self.ground.bed.heights[4:8, 4:9] += 0.001
        self.ground.bucket_volume = 0.1 * self.time
        self.ground.truck_volume = 0.05 * self.time


def recorded(world, seconds, rate=30.0):
    recorder = replay.Recorder(world, rate=rate)
    recorder.capture()
    for _ in range(round(seconds / 0.01)):
        world.step()
        recorder.capture()
    return recorder


def waving(frames=40, **more):
    times = np.arange(frames) / 20
    q = np.sin(times[:, None] * [0.3, 0.5, 0.7, 0.9])
    return replay.from_joints(times, q, **(SAID | more))


def node(header, name):
    return next(entry for entry in header["nodes"] if entry["name"] == name)


def poses_of(header, name, frame):
    """Pose of a node, by the rule before @ motion @ after up the tree, from decoded values."""
    entry = node(header, name)

    def rows(twelve):
        return np.vstack([np.reshape(twelve, (3, 4)), [0, 0, 0, 1]])

    moved = np.eye(4)
    if entry["motion"] == "revolute":
        c, s = np.cos(entry["values"][frame]), np.sin(entry["values"][frame])
        moved[:2, :2] = [[c, -s], [s, c]]
    elif entry["motion"] == "planar":
        x, y, yaw = entry["values"][frame]
        moved[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        moved[:2, 3] = x, y
    T = rows(entry["before"]) @ moved @ rows(entry["after"])
    if entry["parent"] < 0:
        return T
    return poses_of(header, header["nodes"][entry["parent"]]["name"], frame) @ T


@pytest.mark.parametrize("order", [0, 1, 2])
def test_packed_integers_come_back(order):
    rng = np.random.default_rng(1)
    for scale in (1, 60, 5000, 10**8):
        values = rng.integers(-scale, scale + 1, 300)
        assert np.array_equal(unpack(pack(values, order), order), values)
    assert unpack(pack([], order), order).size == 0


def test_small_integers_take_one_byte_each():
    assert len(pack(np.arange(-64, 64))) == 128
    assert len(pack(np.arange(1000), order=2)) == 1000


def test_what_cannot_be_packed_is_refused():
    with pytest.raises(ValueError, match="only whole numbers"):
        pack([0.5])
    with pytest.raises(ValueError, match="within 32 bits"):
        pack([2**40])
    with pytest.raises(ValueError, match="middle of a number"):
        unpack(b"\x80")


def test_every_sample_comes_back_to_half_a_step():
    rng = np.random.default_rng(2)
    times = np.cumsum(rng.uniform(0.01, 0.1, 50)) + 7
    angles = np.cumsum(rng.normal(0, 0.1, 50))
    planar = np.cumsum(rng.normal(0, 0.1, (50, 3)), axis=0)
    turn = rng.normal(size=(50, 4))
    free = np.column_stack([planar, turn / np.linalg.norm(turn, axis=1)[:, None]])
    points = rng.normal(size=(9, 3))
    header = decode(
        encode(
            Recording(
                times,
                (
                    Node("base", None, "planar", planar, meshes=(TRIANGLE,)),
                    Node("arm", "base", "revolute", angles),
                    Node("stone", None, "free", free),
                ),
                scalars=(Scalar("load", angles, "load", "t"),),
                lines=(Line(points),),
            )
        )
    )
    assert np.abs(header["times"] - times).max() <= TIME_STEP / 2 + 1e-12
    assert np.abs(node(header, "arm")["values"] - angles).max() <= ANGLE_STEP / 2 + 1e-12
    assert np.abs(node(header, "base")["values"][:, :2] - planar[:, :2]).max() <= LENGTH_STEP / 2
    assert np.abs(header["scalars"][0]["values"] - angles).max() <= SCALAR_STEP / 2 + 1e-12
    assert np.abs(header["lines"][0]["points"] - points).max() <= LENGTH_STEP / 2 + 1e-12
    assert np.array_equal(node(header, "base")["meshes"][0]["vertices"], TRIANGLE.vertices)
    assert np.array_equal(node(header, "base")["meshes"][0]["faces"], TRIANGLE.faces)
    stone = node(header, "stone")["values"][:, 3:]
    same_turn = np.abs((stone * free[:, 3:]).sum(axis=1))
    assert np.abs(same_turn - 1).max() < 1e-3
    assert (np.sum(np.diff(stone, axis=0) ** 2, axis=1) <= 2 + 1e-3).all()


def test_lengths_are_kept_to_a_millimetre_and_angles_to_a_ten_thousandth():
    rng = np.random.default_rng(5)
    poses = rng.uniform(-3.0, 3.0, (200, 3))
    poses[:, 2] = np.unwrap(poses[:, 2])
    header = decode(encode(Recording(np.arange(200.0), (Node("base", None, "planar", poses),))))
    away = np.abs(node(header, "base")["values"] - poses).max(axis=0)
    assert (away <= [0.501e-3, 0.501e-3, 0.501e-4]).all()


def test_yaw_does_not_jump_where_it_wraps():
    yaw = np.linspace(3.0, 3.4, 9)
    wrapped = (yaw + np.pi) % (2 * np.pi) - np.pi
    planar = np.column_stack([yaw * 0, yaw * 0, wrapped])
    header = decode(encode(Recording(np.arange(9.0), (Node("base", None, "planar", planar),))))
    assert np.abs(np.diff(node(header, "base")["values"][:, 2])).max() < 0.06


def test_heights_come_back_without_drift():
    rng = np.random.default_rng(3)
    heights = rng.normal(size=(20, 30))
    field = HeightField("ground", heights, 0.1, (1.0, 2.0))
    truth = [heights.copy()]
    for _ in range(200):
        heights += 0.0007 * rng.normal(size=heights.shape) * (rng.random(heights.shape) < 0.1)
        field.append(heights)
        truth.append(heights.copy())
    recording = Recording(np.arange(201.0), (), fields=(field,))
    shown = np.array(decode(encode(recording))["fields"][0]["heights"])
    assert np.abs(shown - truth).max() <= HEIGHT_STEP / 2 + 1e-9
    assert np.array_equal(shown[77], field.heights(77))


@pytest.mark.parametrize("name, frame", [("boom", "boom"), ("stick", "stick"), ("bucket", "tip")])
def test_the_drawn_links_are_where_forward_kinematics_puts_them(name, frame):
    rng = np.random.default_rng(4)
    machine = variant(BACKHOE, stick=variant(BACKHOE.stick, length=2.5))
    q = rng.uniform(machine.lower, machine.upper, (20, 4))
    shown = replay.from_joints(np.arange(20.0), q, machine=machine, **SAID)
    header = decode(shown.to_bytes())
    for i in range(20):
        expected = kinematics.forward_kinematics(q[i], frame=frame, machine=machine)
        assert np.abs(poses_of(header, name, i) - expected).max() < 2e-3


def test_a_driven_base_carries_the_arm():
    q = np.full((3, 4), 0.2)
    poses = [[0, 0, 0], [1, 2, 0.5], [2, 3, 1.0]]
    header = decode(replay.from_joints([0, 1, 2], q, poses=poses, **SAID).to_bytes())
    start = kinematics.forward_kinematics(q[0], frame="tip")[:3, 3]
    c, s = np.cos(0.5), np.sin(0.5)
    expected = [1 + c * start[0] - s * start[1], 2 + s * start[0] + c * start[1], start[2]]
    assert poses_of(header, "bucket", 1)[:3, 3] == pytest.approx(expected, abs=2e-3)


def test_the_drawn_load_encloses_the_volume_that_it_stands_for():
    shell = BACKHOE.shell
    load = stage.load_in_bucket(shell)
    empty, faces = load.shapes[0], load.faces
    assert load.knots[0] == 0 and (np.diff(load.knots) > 0).all()
    for volume, top in zip(load.knots, load.shapes, strict=True):
        low, high = empty[faces], top[faces]
        (ax, az), (bx, bz) = (low[:, k, ::2].T - low[:, 0, ::2].T for k in (1, 2))
        area = np.abs(ax * bz - az * bx) / 2
        drawn = (area * (low[..., 1] - high[..., 1]).mean(axis=1)).sum()
        assert drawn == pytest.approx(volume, abs=0.03 * shell.struck_capacity)
    assert shell.struck_capacity == pytest.approx(load.knots[8], rel=0.03)


def test_the_same_run_gives_the_same_bytes_and_the_same_page():
    first, second = (recorded(SmallWorld(), 2.0).replay(**SAID) for _ in range(2))
    assert first.to_bytes() == second.to_bytes()
    assert first._repr_html_() == second._repr_html_()
    assert recorded(SmallWorld(seed=1), 2.0).replay(**SAID).to_bytes() != first.to_bytes()


def test_recorder_keeps_its_rate_and_the_last_moment():
    world = SmallWorld()
    recorder = replay.Recorder(world, rate=20)
    kept = [recorder.capture()]
    for _ in range(203):
        world.step()
        kept.append(recorder.capture())
    assert sum(kept) == 41
    shown = recorder.replay(**SAID)
    assert shown.frame_count == 42
    assert shown.duration == pytest.approx(2.03)
    assert decode(shown.to_bytes())["times"][-1] == pytest.approx(2.03)


def test_recorder_sees_joints_ground_bed_and_volumes():
    world = SmallWorld()
    recorder = recorded(world, 1.0)
    recorder.label("the end")
    header = decode(recorder.replay(**SAID).to_bytes())
    ground, bed = header["fields"]
    assert not ground["bed"] and bed["bed"]
    assert ground["heights"][-1] == pytest.approx(world.ground.terrain.heights, abs=HEIGHT_STEP)
    load = np.zeros(world.ground.bed.heights.shape)
    load[4:8, 4:9] = 0.1
    assert bed["heights"][-1] == pytest.approx(load, abs=HEIGHT_STEP)
    assert bed["origin"][2] == pytest.approx(1.1)
    assert node(header, "boom")["values"][-1] == pytest.approx(world.q[1], abs=ANGLE_STEP)
    assert node(header, "undercarriage")["values"][-1] == pytest.approx(world.pose, abs=1e-3)
    assert [s["values"][-1] for s in header["scalars"]] == pytest.approx([0.1, 0.05], abs=1e-3)
    assert header["labels"] == [[1.0, "the end"]]


def test_recorder_without_soil_shows_no_readouts():
    world = SmallWorld()
    world.ground = None
    recorder = replay.Recorder(world)
    recorder.capture()
    header = decode(recorder.replay(**SAID).to_bytes())
    assert header["scalars"] == header["fields"] == []


def test_a_minute_of_digging_stays_under_a_megabyte():
    """Forty percent of the time a 15-cell edge digs, and avalanches follow it."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[0:175, 0:161] * 0.08
    heights = np.maximum(0, 1 - np.hypot(x - 9, y - 6.4) / 2.5) + 0.02 * rng.random(x.shape)
    field = HeightField("ground", heights, 0.08, (-3.0, -6.4))
    frames = 60 * 30
    for frame in range(1, frames):
        if frame % 450 < 180:
            row, column = 70 + 8 * (frame // 450), 140 - (frame % 450) // 6
            heights[row : row + 15, column : column + 3] -= rng.uniform(0, 0.02, (15, 3))
            slope = (slice(row - 6, row + 21), slice(column - 6, column + 12))
            heights[slope] += rng.normal(0, 0.003, (27, 18))
        field.append(heights)
    q = np.cumsum(rng.normal(0, 0.003, (frames, 4)), axis=0)
    times = np.arange(frames) / 30
    nodes = stage.machine_nodes(q, np.zeros((frames, 3)), BACKHOE) + stage.strut_nodes(q, BACKHOE)
    shown = replay.Replay(Recording(times, nodes, fields=(field,)), **SAID)
    assert shown.duration > 59.9
    assert sum(len(cells) for cells, _ in field.changes) > 200_000
    assert shown.size < 1_000_000


def test_cylinders_point_from_their_mount_to_where_they_push():
    q = np.random.default_rng(4).uniform(BACKHOE.lower, BACKHOE.upper, (20, 4))
    frames = dict(zip(JOINTS, np.moveaxis(link_transforms(q), -3, 0), strict=True))
    nodes = {node.name: node for node in stage.strut_nodes(q, BACKHOE)}
    assert len(nodes) == 2 * len(appearance.struts())
    for number, strut in enumerate(appearance.struts()):
        mount = frames[strut.base_link] @ [*strut.base, 1.0]
        push = frames[strut.tip_link] @ [*strut.tip, 1.0]
        along = (push - mount)[:, :3] / np.linalg.norm(push - mount, axis=1)[:, None]
        for part, start in (("barrel", mount), ("rod", push)):
            node = nodes[f"{part} {number}"]
            cosine, sine = np.cos(node.values), np.sin(node.values)
            zero = np.zeros_like(cosine)
            x_axis = np.stack([cosine, sine, zero, zero], axis=-1)
            T = frames[node.parent] @ node.before
            np.testing.assert_allclose((T @ x_axis[..., None])[:, :3, 0], along, atol=1e-12)
            np.testing.assert_allclose(T[:, :, 3], start, atol=1e-12)


def test_text_says_what_happens():
    assert repr(waving()) == "Replay: wave, 1.9 s at 20 frames/s. The arm waves."
    assert repr(waving(1)) == "Replay: wave, 0.0 s at 0 frames/s. The arm waves."


class Frames(HTMLParser):
    def __init__(self):
        super().__init__()
        self.frames, self.text = [], []

    def handle_starttag(self, tag, attrs):
        if tag == "iframe":
            self.frames.append(dict(attrs))

    def handle_data(self, data):
        self.text.append(data)


def test_notebook_gets_a_sandboxed_page_that_names_no_other_host():
    shown = waving(title="up & <down>", alt='It says "hello".')
    parsed = Frames()
    parsed.feed(shown._repr_html_())
    (frame,) = parsed.frames
    assert frame["sandbox"] == "allow-scripts"
    assert frame["title"] == 'up & <down>: 3D replay. It says "hello".'
    assert frame["srcdoc"] == shown.page()
    assert repr(shown) in "".join(parsed.text)
    assert not re.search(r"https?://|\bsrc=|\bhref=|@import", shown.page())
    assert "<title>up &amp; &lt;down&gt;</title>" in shown.page()


def test_payloads_can_be_told_by_their_first_letters():
    short = re.sub(r"H4sI[A-Za-z0-9+/]{64,}={0,2}", "gzip", waving()._repr_html_())
    assert short.count("gzip&lt;/script") == 2
    assert len(short) < 3500


def test_page_can_be_saved(tmp_path):
    shown = waving()
    path = shown.save_html(tmp_path / "wave.html")
    assert path.read_text(encoding="utf-8") == shown.page()


def test_player_is_in_the_package_and_small():
    player = (files("backhoe") / "view" / "player" / "player.js").read_bytes()
    notice = player[:250].decode()
    assert "three.js" in notice and "MIT" in notice
    assert len(waving(2).page()) < 250_000


def test_player_was_built_from_its_sources():
    """`sh build.sh` writes their digest into the first line of player.js."""
    folder = files("backhoe") / "view" / "player"
    sources = sorted((folder / "src").iterdir(), key=lambda path: path.name)
    sources += [folder / "package.json", folder / "package-lock.json"]
    digest = sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    assert f"Sources {digest}." in (folder / "player.js").read_text(encoding="utf-8")[:250]


def test_lock_file_names_no_host():
    lock = (files("backhoe") / "view" / "player" / "package-lock.json").read_text(encoding="utf-8")
    assert "://" not in lock and '"integrity"' in lock


@pytest.mark.parametrize(
    "times, q, message",
    [
        ([], np.zeros((0, 4)), r"times must have shape \(n,\)"),
        ([0, 1, 1], np.zeros((3, 4)), "times must rise: 1.0 s at index 1"),
        ([0, 2, 1], np.zeros((3, 4)), "times must rise"),
        ([0, np.nan], np.zeros((2, 4)), "times must be finite"),
        ([0, 1], np.zeros((3, 4)), r"q must be swing, .* shape \(2, 4\), got shape \(3, 4\)"),
        ([0, 1], np.zeros((2, 3)), r"q must be swing, .* shape \(2, 4\), got shape \(2, 3\)"),
        ([0, 1], [[0] * 4, [0, np.nan, 0, 0]], "must be finite"),
        ([0, 1], np.full((2, 4), 1j), "q must be numbers"),
        ("ab", np.zeros((2, 4)), "times must be numbers"),
    ],
)
def test_bad_motions_are_refused(times, q, message):
    with pytest.raises(ValueError, match=message):
        replay.from_joints(times, q, **SAID)


@pytest.mark.parametrize(
    "more, message",
    [
        ({"poses": np.zeros((4, 2))}, r"poses must be x, y, yaw .* shape \(40, 3\)"),
        ({"poses": np.full((40, 3), np.inf)}, r"poses must be finite, got inf at index \(0, 0\)"),
        ({"bucket": np.zeros(7)}, r"scalar 'bucket' must have shape \(40,\)"),
        ({"alt": " "}, "needs a title and an alt text"),
        ({"title": ""}, "needs a title and an alt text"),
        ({"poster": 9.0}, r"poster must be one number at least 0 and at most 1.95 \[s\]"),
        ({"poster": np.nan}, "poster must be one number"),
    ],
)
def test_bad_extras_are_refused(more, message):
    with pytest.raises(ValueError, match=message):
        waving(**more)


def test_bad_scenes_are_refused():
    times = [0.0, 1.0]
    field = HeightField("ground", np.zeros((3, 3)), 0.1, (0, 0))
    morph = Morph("load", [0, 1], np.zeros((2, 3, 3)), [[0, 1, 2]])
    for nodes, more, message in [
        ((Node("a", "b"),), {}, "'a' comes before its parent 'b'"),
        ((Node("a"), Node("a")), {}, "two nodes are called 'a'"),
        ((Node("a", motion="slides"),), {}, "motion of 'a' must be one of"),
        ((Node("a", motion="revolute"),), {}, "motion of 'a' must be numbers, got None"),
        ((Node("a", meshes=(morph,)),), {}, "unknown scalar 'load'"),
        ((), {"fields": (field,)}, "'ground' has 1 frames, the times have 2"),
        ((), {"trail": "tip"}, "there is no node 'tip'"),
    ]:
        with pytest.raises(ValueError, match=message):
            Recording(times, nodes, **more)


@pytest.mark.parametrize(
    "broken, message",
    [
        (Node("a", before=np.eye(3)), r"transform must have shape \(4, 4\)"),
        (Node("a", after=np.full((4, 4), np.nan)), "transform must be finite"),
        (Node("a", meshes=(Mesh([[0.0, 0]], [[0, 0, 0]]),)), r"vertices \(n, 3\) and faces"),
        (Node("a", meshes=(Mesh([[0.0, 0, 0]], [[0, 0, 1]]),)), "index the 1 vertices"),
        (Node("a", meshes=(Mesh([[0.0, 0, np.nan]], [[0, 0, 0]]),)), "must be finite"),
    ],
)
def test_broken_meshes_and_transforms_are_refused(broken, message):
    with pytest.raises(ValueError, match=message):
        encode(Recording([0.0], (broken,)))


def test_broken_heights_are_refused():
    field = HeightField("ground", np.zeros((3, 3)), 0.1, (0, 0))
    with pytest.raises(ValueError, match=r"must have shape \(3, 3\), got shape \(2, 3\)"):
        field.append(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="must be finite"):
        field.append(np.full((3, 3), np.nan))
    with pytest.raises(ValueError, match="within 98 m"):
        field.append(np.full((3, 3), 100.0))
    with pytest.raises(ValueError, match=r"must have shape \(ny, nx\)"):
        HeightField("ground", np.zeros(3), 0.1, (0, 0))


def test_recorder_refuses_a_world_that_went_wrong():
    world = SmallWorld()
    recorder = replay.Recorder(world)
    with pytest.raises(ValueError, match="nothing was recorded"):
        recorder.replay(**SAID)
    recorder.capture()
    world.time, world.q = 1.0, np.full(4, np.nan)
    with pytest.raises(ValueError, match=r"the simulation.s q at 1.0 s must be finite"):
        recorder.capture()
    world.time = -1.0
    with pytest.raises(ValueError, match="start a new Recorder after a reset"):
        recorder.capture()
    for rate in (0, -5, np.nan, np.inf):
        with pytest.raises(ValueError, match="rate must be one number above 0"):
            replay.Recorder(world, rate=rate)


def test_other_bytes_are_not_a_recording():
    for data in (b"", b"not gzip", waving().to_bytes()[:-20]):
        with pytest.raises(ValueError, match="not a replay recording"):
            decode(data)
