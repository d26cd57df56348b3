"""Exercise 2.9: the load that tips the machine."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import kinematics
from backhoe.lessons.dynamics.exercises.postures import RADIANS, postures
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, Machine, replace
from backhoe.whole_body import stability


def tipping_load(q: NDArray) -> float:
    """Mass at the bucket's centre of mass with which the machine just tips [kg], q in rad."""
    return float(stability.tipping_load(q).load)


def _cases(rng: np.random.Generator) -> list[tuple[NDArray]]:
    """Postures, over all edges, in which the empty machine stands and some load tips it."""
    tried = postures(rng, 400)
    tried = tried[stability.margin(tried).distance > 0.05]
    loads = stability.tipping_load(tried).load
    return [(q,) for q in tried[loads < 2e4][:100]]


def _loads(
    q: NDArray, frame: str = "bucket_com", machine: Machine = BACKHOE, half: NDArray | None = None
) -> tuple[NDArray, NDArray, NDArray]:
    """For front, left, rear, right: weight's lever, load's lever [m], and the load they give."""
    com = stability.centre_of_mass(q, machine=machine)[:2]
    at = kinematics.forward_kinematics(q, frame)[:2, 3]
    half = stability.support_polygon()[1] if half is None else half
    inside = np.concatenate([half - com, half + com])
    beyond = np.concatenate([at - half, -at - half])
    with np.errstate(divide="ignore"):
        loads = np.where(beyond > 0, machine.mass * inside / beyond, np.inf)
    return inside, beyond, loads


def _least(**wrong: object) -> Callable[[NDArray], float]:
    return lambda q: float(_loads(q, **wrong)[2].min())


def _levers(lever: Callable[[NDArray, NDArray], NDArray]) -> Callable[[NDArray], float]:
    """The load from other levers than distances to the edge, at the edge that is right."""

    def wrong(q: NDArray) -> float:
        inside, beyond, loads = _loads(q)
        edge = loads.argmin()
        over, under = lever(inside, beyond)
        return float(BACKHOE.mass * over[edge] / under[edge])

    return wrong


HALF = stability.support_polygon()[1]
EDGES = np.concatenate([HALF, HALF])
UPPER = BACKHOE.mass - BACKHOE.tracks.mass


def _picked(pick: Callable[[NDArray], float]) -> Callable[[NDArray], float]:
    """Of the loads over the edges beyond which the load lies, another than the least."""

    def wrong(q: NDArray) -> float:
        loads = _loads(q)[2]
        return float(pick(loads[np.isfinite(loads)]))

    return wrong


def _anyhow(q: NDArray) -> NDArray:
    inside, beyond, _ = _loads(q)
    return BACKHOE.mass * inside / beyond


def _to_the_middle(q: NDArray) -> float:
    inside, beyond, _ = _loads(q)
    way = beyond + EDGES
    return float((BACKHOE.mass * inside[way > 0] / way[way > 0]).min())


def _from_the_middle(q: NDArray) -> float:
    beyond = _loads(q)[1]
    return float((BACKHOE.mass * EDGES[beyond > 0] / beyond[beyond > 0]).min())


def _at_edge(lever: Callable[[NDArray, NDArray], int]) -> Callable[[NDArray], float]:
    return lambda q: float(_anyhow(q)[lever(*_loads(q)[:2])])


def _without_tracks(q: NDArray) -> float:
    com = stability.centre_of_mass(q)[:2] * BACKHOE.mass / UPPER
    inside, beyond = np.concatenate([HALF - com, HALF + com]), _loads(q)[1]
    return float((BACKHOE.mass * inside[beyond > 0] / beyond[beyond > 0]).min())


def _radial(less: float) -> Callable[[NDArray], float]:
    def wrong(q: NDArray) -> float:
        way = np.hypot(*kinematics.forward_kinematics(q, "bucket_com")[:2, 3])
        return float(BACKHOE.mass * stability.margin(q).distance / (way - less))

    return wrong


def _scaled(factor: float) -> Callable[[NDArray], float]:
    return lambda q: factor * tipping_load(q)


def _only(edges: list[int]) -> Callable[[NDArray], float]:
    return lambda q: float(_loads(q)[2][edges].min())


NARROW = BACKHOE.tracks.gauge / 2
LIGHT = replace(BACKHOE, tracks=replace(BACKHOE.tracks, mass=1e-9))

TIPS = Exercise(
    number="2.9",
    title="the load that tips the machine",
    reference=tipping_load,
    oracle="moments_about_the_edges",
    cases=_cases,
    tested_on="100 random postures, over all four edges",
    hints=(
        "over one edge: the machine's mass times its way inside is the load times its way beyond",
        "do that for four edges; where the load is not beyond there is no limit; the least counts",
    ),
    mistakes={
        "the lever of a weight ends at the edge about which the machine turns, not at its middle": (
            _levers(lambda inside, beyond: (inside, beyond + EDGES))
        ),
        "the machine's lever is from its centre of mass to the edge, not half of the tracks": (
            _levers(lambda inside, beyond: (EDGES, beyond))
        ),
        "the machine's lever ends at its centre of mass, centre_of_mass(q), not at its middle": (
            _from_the_middle
        ),
        "only the front edge is in it: with the arm turned, the side is nearer": _only([0]),
        "only front and rear are in it: the machine also tips over its sides": _only([0, 2]),
        "only left and right are in it: the machine also tips over its front": _only([1, 3]),
        "the left track is missing: an edge lies on both sides": _only([0, 2, 3]),
        "the rear edge is missing: the arm can point backwards": _only([0, 1, 3]),
        "over the side it stands to the outer edge of the shoes: half the gauge and half a shoe": (
            _least(half=np.array([HALF[0], NARROW]))
        ),
        "the shoe counts half: its middle is half a gauge from the machine's middle": (
            _least(half=np.array([HALF[0], NARROW + BACKHOE.tracks.shoe_width]))
        ),
        "half of the tracks lies before the middle: length / 2": (
            _least(half=np.array([2 * HALF[0], HALF[1]]))
        ),
        "the load lies at the bucket's centre of mass, not at its teeth": _least(frame="tip"),
        "the load lies at the bucket's centre of mass, not at the bucket's pin": (
            _least(frame="stick")
        ),
        "the undercarriage is missing: it is the heaviest part, and it holds the rest": (
            _least(machine=LIGHT)
        ),
        "the undercarriage's mass counts, too, not only that of house and arm": (
            _scaled(UPPER / BACKHOE.mass)
        ),
        "with the load it tips over the edge that gives the least load, not the most": _picked(
            np.max
        ),
        "one load tips it, over one edge: the least counts, not a mean": _picked(np.mean),
        "all edges count: take the least load, not that of the first": _picked(lambda one: one[0]),
        "an edge that the load is not beyond cannot be tipped over: leave negative loads out": (
            lambda q: float(_anyhow(q).min())
        ),
        "an edge that the load is not beyond has no load, not that with another sign": (
            lambda q: float(np.abs(_anyhow(q)).min())
        ),
        "each load's lever ends at its edge, not at the machine's middle": _to_the_middle,
        "the edge that tips need not be the nearest to the centre of mass: try all four": (
            _at_edge(lambda inside, beyond: int(inside.argmin()))
        ),
        "the edge that tips need not be the one that the load is farthest beyond: try all four": (
            _at_edge(lambda inside, beyond: int(beyond.argmax()))
        ),
        "levers are square on an edge: do not take the load's distance from the middle": _radial(
            0.0
        ),
        "levers are square on an edge: do not take a distance along the arm": _radial(HALF.min()),
        "it stands to the outer edge of the shoes, not to the inner one": (
            _least(half=np.array([HALF[0], NARROW - BACKHOE.tracks.shoe_width / 2]))
        ),
        "half a gauge lies to each side, not the whole": (
            _least(half=np.array([HALF[0], HALF[1] + NARROW]))
        ),
        "length lies before and behind, gauge to the sides": _least(half=HALF[::-1]),
        "the right track is missing: an edge lies on both sides": _only([0, 1, 2]),
        "the right and the rear edge are missing: the arm can point there": _only([0, 1]),
        "the load lies at the bucket's centre of mass, not at the stick's": _least(
            frame="stick_com"
        ),
        "the undercarriage counts in the centre of mass, too": _without_tracks,
        "the share is upside down: P l = m d gives P = m d / l": (
            lambda q: BACKHOE.mass**2 / tipping_load(q)
        ),
        "the load is what is added: nothing is to be taken off it": (
            lambda q: tipping_load(q) - BACKHOE.mass
        ),
        "the machine is empty: the bucket's own mass is in the machine's already": (
            lambda q: tipping_load(q) - BACKHOE.bucket.mass
        ),
        "a factor 9.81: kilograms were asked for, not newtons": _scaled(BACKHOE.gravity),
        "three quarters of it is what a maker may print; here it is the load that tips": (
            _scaled(stability.TIPPING_SHARE)
        ),
        RADIANS: lambda q: float(_loads(np.radians(q))[2].min()),
    },
)
