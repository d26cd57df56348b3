"""What is learnt from: uneven times, noise, several demonstrations, and the regressions."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.planning.dmp import (
    DMP,
    Kernels,
    engine,
    loops,
    minimum_jerk,
    motion,
    phase,
    recorded,
    repetitions,
)
from backhoe.planning.dmp import demonstration as shown
from backhoe.planning.dmp.kernels import fit

RNG = np.random.default_rng(3)
UNEVEN = np.r_[0.0, np.cumsum(RNG.uniform(0.016, 0.151, 80))]


def test_differences_and_parabolas_are_exact_for_parabolas_at_uneven_times():
    x = np.column_stack([1 + 2 * UNEVEN - 3 * UNEVEN**2, 0.5 * UNEVEN**2])
    for smoothing in (0.0, 0.6):
        found = motion(x, UNEVEN + 7.0, smoothing)
        assert np.abs(found.x - x).max() < 1e-8
        assert np.abs(found.v - np.column_stack([2 - 6 * UNEVEN, UNEVEN])).max() < 1e-8
        assert np.abs(found.a - [-6.0, 1.0]).max() < 1e-7


def test_smoothing_takes_most_of_the_noise_from_the_accelerations():
    clean = shown("dig", 0.02)
    noisy = recorded(shown("dig"), 1)
    rough, smooth = (motion(noisy.positions, noisy.times, one) for one in (0.0, 0.5))
    truth = motion(clean.positions, clean.times)
    wanted = np.column_stack([np.interp(noisy.times, truth.t, a) for a in truth.a.T])
    errors = [np.sqrt(np.mean((one.a - wanted) ** 2)) for one in (rough, smooth)]
    assert errors[1] < errors[0] / 20
    dmp = DMP(smoothing=0.5).learn(noisy.positions, noisy.times)
    t, x, _ = dmp.rollout(dt=0.02)
    assert np.abs(np.interp(t, clean.times, clean.positions[:, 2]) - x[:, 2]).max() < 0.01


@pytest.mark.parametrize("spacing", ["exponential", "uniform", "time"])
def test_the_kept_kernels_are_those_of_the_formula(spacing):
    """F_i = psi_i s / sum(psi), all kernels at all samples, by NumPy."""
    kernels = Kernels(12, 0.9, spacing)
    u = np.linspace(0, 1, 40)
    s = phase(u, 1.0)
    where = u if spacing == "time" else s
    psi = np.exp(-kernels.sharpness * (where[:, None] - kernels.centres) ** 2)
    dense = kernels.basis(u).dense()
    assert np.abs(dense - psi * s[:, None] / psi.sum(axis=1, keepdims=True)).max() < 1e-12
    basis = kernels.basis(u)
    f = np.column_stack([np.sin(5 * u), u])
    above, below = (psi * s[:, None]).T @ f, (psi * s[:, None] ** 2).sum(axis=0)
    assert fit([basis], [f], "lwr", 0) == pytest.approx(above / below[:, None], rel=1e-9)
    least = np.linalg.lstsq(dense, f, rcond=None)[0]
    assert dense @ fit([basis], [f], "ridge", 1e-14) == pytest.approx(dense @ least, abs=1e-5)


def test_several_demonstrations_are_learnt_together_and_their_spread_is_told():
    t = np.linspace(0, 3, 301)
    m = minimum_jerk(t / 3)[0]
    bump = t**2 * (3 - t) ** 2 / 5
    pair = [np.column_stack([m + sign * bump, 2 * m]) for sign in (1, -1)]
    dmp = DMP(kernels=40).learn(pair, [t, 1.5 * t])
    assert dmp.duration == pytest.approx(3.75)
    _, mean, deviation = dmp.spread(301)
    assert np.abs(mean[:, 0] - m).max() < 1e-9
    assert np.abs(deviation[:, 0] - bump).max() < 1e-9 and deviation[:, 1].max() < 1e-9
    assert np.abs(dmp.rollout(dt=0.0125)[1][:, 0] - m).max() < 5e-3
    many = repetitions("dig", 3)
    dmp = DMP(smoothing=0.5).learn([x for _, x in many], [t for t, _ in many])
    assert len(dmp.shown) == 3
    assert dmp.goal == pytest.approx(np.mean([one.x[-1] for one in dmp.shown], axis=0))


def test_a_last_velocity_is_kept():
    t = np.linspace(0, 2, 201)
    dmp = DMP(kernels=60).learn(np.sin(t), t)
    _, _, v = dmp.rollout(exact_end=True)
    assert v[-1, 0] == pytest.approx(np.cos(2), abs=1e-3)
    assert dmp.rollout()[2][-1, 0] == pytest.approx(np.cos(2), abs=0.05)
    assert v[0, 0] == pytest.approx(1.0, abs=1e-3)


def test_the_compiled_loops_are_the_plain_ones():
    u, places = np.linspace(0, 1, 30), RNG.normal(size=(30, 4))
    results = []
    for way in (loops, engine):
        x, v, a = np.empty((3, 30, 4))
        way.differences(u, places, v, a)
        way.parabolas(u, places, 0.2, x, v, a)
        kernels = Kernels(7)
        first, counts = np.empty((2, 30), np.int64)
        s = phase(u, 1.0)
        way.reach(s, kernels.centres, kernels.sharpness, first, counts)
        offsets = np.r_[0, np.cumsum(counts)]
        values, totals = np.empty(offsets[-1]), np.empty(30)
        way.kernels(s, s, kernels.centres, kernels.sharpness, first, offsets, values, totals)
        f, sums, gram = np.empty((30, 4)), np.zeros((7, 4)), np.zeros((7, 7))
        way.mixed(first, offsets, values, RNG.normal(size=(7, 4)) * 0 + 1.5, f)
        way.weighed(first, offsets, values, totals, places, sums)
        way.products(first, offsets, values, gram)
        results.append([x, v, a, values, totals, f, sums, gram])
    for plain, fast in zip(*results, strict=True):
        assert fast == pytest.approx(plain, rel=1e-12, abs=1e-12)


def test_bad_demonstrations_are_refused_by_what_is_wrong():
    t, x = np.linspace(0, 1, 11), np.zeros((11, 2))
    for positions, times, said in (
        (x[:4], t[:4], "5 or more samples in a row, got 4"),
        (np.where(np.arange(11)[:, None] == 3, np.nan, x), t, "positions must be finite"),
        (x, np.r_[t[:5], t[4], t[6:]], "times must rise"),
        (x, t[::-1], "times must rise"),
        (x, t[:-1], "times must be as many as positions, 11, got 10"),
        ([x, x[:, :1]], t[1], "one number of dimensions, got"),
        ([x, x[:3]], t[1], "demonstration 1: positions must have 5"),
    ):
        with pytest.raises(ValueError, match=said):
            DMP().learn(positions, times)
    with pytest.raises(ValueError, match="displacement, which is 0 in dimension 0"):
        DMP(formulation="ijspeert").learn(x, t)
    still = DMP().learn(x, t)
    with pytest.raises(ValueError, match='remedy "scaled" divides by'):
        still.rollout(goal=[1, 1], remedy="scaled")
    with pytest.raises(ValueError, match="ends elsewhere than it began"):
        still.rollout(goal=[1, 1], remedy="affine")
    with pytest.raises(ValueError, match="must reach 5 samples"):
        DMP(smoothing=0.1).learn(x, t)
    with pytest.raises(RuntimeError, match="learnt nothing yet"):
        DMP().rollout()
