"""The dynamic movement primitive: learnt from demonstrations, rolled out to any goal.

Written here as a spring whose far end u moves; v = tau dx/dt. Then

    tau dv/dt = K (u - x) - D v,    u = g - (g - x0) s + f(s)      (6.4)

and learning asks which u would have moved the spring as the demonstration went:
u = x + (tau dv/dt + D v) / K, which is (6.8). For large K the spring lies at u.

Sources: Mastalli 2013, (6.4) to (6.10), after Pastor et al. 2009; Ijspeert et al. 2003; Hoffmann
et al. 2008, whose frog's force fields K (1 - s)(g - x) + K s (c(s) + x0 - x) sum to (6.4) with
f = s c.
"""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp import spring
from backhoe.planning.dmp.kernels import FITS, Basis, Kernels, fit
from backhoe.planning.dmp.motion import Motion, motion
from backhoe.planning.dmp.phase import END_PHASE, phase_rate
from backhoe.planning.dmp.remedies import (
    REMEDIES,
    Coupling,
    displacement,
    end_exactly,
    integrate,
    moved,
)

FORMULATIONS = ("pastor", "hoffmann", "ijspeert")


class DMP:
    """A movement primitive in any number of dimensions.

    Args:
        kernels: how many.
        stiffness: K [1].
        damping: D [1]; None: critical, 2 sqrt(K).
        tau: factor of time of the demonstration [s]; only K / tau^2 and D / tau count.
        end_phase: phase at the end of the movement.
        width: standard deviation of a kernel over the distance to the next.
        spacing: of the kernels, "exponential", "uniform" or "time", as for `Kernels`.
        formulation: "pastor", "hoffmann" (the same movement) or "ijspeert".
        fit: "ridge", all weights together, or "lwr", each alone, which smooths.
        ridge: of the first.
        smoothing: half width of the window for velocities and accelerations [s]; 0: none.

    Attributes:
        start, goal: of the demonstration, means over several, shapes (d,) [unit].
        duration, step: of the demonstration [s].
        weights: shape (kernels, d) [unit; of "ijspeert": 1].
        velocities: at start and end of the demonstration, shape (2, d) [unit/s].
        shown: the motions that it learnt from.

    Raises:
        ValueError: a number out of its bounds, or an unknown word.
    """

    def __init__(
        self,
        kernels: int = 100,
        stiffness: float = 50_000.0,
        damping: float | None = None,
        tau: float = 6.0,
        *,
        end_phase: float = END_PHASE,
        width: float = 1.2,
        spacing: str = "exponential",
        formulation: str = "pastor",
        fit: str = "ridge",
        ridge: float = 1e-9,
        smoothing: float = 0.0,
    ) -> None:
        self.kernels = Kernels(kernels, width, spacing, end_phase)
        if damping is None:
            damping = 2 * inputs.positive(stiffness, "stiffness") ** 0.5
        spring_ = spring.checked(stiffness, inputs.positive(damping, "damping"), tau)
        self.stiffness, self.damping, self.tau = spring_
        self.formulation = inputs.choice(formulation, "formulation", FORMULATIONS)
        self.fit = inputs.choice(fit, "fit", FITS)
        self.ridge = inputs.not_negative(ridge, "ridge")
        self.smoothing = inputs.not_negative(smoothing, "smoothing", "s")
        self.shown: list[Motion] = []

    @property
    def alpha(self) -> float:
        """Of tau ds/dt = -alpha s, by (6.10) [1]."""
        return phase_rate(self.duration, self.tau, self.kernels.end_phase)

    def learn(self, positions: ArrayLike | list, times: ArrayLike | list) -> DMP:
        """Learn from one demonstration or from several, and return the primitive itself.

        Args:
            positions: shape (m, d), or a list of such arrays [any unit].
            times: rising, shape (m,), or one step, or a list of either, one a demonstration [s].

        Raises:
            ValueError: as for `motion`; demonstrations of different dimensions; "ijspeert"
                with a dimension that ends where it began.
        """
        shown = _several(positions, times, self.smoothing)
        self.start = np.mean([one.x[0] for one in shown], axis=0)
        self.goal = np.mean([one.x[-1] for one in shown], axis=0)
        self.duration = float(np.mean([one.duration for one in shown]))
        self.step = self.duration / (len(shown[0].t) - 1)
        ends = [one.v[[0, -1]] * one.duration / self.duration for one in shown]
        self.velocities = np.mean(ends, axis=0)
        bases = [self.kernels.basis(one.t / one.duration) for one in shown]
        pairs = zip(shown, bases, strict=True)
        targets = [self.forcing(one, basis) for one, basis in pairs]
        self.weights = fit(bases, targets, self.fit, self.ridge)
        self.shown = shown
        return self

    def forcing(self, shown: Motion, basis: Basis) -> NDArray:
        """f that would have moved the spring as shown, shape (m, d) [unit]: (6.8).

        Args:
            shown: m samples of d dimensions.
            basis: the kernels at their shares of the duration.

        Raises:
            TypeError: shown is no Motion or basis no Basis.
            ValueError: a basis of other samples; "ijspeert" with a dimension that ends where it
                began.
        """
        from backhoe.planning.dmp import engine

        inputs.instance(shown, "shown", Motion, "motion(positions, times) makes one")
        inputs.instance(basis, "basis", Basis, "Kernels.basis(share) makes one")
        if len(basis.s) != len(shown.t):
            raise ValueError(f"basis must have {len(shown.t)} samples, got {len(basis.s)}")

        tau = self.tau * shown.duration / self.duration
        by_v, by_a = tau * self.damping / self.stiffness, tau**2 / self.stiffness
        start, goal, f = shown.x[0], shown.x[-1], np.empty(shown.x.shape)
        old = self.formulation == "ijspeert"
        s = np.zeros(len(f)) if old else basis.s
        engine.wanted(shown.x, shown.v, shown.a, s, start, goal, by_v, by_a, f)
        return f / displacement(start, goal, 'formulation "ijspeert"') if old else f

    def with_weights(self, weights: ArrayLike) -> DMP:
        """The same primitive with other weights, shape (kernels, d) [unit]; ValueError if not."""
        other = copy(self._learnt())
        other.weights = inputs.numbers(weights, "weights", self.weights.shape)
        return other

    def forcing_error(self) -> NDArray:
        """Root mean square of learnt less wanted f over all samples, shape (d,) [unit]."""
        left = []
        for one in self._learnt().shown:
            basis = self.kernels.basis(one.t / one.duration)
            left.append(basis.mixed(self.weights) - self.forcing(one, basis))
        return np.sqrt(np.mean(np.concatenate(left) ** 2, axis=0))

    def spread(self, samples: int = 101) -> tuple[NDArray, NDArray, NDArray]:
        """Mean and spread of the demonstrations at even shares of their durations.

        Args:
            samples: how many.

        Returns:
            Times of the mean duration (samples,) [s]; means and standard deviations, shapes
            (samples, d) [unit].
        """
        share = np.linspace(
            0.0, 1.0, inputs.whole(samples, "samples", least=2, most=spring.MOST_STEPS)
        )
        paths = [
            [np.interp(share, one.t / one.duration, column) for column in one.x.T]
            for one in self._learnt().shown
        ]
        return share * self.duration, np.mean(paths, axis=0).T, np.std(paths, axis=0).T

    def rollout(
        self,
        start: ArrayLike | None = None,
        goal: ArrayLike | None = None,
        duration: float | None = None,
        dt: float | None = None,
        remedy: str = "none",
        *,
        velocity: ArrayLike | None = None,
        exact_end: bool = False,
        integrator: str = "exact",
        coupling: Coupling | None = None,
    ) -> tuple[NDArray, NDArray, NDArray]:
        """The movement from a start to a goal.

        Args:
            start, goal: shapes (d,) [unit]; those of the demonstration if None.
            duration: tau is stretched with it [s]; that of the demonstration if None.
            dt: step, shortened so that whole steps fill the duration [s]; that of the demonstration
                if None.
            remedy: what a new start or goal does to the shape: "none", (6.4) as it is; "scaled",
                each dimension by its displacement over the demonstrated one; "affine", a shift that
                grows with the way made towards the goal; "minimum_jerk", one that grows with time.
            velocity: at the start, shape (d,) [unit/s]; as demonstrated if None.
            exact_end: whether the miss at the end is taken off by a minimum-jerk correction.
            integrator: as for `step_matrix`.
            coupling: function (t, x, v) -> further acceleration, shape (d,) [unit/s^2].

        Returns:
            Times (m,) [s], positions (m, d) [unit], velocities (m, d) [unit/s].

        Raises:
            ValueError: another shape, values not finite, a step beyond the integrator's limit, an
                unknown word, or a remedy that needs a displacement where there is none.
            RuntimeError: not learnt yet.
        """
        d = len(self._learnt().start)
        start = self.start if start is None else inputs.numbers(start, "start", (d,))
        goal = self.goal if goal is None else inputs.numbers(goal, "goal", (d,))
        whole = self.duration if duration is None else duration
        whole = inputs.number(whole, "duration", "s", least=1e-5, most=1e8)
        dt = self.step * whole / self.duration if dt is None else inputs.positive(dt, "dt", "s")
        inputs.choice(remedy, "remedy", REMEDIES)
        inputs.choice(integrator, "integrator", spring.INTEGRATORS)
        steps = spring.whole_steps(whole, dt)
        tau, share = self.tau * whole / self.duration, np.arange(steps + 1) / steps
        spring_ = (self.stiffness, self.damping, tau)
        if integrator != "exact":
            limit = spring.step_limit(*spring_, integrator)
            spring.refuse_unstable(whole / steps, limit, integrator)
        pulled, A = self._pulled(share, start, goal, whole, remedy)
        at_ends = self.velocities @ A.T * (self.duration / whole)
        first = at_ends[0] if velocity is None else inputs.numbers(velocity, "velocity", (d,))
        M = spring.step_matrix(whole / steps, *spring_, integrator)
        t = whole * share
        if coupling is None:
            x, v = spring.follow(pulled, start, first, M)
        else:
            x, v = integrate(pulled, start, first, M, t, coupling, tau**2 / self.stiffness)
        if inputs.flag(exact_end, "exact_end"):
            x, v = end_exactly(x, v, share, whole, goal, at_ends[1])
        return t, x, v

    def _pulled(
        self, share: NDArray, start: NDArray, goal: NDArray, whole: float, remedy: str
    ) -> tuple[NDArray, NDArray]:
        """Places of the spring's far end, shape (m, d), and the map A of the path, shape (d, d)."""
        basis = self.kernels.basis(share)
        f, s = basis.mixed(self.weights), basis.s[:, None]
        if remedy == "none":
            return self._far_end(f, s, start, goal), np.eye(len(start))
        learnt = self._far_end(f, s, self.start, self.goal)
        lags = self.damping / self.stiffness * self.tau, self.tau**2 / self.stiffness
        ends = np.array([self.start, self.goal]), np.array([start, goal])
        return moved(learnt, share, *ends, remedy, lags, self.duration)

    def _far_end(self, f: NDArray, s: NDArray, start: NDArray, goal: NDArray) -> NDArray:
        if self.formulation == "ijspeert":
            return goal + (goal - start) * f
        if self.formulation == "hoffmann":
            return (1 - s) * goal + s * (f / s + start)
        f += goal - (goal - start) * s
        return f

    def _learnt(self) -> DMP:
        if not hasattr(self, "weights"):
            raise RuntimeError("the primitive has learnt nothing yet: call learn(positions, times)")
        return self


def _several(
    positions: ArrayLike | list, times: ArrayLike | list, smoothing: float
) -> list[Motion]:
    """One demonstration or a list of them, all of as many dimensions."""
    many = isinstance(positions, (list, tuple)) and np.ndim(positions[0] if positions else 0) == 2
    if not many:
        return [motion(positions, times, smoothing)]
    shared = not isinstance(times, (list, tuple)) and np.ndim(times) == 0
    clocks = [times] * len(positions) if shared else list(times)
    if len(clocks) != len(positions):
        raise ValueError(
            f"times must be one step, or one entry for each of {len(positions)} demonstrations, "
            f"got {len(clocks)}"
        )
    shown = []
    for k, (x, t) in enumerate(zip(positions, clocks, strict=True)):
        try:
            shown.append(motion(x, t, smoothing))
        except ValueError as error:
            raise ValueError(f"demonstration {k}: {error}") from error
    sizes = {one.x.shape[1] for one in shown}
    if len(sizes) > 1:
        raise ValueError(f"positions must have one number of dimensions, got {sorted(sizes)}")
    return shown
