"""The loops of `loops`, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.planning.dmp import loops

reach, kernels, weighed, products, mixed, differences, wanted, parabolas, follow = compiled(
    loops.reach,
    loops.kernels,
    loops.weighed,
    loops.products,
    loops.mixed,
    loops.differences,
    loops.wanted,
    loops.parabolas,
    loops.follow,
)
