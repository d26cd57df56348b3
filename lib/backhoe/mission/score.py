"""What a run is worth, beside the library's own run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from backhoe import simulation
from backhoe.basics.angles import residual, wrap
from backhoe.basics.inputs import instance
from backhoe.machine import Machine
from backhoe.mission.autonomy.report import AutonomyScore, scored
from backhoe.mission.autonomy.running import AutonomyRun
from backhoe.mission.calls import LIBRARY
from backhoe.mission.driving import DriveRun, drive
from backhoe.mission.grading import GradingRun, grade
from backhoe.mission.holding import HoldRun, HoldScore, measure
from backhoe.mission.lifting import LiftRun, LiftScore
from backhoe.mission.lifting import scored as scored_lift
from backhoe.mission.loading import Run, run
from backhoe.mission.orders import OrderRun, OrderScore
from backhoe.mission.orders import scored as scored_orders
from backhoe.mission.surface import SurfaceScore, assess
from backhoe.mission.surveying import SurveyRun, survey
from backhoe.mission.table import MARGIN_ROWS, table
from backhoe.mission.worksite import CODA, EYES
from backhoe.simulation.soil import SoilParameters
from backhoe.vehicle.tracking import Path


@dataclass(frozen=True)
class Score:
    """A run in seven numbers, beside the reference run.

    `soil` loaded into the truck [m^3], `time` [s], `waypoint_error` the mean distance from a wanted
    to a reached stick's tip [m], `bucket_error` the same of the bucket joint [rad], `tracking` the
    root mean square of q_ref - q while the bucket is empty and in the air [rad], `margin` the least
    distance of the balance from the edge of the tracks [m], at `margin_time` [s].
    """

    soil: float
    time: float
    waypoint_error: float
    bucket_error: float
    tracking: float
    margin: float
    margin_time: float
    swapped: tuple[str, ...] = ()
    reference: Score | None = None

    def __str__(self) -> str:
        rows = [
            ("soil in the truck [m^3]", "{:.1f}", lambda score: score.soil),
            ("time [s]", "{:.1f}", lambda score: score.time),
            ("way-point error [cm]", "{:.0f}", lambda score: 100 * score.waypoint_error),
            ("bucket error [deg]", "{:.0f}", lambda score: np.degrees(score.bucket_error)),
            ("error in the air [deg]", "{:.1f}", lambda score: np.degrees(score.tracking)),
            *MARGIN_ROWS,
        ]
        return table(self, rows)


@dataclass(frozen=True)
class DriveScore:
    """A drive in numbers, beside the reference drive.

    `distance` the mean and `farthest` the largest distance from the path [m], `way` the length
    driven over that of the path, `late` by which delay the drive is explained best [s] (NaN without
    times), `time` [s], `push` the root mean square of the tracks' forces [N] (NaN without tracks),
    `reached` whether it arrived. `position_error` [m] and `heading_error` [rad] are the root mean
    squares of its estimate's errors (NaN if it was told the truth), `long_steps` how far an
    odometry's places move when it is asked seldom [m] (NaN without one), `margin` and
    `margin_time` as in `Score` (NaN without tracks). `claimed` is the place's standard deviation
    as the localisation claims it [m], `nees` and `nis` how large the pose's errors and the fixes'
    surprises are by its claims, on average 3 and 2 if it is honest [1]; NaN without claims. Shown
    of a swapped tracker alone: `off_goal`, the mean distance from where the trajectory wanted it at
    each moment [m] (NaN without times), and `steering`, the sum of the steps of the turning rate
    that was asked for [rad/s].
    """

    distance: float
    farthest: float
    way: float
    late: float
    time: float
    push: float
    reached: bool
    swapped: tuple[str, ...] = ()
    reference: DriveScore | None = None
    position_error: float = np.nan
    heading_error: float = np.nan
    long_steps: float = np.nan
    margin: float = np.nan
    margin_time: float = np.nan
    claimed: float = np.nan
    nees: float = np.nan
    nis: float = np.nan
    off_goal: float = np.nan
    steering: float = np.nan

    def __str__(self) -> str:
        rows = [
            ("mean distance [cm]", "{:.1f}", lambda score: 100 * score.distance),
            ("largest distance [cm]", "{:.1f}", lambda score: 100 * score.farthest),
            ("way driven / path", "{:.2f}", lambda score: score.way),
            ("late by [s]", "{:.1f}", lambda score: round(score.late, 1) + 0.0),
            ("time [s]", "{:.1f}", lambda score: score.time),
            ("force of a track [kN]", "{:.0f}", lambda score: score.push / 1e3),
            ("arrived", "{}", lambda score: "yes" if score.reached else "no"),
        ]
        if "tracker" in self.swapped:
            rows[3] = ("late by [s]", "{:.2f}", lambda score: round(score.late, 2) + 0.0)
            rows[4:4] = [
                ("off the goal [cm]", "{:.1f}", lambda score: 100 * score.off_goal),
                ("steering [rad/s]", "{:.1f}", lambda score: score.steering),
            ]
        if not np.isnan(self.margin):
            rows += MARGIN_ROWS
        if not np.isnan(self.position_error):
            off = np.nan_to_num
            rows += [
                ("believed place off [cm]", "{:.1f}", lambda s: off(100 * s.position_error)),
                ("believed heading [deg]", "{:.1f}", lambda s: off(np.degrees(s.heading_error))),
            ]
        for score in (self, self.reference):
            if score is not None and not np.isnan(score.nees):
                rows += _CLAIMS
                break
        if not np.isnan(self.long_steps):
            rows.append(("in long steps off [cm]", "{:.1f}", lambda s: 100 * s.long_steps))
        return table(self, rows)


def _if_any(value: float, form: str) -> str:
    return "-" if np.isnan(value) else format(value, form)


_CLAIMS = [
    ("claimed sigma [cm]", "{}", lambda score: _if_any(100 * score.claimed, ".1f")),
    ("NEES, 3 if honest [1]", "{}", lambda score: _if_any(score.nees, ".2g")),
    ("NIS, 2 if honest [1]", "{}", lambda score: _if_any(score.nis, ".2g")),
]


@dataclass(frozen=True)
class SurveyScore:
    """A survey in nine numbers, beside the library's survey.

    Over the first and the last look, whose pictures show the heap: `seen` the share of its cells
    that have stereo points, `off` the root mean square of their errors in height [m] (NaN without
    points); `covered` the share that have laser points. Over all looks: `wrong` the share of stereo
    points whose disparity is more than a pixel off (NaN without points), `strays` the share that
    was kept of laser points where nothing is, `found` the mean share of a look's true surface that
    the map holds for occupied. At the end: `false` what it holds for occupied where nothing is
    [m^3], `left` the share that is left in it of the truck, which has left, and `dark` the share of
    the deep ground that it holds for unknown.
    """

    seen: float
    off: float
    wrong: float
    covered: float
    strays: float
    found: float
    false: float
    left: float
    dark: float
    swapped: tuple[str, ...] = ()
    reference: SurveyScore | None = None

    def __str__(self) -> str:
        rows = [
            ("stereo: heap seen [%]", "{:.0f}", lambda score: 100 * score.seen),
            ("stereo: heap off [cm]", "{:.1f}", lambda score: 100 * score.off),
            ("stereo: wrong [%]", "{:.1f}", lambda score: 100 * score.wrong),
            ("lasers: heap seen [%]", "{:.0f}", lambda score: 100 * score.covered),
            ("lasers: strays kept [%]", "{:.0f}", lambda score: 100 * score.strays),
            ("map: surface found [%]", "{:.0f}", lambda score: 100 * score.found),
            ("map: wrongly full [m^3]", "{:.2f}", lambda score: score.false),
            ("map: truck left [%]", "{:.0f}", lambda score: 100 * score.left),
            ("map: dark unknown [%]", "{:.1f}", lambda score: 100 * score.dark),
        ]
        return table(self, rows)


def _measure(run: Run) -> Score:
    distance = np.linalg.norm(run.reached[:, :3] - run.wanted[:, :3], axis=-1)
    error = run.q_ref - run.q
    return Score(
        soil=float(run.truck_volume[-1] - run.truck_volume[0]),
        time=float(run.time[-1]),
        waypoint_error=float(distance.mean()),
        bucket_error=float(np.abs(run.reached[:, 3] - run.wanted[:, 3]).mean()),
        tracking=float(np.sqrt(np.mean(error[run.in_the_air] ** 2))),
        margin=run.least.margin,
        margin_time=run.least.time,
        swapped=run.swapped,
    )


@lru_cache(maxsize=8)
def _reference_score(
    cycles: int,
    machine: Machine,
    scene: simulation.Scene,
    soil: SoilParameters,
    backend: str,
) -> Score:
    with simulation.open_world(machine, backend=backend, scene=scene, soil=soil) as world:
        return _measure(run(cycles=cycles, world=world))


def _measure_drive(run: DriveRun) -> DriveScore:
    push = np.nan if run.traction is None else np.sqrt(np.mean(run.traction[1:] ** 2))
    return DriveScore(
        distance=run.metrics.d_mean,
        farthest=run.metrics.d_max,
        way=run.metrics.d_ratio,
        late=run.assessment.lag,
        time=float(run.time[-1]),
        push=float(push),
        reached=run.reached,
        off_goal=run.assessment.time_error_mean,
        steering=run.assessment.change_omega,
        swapped=run.swapped,
        long_steps=run.long_steps,
        **_estimate_errors(run),
        **_claims(run),
        **(
            {} if run.least is None else {"margin": run.least.margin, "margin_time": run.least.time}
        ),
    )


def _estimate_errors(run: DriveRun) -> dict[str, float]:
    """Root mean square errors of the estimated position [m] and heading [rad]."""
    if run.estimate is None:
        return {}
    x, y, heading = (run.estimate - run.pose).T
    return {
        "position_error": float(np.sqrt(np.mean(x**2 + y**2))),
        "heading_error": float(np.sqrt(np.mean(wrap(heading) ** 2))),
    }


def _claims(run: DriveRun) -> dict[str, float]:
    """What a localisation claims of its place [m], and NEES and NIS by that.

    Nobody knows a pose better than to a micrometre: so a claim of zero has a NEES as well.
    """
    claims = run.claims[1:]
    if not np.isfinite(claims).any():
        return {}
    P = (claims + np.swapaxes(claims, 1, 2)) / 2 + 1e-12 * np.eye(3)
    e = residual(run.pose, run.estimate, (2,))[1:]
    place = np.maximum(claims[:, 0, 0] + claims[:, 1, 1], 0.0)
    return {
        "claimed": float(np.sqrt(np.mean(place))),
        "nees": float(np.mean(np.sum(e * np.linalg.solve(P, e[..., None])[..., 0], axis=1))),
        "nis": float(np.mean(run.surprises)) if len(run.surprises) else np.nan,
    }


@lru_cache(maxsize=8)
def _reference_drive(points: tuple, times: tuple | None, **settings: object) -> DriveScore:
    return _measure_drive(drive(path=Path(points, times), **settings))


def _score_drive(run: DriveRun) -> DriveScore:
    measured, path = _measure_drive(run), run.path
    if run.own_plant or not (run.swapped or run.estimates):
        return measured
    estimators = dict.fromkeys(run.estimates, LIBRARY) if run.swapped else {}
    reference = _reference_drive(
        tuple(map(tuple, path.points.tolist())),
        None if path.times is None else tuple(path.times.tolist()),
        mode=run.mode,
        pose=tuple(run.pose[0].tolist()),
        machine=run.machine,
        backend=run.backend,
        fixes=run.fixes if "localisation" in estimators else None,
        seed=run.seed,
        time_limit=run.time_limit,
        **estimators,
    )
    return replace(measured, reference=reference)


def _measure_survey(run: SurveyRun) -> SurveyScore:
    ends = [0, -1]
    stereo, lasers = run.heap["stereo"][ends], run.heap["lasers"][ends]
    pairs = [seen["stereo"].faults for seen in run.clouds if "stereo" in seen]
    scans = [cloud.faults for seen in run.clouds for name, cloud in seen.items() if name in EYES]
    points, wrong = np.sum(pairs, axis=0)
    strays, kept = np.sum(scans, axis=0)
    return SurveyScore(
        seen=float(stereo[:, 0].mean()),
        off=float(np.sqrt(np.mean(stereo[:, 1] ** 2))),
        wrong=float(wrong / points) if points else np.nan,
        covered=float(lasers[:, 0].mean()),
        strays=float(kept / strays),
        found=float(run.found.mean()),
        false=float(run.false[-1]),
        left=float(run.left[-1 - CODA]),
        dark=run.dark,
        swapped=run.swapped,
    )


@lru_cache(maxsize=4)
def _reference_survey(**settings: object) -> SurveyScore:
    return _measure_survey(survey(**settings))


def _measure_grading(run: GradingRun) -> SurfaceScore:
    return assess(
        run.design,
        run.scene,
        run.before,
        run.after,
        bucket=run.bucket_volume,
        off_map=run.off_map_volume,
        time=float(run.time[-1]),
        margin=run.least.margin,
        margin_time=run.least.time,
        violations=run.violations,
        given_up=run.given_up,
        swapped=run.swapped,
    )


@lru_cache(maxsize=8)
def _reference_grading(**settings: object) -> SurfaceScore:
    return _measure_grading(grade(**settings))


def score(
    run: Run | DriveRun | LiftRun | OrderRun | SurveyRun | GradingRun | HoldRun | AutonomyRun,
) -> (
    Score
    | DriveScore
    | LiftScore
    | OrderScore
    | SurveyScore
    | SurfaceScore
    | HoldScore
    | AutonomyScore
):
    """Measure a run beside the same run with the library's parts only.

    The reference runs in a new world of the same scene and soil, by the same backend if it is the
    library's. A drive on your own estimate stands beside one on the library's, and one on the
    library's beside a drive that is told the truth. A drive with a plant of your own has no
    reference: drive the plant again without your tracker.

    Args:
        run: what `mission.run`, `drive`, `lift`, `obey`, `survey`, `grade`, `hold` or
            `autonomy.run` gave.

    Returns:
        The score; `print` shows it beside the reference.

    Raises:
        TypeError: run is something else.
    """
    kinds = (Run, DriveRun, LiftRun, OrderRun, SurveyRun, GradingRun, HoldRun, AutonomyRun)
    advice = (
        "take what mission.run, drive, lift, obey, survey, grade, hold or autonomy.run returned"
    )
    instance(run, "run", kinds, advice)
    if isinstance(run, AutonomyRun | OrderRun):
        return scored(run) if isinstance(run, AutonomyRun) else scored_orders(run)
    if isinstance(run, LiftRun):
        return scored_lift(run)
    if isinstance(run, HoldRun):
        return measure(run)
    if isinstance(run, GradingRun):
        reference = _reference_grading(**run.settings) if run.swapped else None
        return replace(_measure_grading(run), reference=reference)
    if isinstance(run, SurveyRun):
        settings = {name: getattr(run, name) for name in ("cycles", "seed", "resolution")}
        settings["record"] = run.recorder is not None
        reference = _reference_survey(**settings) if run.swapped else None
        return replace(_measure_survey(run), reference=reference)
    if isinstance(run, DriveRun):
        return _score_drive(run)
    measured = _measure(run)
    if not run.swapped:
        return measured
    backend = run.backend if run.backend in simulation.BACKENDS else "auto"
    return replace(
        measured, reference=_reference_score(run.cycles, run.machine, run.scene, run.soil, backend)
    )
