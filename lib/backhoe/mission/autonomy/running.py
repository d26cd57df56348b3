"""`autonomy.run`: the whole mission in one call, and what is kept of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe import simulation
from backhoe.basics.inputs import instance, numbers, positive, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.autonomy.body import Body, Halt
from backhoe.mission.autonomy.cycle import Load, Mission, Order
from backhoe.mission.autonomy.eyes import Eyes, View
from backhoe.mission.autonomy.faults import Fault, fault_of
from backhoe.mission.calls import LIBRARY, given_parts
from backhoe.mission.parts import AUTONOMY_PARTS
from backhoe.mission.records import Record
from backhoe.simulation.scene import LOADING, Scene
from backhoe.simulation.soil import SoilParameters, soil_of
from backhoe.simulation.standing import Least

START = (-4.0, -1.2, 0.3)
"""Where the machine begins, x, y, heading [m, m, rad]."""

FIXES = 0.5
"""Time between two positions by a total station while it drives [s]."""

ABOUT = {"heap": 0.3, "height": 0.1, "truck": 0.2, "start": 0.3}
"""How far a site may be from the order to each side [m, share, m, m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AutonomyRun(Record):
    """What happened; n rows at 50 Hz, true but for `belief` and what is in `views`.

    Attributes:
        order: what the machine was told; `scene`, what was true; `fault`, what went wrong.
        ended: why the work ended, in words; `stopped`: whether that was a safe stop.
        time: shape (n,) [s]; `phase`, the n names of what the machine did.
        pose, belief: x, y, heading, true and as the machine took them, (n, 3) [m, m, rad].
        q, dq, q_ref, torque: of the joints, shape (n, 4) [rad, rad/s, rad, N m].
        bucket, truck: soil there, shape (n,) [m^3].
        margin: of the balance, shape (n,) [m]; `least` of all steps.
        power: that joints and tracks take, shape (n,) [W].
        loads: of each bucket, `Load`s.
        views: of each look, what was seen beside what was true.
        events: (time [s], what) where the machine changed its plan.
        soil_lost: change of the sum of all soil [m^3].
        settings: what `run` was told but for the parts.
    """

    order: Order
    scene: Scene
    fault: Fault
    soil: SoilParameters
    ended: str
    stopped: bool
    time: NDArray
    pose: NDArray
    belief: NDArray
    q: NDArray
    dq: NDArray
    q_ref: NDArray
    torque: NDArray
    bucket: NDArray
    truck: NDArray
    margin: NDArray
    power: NDArray
    phase: tuple[str, ...]
    least: Least
    loads: tuple[Load, ...]
    views: tuple[View, ...]
    events: tuple[tuple[float, str], ...]
    soil_lost: float
    settings: dict[str, object]
    SHOWN = (
        "mission.autonomy.run",
        "Alone",
        "3D replay of the backhoe driving to a heap and loading a truck by itself",
    )

    def _drawn(self) -> dict[str, object]:
        return {"camera": (np.array([10.5, -9.5, 6.5]), np.array([1.5, 1.0, 0.8]))}


def site(seed: int, order: Scene = LOADING) -> Scene:
    """A scene as it may be when the order says another: heap and truck a little elsewhere.

    Args:
        seed: 0 for the order's own.
        order: with a heap and a truck.
    """
    if whole(seed, "seed", least=0) == 0:
        return order
    rng = np.random.default_rng([seed, 14])
    heap, truck = order.heaps[0], order.truck
    dx, dy, dh, tx, ty = rng.uniform(-1.0, 1.0, 5)
    moved = replace(
        heap,
        x=heap.x + ABOUT["heap"] * dx,
        y=heap.y + ABOUT["heap"] * dy,
        height=heap.height * (1 + ABOUT["height"] * dh),
    )
    parked = replace(truck, x=truck.x + ABOUT["truck"] * tx, y=truck.y + ABOUT["truck"] * ty)
    return replace(order, heaps=(moved, *order.heaps[1:]), truck=parked)


def run(
    *,
    odometry: Callable | str | None = None,
    localisation: Callable | str | None = LIBRARY,
    scan_filter: Callable | None = None,
    terrain: Callable | None = None,
    dig_choice: Callable | None = None,
    primitive: Callable | None = None,
    planner: Callable | None = None,
    controller: Callable | None = None,
    loads: int = 40,
    wanted: float | None = None,
    fault: str | Fault | None = None,
    seed: int = 0,
    scene: Scene | None = None,
    start: ArrayLike = START,
    soil: str | SoilParameters | None = None,
    fixes: float | None = FIXES,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    record: bool = False,
    **unknown: object,
) -> AutonomyRun:
    """Drive to the heap and load the truck without a man, with the library's parts or with yours.

    Args:
        odometry, localisation, scan_filter, terrain, dig_choice, primitive, planner, controller:
            your parts; `AUTONOMY_PARTS` gives the call of each. What is left out is the library's.
        loads: buckets at most.
        wanted: soil to be loaded [m^3]; default what the bed holds when it is level full.
        fault: one of `faults.FAULTS` by its name, or your own; None for none.
        seed: of the site (0: as ordered, else a little elsewhere), the bumps and the sensors'
            noise.
        scene: that is ordered, with a heap and a truck; default `simulation.LOADING`.
        start: x, y, heading where the machine begins, shape (3,) [m, m, rad].
        soil: as in `simulation.open_world`.
        fixes: time between two positions by a total station [s]; None for none.
        machine, backend: as in `simulation.open_world`.
        record: keep what the 3D replay needs.

    Returns:
        The run. A safe stop is a run that `stopped`, with its reason in `ended`.

    Raises:
        ValueError: numbers out of range, a scene without heap or truck, an unknown fault, a part
            that returns the wrong shape or values that are not finite.
        TypeError: a part of an unknown name, or one that cannot be called.
        Tipped: the machine tips over (a RuntimeError); its `run` is the run until then.
    """
    given = given_parts(
        AUTONOMY_PARTS,
        unknown,
        odometry=odometry,
        localisation=localisation,
        scan_filter=scan_filter,
        terrain=terrain,
        dig_choice=dig_choice,
        primitive=primitive,
        planner=planner,
        controller=controller,
    )
    scene = LOADING if scene is None else instance(scene, "scene", Scene)
    if not scene.heaps or scene.truck is None:
        raise ValueError("scene must have a heap and a truck, as simulation.LOADING has")
    truck = scene.truck
    level = truck.bed_length * truck.bed_width * (truck.wall - truck.floor)
    wanted = level if wanted is None else positive(wanted, "wanted", "m^3")
    start = numbers(start, "start", (3,), meaning="x, y, heading")
    fault, seed = fault_of(fault), whole(seed, "seed", least=0)
    fixes = None if fixes is None else positive(fixes, "fixes", "s")
    order = Order(scene, (0.0, 0.0, 0.0), wanted, whole(loads, "loads", least=1))
    soil = soil_of("sandy loam" if soil is None else soil)
    settings = {
        **{"loads": order.loads, "wanted": wanted, "fault": fault, "seed": seed, "scene": scene},
        **{"start": tuple(start.tolist()), "soil": soil, "fixes": fixes, "machine": machine},
        "backend": backend,
    }
    true = fault.scene(site(seed, scene))
    with simulation.open_world(machine, backend=backend, scene=true, seed=seed, soil=soil) as world:
        world.reset(pose=start)
        soil_then = world.ground.total_volume
        body = Body(world, given, fixes, seed, fault, record)
        eyes = Eyes(body, given, truck, seed)
        mission = Mission(body, eyes, order, given)

        def made(ended: str, stopped: bool) -> AutonomyRun:
            columns = zip(Body.COLUMNS, zip(*body.log, strict=True), strict=True)
            log = {
                name: values if name == "phase" else np.array(values) for name, values in columns
            }
            return AutonomyRun(
                swapped=tuple(name for name, part in given.items() if not isinstance(part, str)),
                machine=machine,
                backend=world.backend,
                recorder=body.recorder,
                order=order,
                scene=true,
                fault=fault,
                soil=soil,
                ended=ended,
                stopped=stopped,
                **log,
                least=world.least_margin,
                loads=tuple(mission.loads),
                views=tuple(eyes.views),
                events=tuple(mission.events),
                soil_lost=float(world.ground.total_volume - soil_then),
                settings=settings,
            )

        try:
            return made(mission.do(), False)
        except Halt as halt:
            body.server.cancel_all(str(halt))
            return made(str(halt), True)
        except simulation.Tipped as error:
            error.run = made("the machine tipped over", True)
            raise
