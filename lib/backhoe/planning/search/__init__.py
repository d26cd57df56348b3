"""Ways around obstacles: on grids, in the plane and for the arm."""

from __future__ import annotations

from backhoe.planning.search.arm_world import ArmWorld, Relief, few_spheres

__all__ = ["ArmWorld", "Relief", "few_spheres"]
