"""Figures of the arm's control: the constants of the proof, certificates, runs, the gain space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.basics.inputs import number, numbers, positive
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.view.plots.style import GREEN, GREY, KINDS, RED, draw_lines, figure, styled

if TYPE_CHECKING:
    from backhoe.arm.lyapunov import Certificate, Profile
    from backhoe.arm.movement import Movement
    from backhoe.arm.pid import Gains

_PHASE, _RAN_AWAY = "#f1f1f1", "#3a3a3a"
_DECADES = 4
_ROUTES = ("scalar", "matrix")
_MANY = 1e6


@styled
def joint_movement(movement: Movement, phases: Mapping[str, tuple[float, float]]) -> Figure:
    """Angles and speeds of a movement, with its phases shaded in turn.

    Args:
        movement: the reference.
        phases: name -> its begin and end [s].
    """
    fig, axes = figure(6.8, 5.6, rows=2, sharex=True)
    angles, speeds = (
        dict(zip(JOINTS, np.degrees(values).T, strict=True)) for values in (movement.q, movement.dq)
    )
    for ax, curves in zip(axes, (angles, speeds), strict=True):
        _shade(ax, phases)
        draw_lines(ax, movement.t, curves)
    axes[1].plot(movement.t, np.degrees(movement.speed), "-.", color=GREEN, label="norm")
    axes[0].set(ylabel="angle of a joint [deg]", xlabel="time [s]")
    axes[1].set(ylabel="speed of a joint [deg/s]", xlabel="time [s]")
    axes[1].legend(ncols=5, loc="upper center", bbox_to_anchor=(0.5, -0.24), columnspacing=1.2)
    top = axes[0].get_ylim()[1]
    for name, (begin, end) in phases.items():
        axes[0].text((begin + end) / 2, top, name, ha="center", va="bottom", color=GREY)
    return fig


@styled
def arm_constants(time: ArrayLike, profile: Profile) -> Figure:
    """What the proof's constants come from, posture by posture.

    The first curve of a panel is an entry or an eigenvalue, the second the norm that counts.

    Args:
        time: shape (n,) [s].
        profile: of the postures at these times, from `lyapunov.profile`.
    """
    fig, axes = figure(6.8, 5.6, rows=2, columns=2, sharex=True)
    panels = (
        ("slope [kN m/rad]", {"max |dg/dq|": profile.slope, "spectral norm": profile.kg}),
        ("Coriolis [t m²]", {"max |C|": profile.symbol, "norm of C": profile.kc1}),
        ("inertia [t m²]", {"largest of M": profile.lambda_max, "smallest": profile.lambda_min}),
        ("ratio [1000 t m²]", {"largest² / smallest": profile.ratio / 1e3}),
    )
    for ax, (ylabel, curves) in zip(axes.flat, panels, strict=True):
        draw_lines(ax, time, {label: values / 1e3 for label, values in curves.items()})
        ax.set(ylabel=ylabel, ylim=(0, 1.35 * ax.dataLim.y1))
        ax.legend(loc="upper left", fontsize=9)
    axes[1, 0].set(yscale="log", ylim=(0.1, 2000))
    for ax in axes.flat:
        ax.set_xlabel("time [s]")
    return fig


@styled
def certificates(judged: Mapping[str, Certificate]) -> Figure:
    """The interval that each certificate leaves for alpha, or the gap where it leaves none.

    Args:
        judged: label -> certificate from `lyapunov.check_gains`.

    Raises:
        ValueError: no certificate.
    """
    if not judged:
        raise ValueError("no certificate to draw: give label -> lyapunov.check_gains(...)")
    fig, ax = figure(6.8, 1.3 + 0.52 * len(judged))
    for row, certificate in enumerate(reversed(judged.values())):
        low, high = certificate.alpha_low, certificate.alpha_high
        usable = np.isfinite(low) and high > 0
        holds = usable and low < high
        colour = GREEN if holds else RED
        if usable:
            ends = sorted((low, high))
            style = {"lw": 9, "alpha": 0.85} if holds else {"lw": 2.5, "ls": ":"}
            ax.plot(ends, [row, row], color=colour, solid_capstyle="butt", **style)
            ax.plot(low, row + 0.2, ">", color=GREY, ms=7, zorder=5)
            ax.plot(high, row - 0.2, "<", color=GREY, ms=7, zorder=5)
        text = _verdict(certificate, holds)
        ax.text(1.02, row, text, transform=ax.get_yaxis_transform(), va="center", color=colour)
    ax.set(yticks=range(len(judged)), yticklabels=list(judged)[::-1], xscale="log")
    ax.set(xlabel=r"$\alpha$ [1/s]: above ▶ for the springs, below ◀ for the dampers")
    ax.set(ylabel="gains and route", ylim=(-0.6, len(judged) - 0.4))
    return fig


def _verdict(certificate: Certificate, holds: bool) -> str:
    if not holds:
        return r"no $\alpha$"
    reach = certificate.region
    return f"‖error‖ < {reach:.2g} rad" if np.isfinite(reach) else "everywhere"


@styled
def margins(conditions: Mapping[str, tuple[float, float]]) -> Figure:
    """What there is over what is needed, one bar a condition: right of one it holds.

    Args:
        conditions: label -> (what there is, what it must exceed), in one unit, the latter positive.

    Raises:
        ValueError: no condition, or what is needed is not positive.
    """
    if not conditions:
        raise ValueError("no condition to draw: give label -> (have, need)")
    for label, (have, need) in conditions.items():
        number(have, f"{label}: what there is"), positive(need, f"{label}: what is needed")
    fig, ax = figure(6.8, 1.2 + 0.42 * len(conditions))
    for row, (have, need) in enumerate(reversed(conditions.values())):
        size = np.log10(np.clip(have / need, 10.0**-_DECADES, 10.0**_DECADES))
        ax.barh(row, size, color=GREEN if have > need else RED, height=0.55)
        side = -np.sign(size) or 1.0
        text = f"{have:.3g} > {need:.3g}" if have > need else f"{have:.3g}, needs {need:.3g}"
        ax.text(0.06 * side, row, text, va="center", ha="left" if side > 0 else "right", size=9)
    ax.axvline(0, color=GREY, lw=1.2)
    ax.set(yticks=range(len(conditions)), yticklabels=list(conditions)[::-1])
    ax.set(
        xlim=(-_DECADES, _DECADES), xlabel="what there is over what is needed [1]", ylabel="demand"
    )
    ax.set_xticks(range(-_DECADES, _DECADES + 1, 2), ["1/10⁴", "1/100", "1", "100", "10⁴"])
    return fig


def gain_demands(gains: Gains, machine: Machine = BACKHOE) -> Figure:
    """All demands on gains as `margins`: proof by two routes, drives, clock and memory.

    Args:
        gains: shape (4,) each [N m/rad, N m/(rad s), N m s/rad].
        machine: the arm.

    Raises:
        ValueError: a gain is not positive definite.
    """
    from backhoe.arm import lyapunov

    arm = lyapunov.constants(machine=machine)
    scalar, matrix = (lyapunov.check_gains(gains, constants=arm, route=r) for r in _ROUTES)
    postures = np.random.default_rng(0).uniform(machine.lower, machine.upper, (400, 4))
    fastest = _damping_rate(gains.kd, postures, machine)
    kp, ki, kd = (np.asarray(gain, dtype=float) for gain in gains)
    return margins(
        {
            "springs beat gravity": (kp.min(), arm.kg),
            "scalar: dampers": (kd.min(), min(scalar.alpha_low, _MANY) * arm.ratio),
            "matrix: room for alpha": (matrix.alpha_high, min(matrix.alpha_low, _MANY)),
            "drives: 0.05 rad fits": (1.0, (0.05 * kp / machine.torque_limit).max()),
            "clock: 100 Hz is enough": (200.0, fastest),
            "memory: learns in 10 s": (10.0, (kp / ki).max()),
        }
    )


def _damping_rate(kd: ArrayLike, postures: NDArray, machine: Machine) -> float:
    """Fastest rate of M^-1 K_d in these postures [1/s]."""
    root = np.sqrt(np.asarray(kd, dtype=float))
    mobility = np.linalg.inv(dynamics.mass_matrix(postures, machine))
    return float(np.linalg.eigvalsh(root[:, None] * mobility * root)[:, -1].max())


@styled
def joint_lines(
    time: ArrayLike,
    values: ArrayLike,
    ylabel: str,
    band: float | None = None,
    phases: Mapping[str, tuple[float, float]] = {},
    **settings: object,
) -> Figure:
    """One curve a joint over time, such as errors or torques.

    Args:
        time: shape (n,) [s].
        values: shape (n, 4).
        ylabel: quantity with its unit.
        band: draws dashed lines at plus and minus this, in the unit of `values`.
        phases: name -> its begin and end [s], shaded in turn.
        settings: passed to `Axes.set`.

    Raises:
        ValueError: values are not finite numbers of shape (n, 4).
    """
    shape = len(np.atleast_1d(time)), len(JOINTS)
    values = numbers(values, "values", shape, meaning="a row of 4 joints for each time")
    fig, ax = figure(6.8, 3.6)
    _shade(ax, phases)
    draw_lines(ax, time, dict(zip(JOINTS, values.T, strict=True)))
    if band is not None:
        for side in (-band, band):
            ax.axhline(side, **KINDS["reference"])
    ax.set(**{"xlabel": "time [s]", "ylabel": ylabel, **settings})
    ax.legend(ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return fig


@styled
def gain_space(
    stiffness: ArrayLike,
    damping: ArrayLike,
    errors: Sequence[ArrayLike],
    titles: Sequence[str],
    certified: Sequence[ArrayLike] = (),
    sampled: Sequence[ArrayLike] = (),
    marks: Mapping[str, tuple[float, float]] = {},
) -> Figure:
    """Error of closed-loop runs over the gain space, with the certified region drawn in.

    Args:
        stiffness, damping: factors on K_p and K_d of the grid, shapes (m,) and (n,) [1].
        errors: one panel each, shape (m, n) [rad]; infinite where the arm ran away.
        titles: one for each panel.
        certified: for each panel the smallest certified damping at each stiffness, shape (m,).
        sampled: for each panel the largest damping that the sampling bears, shape (m,).
        marks: label -> (stiffness, damping) of a point to mark in every panel.

    Raises:
        ValueError: a panel whose shape is not (m, n), or titles that do not fit.
    """
    m, n = len(np.atleast_1d(stiffness)), len(np.atleast_1d(damping))
    panels = [np.degrees(numbers(error, "errors", finite=False)) for error in errors]
    if len(panels) != len(titles) or any(panel.shape != (m, n) for panel in panels):
        raise ValueError(f"errors must be one ({m}, {n}) array for each of {len(titles)} titles")
    fig, axes = figure(6.8, 3.6, columns=len(panels), squeeze=False, sharey=True)
    drawn = [
        _gain_panel(ax, stiffness, damping, one) for ax, one in zip(axes[0], panels, strict=True)
    ]
    for k, (ax, title) in enumerate(zip(axes[0], titles, strict=True)):
        if len(certified):
            ax.plot(stiffness, certified[k], color=RED, lw=2.2, label="certified above")
        if len(sampled):
            ax.plot(stiffness, sampled[k], color=RED, lw=2.2, ls="--", label="too fast above")
        for (label, point), marker in zip(marks.items(), "o*sD", strict=False):
            ax.plot(*point, marker, color="white", mec=GREY, ms=10, label=label, ls="none")
        ax.set(title=title, xscale="log", yscale="log", xlabel="factor on $K_p$ [1]")
        ax.set(xlim=_edges(stiffness)[[0, -1]], ylim=_edges(damping)[[0, -1]])
        ax.grid(False)
        ax.set_ylabel("factor on $K_d$ [1]", visible=k == 0)
    fig.colorbar(drawn[-1], ax=axes[0], label="rms error [deg]", extend="max")
    handles, _ = axes[0, 0].get_legend_handles_labels()
    handles.append(Patch(color=_RAN_AWAY, label="ran away"))
    fig.legend(handles=handles, loc="outside lower center", ncols=4)
    return fig


def _gain_panel(ax: Axes, stiffness: ArrayLike, damping: ArrayLike, error: NDArray) -> object:
    ax.set_facecolor(_RAN_AWAY)
    grid, shown = (_edges(stiffness), _edges(damping)), np.ma.masked_invalid(error)
    return ax.pcolormesh(*grid, shown.T, cmap="viridis_r", norm=LogNorm(0.03, 30))


def _edges(centres: ArrayLike) -> NDArray:
    """Borders of cells about logarithmically spaced centres."""
    logs = np.log(np.asarray(centres, dtype=float))
    middle = (logs[1:] + logs[:-1]) / 2
    ends = 2 * logs[0] - middle[0], 2 * logs[-1] - middle[-1]
    return np.exp(np.concatenate([[ends[0]], middle, [ends[1]]]))


def _shade(ax: Axes, phases: Mapping[str, tuple[float, float]]) -> None:
    for begin, end in list(phases.values())[::2]:
        ax.axvspan(begin, end, color=_PHASE, lw=0, zorder=0)
