"""The self filter's volumes hold the links as they are drawn, closely."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.perception import cloud
from backhoe.simulation.volumes import link_volumes
from backhoe.view.appearance import visuals

ARM = ("boom", "stick", "bucket")


def outside(points, link, volumes, padding=1e-6):
    return cloud.self_filter(points, {link: volumes[link]}, {link: np.eye(4)}, padding)


@pytest.mark.parametrize("link", ARM)
@pytest.mark.parametrize("slices", [1, 3, 8])
def test_no_point_of_a_links_surface_is_outside(link, slices):
    rng = np.random.default_rng(0)
    corners = np.concatenate([part.vertices[part.faces] for part in visuals()[link]])
    shares = rng.dirichlet(np.ones(3), (40, len(corners)))
    surface = np.einsum("ktc,tcx->ktx", shares, corners).reshape(-1, 3)
    assert not outside(surface, link, link_volumes(slices=slices)).any()


def size(link, volumes):
    corners = np.concatenate([part.vertices for part in visuals()[link]])
    low, high = corners.min(0), corners.max(0)
    points = np.random.default_rng(1).uniform(low, high, (50_000, 3))
    return np.prod(high - low) * (~outside(points, link, volumes, 0.0)).mean()


def test_slices_lie_closer_around_the_bent_boom_than_one_hull():
    one, eight = (size("boom", link_volumes(slices=n)) for n in (1, 8))
    assert eight < 0.5 * one


def test_other_links_can_be_asked_for_and_bad_ones_are_refused():
    assert set(link_volumes(links=("swing", "undercarriage"))) == {"swing", "undercarriage"}
    with pytest.raises(ValueError, match="links must be among"):
        link_volumes(links=("cab",))
    with pytest.raises(ValueError, match="slices"):
        link_volumes(slices=0)
    with pytest.raises(TypeError, match="machine"):
        link_volumes("backhoe")
