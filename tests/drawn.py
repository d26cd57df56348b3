"""What a figure shows, read from its artists, beside what it was given to show.

A `Panel` lists everything that one pair of axes must hold: an artist that is missing, moved, has
its axes swapped or is one too many is a fault. `proofs` tries that on all drawing functions of a
module, and then on figures that it has spoilt, artist by artist: what no panel notices fails.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_rgb
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyBboxPatch
from matplotlib.path import Path
from matplotlib.transforms import IdentityTransform

MOST = 6
"""Artists of one kind in one panel that are spoilt: the first, the last and some between."""


class Item(NamedTuple):
    """Something drawn: its kind, numbers in the axes' units, and label or words, if it has any."""

    kind: str
    data: object
    label: str | None = None


@dataclass
class Panel:
    """What one pair of axes shows; `clipped` where a part of it lies outside the limits."""

    x: str
    y: str
    items: Sequence[Item]
    title: str = ""
    scales: tuple[str, str] = ("linear", "linear")
    clipped: bool = False


def line(x, y, label=None):
    """A line or markers through points, x and y of shape (n,) or numbers."""
    return Item("line", np.column_stack((np.atleast_1d(x), np.atleast_1d(y))).astype(float), label)


def track(points, label=None):
    """A line through points, shape (n, 2)."""
    return line(*np.asarray(points, dtype=float).T, label)


def level(y, label=None):
    """A horizontal line across the axes."""
    return line((0.0, 1.0), (y, y), label)


def upright(x):
    """A vertical line across the axes."""
    return line((x, x), (0.0, 1.0))


def shape(corners):
    """A filled outline, shape (n, 2)."""
    return Item("shape", _corners(np.asarray(corners, dtype=float)))


def box(x0, y0, x1, y1):
    """A filled rectangle; 0 and 1 where it spans the axes."""
    return shape([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def tunnel(x, low, high):
    """What `fill_between` fills."""
    return shape(np.r_[np.c_[x, low], np.c_[x, high]])


def ellipse(centre, width, height, angle=0.0, start=0.0, end=360.0):
    """An ellipse, circle or arc; angles in degrees."""
    return Item("ellipse", np.array([*centre, width, height, angle, start, end], dtype=float))


def words(text, at):
    """Words at a place; those of an annotation at the place it is about."""
    return Item("words", np.array([at], dtype=float), text)


def arrow(start, end):
    """An arrow between two places."""
    return Item("arrow", np.array([start, end], dtype=float))


def field(values: Callable, tolerance: float):
    """Contours of a function of x and y: the edges between two levels have such values."""
    known: dict[bytes, np.ndarray] = {}

    def remembered(x, y):
        place = x.tobytes() + y.tobytes()
        if place not in known:
            known[place] = np.asarray(values(x, y))
        return known[place]

    return Item("field", (remembered, tolerance))


def cells(x, y, values):
    """Coloured cells between edges x (n + 1,) and y (m + 1,), values (m, n)."""
    return Item("cells", np.concatenate([np.ravel(a) for a in (*np.meshgrid(x, y), values)]))


def picture(values, edges, limits):
    """A picture, values (rows, columns), between edges left, right, bottom, top; black, white."""
    return Item(
        "picture", np.concatenate([np.ravel(a).astype(float) for a in (edges, limits, values)])
    )


def part(draw: Callable) -> list[Item]:
    """What a drawing function of axes draws, as a part of more; it has a proof of its own."""
    ax = Figure().subplots()
    draw(ax)
    return [
        item._replace(label=item.label if item.kind == "words" else None) for _, item in read(ax)
    ]


def read(ax) -> Iterator[tuple[object, Item]]:
    """Each artist that can be seen in the axes, and what it shows."""
    for one in (*ax.images, *ax.lines, *ax.patches, *ax.collections, *ax.texts):
        if one.get_visible() and not (one in ax.lines and not len(one.get_xdata())):
            yield from ((one, item) for item in _items(ax, one))


def faults(fig: Figure, panels: Sequence[Panel]) -> list[str]:
    """In what the figure differs from the panels, in the order of its axes."""
    axes = [ax for ax in fig.axes if ax.get_label() != "<colorbar>" and ax.axison]
    if len(axes) != len(panels):
        return [f"{len(axes)} panels, not {len(panels)}"]
    found = []
    for number, (ax, panel) in enumerate(zip(axes, panels, strict=True)):
        found += [f"panel {number}: {fault}" for fault in _panel_faults(fig, ax, panel)]
    return found


def alike(fig: Figure) -> list[str]:
    """Curves in one pair of axes that only their colour tells apart, and what is black too often.

    Curves differ in marker, dashes, width or clearly in their grey; one black look stands for one
    truth. Clouds of dots are too small for a shape.
    """
    found = []
    for number, ax in enumerate(fig.axes):
        named = [one for one in ax.lines if one.get_visible() and one.get_label()[:1] != "_"]
        named = [one for one in named if one.get_linestyle() != "None" or one.get_markersize() > 2]
        for one, other in combinations(named, 2):
            if one.get_label() == other.get_label():
                continue
            if _plain(one) == _plain(other) and abs(_grey(one) - _grey(other)) < 0.15:
                found.append(f"panel {number}: {one.get_label()!r} and {other.get_label()!r}")
        black = {one.get_label() for one in named if _grey(one) < 0.15}
        if len(black) > 1:
            found.append(f"panel {number}: {sorted(black)} are black")
    return found


def _plain(curve) -> tuple:
    dashes = curve._unscaled_dash_pattern  # what a dash tuple became
    line = curve.get_linestyle() != "None" and round(curve.get_linewidth())
    return str(curve.get_marker()), str(dashes), line


def _grey(curve) -> float:
    shown = curve.get_color() if curve.get_linestyle() != "None" else curve.get_markerfacecolor()
    return float(np.dot(to_rgb(shown), (0.299, 0.587, 0.114))) if shown != "none" else 1.0


def _panel_faults(fig, ax, panel) -> Iterator[str]:
    for name in ("xlabel", "ylabel", "title"):
        shown, wanted = getattr(ax, f"get_{name}")(), getattr(panel, name.removesuffix("label"))
        if name == "title":
            shown = shown or ax.get_title(loc="left")
        if shown != wanted:
            yield f"{name} {shown!r}, not {wanted!r}"
    if (ax.get_xscale(), ax.get_yscale()) != panel.scales:
        yield f"scales {ax.get_xscale()}, {ax.get_yscale()}"
    left = [item for _, item in read(ax)]
    for wanted in sorted(panel.items, key=lambda item: item.label is None):
        match = next((k for k, item in enumerate(left) if _same(item, wanted)), None)
        if match is None:
            yield f"no {wanted}"
        else:
            del left[match]
    yield from (f"unexpected {item}" for item in left)
    legends = [*fig.legends, *(a.get_legend() for a in fig.axes if a.get_legend())]
    named = {text.get_text() for legend in legends for text in legend.get_texts()}
    labels = {item.label for item in panel.items if item.kind == "line"} - {None}
    if lost := {label for label in labels if label[0] != "_"} - named:
        yield f"not in the legend: {sorted(lost)}"
    if not panel.clipped:
        low, high = np.sort([ax.get_xlim(), ax.get_ylim()], axis=1).T
        for item in panel.items:
            if item.kind == "line":
                outside = (item.data < low - 1e-9) | (item.data > high + 1e-9)
                if outside[:, 1].any() or (outside[:, 0].any() and ax.name != "polar"):
                    yield f"outside the limits: {item}"


def _same(item: Item, wanted: Item) -> bool:
    if item.kind != wanted.kind or (wanted.label is not None and item.label != wanted.label):
        return False
    if item.kind == "field":
        values, tolerance = wanted.data
        return all(
            (low - tolerance <= values(*at)).all() and (values(*at) <= high + tolerance).all()
            for low, high, at in item.data
            if at.size
        )
    one, other = np.asarray(item.data), np.asarray(wanted.data)
    return one.shape == other.shape and np.allclose(one, other, 1e-9, 1e-9, equal_nan=True)


def _corners(vertices: np.ndarray) -> np.ndarray:
    return np.unique(np.round(vertices, 9) + 0.0, axis=0)


def _items(ax, one) -> Iterator[Item]:
    if one in ax.images:
        yield picture(one.get_array(), one.get_extent(), one.get_clim())
    elif one in ax.lines:
        yield Item("line", np.asarray(one.get_xydata(), dtype=float), one.get_label())
    elif isinstance(one, Ellipse):
        spans = getattr(one, "theta1", 0.0), getattr(one, "theta2", 360.0)
        yield ellipse(one.get_center(), one.get_width(), one.get_height(), one.get_angle(), *spans)
    elif isinstance(one, FancyBboxPatch):
        x, y = one.get_x(), one.get_y()
        yield box(x, y, x + one.get_width(), y + one.get_height())
    elif one in ax.patches:
        yield shape(one.get_path().transformed(one.get_patch_transform()).vertices)
    elif isinstance(one, ContourSet):
        levels = one.levels if one.filled else np.column_stack((one.levels, one.levels))
        spans = pairwise(levels) if one.filled else levels
        if one.filled and one.extend in ("max", "both"):
            spans = [*spans, (levels[-1], np.inf)]
        paths = zip(spans, one.get_paths(), strict=True)
        yield Item("field", [(*span, path.vertices.T) for span, path in paths])
    elif isinstance(one, QuadMesh):
        corners = np.moveaxis(np.asarray(one.get_coordinates()), -1, 0)
        values = np.ma.filled(np.ma.asarray(one.get_array(), dtype=float), np.nan)
        yield Item(
            "cells", np.concatenate([corners[0].ravel(), corners[1].ravel(), values.ravel()])
        )
    elif one in ax.collections:
        yield from (shape(path.vertices) for path in one.get_paths())
    elif getattr(one, "arrow_patch", None) is not None and not one.get_text():
        yield arrow(one.xyann, one.xy)
    else:
        yield words(one.get_text(), getattr(one, "xy", one.get_position()))


def survivors(fig: Figure, panels: Sequence[Panel]) -> tuple[int, list[str]]:
    """How often the figure was spoilt, and the spoilt artists that no panel noticed."""
    tried, unnoticed = 0, []
    assert not faults(fig, panels)
    axes = [ax for ax in fig.axes if ax.get_label() != "<colorbar>" and ax.axison]
    for number, ax in enumerate(axes):
        step = 0.03 * np.ptp(ax.get_ylim())
        spoils = {
            "moved": lambda points, step=step: np.add(points, (0.0, step)),
            "swapped": lambda points: points[:, ::-1],
        }
        for one in _some(ax):
            before = [item for of, item in read(ax) if of is one]
            for name, change in spoils.items():
                mend = _spoil(ax, one, change)
                after = [item for of, item in read(ax) if of is one]
                changed = not all(map(_alike, after, before))
                if changed:
                    tried += 1
                    noticed = any(_panel_faults(fig, ax, panels[number]))
                    unnoticed += [] if noticed else [f"{number} {name}: {before}"]
                mend()
            one.set_visible(False)
            tried += 1
            noticed = any(_panel_faults(fig, ax, panels[number]))
            unnoticed += [] if noticed else [f"{number} gone: {before}"]
            one.set_visible(True)
    return tried, unnoticed


def _some(ax) -> list[object]:
    kinds: dict[str, list[object]] = {}
    for one, item in read(ax):
        of_kind = kinds.setdefault(item.kind, [])
        if one not in of_kind:
            of_kind.append(one)
    picked = [
        {round(k) for k in np.linspace(0, len(found) - 1, min(len(found), MOST))}
        for found in kinds.values()
    ]
    return [
        one
        for found, numbers in zip(kinds.values(), picked, strict=True)
        for k, one in enumerate(found)
        if k in numbers
    ]


def _alike(item: Item, other: Item) -> bool:
    if item.kind != "field":
        return _same(item, other)
    pairs = zip(item.data, other.data, strict=True)
    return all(a[2].shape == b[2].shape and np.allclose(a[2], b[2]) for a, b in pairs)


def _spoil(ax, one, change: Callable) -> Callable[[], None]:
    """Change the points (n, 2) of an artist; returns what mends it."""
    if one in ax.lines:
        before = one.get_data()
        one.set_data(*change(np.column_stack(before).astype(float)).T)
        return lambda: one.set_data(*before)
    if one in ax.images:
        before = one.get_array()
        one.set_data(np.roll(before, 1, axis=int(change(np.eye(2))[0, 0] == 0)))
        return lambda: one.set_data(before)
    if one in ax.texts:
        about = hasattr(one, "xy")
        before = one.xy if about else one.get_position()
        put = (lambda at: setattr(one, "xy", at)) if about else one.set_position
        put(tuple(change(np.array([before], dtype=float))[0]))
        return lambda: put(before)
    if isinstance(one, QuadMesh):
        before = one.get_array()
        one.set_array(np.roll(before, 1, axis=int(change(np.eye(2))[0, 0] == 0)))
        return lambda: one.set_array(before)
    if one in ax.collections:
        before = one.get_paths()
        spoilt = [Path(change(p.vertices) if len(p) else p.vertices, p.codes) for p in before]
        Collection.set_paths(one, spoilt)
        return lambda: Collection.set_paths(one, before)
    if isinstance(one, Ellipse):
        before = one.get_center()
        one.set_center(change(np.array([before], dtype=float))[0])
        return lambda: one.set_center(before)
    if isinstance(one, FancyBboxPatch):
        before = one.get_x(), one.get_y()
        put = lambda at: (one.set_x(at[0]), one.set_y(at[1]))  # noqa: E731
        put(change(np.array([before]))[0])
        return lambda: put(before)
    path = one.get_path().transformed(one.get_patch_transform())
    spoilt = Path(change(path.vertices), path.codes)
    one.get_path, one.get_patch_transform = (lambda: spoilt), IdentityTransform

    def mend() -> None:
        del one.get_path, one.get_patch_transform

    return mend


def proofs(module: object, cases: dict[str, Callable]) -> type:
    """A class of tests for the drawing functions of a module.

    Args:
        module: whose public functions each need a case.
        cases: name of a function, and a word behind it for a second case -> function that gives its
            figure and the panels that this must have.
    """

    class Proofs:
        def test_what_is_drawn_is_what_was_given(self):
            found = [
                f"{name}, {fault}" for name, case in cases.items() for fault in faults(*case())
            ]
            assert not found, "\n".join(found)

        def test_a_spoilt_figure_is_noticed(self):
            for name, case in cases.items():
                tried, unnoticed = survivors(*case())
                assert tried >= 3 and not unnoticed, (name, tried, unnoticed)

        def test_curves_are_told_apart_without_colour(self):
            found = [
                f"{name}, {fault}" for name, case in cases.items() for fault in alike(case()[0])
            ]
            assert not found, "\n".join(found)

        def test_every_drawing_function_has_its_case(self):
            without = set(drawing_functions(module)) - {name.split()[0] for name in cases}
            assert not without, without

    return Proofs


def drawing_functions(module: object) -> list[str]:
    """Names of a module's public functions that give a figure or draw into axes."""
    functions = {
        name: inspect.signature(thing)
        for name, thing in vars(module).items()
        if inspect.isfunction(thing) and name[0] != "_"
    }
    own = getattr(module, "__name__", "").rpartition(".")[0] or ""
    return [
        name
        for name, signature in functions.items()
        if vars(module)[name].__module__.startswith(own)
        and (
            signature.return_annotation in (Figure, "Figure")
            or any(p.annotation in (Axes, "Axes") for p in signature.parameters.values())
        )
    ]
