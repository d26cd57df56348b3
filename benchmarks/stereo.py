"""Stereo and rays against OpenCV and PyBullet: same answers, ratio of the times.

Exit code 1 when a limit is missed or too few answers agree.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

import cv2
import numpy as np

from backhoe import simulation
from backhoe.perception import camera, stereo
from backhoe.perception.picture import looking
from backhoe.simulation.sight import Sight

DATA = Path(__file__).parents[1] / "data" / "stereo"
RAYS = 14_000
"""In one call of PyBullet, which takes at most 16384; few enough that our rays take one core."""


def best_times(*functions: Callable[[], object], repeats: int = 25) -> list[float]:
    """Shortest of some runs of each, in turn, after one to warm up [s]."""
    times = [[] for _ in functions]
    for function in functions:
        function()
    for _ in range(repeats):
        for function, kept in zip(functions, times, strict=True):
            start = perf_counter()
            function()
            kept.append(perf_counter() - start)
    return [min(kept) for kept in times]


def report(what: str, figure: float, limit: float, *, least: bool = False) -> bool:
    fine = figure >= limit if least else figure <= limit
    bound = "at least" if least else "at most"
    print(f"{what:62s} {figure:8.3g} {bound} {limit:<5g} {'ok' if fine else 'MISSED'}")
    return fine


def opencv_matcher(prefilter: int) -> cv2.StereoBM:
    matcher = cv2.StereoBM.create(128, 15)
    matcher.setPreFilterType(prefilter)
    matcher.setPreFilterSize(9)
    matcher.setPreFilterCap(31)
    matcher.setTextureThreshold(10)
    matcher.setUniquenessRatio(15)
    matcher.setSpeckleWindowSize(200)
    matcher.setSpeckleRange(16)
    return matcher


def measure_matcher() -> list[bool]:
    pair = np.load(DATA / "rocks.npz")
    left, right = (np.tile(pair[eye], (1, 2))[:480, :640].copy() for eye in ("left", "right"))
    results = []
    for kind, prefilter in enumerate(stereo.PREFILTERS):
        matcher = opencv_matcher(kind)
        ours = stereo.block_match(left, right, prefilter=prefilter)
        theirs = matcher.compute(left, right) / 16
        both = np.isfinite(ours) & (theirs >= 0)
        close = (np.abs(ours - theirs)[both] <= 0.5).mean()
        a, b = best_times(
            lambda p=prefilter: stereo.block_match(left, right, prefilter=p),
            lambda m=matcher: m.compute(left, right),
        )
        print(f"640x480, 128 disparities, {prefilter}: {1e3 * a:.1f} ms; StereoBM {1e3 * b:.1f} ms")
        results += [
            report(f"block_match over StereoBM, {prefilter}", a / b, 1.0),
            report(f"common pixels within half a disparity, {prefilter}", close, 0.97, least=True),
        ]
    return results


def measure_semi_global() -> list[bool]:
    """No limit on the time: OpenCV's is three times as fast, and the course needs one picture."""
    pair = np.load(DATA / "loading.npz")
    left, right = pair["left"], pair["right"]
    matcher = cv2.StereoSGBM.create(
        0,
        128,
        5,
        P1=200,
        P2=800,
        disp12MaxDiff=1,
        preFilterCap=63,
        uniquenessRatio=5,
        speckleWindowSize=200,
        speckleRange=1,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )
    ours, theirs = stereo.semi_global_match(left, right), matcher.compute(left, right) / 16
    both = np.isfinite(ours) & (theirs >= 0)
    a, b = best_times(
        lambda: stereo.semi_global_match(left, right),
        lambda: matcher.compute(left, right),
        repeats=3,
    )
    print(f"semi-global, 640x480, 128 disparities: {1e3 * a:.0f} ms; StereoSGBM {1e3 * b:.0f} ms")
    close = (np.abs(ours - theirs)[both] <= 0.5).mean()
    return [report("common pixels within half a disparity, semi-global", close, 0.97, least=True)]


def measure_rays() -> list[bool]:
    rng = np.random.default_rng(0)
    azimuth, elevation = rng.uniform(-np.pi, np.pi, RAYS), rng.uniform(-1.2, 0.3, RAYS)
    flat = np.stack([np.cos(azimuth), np.sin(azimuth)], -1) * np.cos(elevation)[:, None]
    vector = 30 * np.c_[flat, np.sin(elevation)]
    start = np.tile([0.5, -1.2, 3.6], (RAYS, 1))
    with simulation.open_world(backend="pybullet") as world:
        caster = Sight(world).caster()
        theirs = world.cast_rays(start, start + vector)
        ours = caster.cast(start, vector, 1.0).points
        apart = np.linalg.norm(ours - theirs, axis=1)
        same = (np.isnan(ours[:, 0]) & np.isnan(theirs[:, 0])) | (apart < 1e-3)
        starts, ends = start.tolist(), (start + vector).tolist()
        server = world._rays._server
        a, b = best_times(
            lambda: caster.cast(start, vector, 1.0),
            lambda: server.rayTestBatch(starts, ends),
            repeats=15,
        )
    print(
        f"rays at the scene, one core: {RAYS / a / 1e6:.2f} M/s; PyBullet {RAYS / b / 1e6:.2f} M/s"
    )
    return [
        report("rays a second over PyBullet's rayTestBatch", b / a, 4.0, least=True),
        report("hits within 1 mm of each other", same.mean(), 0.999, least=True),
    ]


def dig(world: simulation.World) -> None:
    """Change the terrain, so that it must be drawn anew."""
    world.ground.terrain.lay((5.0, 0.3), (6.0, 0.9), 0.002)


def measure_pair() -> list[bool]:
    """A pair of pictures of terrain that has just changed."""
    lens, eye = camera.Pinhole.of_view((640, 480), np.radians(60)), np.array([1.3, -1.1, 2.9])
    poses = [looking(eye + np.array([0, side, 0]), (6.0, side, 0.4)) for side in (0.0, -0.4)]
    results = []
    with simulation.open_world(backend="analytic") as world:
        sight = Sight(world)

        def pair() -> list:
            dig(world)
            return [sight.look(lens, T) for T in poses]

        def by_rays() -> list:
            return [sight.look(bent, T) for T in poses]

        bent = camera.Pinhole(lens.K, lens.size, [1e-15, 0, 0, 0, 0])
        for drawn, cast in zip(pair(), by_rays(), strict=True):
            apart = np.nan_to_num(np.abs(drawn.depth - cast.depth))
            same = (apart < 1e-6) & (np.isnan(drawn.depth) == np.isnan(cast.depth))
            results.append(report("pixels with the depth of rays", same.mean(), 0.9999, least=True))
        (wall,) = best_times(pair, repeats=15)
        alone = min(timed(pair, process_time) for _ in range(15))
        results.append(report("a pair of 640x480, new terrain, depth [ms]", 1e3 * wall, 100))
        print(f"  {1e3 * alone:.0f} ms of the processor, on however many cores")
    return results


def measure_rendered_pair() -> list[bool]:
    """The same by PyBullet's renderer, without depth."""
    eye = np.array([1.3, -1.1, 2.9])
    with simulation.open_world(backend="pybullet") as world:

        def pair() -> list:
            dig(world)
            return [
                world.render(
                    640,
                    480,
                    eye + np.array([0, side, 0]),
                    (6.0, side, 0.4),
                    np.radians(47),
                    shadow=False,
                )
                for side in (0.0, -0.4)
            ]

        (wall,) = best_times(pair, repeats=9)
    return [report("a pair of 640x480, new terrain, by PyBullet [ms]", 1e3 * wall, 100)]


def measure_calibration() -> None:
    corners = np.load(DATA / "corners.npz")["corners"]
    board = camera.chessboard(9, 6, 0.025)
    (found,) = best_times(lambda: camera.calibrate(board, corners, (640, 480)), repeats=3)
    print(f"calibration from {len(corners)} pictures: {1e3 * found:.0f} ms")


def timed(function: Callable[[], object], clock: Callable[[], float]) -> float:
    start = clock()
    function()
    return clock() - start


def main() -> int:
    results = [*measure_pair(), *measure_rendered_pair(), *measure_matcher()]
    results += [*measure_semi_global(), *measure_rays()]
    measure_calibration()
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
