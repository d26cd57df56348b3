"""The exact shortest way in the plane, between bounds by another graph, and by hand."""

import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra

from backhoe.planning.search import NoPath, path_length, tangent

CORNERS = 64


def to_segments(middle, a, b):
    """Distance of a point to all segments from a to b, shape (n, 2) each."""
    way = b - a
    share = ((middle - a) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-300)
    return np.linalg.norm(a + np.clip(share, 0, 1)[:, None] * way - middle, axis=1)


def bound(start, goal, discs, rim, core):
    """Shortest way over places on circles of `rim` radii that keeps out of `core` radii."""
    angle = 2 * np.pi * np.arange(CORNERS) / CORNERS
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    places = np.vstack([start, goal, *[(x, y) + rim * r * circle for x, y, r in discs]])
    i, j = np.triu_indices(len(places), 1)
    a, b = places[i], places[j]
    free = np.ones(len(a), bool)
    for x, y, r in discs:
        free &= to_segments(np.array([x, y]), a, b) >= core * r - 1e-9
    lengths = np.zeros((len(places),) * 2)
    lengths[i[free], j[free]] = np.linalg.norm(b - a, axis=1)[free]
    return dijkstra(lengths, directed=False, indices=0)[1]


def test_it_lies_between_bounds_and_is_free():
    """Over rims a bit wide the ways are free and too long; over the rims, cores a bit small, all
    ways of the rubber band are there up to a corner, and none can be shorter by more than that."""
    rng = np.random.default_rng(0)
    start, goal, tried = np.zeros(2), np.array([10.0, 6.0]), 0
    widen = 1 / np.cos(np.pi / CORNERS)
    for _ in range(8):
        discs = np.column_stack(
            [rng.uniform(0, 10, 5), rng.uniform(0, 6, 5), rng.uniform(0.5, 2, 5)]
        )
        if (
            np.linalg.norm(discs[:, None, :2] - [start, goal], axis=-1) < discs[:, 2:] + 0.05
        ).any():
            continue
        length, path = tangent(start, goal, discs)
        assert length <= bound(start, goal, discs, widen, 1.0) + 1e-9
        assert length >= 0.999 * bound(start, goal, discs, 1.0, 1 / widen) - 0.1 * (1 - 1 / widen)
        assert path_length(path) == pytest.approx(length, rel=1e-4)
        assert path_length(path) <= length + 1e-9
        for x, y, r in discs:
            gap = to_segments(np.array([x, y]), path[:-1], path[1:]) - r
            assert gap.min() > -1e-4 * r
        tried += 1
    assert tried >= 3


def test_by_hand_around_a_disc_and_a_box():
    assert tangent([0, 0], [4, 0], [[2, 0, 1]]).length == pytest.approx(2 * 3**0.5 + np.pi / 3)
    box = [[1, -1], [2, -1], [2, 1.5], [1, 1.5]]
    assert tangent([0, 0], [4, 0], polygons=[box]).length == pytest.approx(2**0.5 + 1 + 5**0.5)
    turned = np.array(box)[::-1]
    assert tangent([0, 0], [4, 0], polygons=[turned]).length == pytest.approx(2**0.5 + 1 + 5**0.5)
    assert tangent([0, 0], [3, 4]).length == pytest.approx(5.0)
    assert tangent([0, 0], [3, 4]).path.tolist() == [[0, 0], [3, 4]]
    assert tangent([1, 1], [1, 1]).length == 0.0


def test_between_two_discs_it_changes_sides_along_the_crossed_tangent():
    """A belt that goes over the first and under the second disc."""
    discs = [[2.0, -0.6, 1.0], [6.0, 0.6, 1.0]]
    found = tangent([0, 0], [8, 0], discs)
    apart = np.hypot(4.0, 1.2)
    crossed = (apart**2 - 4) ** 0.5
    to_disc = (2.0**2 + 0.6**2 - 1) ** 0.5
    tilt = np.arctan2(1.2, 4.0) - np.arcsin(2 / apart)
    begins = np.arctan2(-0.6, 2.0) + np.arcsin(1 / np.hypot(2.0, 0.6))
    assert found.length == pytest.approx(crossed + 2 * (to_disc + begins - tilt))


def test_discs_that_overlap_and_boxes_beside_discs_leave_no_gap():
    one, two = [2.0, 0.6, 0.7], [2.0, -0.6, 0.7]
    alone = tangent([0, 0], [4, 0], [one, two])
    assert np.abs(alone.path[:, 1]).max() > 1.2
    box = [[1.5, -3], [2.5, -3], [2.5, 0.3], [1.5, 0.3]]
    beside = tangent([0, 0], [4, 0], [one], [box])
    assert beside.path[:, 1].max() > 1.2 and beside.length > alone.length - 1e-9
    touching = tangent([0, 0], [4, 0], [[2.0, 1.0, 1.0], [2.0, -1.0, 1.0]])
    assert touching.length == pytest.approx(4.0)


def test_of_two_arcs_between_the_same_places_the_short_one_is_drawn():
    found = tangent([1.0, 0.0], [-1.0, 0.3], [[0.0, 0.0, 1.0]])
    assert path_length(found.path) == pytest.approx(found.length, rel=1e-4)


def test_who_is_shut_in_has_no_way():
    angle = np.radians(60 * np.arange(6))
    ring = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), np.full(6, 1.05)])
    with pytest.raises(NoPath, match="shut"):
        tangent([0, 0], [9, 0], ring)
    assert tangent([0, 0], [9, 0], ring[:5]).length > 9


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"start": [2, 0]}, "start must be free"),
        ({"goal": [2, 0.5]}, "goal must be free"),
        ({"discs": [[2, 0, 0]]}, "least radius of discs must be one number above 0"),
        ({"discs": [[2, 0]]}, "discs must be middles and radii"),
        ({"polygons": [[[5, 5], [6, 5]]]}, r"polygons\[0\] must be convex"),
        ({"polygons": [[[5, 5], [7, 5], [6, 5.5], [6, 7]]]}, r"polygons\[0\] must be convex"),
        ({"goal": [np.inf, 0]}, "goal must be finite"),
    ],
)
def test_bad_input_is_named(changed, said):
    given = {"start": [0, 0], "goal": [4, 0], "discs": [[2, 0, 1]], "polygons": []}
    with pytest.raises(ValueError, match=said):
        tangent(**{**given, **changed})


def test_an_arc_under_another_disc_is_no_way():
    """A small disc sits on the large one, above and below: the way touches the small one alone,
    although both ends of the large one's arc can be reached."""
    discs = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.5], [0.0, -1.0, 0.5]]
    climb = np.arctan2(1, 2) + np.arcsin(0.5 / 5**0.5)
    found = tangent([-2, 0], [2, 0], discs)
    assert found.length == pytest.approx(2 * (5 - 0.25) ** 0.5 + 0.5 * 2 * climb)
