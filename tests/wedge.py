"""A second model of a blade in soil: trial wedges, one after the other, with forces as vectors.

No N factor is used: corners of the wedge, its area by the shoelace formula, the pulls on its sides
and ends, and the balance of forces in the plane (x ahead, z up) by a linear solve. The wedge that
needs the least force gives way.
"""

from math import cos, pi, sin, tan

import numpy as np


def trial(soil, depth, rake, width, surcharge, gravity, beta, slope=0.0):
    """Force of the blade on the wedge over the failure plane at beta, (ahead, up) [N].

    `slope` is how steeply the surface falls ahead [rad]. NaN where the wedge would lock.
    """
    fall = tan(slope)
    up_face = np.array([-cos(rake), sin(rake)])
    up_plane = np.array([cos(beta), sin(beta)])
    back = up_face * depth / (up_face[1] + fall * up_face[0])
    front = up_plane * depth / (up_plane[1] + fall * up_plane[0])
    area = 0.5 * abs(back[0] * front[1] - back[1] * front[0])
    face, plane = np.hypot(*back), np.hypot(*front)

    pull = np.array([0.0, -soil.density * gravity * area * width])
    pull += np.array([0.0, -surcharge * (front[0] - back[0]) * width])
    pull -= soil.cohesion * plane * width * up_plane
    pull -= soil.adhesion * face * width * up_face
    pull -= 2 * end_shear(soil, back, front, surcharge, gravity) * up_plane

    ahead_of_face = np.array([up_face[1], -up_face[0]])
    over_plane = np.array([-up_plane[1], up_plane[0]])
    delta, phi = soil.tool_friction, soil.friction
    blade = cos(delta) * ahead_of_face - sin(delta) * up_face
    ground = cos(phi) * over_plane - sin(phi) * up_plane
    pushes, carries = np.linalg.solve(np.column_stack([blade, ground]), -pull)
    if pushes < 0 or carries < 0:
        return np.full(2, np.nan)
    return pushes * blade - soil.adhesion * face * width * up_face


def end_shear(soil, back, front, surcharge, gravity, strips=500):
    """What one end of the wedge shears off with [N]: cohesion and friction of earth at rest.

    Strips of one depth, under a level surface (the two corners' mean height if it falls).
    """
    top = (back[1] + front[1]) / 2
    z = (np.arange(strips) + 0.5) * top / strips
    pressure = soil.density * gravity * (top - z) + surcharge
    side = (1 - sin(soil.friction)) * pressure
    length = (front[0] - back[0]) * z / top
    return ((soil.cohesion + side * tan(soil.friction)) * length).sum() * top / strips


def least(soil, depth, rake, width, surcharge, gravity, slope=0.0, count=150):
    """The wedge that gives way first: force on it (ahead, up) [N] and its beta [rad]."""
    lock = pi - rake - soil.friction - soil.tool_friction
    betas = np.linspace(0.02, lock - 0.02, count)
    settings = soil, depth, rake, width, surcharge, gravity
    forces = np.array([trial(*settings, beta, slope) for beta in betas])
    first = np.nanargmin(np.hypot(*forces.T))
    return forces[first], betas[first]
