"""A report like a site's: how fast, how full, how dear, how near, and how often a man is needed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import JOINTS, Machine
from backhoe.mission.autonomy.body import SAMPLE
from backhoe.mission.autonomy.running import AutonomyRun, run
from backhoe.mission.table import MARGIN_ROWS, table
from backhoe.perception.distance_field import covering_spheres
from backhoe.simulation.clock import STEP
from backhoe.simulation.scene import Scene
from backhoe.view.appearance import truck_boxes, visuals

OPERATORS = 12.0, 10.0
"""Times that skilled operators take to dig and to load [s]: Mastalli 2013, 6.7.1 and 6.7.2."""

HYDRAULICS, ENGINE = 0.4, 0.38
"""Shares of the engine's work that arrives at joints and tracks, and of the diesel's heat that the
engine makes work of: assumptions of ours; idling is not counted [1]."""

DIESEL = 9.96
"""Heat in a litre of diesel [kWh]: 35.9 MJ/l, its lower heating value."""

COARSE = 0.12
"""Edge of the cubes in which a mesh gets one sphere [m]."""

EVERY = 5
"""Rows of the log from one look at the clearance to the next: 0.1 s."""


@dataclass(frozen=True)
class AutonomyScore:
    """A mission alone in fourteen numbers, beside the reference run.

    `loads` in the truck, `soil` there [m^3] and `rate` [m^3/h] from the first dig on; `digging` and
    `loading`, mean times from the choice of a strip until the bucket is lifted, and from there
    until it is empty [s], `cycle` all of a cycle [s]; `fill`, soil in a lifted bucket over what one
    holds [1]; `into_truck`, soil in the truck over soil that was lifted [1]; `energy` of joints and
    tracks [kWh]; `litres` of diesel, see `HYDRAULICS`; `clearance`, least of boom, stick and bucket
    from the truck [m]; `margin` and `margin_time` as in `Score`; `replans`, how often the plan was
    changed, and `stops`, safe stops, which need a man; `astray`, largest error of the believed
    place after the drive [m].
    """

    loads: int
    soil: float
    rate: float
    digging: float
    loading: float
    cycle: float
    fill: float
    into_truck: float
    energy: float
    litres: float
    clearance: float
    margin: float
    margin_time: float
    replans: int
    stops: int
    astray: float
    ended: str
    swapped: tuple[str, ...] = ()
    reference: AutonomyScore | None = None

    def __str__(self) -> str:
        dig, load = OPERATORS
        rows = [
            ("buckets loaded", "{:.0f}", lambda score: score.loads),
            ("soil in the truck [m^3]", "{:.1f}", lambda score: score.soil),
            ("  a hour [m^3/h]", "{:.0f}", lambda score: score.rate),
            (f"digging ({dig:.0f} s) [s]", "{:.1f}", lambda score: score.digging),
            (f"loading ({load:.0f} s) [s]", "{:.1f}", lambda score: score.loading),
            ("cycle [s]", "{:.1f}", lambda score: score.cycle),
            ("fill factor [%]", "{:.0f}", lambda score: 100 * score.fill),
            ("dug soil in truck [%]", "{:.0f}", lambda score: 100 * score.into_truck),
            ("energy [kWh]", "{:.2f}", lambda score: score.energy),
            ("diesel [l]", "{:.2f}", lambda score: score.litres),
            ("clearance to truck [m]", "{:.2f}", lambda score: score.clearance),
            *MARGIN_ROWS,
            ("believed place off [m]", "{:.2f}", lambda score: score.astray),
            ("changes of plan", "{:.0f}", lambda score: score.replans),
            ("safe stops", "{:.0f}", lambda score: score.stops),
        ]
        return f"{table(self, rows)}\nended: {self.ended}\n(in brackets: skilled operators)"


def report(of: AutonomyRun) -> AutonomyScore:
    """The numbers of a run, without a reference."""
    loads = of.loads
    soil = float(of.truck[-1] - of.truck[0])
    digging, loading, cycle, fill, into, rate = (np.nan,) * 6
    if loads:
        begin, lifted, end, dug = (np.array([getattr(one, k) for one in loads]) for k in _OF_LOAD)
        digging, loading = float((lifted - begin).mean()), float((end - lifted).mean())
        if len(loads) > 1:
            cycle = float((begin[-1] - begin[0]) / (len(loads) - 1))
        fill = float(dug.mean() / _heaped(of))
        into = float(sum(one.loaded for one in loads) / dug.sum())
        rate = soil / (float(end[-1] - begin[0]) / 3600)
    energy = float(of.power.sum() * SAMPLE * STEP / 3.6e6)
    driven = np.array([view.belief - view.pose for view in of.views]).reshape(-1, 3)
    return AutonomyScore(
        loads=len(loads),
        soil=soil,
        rate=rate,
        digging=digging,
        loading=loading,
        cycle=cycle,
        fill=fill,
        into_truck=into,
        energy=energy,
        litres=energy / (HYDRAULICS * ENGINE * DIESEL),
        clearance=float(clearances(of).min()),
        margin=of.least.margin,
        margin_time=of.least.time,
        replans=len(of.events),
        stops=int(of.stopped),
        astray=float(np.hypot(*driven[:, :2].T).max(initial=0.0)),
        ended=of.ended,
        swapped=of.swapped,
    )


def scored(of: AutonomyRun) -> AutonomyScore:
    """The numbers of a run, beside those of the library's parts on the same site if it has a
    student's."""
    return replace(report(of), reference=_reference(**of.settings) if of.swapped else None)


def clearances(of: AutonomyRun) -> NDArray:
    """Least distance of boom, stick and bucket from the truck, each `EVERY` rows while it is there,
    never more than the meshes' [m]; shape (m,)."""
    q, pose = of.q[::EVERY], of.pose[::EVERY]
    return clearance(q, pose, of.scene, of.machine)


def clearance(q: NDArray, pose: NDArray, scene: Scene, machine: Machine) -> NDArray:
    """Least distance of boom, stick and bucket from a scene's truck.

    Args:
        q: joint angles, shape (n, 4) [rad].
        pose: x, y, heading, shape (n, 3) [m, m, rad].
        scene: with a truck.
        machine: whose arm.

    Returns:
        Shape (n,) [m]; below 0 where they may overlap.
    """
    T = link_transforms(q, machine)
    c, s = np.cos(pose[:, 2, None]), np.sin(pose[:, 2, None])
    least = np.full(len(q), np.inf)
    for number, balls in enumerate(_spheres(machine), start=1):
        at = np.einsum("nij,kj->nki", T[:, number, :3, :3], balls[:, :3])
        x, y, z = np.moveaxis(at + T[:, number, None, :3, 3], -1, 0)
        at = np.stack([pose[:, :1] + x * c - y * s, pose[:, 1:2] + x * s + y * c, z], axis=-1)
        for low, high in truck_boxes(scene.truck):
            out = np.maximum(np.maximum(low - at, at - high), 0.0)
            gap = np.sqrt((out**2).sum(axis=-1)) - balls[:, 3]
            least = np.minimum(least, gap.min(axis=1))
    return least


_OF_LOAD = ("begin", "lifted", "end", "dug")


@lru_cache(maxsize=2)
def _spheres(machine: Machine) -> list[NDArray]:
    """Of boom, stick and bucket in their frames, shape (k, 4) each [m]."""
    drawn = visuals(machine)
    return [
        np.concatenate([covering_spheres(p.vertices, p.faces, COARSE) for p in drawn[link]])
        for link in JOINTS[1:]
    ]


def _heaped(of: AutonomyRun) -> float:
    from backhoe.simulation.soil.bucket_fill import BucketFill

    return BucketFill(of.machine.shell, of.soil.repose).heaped


@lru_cache(maxsize=4)
def _reference(**settings: object) -> AutonomyScore:
    return report(run(**settings))
