"""What the shared figures show is what they were given; the arm is where its kinematics say."""

import re
from importlib import import_module
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE
from backhoe.view import plots
from backhoe.view.plots import drawing, way
from backhoe.whole_body import stability
from drawn import (
    Panel,
    arrow,
    box,
    drawing_functions,
    ellipse,
    level,
    line,
    part,
    proofs,
    read,
    shape,
    track,
    words,
)

T = np.array([0.0, 0.5, 1.5, 2.0])
Q = np.radians([-50.0, 15.0, -10.0, 40.0])
RUN = np.array([[-1.5, 0.2, -0.4, 0.9], [-1.2, 0.3, -0.5, 1.0]] * 2) * T[:, None]
DRIVE = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.5], [2.0, 1.0, 1.0], [2.2, 2.5, 1.6]])
OTHER = DRIVE[:, :2] + (0.3, -0.2)
NAMES = ("swing", "boom", "stick", "bucket")
REACH, HEIGHT = "distance from the swing axis [m]", "height above the ground [m]"
AHEAD, LEFT = "forward $x$ [m]", "left $y$ [m]"
GAUGE, LENGTH, SHOE = (getattr(BACKHOE.tracks, n) for n in ("gauge", "length", "shoe_width"))


def joints(q):
    """Boom's, stick's and bucket's joint and the teeth, in the base frame, shape (4, 3) [m]."""
    frames = ("swing", "boom", "stick", "tip")
    return np.array([kinematics.forward_kinematics(q, frame)[:3, 3] for frame in frames])


def in_plane(points):
    """Distance from the swing axis and height."""
    return np.c_[np.hypot(points[:, 0] - BACKHOE.base.offset, points[:, 1]), points[:, 2]]


def tracks():
    return [
        box(-LENGTH / 2, s - SHOE / 2, LENGTH / 2, s + SHOE / 2) for s in (-GAUGE / 2, GAUGE / 2)
    ]


def posture_panels():
    limits = (-3.0, 9.6, -5.4, 9.4)
    arm = part(lambda ax: drawing.draw_arm(ax, Q))
    side = arm + part(lambda ax: drawing.side_axes(ax, limits))
    above = part(lambda ax: drawing.draw_from_above(ax, Q))
    return [
        Panel(REACH, HEIGHT, side, "from the side"),
        Panel(AHEAD, LEFT, above, "from above"),
    ]


def tracking():
    panels = [
        Panel(
            "time [s]" if name == "bucket" else "",
            f"{name} [deg]",
            [line(T, np.degrees(q), "measured"), line(T, np.degrees(q) + 2, "wanted")],
        )
        for name, q in zip(NAMES, RUN.T, strict=True)
    ]
    return plots.joint_tracking(T, RUN, RUN + np.radians(2.0)), panels


def scenes():
    given = {"one": {"path": DRIVE[:, :2], "a": OTHER}, "two": {"path": OTHER, "b": DRIVE}}
    panels = [
        Panel("$x$ [m]", "$y$ [m]", [track(np.array(p)[:, :2], n) for n, p in lines.items()]
              + [track([(0.5, 0.7)], "goal")], title)
        for title, lines in given.items()
    ]  # fmt: skip
    return plots.from_above(given, marks={"goal": [(0.5, 0.7)]}), panels


def chart():
    front = np.array([[9e3, np.nan], [4e3, 2.5e3]])
    side = np.array([[8e3, 3e3], [np.nan, 2.2e3]])
    heights, radii = np.array([3.0, 0.0]), np.array([4.0, 6.0])
    never = np.zeros((2, 2), bool)
    given = stability.LiftingChart(radii, heights, front, side, never, front < 3e3)
    panels = []
    for over, texts in (
        ("front", {"9.0": (4, 3), "4.0": (4, 0), "2.5": (6, 0)}),
        ("side", {"8.0": (4, 3), "3.0": (6, 3), "2.2*": (6, 0)}),
    ):
        arm = part(lambda ax: drawing.draw_arm(ax, Q))
        sides = (-2.6, 7.0, -0.8, 4.0), BACKHOE, over
        scenery = part(lambda ax, sides=sides: drawing.side_axes(ax, *sides))
        items = [*arm, *scenery, *(words(text, at) for text, at in texts.items())]
        title = f"rated load over the {over} [t]"
        panels.append(Panel(REACH, HEIGHT, items, title, clipped=True))
    return plots.lifting_chart(given, Q), panels


def stood():
    corners = stability.support_polygon(BACKHOE)
    places = {"empty": (0.2, 0.9), "full": (0.3, 1.2)}
    above = part(lambda ax: drawing.draw_from_above(ax, Q))
    items = [*above, shape(corners), shape(corners)]
    items += [track([at], label) for label, at in places.items()]
    return plots.balance(Q, places), [Panel(AHEAD, LEFT, items, clipped=True)]


def mapped():
    half, high = way._WIDTH / 2, way._HEIGHT / 2
    items = part(lambda ax: None)
    for name, (x, y) in way._PLACES.items():
        items.append(box(x - half, y - high, x + half, y + high))
        items += [words(plots.STAGES[name], (x, y + 0.11))]
        items += [words(name.replace("_", " "), (x, y - 0.14))]
    ends = [
        ((half, 1), (1 - half, 1)), ((1 + half, 1), (2 - half, 1)), ((2 + half, 1), (3 - half, 1)),
        ((3, 1 - high), (3, high)), ((3 - half, 0), (2 + half, 0)),
        ((0.75, high), (0.25, 1 - high)), ((1.75, high), (0.4, 1 - high)),
        ((2.75, -high), (1.25, -high)), ((-0.1, high), (-0.1, 1 - high)),
    ]  # fmt: skip
    items += [arrow(*pair) for pair in ends]
    fig = plots.data_way("arm")
    fig.axes[0].set_axis_on()
    return fig, [Panel("", "", items)]


def margins():
    distance = np.array([0.9, 0.8, 0.4, 0.6])
    items = [box(0, -0.2, 1, 0.0), level(0.0), line(T, distance), line(1.6, 0.37)]
    items += [words("0.37 m at 1.6 s", (1.6, 0.37))]
    fig = plots.margin(T, distance, 0.37, 1.6)
    return fig, [Panel("time [s]", "margin to the edge [m]", items)]


def curves():
    fig = plots.lines(
        T, {"a": T**2, "b": T[:3] + 0.2}, "time [s]", "angle [rad]", title="two", ylim=(-1, 5)
    )
    items = [line(T, T**2, "a"), line(T[:3], T[:3] + 0.2, "b")]
    return fig, [Panel("time [s]", "angle [rad]", items, "two")]


def rows():
    fig = plots.stacked(T, {"v [m/s]": {"is": T + 1, "told": T}, "F [N]": {"left": -(T**2)}})
    upper = Panel("", "v [m/s]", [line(T, T + 1, "is"), line(T, T, "told")])
    return fig, [upper, Panel("time [s]", "F [N]", [line(T, -(T**2), "left")])]


def headed():
    fig = plots.paths({"a": DRIVE, "b": np.add(DRIVE, (0.3, -0.2, 0.1))}, marks=2, title="there")
    items = [track(OTHER, "b"), track(DRIVE[:, :2], "a")]
    items += [track([points[k]]) for points in (DRIVE[:, :2], OTHER) for k in (0, -1)]
    return fig, [Panel("$x$ [m]", "$y$ [m]", items, "there")]


def axes_with(draw, items, x="", y="", **panel):
    fig = Figure()
    draw(fig.subplots())
    return fig, [Panel(x, y, items, **panel)]


def drawn_lines():
    items = [line(T, T**2, "a"), line(T[:2], T[:2], "b")]
    fig, panels = axes_with(lambda ax: plots.draw_lines(ax, T, {"a": T**2, "b": T[:2]}), items)
    fig.axes[0].legend()
    return fig, panels


def three_angles():
    """The stick's line and its centre of mass are where the forward kinematics put them."""
    _, elbow, pin, _ = at = in_plane(joints(Q))
    mass = in_plane(kinematics.forward_kinematics(Q, "stick_com")[None, :3, 3])[0]
    way = {"before": elbow - at[0], "star": pin - elbow, "mass": mass - elbow}
    slope = {name: np.arctan2(line[1], line[0]) for name, line in way.items()}
    slope["zero"] = slope["star"] - Q[2]

    def ray(name, length, label):
        end = elbow + length * np.array([np.cos(slope[name]), np.sin(slope[name])])
        return track([elbow, end], label)

    items = part(lambda ax: drawing.draw_arm(ax, Q))
    limits = (elbow[0] - 3.4, elbow[0] + 3.4, elbow[1] - 2.9, elbow[1] + 2.3)
    items += part(lambda ax: drawing.side_axes(ax, limits))
    items += [
        ray("before", 3.0, "line before"), ray("zero", 2.6, "$q_3=0$"),
        ray("star", 2.6, "to the next joint"),
        track([elbow, mass]), track([mass], "centre of mass"),
    ]  # fmt: skip
    for start, end, size, name in (
        ("before", "star", 1.9, "$q_3^*$"), ("zero", "star", 1.35, "$q_3$"),
        ("before", "mass", 0.8, "$q_3^{cm}$"),
    ):  # fmt: skip
        low, high = np.sort((slope[start], slope[end]))
        items.append(ellipse(elbow, 2 * size, 2 * size, 0, *np.degrees((low, high))))
        middle, away = (low + high) / 2, size + 0.22
        items.append(words(name, elbow + away * np.array([np.cos(middle), np.sin(middle)])))
    return plots.joint_angles(Q), [Panel(REACH, HEIGHT, items, clipped=True)]


TestPlots = proofs(
    plots,
    {
        "balance": stood,
        "data_way": mapped,
        "draw_lines": drawn_lines,
        "from_above": scenes,
        "joint_angles": three_angles,
        "joint_tracking": tracking,
        "lifting_chart": chart,
        "lines": curves,
        "margin": margins,
        "paths": headed,
        "posture": lambda: (plots.posture(Q), posture_panels()),
        "stacked": rows,
    },
)


def test_the_links_are_drawn_between_their_joints_in_the_plane_of_the_arm():
    ax = Figure().subplots()
    drawing.draw_arm(ax, Q)
    at = in_plane(joints(Q))
    (pins,) = ax.lines
    np.testing.assert_allclose(pins.get_xydata(), at[:3], atol=1e-12)
    boom, stick, bucket = (patch.get_xy() for patch in ax.patches)
    for outline, start, end in ((boom, *at[:2]), (stick, *at[1:3])):
        along = (end - start) / np.linalg.norm(end - start)
        way, aside = (outline - start) @ along, (outline - start) @ (-along[1], along[0])
        assert abs(way.min()) < 1e-9
        assert np.linalg.norm(end - start) < way.max() < np.linalg.norm(end - start) + 0.2
        assert abs(aside.min() + aside.max()) < 1e-9 and 0.1 < aside.max() < 0.5
    np.testing.assert_allclose(bucket[0], at[3], atol=1e-12)
    assert np.linalg.norm(bucket - at[2], axis=1).min() < 0.2


def test_from_above_the_links_lie_where_the_kinematics_say_on_tracks_of_the_machine():
    ax = Figure().subplots()
    drawing.draw_from_above(ax, Q)
    at = joints(Q)[:, :2]
    items = [item for _, item in read(ax)]
    links = np.array([item.data for item in items if item.kind == "line"][:3])
    np.testing.assert_allclose(links, np.stack((at[:-1], at[1:]), axis=1), atol=1e-12)
    np.testing.assert_allclose(ax.lines[3].get_xydata(), [(BACKHOE.base.offset, 0.0)])
    shown = [item.data for item in items if item.kind == "shape"]
    np.testing.assert_allclose(shown[0], tracks()[0].data)
    np.testing.assert_allclose(shown[1], tracks()[1].data)
    assert shown[2][:, 0].max() == LENGTH / 2 + 0.6 and np.ptp(shown[2][:, 1]) == 0.7


def test_the_machine_stands_on_the_ground_seen_from_its_side_and_from_its_ends():
    for over, wide in (("front", LENGTH), ("side", GAUGE + SHOE)):
        ax = Figure().subplots()
        drawing.side_axes(ax, (-3.0, 9.0, -2.0, 6.0), BACKHOE, over)
        ground, *shoes, house = [item.data for _, item in read(ax) if item.kind == "shape"]
        assert ground[:, 1].tolist() == [-2.0, 0.0, -2.0, 0.0]
        shoes = np.concatenate(shoes)
        np.testing.assert_allclose(np.ptp(shoes, axis=0), (wide, BACKHOE.tracks.height), atol=1e-9)
        middle = -BACKHOE.base.offset if over == "front" else 0.0
        np.testing.assert_allclose((shoes[:, 0].min() + shoes[:, 0].max()) / 2, middle, atol=1e-9)
        assert shoes[:, 1].min() == 0.0 and abs(house[0, 0] + 2.0) < 1e-9
        assert abs(house[:, 1].min() - BACKHOE.base.height + 0.2) < 1e-9
        assert (*ax.get_xlim(), *ax.get_ylim()) == (-3.0, 9.0, -2.0, 6.0)
        assert ax.lines[0].get_ydata()[0] == 0.0 and ax.get_aspect() == 1.0


def test_the_lit_parts_of_the_map_are_those_asked_for():
    for lit in ((), "vehicle", ("arm", "planning"), "tour"):
        colours = {patch.get_facecolor() for patch in plots.data_way(lit).axes[0].patches}
        names = set(plots.STAGES) if lit == "tour" else {lit} if isinstance(lit, str) else set(lit)
        bold = {t.get_text() for t in plots.data_way(lit).axes[0].texts if t.get_weight() == "bold"}
        assert bold == {plots.STAGES[name] for name in names}
        assert len(colours) == (1 if not names or lit == "tour" else 2)


def test_every_lesson_has_proofs_of_its_figures():
    root = Path(__file__).resolve().parents[2]
    rooms = sorted(path for path in (root / "lib/backhoe/lessons").iterdir() if path.is_dir())
    drawing = 0
    for room in rooms:
        texts = [p.read_text() for p in (root / "tests/lessons" / room.name).glob("test_drawn*.py")]
        for path in (*room.glob("figures.py"), *room.glob("figures/[a-z]*.py")):
            name = ".".join(path.relative_to(root / "lib").with_suffix("").parts)
            for function in drawing_functions(import_module(name)):
                drawing += 1
                assert any(re.search(rf"\b{function}\b", text) for text in texts), (name, function)
    assert drawing > 60
