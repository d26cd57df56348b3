"""The small file that carries a `Recording` to the player.

Everything is rounded to fixed steps, stored as differences in variable-length integers and
compressed; the same recording gives the same bytes. `decode` reads them back here, `player/src/
format.js` in the page. Layout: gzip of [length of the header, uint32 little-endian][header, JSON]
[sections of integers, see `integer_codec`].
"""

from __future__ import annotations

import gzip
import json
import struct
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.view.replay.integer_codec import pack, unpack
from backhoe.view.replay.recording import HEIGHT_STEP, HeightField, Mesh, Morph, Node, Recording

ANGLE_STEP = 1e-4  # rad, and for the components of a quaternion
LENGTH_STEP = 1e-3  # m
TIME_STEP = 1e-3  # s
SCALAR_STEP = 1e-3  # of the scalar's unit

_VERSION = 1
_STEPS = {
    "revolute": (ANGLE_STEP,),
    "planar": (LENGTH_STEP, LENGTH_STEP, ANGLE_STEP),
    "free": (LENGTH_STEP,) * 3 + (ANGLE_STEP,) * 4,
}


def encode(recording: Recording) -> bytes:
    """The recording as compressed bytes; equal recordings give equal bytes.

    Raises:
        ValueError: a mesh or a transform has a wrong shape or a value that is not finite.
    """
    writer = _Writer()
    index = {node.name: i for i, node in enumerate(recording.nodes)}
    eye, target = ([round(float(x), 3) for x in point] for point in recording.camera)
    header = {
        "version": _VERSION,
        "times": writer.steps(recording.times, (TIME_STEP,), 2),
        "nodes": [_node(node, index, writer) for node in recording.nodes],
        "fields": [_field(ground, index, writer) for ground in recording.fields],
        "scalars": [
            {
                "name": s.name,
                "label": s.label,
                "unit": s.unit,
                "digits": s.digits,
                "values": writer.steps(s.values, (SCALAR_STEP,), 2),
            }
            for s in recording.scalars
        ],
        "lines": [
            {
                "points": writer.steps(line.points, (LENGTH_STEP,) * 3, 1),
                "colour": [round(float(c), 3) for c in line.colour],
            }
            for line in recording.lines
        ],
        "labels": [[round(float(t), 3), text] for t, text in recording.labels],
        "camera": {"eye": eye, "target": target},
        "follow": index.get(recording.follow, -1),
        "trail": index.get(recording.trail, -1),
    }
    header["sections"] = [len(section) for section in writer.sections]
    text = json.dumps(header, separators=(",", ":"), ensure_ascii=True).encode()
    body = struct.pack("<I", len(text)) + text + b"".join(writer.sections)
    return gzip.compress(body, compresslevel=9, mtime=0)


def decode(data: bytes) -> dict:
    """The header of an encoded recording with its sections put back as arrays.

    Returns:
        The header; wherever a section was named stands its array, `values`, `vertices` and the
        like with one column a coordinate; fields get `heights`, a list of (ny, nx) [m].

    Raises:
        ValueError: the bytes are not a recording of this version.
    """
    try:
        body = gzip.decompress(data)
        (length,) = struct.unpack_from("<I", body)
        header = json.loads(body[4 : 4 + length])
    except (OSError, EOFError, struct.error, ValueError) as error:
        raise ValueError(f"these bytes are not a replay recording: {error}") from None
    if header.get("version") != _VERSION:
        raise ValueError(f"recording version {header.get('version')!r}, expected {_VERSION}")
    bounds = 4 + length + np.concatenate([[0], np.cumsum(header.pop("sections"))])
    sections = [body[a:b] for a, b in pairwise(bounds)]

    def steps(entry: dict) -> NDArray:
        order = entry["order"]
        columns = [
            unpack(sections[i], order) * step
            for i, step in zip(entry["sections"], entry["steps"], strict=True)
        ]
        return columns[0] if len(columns) == 1 else np.column_stack(columns)

    header["times"] = steps(header["times"])
    for entry in header["nodes"] + header["scalars"]:
        if "values" in entry:
            entry["values"] = steps(entry["values"])
        for mesh in entry.get("meshes", ()):
            mesh["vertices"] = steps(mesh["vertices"])
            mesh["faces"] = unpack(sections[mesh["faces"]], 1).reshape(-1, 3)
    for line in header["lines"]:
        line["points"] = steps(line["points"])
    for entry in header["fields"]:
        _read_heights(entry, sections)
    return header


class _Writer:
    """Collects sections of integers and refers to them by position."""

    def __init__(self) -> None:
        self.sections: list[bytes] = []

    def integers(self, values: ArrayLike, order: int = 0) -> int:
        self.sections.append(pack(values, order))
        return len(self.sections) - 1

    def steps(self, values: ArrayLike, steps: tuple[float, ...], order: int) -> dict:
        columns = np.asarray(values, dtype=float).reshape(-1, len(steps)).T
        sections = [
            self.integers(np.rint(c / s), order) for c, s in zip(columns, steps, strict=True)
        ]
        return {"sections": sections, "steps": list(steps), "order": order}


def _matrix(T: ArrayLike) -> list[float]:
    T = numbers(T, "a node's transform", (4, 4))
    return [round(float(x), 6) + 0.0 for x in T[:3].ravel()]


def _mesh(mesh: Mesh | Morph, writer: _Writer) -> dict:
    shape = numbers(mesh.shapes if isinstance(mesh, Morph) else mesh.vertices, "vertices")
    faces = np.asarray(mesh.faces)
    if shape.shape[-1:] != (3,) or faces.ndim != 2 or faces.shape[1] != 3:
        raise ValueError(
            f"a mesh needs vertices (n, 3) and faces (m, 3), got {shape.shape} and {faces.shape}"
        )
    if faces.size and not 0 <= faces.min() <= faces.max() < shape.shape[-2]:
        raise ValueError(f"faces must index the {shape.shape[-2]} vertices of their mesh")
    header = {
        "vertices": writer.steps(shape, (LENGTH_STEP,) * 3, 1),
        "faces": writer.integers(faces, 1),
        "colour": [round(float(c), 3) for c in mesh.colour],
    }
    if isinstance(mesh, Morph):
        knots = [round(float(k), 4) for k in np.asarray(mesh.knots)]
        if shape.ndim != 3 or len(knots) != len(shape) or (np.diff(knots) <= 0).any():
            raise ValueError("a morph needs shapes (k, n, 3) and k rising knots")
        header |= {"scalar": mesh.scalar, "knots": knots}
    return header


def _node(node: Node, index: dict[str, int], writer: _Writer) -> dict:
    values = np.asarray(0.0 if node.values is None else node.values, dtype=float)
    if node.motion == "planar":
        values = np.column_stack([values[:, :2], np.unwrap(values[:, 2])])
    elif node.motion == "free":
        turns = np.where((np.diff(values[:, 3:], axis=0) ** 2).sum(axis=1) > 2, -1.0, 1.0)
        signs = np.concatenate([[1.0], np.cumprod(turns)])
        values = np.column_stack([values[:, :3], values[:, 3:] * signs[:, None]])
    header = {
        "name": node.name,
        "parent": -1 if node.parent is None else index[node.parent],
        "motion": node.motion,
        "before": _matrix(node.before),
        "after": _matrix(node.after),
        "meshes": [_mesh(mesh, writer) for mesh in node.meshes],
    }
    if node.motion in _STEPS:
        header["values"] = writer.steps(values, _STEPS[node.motion], 2)
    return header


def _field(ground: HeightField, index: dict[str, int], writer: _Writer) -> dict:
    cells = [np.diff(c, prepend=-1) - 1 for c, _ in ground.changes]
    deltas = [d for _, d in ground.changes]
    nothing = [np.zeros(0, dtype=np.int64)]
    return {
        "name": ground.name,
        "node": -1 if ground.node is None else index[ground.node],
        "bed": ground.bed,
        "shape": list(ground.first.shape),
        "cell": round(ground.cell, 6),
        "origin": [round(x, 6) for x in (*ground.origin, ground.level)],
        "step": HEIGHT_STEP,
        "first": writer.integers(ground.first, 1),
        "counts": writer.integers([len(c) for c in cells]),
        "gaps": writer.integers(np.concatenate(nothing + cells)),
        "deltas": writer.integers(np.concatenate(nothing + deltas)),
    }


def _read_heights(entry: dict, sections: list[bytes]) -> None:
    first = unpack(sections[entry.pop("first")], 1)
    counts, gaps, deltas = (unpack(sections[entry.pop(k)], 0) for k in ("counts", "gaps", "deltas"))
    ends = np.concatenate([[0], np.cumsum(counts)])
    frames = [first]
    for a, b in pairwise(ends):
        after = frames[-1].copy()
        after[np.cumsum(gaps[a:b] + 1) - 1] += deltas[a:b]
        frames.append(after)
    entry["heights"] = [f.reshape(entry["shape"]) * entry["step"] for f in frames]
