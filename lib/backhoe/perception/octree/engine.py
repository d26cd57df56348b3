"""The loops of `rays`, `nodes`, `queries` and `stream`, compiled on first use and kept on disk."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.octree import nodes, queries, rays, stream

(
    mark,
    update,
    update_rays,
    look_up,
    list_leaves,
    cast,
    write_all,
    write_binary,
    read_all,
    read_binary,
    finish,
    *_,
) = compiled(
    rays.mark,
    nodes.update,
    nodes.update_rays,
    queries.look_up,
    queries.list_leaves,
    queries.cast,
    stream.write_all,
    stream.write_binary,
    stream.read_all,
    stream.read_binary,
    stream.finish,
    rays.index,
    rays.centre,
    rays.spread,
    rays.place,
    rays.brick_key,
    rays.brick_of,
    rays.cut,
    rays.first_border,
    rays.ray,
    nodes.octant,
    nodes.take,
    nodes.cut_off,
    nodes.opened,
    nodes.settle,
    nodes.find,
    nodes.read_brick,
    nodes.alike,
    nodes.write_brick,
    queries.mean_of,
)
