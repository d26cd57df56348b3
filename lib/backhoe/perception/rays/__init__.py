"""Rays against ground and bodies, without PyBullet: what lasers and cameras see.

- `caster`: heightmaps, bodies, and the casting of many rays
- `tree`: boxes over a body's triangles
- `loops`: a ray's way, `raster`: what a camera's pixels see, written once
- `engine`: the same, compiled
"""

from backhoe.perception.rays.caster import Body, HeightField, Hits, RayCaster

__all__ = ["Body", "HeightField", "Hits", "RayCaster"]
