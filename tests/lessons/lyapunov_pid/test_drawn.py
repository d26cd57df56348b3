"""What the figures of lesson 03 show is what they were given."""

from types import SimpleNamespace

import numpy as np

from backhoe.arm import dynamics, lyapunov, movement
from backhoe.arm.pid import Gains
from backhoe.lessons.lyapunov_pid import figures
from backhoe.machine import BACKHOE
from drawn import Panel, box, cells, level, line, proofs, track, upright, words

T = np.array([0.0, 1.0, 2.0, 4.0])
VALUES = np.array([[0.1, 0.4, -0.3, 0.8]]) * np.array([[0.0], [1.0], [0.5], [-0.7]])
PHASES = {"wait": (0.0, 1.0), "load": (1.0, 3.0), "return": (3.0, 4.0)}
SHADES = [box(0.0, 0.0, 1.0, 1.0), box(3.0, 0.0, 4.0, 1.0)]
NAMES = ("swing", "boom", "stick", "bucket")


def moved():
    t = np.arange(5.0)
    q = np.outer(t, [0.1, -0.2, 0.3, 0.05])
    given = movement.Movement(t, q, 2 * q, 0 * q)
    items = [
        [line(t, np.degrees(k * q[:, j]), name) for j, name in enumerate(NAMES)] for k in (1, 2)
    ]
    items[1].append(line(t, np.degrees(np.linalg.norm(2 * q, axis=1)), "norm"))
    fig = figures.joint_movement(given, PHASES)
    top = fig.axes[0].get_ylim()[1]
    names = [words(name, (sum(span) / 2, top)) for name, span in PHASES.items()]
    return fig, [
        Panel("time [s]", "angle of a joint [deg]", [*items[0], *SHADES, *names]),
        Panel("time [s]", "speed of a joint [deg/s]", [*items[1], *SHADES]),
    ]


def constants():
    one = dict(zip(lyapunov.Profile._fields, (1 + np.arange(7)[:, None] + T), strict=True))
    one = lyapunov.Profile(**{name: 1e4 * values for name, values in one.items()})
    panels = [
        ("slope [kN m/rad]", {"max |dg/dq|": one.slope, "spectral norm": one.kg}, 1e3),
        ("Coriolis [t m²]", {"max |C|": one.symbol, "norm of C": one.kc1}, 1e3),
        ("inertia [t m²]", {"largest of M": one.lambda_max, "smallest": one.lambda_min}, 1e3),
        ("ratio [1000 t m²]", {"largest² / smallest": one.ratio}, 1e6),
    ]
    return figures.arm_constants(T, one), [
        Panel(
            "time [s]",
            label,
            [line(T, values / unit, name) for name, values in curves.items()],
            scales=("linear", "log" if row == 2 else "linear"),
        )
        for row, (label, curves, unit) in enumerate(panels)
    ]


def judged():
    holds = SimpleNamespace(alpha_low=1.0, alpha_high=8.0, region=5.4)
    fails = SimpleNamespace(alpha_low=3.0, alpha_high=0.1, region=0.0)
    always = SimpleNamespace(alpha_low=0.5, alpha_high=2.0, region=np.inf)
    items = []
    rows = (always, "everywhere"), (fails, r"no $\alpha$"), (holds, "‖error‖ < 5.4 rad")
    for row, (one, verdict) in enumerate(rows):
        low, high = one.alpha_low, one.alpha_high
        items += [line(sorted((low, high)), (row, row)), words(verdict, (1.02, row))]
        items += [line(low, row + 0.2), line(high, row - 0.2)]
    fig = figures.certificates({"holds": holds, "fails": fails, "always": always})
    names = [label.get_text() for label in fig.axes[0].get_yticklabels()]
    assert names == ["always", "fails", "holds"]
    xlabel = r"$\alpha$ [1/s]: above ▶ for the springs, below ◀ for the dampers"
    return fig, [Panel(xlabel, "gains and route", items, scales=("log", "linear"))]


def bars(conditions):
    items = [upright(0.0)]
    for row, (have, need) in enumerate(reversed(conditions.values())):
        size = np.clip(np.log10(have / need), -4, 4)
        text = f"{have:.3g} > {need:.3g}" if have > need else f"{have:.3g}, needs {need:.3g}"
        items += [box(0.0, row - 0.275, size, row + 0.275)]
        items += [words(text, (-0.06 if size > 0 else 0.06, row))]
    return [Panel("what there is over what is needed [1]", "demand", items)]


def margins():
    conditions = {"holds": (20.0, 10.0), "fails": (1.0, 10.0), "nearly": (9.0, 10.0)}
    fig = figures.margins(conditions)
    names = [label.get_text() for label in fig.axes[0].get_yticklabels()]
    assert names == ["nearly", "fails", "holds"]
    return fig, bars(conditions)


def demands():
    gains = Gains([3e5, 4e5, 2e5, 1e5], [3e4, 9e4, 5e4, 2e4], [9e4, 9e4, 5e4, 2e4])
    arm = lyapunov.constants()
    scalar, matrix = (lyapunov.check_gains(gains, route=r) for r in ("scalar", "matrix"))
    q = np.random.default_rng(0).uniform(BACKHOE.lower, BACKHOE.upper, (400, 4))
    rates = np.linalg.eigvals(np.linalg.solve(dynamics.mass_matrix(q), np.diag(gains.kd)))
    kp, ki, kd = map(np.array, (gains.kp, gains.ki, gains.kd))
    return figures.gain_demands(gains), bars(
        {
            "springs": (kp.min(), arm.kg),
            "scalar": (kd.min(), min(scalar.alpha_low, 1e6) * arm.ratio),
            "matrix": (matrix.alpha_high, min(matrix.alpha_low, 1e6)),
            "drives": (1.0, (0.05 * kp / BACKHOE.torque_limit).max()),
            "clock": (200.0, rates.real.max()),
            "memory": (10.0, (kp / ki).max()),
        }
    )


def errors():
    items = [line(T, curve, name) for curve, name in zip(VALUES.T, NAMES, strict=True)]
    items += [*SHADES, level(-2.0), level(2.0)]
    fig = figures.joint_lines(T, VALUES, "error [deg]", band=2.0, phases=PHASES)
    return fig, [Panel("time [s]", "error [deg]", items)]


def space():
    stiff, damp = np.geomspace(0.1, 10.0, 3), np.geomspace(0.01, 1.0, 4)
    error = np.radians(np.arange(1.0, 13.0).reshape(3, 4))
    error[0, 3] = np.inf
    edges = [np.append(v, v[-1] * v[1] / v[0]) / np.sqrt(v[1] / v[0]) for v in (stiff, damp)]
    shown = np.degrees(np.where(np.isfinite(error), error, np.nan)).T
    panels = []
    for k, title in enumerate(("one", "two")):
        items = [
            cells(*edges, (k + 1) * shown),
            line(stiff, damp[0] * (k + 1) * np.ones(3), "certified above"),
            line(stiff, damp[2] * (k + 1) * np.ones(3), "too fast above"),
            track([(1.0, 0.2)], "tuned"),
        ]
        panels.append(
            Panel("factor on $K_p$ [1]", "factor on $K_d$ [1]", items, title, ("log", "log"))
        )
    certified, sampled = ([damp[i] * (k + 1) * np.ones(3) for k in (0, 1)] for i in (0, 2))
    marks = {"tuned": (1.0, 0.2)}
    fig = figures.gain_space(
        stiff, damp, [error, 2 * error], ["one", "two"], certified, sampled, marks
    )
    return fig, panels


TestDrawn = proofs(
    figures,
    {
        "arm_constants": constants,
        "certificates": judged,
        "gain_demands": demands,
        "gain_space": space,
        "joint_lines": errors,
        "joint_movement": moved,
        "margins": margins,
    },
)
