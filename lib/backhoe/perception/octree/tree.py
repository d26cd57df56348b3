"""A map of occupied, free and unknown space that keeps up with what is seen."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, flag, number, numbers, positive, whole
from backhoe.perception.octree import files, stream
from backhoe.perception.octree.log_odds import HIT, L_MAX, L_MIN, MISS
from backhoe.perception.octree.nodes import DEPTH, SPARE
from backhoe.perception.octree.rays import MIDDLE

RULES = ("scan", "voxels", "rays")
"""How a scan counts; see `OccupancyOctree.insert_scan`."""

POLICIES = ("max", "mean")
"""What a larger voxel says of the smaller ones in it: eq. (5.5), eq. (5.4)."""

LARGEST = 1 << 24
"""Blocks that a map may have: 1 GiB."""

FEW_BRICKS, MOST_BRICKS = 1 << 11, 1 << 23
"""Bricks of 8 x 8 x 8 voxels that there is room for at first, and at most: 1.2 GiB for one scan."""

CORRUPT = {
    stream.TRUNCATED: "ends before its last node",
    stream.TOO_DEEP: f"has a node more than {DEPTH} levels deep",
    stream.EMPTY_NODE: "has an inner node without children",
    stream.LEFT_OVER: "goes on after its last node",
}


class Leaves(NamedTuple):
    """Cubes that are known and not divided.

    Attributes:
        centres: shape (n, 3) [m].
        sizes: edges, shape (n,) [m].
        log_odds: shape (n,) [1]; 0 or more is occupied.
    """

    centres: NDArray
    sizes: NDArray
    log_odds: NDArray


class Met(NamedTuple):
    """Where rays end.

    Attributes:
        points: middles of the last voxels, shape (n, 3) [m].
        states: 1 for occupied, 0 for free up to the range, -1 for unknown, shape (n,) [1].
    """

    points: NDArray
    states: NDArray


class OccupancyOctree:
    """Log-odds of being occupied for each voxel that a ray passed or hit.

    Source: Mastalli 2013, section 5.4.2, eqs. (5.2) to (5.6); the same as OctoMap's, number for
    number, with the same arguments.

    Args:
        resolution: edge of the smallest voxels [m].
        hit, miss: what a reflection adds, and a ray that passes, log-odds [1], eq. (5.6).
        l_min, l_max: between which the sum is kept, log-odds [1], eq. (5.3).

    Raises:
        ValueError: a resolution, a hit or l_max that is not above 0, a miss or l_min not below 0.
    """

    def __init__(
        self,
        resolution: float,
        *,
        hit: float = HIT,
        miss: float = MISS,
        l_min: float = L_MIN,
        l_max: float = L_MAX,
    ) -> None:
        self.resolution = positive(resolution, "resolution", "m")
        self.hit, self.l_max = positive(hit, "hit"), positive(l_max, "l_max")
        self.miss, self.l_min = number(miss, "miss", below=0.0), number(l_min, "l_min", below=0.0)
        self._odds = [np.float32(x) for x in (self.miss, self.hit, self.l_min, self.l_max)]
        self._bricks = FEW_BRICKS
        self._start(64)

    @property
    def size(self) -> int:
        """Number of nodes, inner ones too."""
        return int(np.count_nonzero(~np.isnan(self._value[: self._books[0]])))

    @property
    def memory(self) -> int:
        """What its nodes take, those in reserve too [bytes]."""
        return self._value.nbytes + self._child.nbytes

    def insert_scan(
        self,
        points: ArrayLike,
        origin: ArrayLike,
        max_range: float | None = None,
        *,
        rule: str = "scan",
    ) -> None:
        """Add a scan: its points are hit, and what lies between them and the sensor is free.

        Args:
            points: where rays were reflected, in single precision, shape (n, 3) [m].
            origin: of the rays, shape (3,) [m].
            max_range: rays to points beyond only free space, up to there [m]; None for no limit.
            rule: "scan" tells a voxel once, a hit before any miss; "voxels" also sends one ray
                to each voxel that has points, to its middle; "rays" tells a voxel as often as
                rays pass or hit it, in their order.

        Raises:
            ValueError: no points, not finite or outside the map, another rule, or so long rays that
                memory would not hold the voxels; then nothing of the scan is inserted.
        """
        points = self._inside(points, "points")
        origin = self._inside(
            numbers(origin, "origin", (3,), meaning="a point [m]")[None], "origin"
        )[0]
        max_range = np.inf if max_range is None else positive(max_range, "max_range", "m")
        if choice(rule, "rule", RULES) == "voxels":
            points = self._middles(points)
        from backhoe.perception.octree import engine

        how = points, origin, self.resolution, max_range
        scan = self._touched(*how)
        insert, total = engine.update, len(scan[0])
        if rule == "rays":
            longest = min(np.linalg.norm(points - origin, axis=1).max(), max_range)
            room = _room(int(2 * longest / self.resolution / 8) + 8)
            scan, insert, total = (*how, room), engine.update_rays, len(points)
        done = 0
        while True:
            done = insert(self._value, self._child, self._books, done, *scan, *self._odds)
            if done == total:
                return
            self._grow()

    def log_odds(self, points: ArrayLike, depth: int = DEPTH, policy: str = "max") -> NDArray:
        """Log-odds of the voxels that have these points, NaN where unknown.

        Args:
            points: shape (..., 3) [m].
            depth: 16 for the smallest voxels; each less doubles their edge.
            policy: "max", eq. (5.5), or "mean", eq. (5.4), of the smaller voxels in it;
                unknown ones count 0 in the mean.

        Returns:
            Shape (...) [1].

        Raises:
            ValueError: points of another shape, not finite or outside the map, another policy, or
                a depth that is not from 0 to 16.
        """
        points = numbers(points, "points", (..., 3), meaning="coordinates [m]")
        depth = whole(depth, "depth", least=0, most=DEPTH)
        mean = choice(policy, "policy", POLICIES) == "mean"
        found = np.empty(points.size // 3, np.float32)
        if points.size:
            from backhoe.perception.octree import engine

            keys = self._keys(self._inside(points.reshape(-1, 3), "points"))
            engine.look_up(self._value, self._child, keys, depth, mean, found)
        return found.reshape(points.shape[:-1]).astype(float)

    def leaves(self, depth: int = DEPTH, box: ArrayLike | None = None) -> Leaves:
        """The cubes that make up known space, none smaller than those of a depth.

        Args:
            depth: as for `log_odds`; a cube cut there has the largest log-odds in it.
            box: lowest and highest corner, shape (2, 3) [m]; only cubes that touch it; None: all.

        Raises:
            ValueError: a depth that is not from 0 to 16; a box outside the map, or whose corners
                are the wrong way round.
        """
        depth = whole(depth, "depth", least=0, most=DEPTH)
        low, high = np.zeros(3, np.int64), np.full(3, 2 * MIDDLE - 1)
        if box is not None:
            low, high = self._keys(self._inside(numbers(box, "box", (2, 3)), "box"))
            if (low > high).any():
                raise ValueError(f"box must have its lowest corner first, got {box}")
        from backhoe.perception.octree import engine

        limits = self._value, self._child, depth, low, high
        keys, depths, odds = np.empty((0, 3), np.int64), np.empty(0, np.int64), np.empty(0, "f4")
        count = engine.list_leaves(*limits, keys, depths, odds)
        keys, depths, odds = (
            np.empty((count, 3), np.int64),
            np.empty(count, np.int64),
            np.empty(count, "f4"),
        )
        engine.list_leaves(*limits, keys, depths, odds)
        edges = 1 << (DEPTH - depths)
        centres = (keys - MIDDLE + edges[:, None] / 2) * self.resolution
        return Leaves(centres, edges * self.resolution, odds.astype(float))

    def bounds(self) -> NDArray:
        """Lowest and highest corner of what is known, shape (2, 3) [m]; NaN for an empty map."""
        centres, sizes, _ = self.leaves()
        if not len(sizes):
            return np.full((2, 3), np.nan)
        half = sizes[:, None] / 2
        return np.array([(centres - half).min(axis=0), (centres + half).max(axis=0)])

    def cast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        max_range: float | None = None,
        *,
        through_unknown: bool = False,
    ) -> Met:
        """What rays meet in the map: the first voxel that is occupied, or unknown.

        Args:
            origins: shape (n, 3) [m].
            directions: of any length but 0, shape (n, 3) [1].
            max_range: where a ray ends in free space [m]; None for the edge of the map.
            through_unknown: whether rays go on through unknown voxels.

        Raises:
            ValueError: shapes that differ, values not finite, origins outside, a direction 0.
        """
        origins = self._inside(origins, "origins").astype(float)
        directions = numbers(directions, "directions", origins.shape)
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        if (lengths == 0).any():
            raise ValueError("directions must not be 0: a ray must lead somewhere")
        max_range = np.inf if max_range is None else positive(max_range, "max_range", "m")
        from backhoe.perception.octree import engine

        ends, met = np.empty(origins.shape), np.empty(len(origins), np.int64)
        tree, through = (self._value, self._child), flag(through_unknown, "through_unknown")
        engine.cast(
            *tree, origins, directions / lengths, self.resolution, max_range, through, ends, met
        )
        return Met(ends, met)

    def prune(self) -> None:
        """Make one leaf of eight equal ones, everywhere; insertion does where it changes some."""
        self._rebuild(*self._nodes(), prune=True)

    def save(self, path: str | Path) -> None:
        """Write the map for OctoMap's tools and for `load`.

        Args:
            path: ends in `.ot`, which keeps all log-odds, or in `.bt`, which keeps of each leaf
                only whether it is occupied or free, and is much smaller.

        Raises:
            ValueError: another ending; a `.bt` of a map that is one leaf as a whole.
            TypeError: what is no path.
        """
        tree = self
        if files.suffix_of(path) == ".bt":
            tree = OccupancyOctree(self.resolution, l_min=self.l_min, l_max=self.l_max)
            odds, children = self._nodes()
            tree._rebuild(np.where(odds >= 0, 1, -1).astype("f4"), children, prune=True)
            if tree.size == 1:
                raise ValueError(".bt cannot say that all space is the same: save it as .ot")
        files.write(
            path, files.Content(self.resolution, tree.size, tree._data(files.suffix_of(path)))
        )

    @classmethod
    def load(cls, path: str | Path, **arguments: float) -> OccupancyOctree:
        """The map in a file of OctoMap's or of `save`.

        Args:
            path: ends in `.ot` or `.bt`; leaves of the latter get l_max and l_min.
            arguments: hit, miss, l_min and l_max of the new map, as for the class.

        Raises:
            ValueError: another kind of file or tree, a file that is cut short, damaged or longer
                than it says, or too large; memory is only taken for what is there.
        """
        suffix, name = files.suffix_of(path), Path(path).name
        resolution, size, data = files.read(path, LARGEST * (5 if suffix == ".ot" else 2))
        tree = cls(resolution, **arguments)
        if size == 0:
            return tree
        if suffix == ".ot":
            nodes = np.frombuffer(data, files.FULL)
            odds, children = nodes["odds"].astype("f4"), nodes["children"].copy()
            if not np.isfinite(odds).all():
                raise ValueError(f"{name} is damaged: it has log-odds that are not finite")
            state, count = tree._rebuild(odds, children)
        else:
            if len(data) % 2:
                raise ValueError(f"{name} is cut short or damaged: it has half a node at its end")
            state, count = tree._from_binary(np.frombuffer(data, "<u2").astype(np.int64))
        if state != stream.WHOLE:
            raise ValueError(f"{name} is damaged: it {CORRUPT[state]}")
        if count != size:
            raise ValueError(f"{name} is damaged: it claims {size} nodes and has {count}")
        return tree

    def _start(self, blocks: int) -> None:
        """Forget all and take room for that many blocks."""
        self._value = np.full((blocks, 8), np.nan, np.float32)
        self._child = np.zeros((blocks, 8), np.int32)
        self._books = np.array([1, 0])

    def _grow(self) -> None:
        """Half as many blocks more."""
        more = len(self._value) // 2 + 2 * SPARE
        self._value = np.concatenate((self._value, np.full((more, 8), np.nan, np.float32)))
        self._child = np.concatenate((self._child, np.zeros((more, 8), np.int32)))

    def _touched(self, *how: object) -> tuple[NDArray, ...]:
        """Bricks that a scan touches, their voxels' bits; ValueError where memory is too small."""
        from backhoe.perception.octree import engine

        while self._bricks <= MOST_BRICKS:
            room = _room(self._bricks)
            if engine.mark(*how, 0, *room) == len(how[0]):
                bricks, _, free, hit, (count,) = room
                blocks = self._books[0] + 9 * count + np.count_nonzero(free | hit) + SPARE
                if blocks <= LARGEST:
                    return bricks[:count], free, hit
                break
            self._bricks *= 4
        self._bricks = FEW_BRICKS
        raise ValueError(
            f"points must not be so far that their rays pass more voxels of {self.resolution} m "
            f"than memory holds: give a max_range, or insert fewer at once"
        )

    def _nodes(self) -> tuple[NDArray, NDArray]:
        """The nodes of `.ot`, in order."""
        from backhoe.perception.octree import engine

        odds, children = np.empty(self.size, np.float32), np.empty(self.size, np.uint8)
        if self.size:
            engine.write_all(self._value, self._child, odds, children)
        return odds, children

    def _rebuild(self, odds: NDArray, children: NDArray, prune: bool = False) -> tuple[int, int]:
        """Become the tree of these nodes."""
        from backhoe.perception.octree import engine

        self._start(1 + np.count_nonzero(children))
        if not len(odds):
            return stream.WHOLE, 0
        state = engine.read_all(self._value, self._child, self._books, odds, children)
        self._finish(prune)
        return state

    def _from_binary(self, words: NDArray) -> tuple[int, int]:
        from backhoe.perception.octree import engine

        self._start(1 + len(words))
        odds = np.float32(self.l_min), np.float32(self.l_max)
        state = engine.read_binary(self._value, self._child, self._books, words, *odds)
        self._finish(False)
        return state

    def _finish(self, prune: bool) -> None:
        from backhoe.perception.octree import engine

        books = self._books if prune else np.empty(0, np.int64)
        engine.finish(self._value, self._child, self._books[0], books)

    def _data(self, suffix: str) -> bytes:
        from backhoe.perception.octree import engine

        if not self.size:
            return b""
        if suffix == ".ot":
            odds, children = self._nodes()
            nodes = np.empty(len(odds), files.FULL)
            nodes["odds"], nodes["children"] = odds, children
            return nodes.tobytes()
        words = np.empty(self._books[0], np.uint16)
        return words[: engine.write_binary(self._value, self._child, words)].astype("<u2").tobytes()

    def _inside(self, points: ArrayLike, name: str) -> NDArray:
        """Points (n, 3) in single precision, all in the map."""
        points = numbers(points, name, ("n", 3), meaning="coordinates [m]")
        reach = (MIDDLE - 1) * self.resolution
        if (np.abs(points) > reach).any():
            far = points[np.abs(points).max(axis=1).argmax()]
            raise ValueError(
                f"{name} must be within {reach:g} m of the map's origin, got {far}: "
                f"take a larger resolution than {self.resolution} m or other axes"
            )
        return points.astype(np.float32)

    def _keys(self, points: NDArray) -> NDArray:
        """Keys of the voxels that have these points, shape (n, 3)."""
        return np.floor(1.0 / self.resolution * points.astype(float)).astype(np.int64) + MIDDLE

    def _middles(self, points: NDArray) -> NDArray:
        """Middles of the voxels that have points, each once, in single precision."""
        packed = np.unique(self._keys(points) @ (1, 1 << 16, 1 << 32))
        keys = packed[:, None] >> (0, 16, 32) & 0xFFFF
        return ((keys - MIDDLE + 0.5) * self.resolution).astype(np.float32)


def _room(bricks: int) -> tuple[NDArray, ...]:
    """What `rays.mark` fills in, for that many bricks or a little more."""
    bricks = 1 << int(np.ceil(np.log2(bricks)))
    bits = [np.zeros((bricks, 64), np.uint8) for _ in range(2)]
    slots = np.full(4 * bricks, -1, np.int32)
    return np.empty(bricks, np.int64), slots, *bits, np.zeros(1, np.int64)
