"""Grading: the tracks creep while the bucket's edge draws a plane surface in the soil.

`passes` plans the way of the edge, `tracing` leads it there with the whole machine, on the pose
that the machine's sensors say; `design` judges the surface that is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe import simulation
from backhoe.basics.inputs import choice, instance, numbers, positive, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.calls import ESTIMATORS, LIBRARY, given_parts
from backhoe.mission.design import Design, SlopeDesign, TrenchDesign
from backhoe.mission.parts import GRADE_PARTS
from backhoe.mission.passes import LANES, Stroke, edge_posture, slope_strokes
from backhoe.mission.records import Record
from backhoe.mission.tracing import CARRYING, FORWARD, PERIOD, Tracer, pitch_of
from backhoe.mission.trench import trench_strokes
from backhoe.simulation.scene import GRADING, TRENCHING, Scene
from backhoe.simulation.soil import SoilParameters, soil_of
from backhoe.simulation.standing import Least
from backhoe.whole_body import hand

JOBS = ("slope", "trench")

FIXES = 0.5
"""Time between two positions by a total station [s]."""

APPROACH = 1.2
"""From where the machine starts to where it begins a trench [m]."""

BORDER = 0.2
"""At each side of what the bucket passes, where the earth beside it slides down [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class GradingRun(Record):
    """What happened; n rows, one for every sample of the sensors.

    Attributes:
        job, seed, fixes: as given.
        scene, soil: of the world.
        design: what should be left.
        strokes: of the edge.
        before, after: heights of the soil, shape (rows, columns) [m].
        time: shape (n,) [s].
        stroke: its number from 1, shape (n,).
        pose, estimate: x, y, heading, true and as the part was told, shape (n, 3) [m, m, rad].
        q: joint angles, shape (n, 4) [rad].
        edge: x, y, z [m] and pitch [rad] of the edge, true, shape (n, 4).
        goal: where it should be, NaN between two strokes, shape (n, 4).
        v: velocities u, omega and of the joints that were asked for, shape (n, 6).
        share: of the wanted velocity of the edge that these give, (n,) [1], NaN between strokes.
        margin: of the machine's balance, shape (n,) [m]; `least` since the start.
        bucket: soil in it, shape (n,) [m^3].
        bucket_volume, off_map_volume: soil in the bucket and beside the map at the end [m^3].
        settings: what `grade` was told but for the parts; the pose as a tuple.
        soil_lost: largest change of all soil together [m^3].
        excess: by which the part asked for more than the bounds, as a share of the largest
            velocity, one value for each period of the strokes, shape (m,) [1].
        given_up: number of strokes that took too long.
    """

    job: str
    seed: int
    fixes: float | None
    scene: Scene
    soil: SoilParameters
    design: Design
    strokes: tuple[Stroke, ...]
    before: NDArray
    after: NDArray
    time: NDArray
    stroke: NDArray
    pose: NDArray
    estimate: NDArray
    q: NDArray
    edge: NDArray
    goal: NDArray
    v: NDArray
    share: NDArray
    margin: NDArray
    least: Least
    bucket: NDArray
    bucket_volume: float
    off_map_volume: float
    soil_lost: float
    settings: dict[str, object]
    excess: NDArray
    given_up: int
    SHOWN = ("mission.grade", "Grade", "3D replay of the backhoe grading soil on its tracks")

    @property
    def violations(self) -> float:
        """Share of the strokes' periods in which the part asked for more than the bounds [1]."""
        return float(np.mean(self.excess > 1e-6)) if len(self.excess) else 0.0

    def _drawn(self) -> dict[str, object]:
        """A camera aside that sees the machine and all of the work."""
        ends = self.design.point([0.0, self.design.run])
        seen = np.vstack([ends, np.c_[self.pose[:, :2], np.ones(len(self.pose))]])
        low, high = seen.min(axis=0), seen.max(axis=0)
        c, s = np.cos(self.design.direction), np.sin(self.design.direction)
        target, size = (low + high) / 2, float(np.hypot(*(high - low)[:2])) + 4.0
        eye = target + size * np.array([0.55 * s - 0.5 * c, -0.55 * c - 0.5 * s, 0.5])
        return {"camera": (eye, target)}


def grade(
    *,
    job: str = "slope",
    whole_body: Callable | None = None,
    odometry: Callable | str | None = None,
    localisation: Callable | str | None = "library",
    fixes: float | None = FIXES,
    scene: Scene | None = None,
    design: TrenchDesign | None = None,
    lanes: Sequence[float] = LANES,
    soil: str | SoilParameters | None = None,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    pose: ArrayLike | None = None,
    seed: int = 0,
    record: bool = False,
    **unknown: object,
) -> GradingRun:
    """Grade a slope, or dig a trench, with the library's parts or with yours in their place.

    Args:
        job: "slope", the scene's bank, or "trench", a flat bottom in level ground.
        whole_body, odometry, localisation: your parts; `GRADE_PARTS` gives the call of each. What
            tells the machine where it is may be "library"; of both the localisation counts, and
            None for both is the truth.
        fixes: time between two positions by a total station, for the localisation [s]; None for
            none.
        scene: with a bank for a slope; default `scene.GRADING` or `scene.TRENCHING`.
        design: of the trench; default `TrenchDesign()`.
        lanes: where the passes lie across the slope, as shares of the bucket's width from its
            middle line, shape (n,) [1]. What they cover is graded, but for `BORDER` at each side.
        soil: as in `simulation.open_world`.
        machine, backend: likewise.
        pose: where the machine starts, x, y, heading, shape (3,) [m, m, rad]; default the origin,
            for a trench `APPROACH` behind where it begins.
        seed: of the bank's bumps and of the sensors' noise.
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log.

    Raises:
        ValueError: a job that there is not, a scene without a bank, a slope too steep for the soil
            or out of reach, a start not well before it, a part that returns the wrong shape or
            values that are not finite.
        TypeError: a part of an unknown name, or one that cannot be called.
        Tipped: the machine tips over (a RuntimeError); its `run` is the run until then.
    """
    choice(job, "job", JOBS)
    given = given_parts(
        GRADE_PARTS, unknown, whole_body=whole_body, odometry=odometry, localisation=localisation
    )
    fixes = None if fixes is None else positive(fixes, "fixes", "s")
    seed = whole(seed, "seed", least=0)
    soil = soil_of("sandy loam" if soil is None else soil)
    instance(machine, "machine", Machine)
    pose = None if pose is None else numbers(pose, "pose", (3,), meaning="x, y, heading")
    lanes = tuple(numbers(lanes, "lanes", ("n",), meaning="shares of the bucket's width").tolist())
    width = (max(lanes) - min(lanes) + 1) * machine.shell.width - 2 * BORDER
    scene = {"slope": GRADING, "trench": TRENCHING}[job] if scene is None else scene
    instance(scene, "scene", Scene)
    if job == "trench":
        design = TrenchDesign() if design is None else instance(design, "design", TrenchDesign)
        strokes = trench_strokes(design, machine, PERIOD)
        pose = _behind(strokes[0].stand) if pose is None else pose
    elif design is not None:
        raise ValueError("the design of a slope is its scene's bank: leave design out")
    else:
        design = _slope(scene, soil, width)
        strokes = slope_strokes(design, PERIOD, machine, lanes)
    _check_map(strokes, scene)
    start = edge_posture(CARRYING, machine)
    start[0] = FORWARD
    settings = {
        "job": job,
        "scene": scene,
        "design": design if job == "trench" else None,
        "lanes": lanes,
        "soil": soil,
        "machine": machine,
        "backend": backend,
        "pose": None if pose is None else tuple(np.array(pose).tolist()),
        "seed": seed,
        "fixes": fixes,
        "odometry": None if odometry is None else LIBRARY,
        "localisation": None if localisation is None else LIBRARY,
    }
    options = {"backend": backend, "scene": scene, "seed": seed, "q": start, "soil": soil}
    with simulation.open_world(machine, **options) as world:
        if pose is not None:
            world.reset(pose=pose)
        _check_start(world.pose, strokes[0].stand)
        before = world.ground.terrain.heights.copy()
        tracer = Tracer(world, given, fixes, seed, record)

        def made() -> GradingRun:
            return _run(tracer, given, design, strokes, before, settings)

        try:
            tracer.do(strokes)
        except simulation.Tipped as error:
            error.run = made()
            raise
        return made()


def _slope(scene: Scene, soil: SoilParameters, width: float) -> SlopeDesign:
    bank = scene.bank
    if bank is None:
        raise ValueError("scene has no bank: give one, as simulation.scene.GRADING has")
    design = SlopeDesign(bank.foot, bank.direction, bank.ratio, bank.length, width)
    if design.angle >= soil.repose:
        raise ValueError(
            f"a slope of 1:{bank.ratio:g} ({degrees(design.angle):.0f} deg) does not stand in this "
            f"soil, whose angle of repose is {degrees(soil.repose):.0f} deg"
        )
    return design


def _behind(stand: NDArray) -> NDArray:
    """A pose `APPROACH` behind another, shapes (3,) [m, m, rad]."""
    return stand - APPROACH * np.array([np.cos(stand[2]), np.sin(stand[2]), 0.0])


def _check_map(strokes: list[Stroke], scene: Scene) -> None:
    goals = np.concatenate([stroke.goals[:, :2] for stroke in strokes])
    low = np.array(scene.corner)
    high = low + scene.cell * (np.array([scene.columns, scene.rows]) - 1)
    if (goals < low + 1.0).any() or (goals > high - 1.0).any():
        raise ValueError(
            f"the work must lie 1 m or more within the scene's map, x, y {low} to {high} m, got "
            f"{goals.min(axis=0).round(2)} to {goals.max(axis=0).round(2)} m"
        )


def _check_start(pose: NDArray, stand: NDArray, room: float = 1.0) -> None:
    c, s = np.cos(stand[2]), np.sin(stand[2])
    ahead, aside = stand[:2] - pose[:2]
    ahead = ahead * c + aside * s
    turned = abs((pose[2] - stand[2] + np.pi) % (2 * np.pi) - np.pi)
    if ahead < room or turned > np.pi / 4:
        raise ValueError(
            f"pose must be {room:g} m or more before where the first pass begins, {stand.round(2)},"
            f" and face the work within 45 deg, got {pose.round(2)}"
        )


def _run(
    tracer: Tracer,
    given: dict,
    design: Design,
    strokes: list[Stroke],
    before: NDArray,
    settings: dict[str, object],
) -> GradingRun:
    time, stroke, q, estimate, goal, v, share, margin, bucket = map(
        np.array, zip(*tracer.log, strict=True)
    )
    world, ground = tracer.world, tracer.world.ground
    return GradingRun(
        swapped=tuple(name for name, part in given.items() if not isinstance(part, str)),
        machine=world.machine,
        backend=world.backend,
        recorder=tracer.recorder,
        job=settings["job"],
        seed=settings["seed"],
        fixes=settings["fixes"] if any(name in given for name in ESTIMATORS) else None,
        settings=settings,
        scene=world.scene,
        soil=ground.parameters,
        design=design,
        strokes=tuple(strokes),
        before=before,
        after=ground.terrain.heights.copy(),
        time=time,
        stroke=stroke,
        pose=q[:, :3],
        estimate=estimate,
        q=q[:, 3:],
        edge=np.column_stack([hand(q, tracer.plant.robot), pitch_of(q[:, 3:], world.machine)]),
        goal=goal,
        v=v,
        share=share,
        margin=margin,
        least=world.least_margin,
        bucket=bucket,
        bucket_volume=ground.bucket_volume,
        off_map_volume=ground.off_map_volume,
        soil_lost=tracer.soil_lost,
        excess=np.array(tracer.excess),
        given_up=tracer.given_up,
    )
