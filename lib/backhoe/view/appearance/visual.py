"""What a picture is made of: a mesh of one colour, and a hydraulic cylinder between two links."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import NDArray

from backhoe.view.shapes import Mesh, join

Colour = tuple[float, float, float, float]
YELLOW: Colour = (0.96, 0.71, 0.08, 1.0)
DARK: Colour = (0.17, 0.18, 0.20, 1.0)
RUBBER: Colour = (0.10, 0.10, 0.11, 1.0)
STEEL: Colour = (0.46, 0.47, 0.49, 1.0)
GLASS: Colour = (0.42, 0.60, 0.68, 1.0)
SOIL: Colour = (0.52, 0.40, 0.28, 1.0)
BLUE: Colour = (0.15, 0.33, 0.53, 1.0)
LIGHT: Colour = (0.88, 0.89, 0.87, 1.0)


@dataclass(frozen=True)
class Visual:
    """A mesh of one colour: vertices (n, 3) [m], faces (m, 3), rgba in 0..1."""

    vertices: NDArray
    faces: NDArray
    colour: Colour


@dataclass(frozen=True)
class Strut:
    """A hydraulic cylinder between a point of one link's frame and a point of another's, (3,) [m].

    The barrel lies along +x from `base`, the rod along -x from `tip`: place each at its point with
    x in the direction from `base` to `tip`.
    """

    base_link: str
    base: NDArray
    tip_link: str
    tip: NDArray
    barrel: Visual
    rod: Visual


def visual(colour: Colour, *meshes: Mesh) -> Visual:
    """Several meshes in one colour."""
    return Visual(*join(*meshes), colour)
