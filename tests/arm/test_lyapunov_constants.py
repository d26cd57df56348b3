"""The constants from their definitions: never exceeded, reached, and bounded from above."""

from dataclasses import FrozenInstanceError
from itertools import product

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from backhoe.arm import dynamics, lyapunov
from backhoe.arm.dynamics.terms import Vectors, arm_of, inertia_slopes
from backhoe.arm.lyapunov.bilinear import bilinear_norm, bilinear_value, unfolded_bound
from backhoe.arm.lyapunov.suprema import domain_of
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded, scaled

DOMAINS = ("box", "torus")
NAMES = ("kg", "kc1", "lambda_min", "lambda_max", "ratio", "largest_slope", "largest_symbol")


@pytest.fixture
def rng():
    return np.random.default_rng(33)


def postures(rng, domain, count):
    where = domain_of(None, domain)
    return rng.uniform(where.lower, where.upper, (count, 4))


def quantities(q):
    """What the constants are the extremes of, at each posture."""
    ends = np.linalg.eigvalsh(dynamics.mass_matrix(q))
    slope, symbol = lyapunov.gravity_slope(q), lyapunov.christoffel(q)
    return {
        "kg": np.linalg.norm(slope, 2, axis=(-2, -1)),
        "kc1": bilinear_norm(symbol)[0],
        "lambda_min": ends[..., 0],
        "lambda_max": ends[..., -1],
        "ratio": ends[..., -1] ** 2 / ends[..., 0],
        "largest_slope": np.abs(slope).max(axis=(-2, -1)),
        "largest_symbol": np.abs(symbol).max(axis=(-3, -2, -1)),
    }


# Bounds from above, by branch and bound: a cell's value is at most that of its middle and, for
# each joint, half the cell's width times the steepest slope that the arm's lengths allow.


class Interval:
    """Numbers between two ends: enough of interval arithmetic for `terms`."""

    def __init__(self, low, high):
        self.low, self.high = low, high

    @staticmethod
    def of(value):
        return value if isinstance(value, Interval) else Interval(value, value)

    def __add__(self, other):
        other = Interval.of(other)
        return Interval(self.low + other.low, self.high + other.high)

    def __sub__(self, other):
        return self + (-1.0) * Interval.of(other)

    def __mul__(self, other):
        other = Interval.of(other)
        ends = [a * b for a, b in product((self.low, self.high), (other.low, other.high))]
        return Interval(min(ends), max(ends))

    __radd__, __rmul__ = __add__, __mul__

    @property
    def size(self):
        return max(abs(self.low), abs(self.high))


def any_posture():
    """The vectors of `terms` with every component between minus and plus its length."""
    arm = arm_of(BACKHOE)
    masses = [(arm.along2, arm.across2), (arm.along3, arm.across3), (arm.along4, arm.across4)]
    lengths = [arm.L2, arm.L3, *np.hypot(*np.transpose(masses))]
    return arm, Vectors(*(Interval(-size, size) for size in np.repeat(lengths, 2)))


def steepest_mass_matrix():
    """Bounds on the spectral norms of dM/dq_2, dM/dq_3 and dM/dq_4 over all postures."""
    slopes = inertia_slopes(*any_posture())
    by_q2, by_q3, by_q4, l2_l3, l2_c4, l3_c4 = (slope.size for slope in slopes)
    both = l2_l3 + l2_c4
    by_stick = [[2 * both, both, l2_c4], [both, 0, 0], [l2_c4, 0, 0]]
    last = l2_c4 + l3_c4
    by_bucket = [
        [2 * last, l2_c4 + 2 * l3_c4, last],
        [l2_c4 + 2 * l3_c4, 2 * l3_c4, l3_c4],
        [last, l3_c4, 0],
    ]
    plane = [0.0, np.linalg.norm(by_stick, 2), np.linalg.norm(by_bucket, 2)]
    return np.maximum([by_q2, by_q3, by_q4], plane)


def bound_from_above(f, slopes, domain, tolerance):
    """An upper bound of f over the domain, no more than `tolerance` above a value of f."""
    where = domain_of(None, domain)
    half = (where.upper - where.lower)[1:] / 24
    axes = [
        np.linspace(low + h, high - h, 12)
        for low, high, h in zip(where.lower[1:], where.upper[1:], half, strict=True)
    ]
    middles = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    best = 0.0
    while True:
        values = f(np.pad(middles, ((0, 0), (1, 0))))
        best = max(best, values.max())
        above = values + slopes @ half
        if above.max() <= best * (1 + tolerance):
            return above.max()
        keep = middles[above > best * (1 + tolerance)]
        half = half / 2
        middles = (keep[:, None] + corners * 2 * half).reshape(-1, 3)
        assert len(middles) < 3e6, "the bound does not close"


@pytest.mark.parametrize("domain", DOMAINS)
def test_lambda_max_is_within_a_hundredth_of_a_bound_from_above(domain):
    def highest(q):
        return np.linalg.eigvalsh(dynamics.mass_matrix(q))[:, -1]

    above = bound_from_above(highest, steepest_mass_matrix(), domain, 0.01)
    assert above / 1.0101 <= lyapunov.constants(domain=domain).lambda_max <= above


@pytest.mark.parametrize("domain", DOMAINS)
def test_kg_is_within_a_hundredth_of_a_bound_from_above(domain):
    arm, v = any_posture()
    bucket = arm.g * arm.m_bu * v.c4z.size
    stick = arm.g * (arm.m_s * v.c3z.size + arm.m_bu * v.l3z.size)
    boom = arm.g * (arm.m_bo * v.c2z.size + (arm.m_s + arm.m_bu) * v.l2z.size)
    # dg/dq = a_2 uu' + a_3 vv' + a_4 ww' with |u|^2 = 1, |v|^2 = 2, |w|^2 = 3
    slopes = np.cumsum([3 * bucket, 2 * stick, boom])[::-1]

    def size(q):
        return np.linalg.norm(lyapunov.gravity_slope(q), 2, axis=(-2, -1))

    above = bound_from_above(size, slopes, domain, 0.01)
    assert above / 1.0101 <= lyapunov.constants(domain=domain).kg <= above


@pytest.mark.parametrize("domain", DOMAINS)
def test_a_fine_grid_comes_close_to_lambda_min_and_not_below(domain):
    # the least eigenvalue belongs to boom, stick and bucket, which only the last two angles change
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (2000, 4))
    assert (dynamics.mass_matrix(q)[:, 0, 0] > 23000).all()
    grid = domain_of(None, domain)
    axes = [np.linspace(grid.lower[j], grid.upper[j], 501) for j in (2, 3)]
    stick, bucket = (axis.ravel() for axis in np.meshgrid(*axes))
    fine = np.stack([0 * stick, 0 * stick, stick, bucket], axis=-1)
    lowest = np.linalg.eigvalsh(dynamics.mass_matrix(fine))[:, 0].min()
    found = lyapunov.constants(domain=domain).lambda_min
    assert found <= lowest < 1.001 * found


def test_kg_over_all_angles_is_reached_when_all_levers_stand_upright():
    arm, _ = any_posture()
    boom = np.hypot(arm.m_bo * arm.along2 + (arm.m_s + arm.m_bu) * arm.L2, arm.m_bo * arm.across2)
    stick = np.hypot(arm.m_s * arm.along3 + arm.m_bu * arm.L3, arm.m_s * arm.across3)
    bucket = arm.m_bu * np.hypot(arm.along4, arm.across4)
    a, b, c = arm.g * np.cumsum([bucket, stick, boom])[::-1]
    H = np.array([[a, b, c], [b, b, c], [c, c, c]])
    found = lyapunov.constants(domain="torus").kg
    assert found == pytest.approx(np.linalg.norm(H, 2), rel=1e-9)


# never exceeded, reached


@pytest.mark.parametrize("domain", DOMAINS)
def test_no_random_posture_exceeds_the_constants(rng, domain):
    c = lyapunov.constants(domain=domain)
    found = quantities(postures(rng, domain, 8000))
    for name in NAMES:
        if name == "lambda_min":
            assert found[name].min() >= c.lambda_min
        else:
            assert found[name].max() <= getattr(c, name)


@pytest.mark.parametrize("domain", DOMAINS)
def test_every_constant_is_reached_at_the_posture_that_it_names(domain):
    c = lyapunov.constants(domain=domain)
    where = domain_of(None, domain)
    for name in NAMES:
        q = c.where[name]
        assert domain == "torus" or ((q >= where.lower) & (q <= where.upper)).all()
        assert quantities(q)[name] == pytest.approx(getattr(c, name), rel=1e-9)


@pytest.mark.parametrize("name", ["kg", "lambda_min", "lambda_max", "ratio"])
def test_scipy_finds_no_other_extreme_in_the_box(name):
    sign = 1 if name == "lambda_min" else -1
    sides = list(zip(BACKHOE.lower[1:], BACKHOE.upper[1:], strict=True))

    def cost(arm):
        q = np.pad(arm.T, ((0, 0), (1, 0)))
        ends = np.linalg.eigvalsh(dynamics.mass_matrix(q))
        slope = np.linalg.norm(lyapunov.gravity_slope(q), 2, axis=(-2, -1))
        values = {
            "kg": slope,
            "lambda_min": ends[:, 0],
            "lambda_max": ends[:, -1],
            "ratio": ends[:, -1] ** 2 / ends[:, 0],
        }
        return sign * values[name]

    best = differential_evolution(
        cost, sides, seed=1, tol=1e-10, vectorized=True, updating="deferred", polish=False
    )
    assert sign * best.fun == pytest.approx(getattr(lyapunov.constants(), name), rel=1e-6)


@pytest.mark.parametrize("domain", DOMAINS)
def test_kc1_bounds_random_vectors_and_scipy_finds_no_larger(rng, domain):
    c, where = lyapunov.constants(domain=domain), domain_of(None, domain)
    q, x, y = postures(rng, domain, 100_000), *rng.normal(size=(2, 100_000, 4))
    turned = (dynamics.coriolis_matrix(q, x) @ y[..., None])[..., 0]
    share = np.linalg.norm(turned, axis=-1) / np.linalg.norm(x, axis=-1)
    assert (share / np.linalg.norm(y, axis=-1)).max() <= c.kc1

    def cost(columns):
        q, x = np.pad(columns[:3].T, ((0, 0), (1, 0))), columns[3:].T
        size = np.linalg.norm(bilinear_value(lyapunov.christoffel(q), x), axis=-1)
        return -size / (x * x).sum(axis=-1)

    sides = [*zip(where.lower[1:], where.upper[1:], strict=True), *[(-1.0, 1.0)] * 4]
    best = differential_evolution(
        cost, sides, seed=2, tol=1e-9, vectorized=True, updating="deferred", polish=False
    )
    assert -best.fun == pytest.approx(c.kc1, rel=1e-5)


def test_the_norm_of_a_bilinear_map_is_certified_by_a_net_of_directions(rng):
    """||C_z|| is convex in z, so a net whose hull holds a ball of radius r bounds it up to 1/r."""
    steps = np.linspace(-1, 1, 9)
    net = np.array([z for z in product(steps, repeat=4) if max(map(abs, z)) == 1.0])
    net = net / np.linalg.norm(net, axis=-1, keepdims=True)
    # every unit vector is near one of the net, whose hull therefore holds the ball of that cosine
    probes = rng.normal(size=(20_000, 4))
    probes /= np.linalg.norm(probes, axis=-1, keepdims=True)
    radius = (probes @ net.T).max(axis=-1).min() - 0.005
    symbols = lyapunov.christoffel(rng.uniform(-np.pi, np.pi, (60, 4)))
    bent = np.einsum("zk,nkij->nzij", net, symbols)
    widest = np.abs(np.linalg.eigvalsh(bent)).max(axis=(-2, -1))
    norm, vector = bilinear_norm(symbols)
    assert radius > 0.97
    assert (norm >= widest * (1 - 1e-12)).all()
    assert (norm <= widest / radius).all()
    assert (norm <= unfolded_bound(symbols)).all()
    reached = np.linalg.norm(bilinear_value(symbols, vector), axis=-1)
    np.testing.assert_allclose(reached, norm)
    np.testing.assert_allclose(np.linalg.norm(vector, axis=-1), 1.0)


def test_the_bound_by_unfolding_is_above_the_norm_and_reached_by_a_map_of_one_vector(rng):
    B = rng.normal(size=(200, 4, 4, 4))
    B = B + np.swapaxes(B, -1, -2)
    bound, norm = unfolded_bound(B), bilinear_norm(B)[0]
    assert (bound >= norm).all() and (bound < 4 * norm).all()
    a, x = rng.normal(size=(2, 4))
    alone = np.einsum("i,j,k->ijk", a, x, x)
    wanted = np.linalg.norm(a) * np.linalg.norm(x) ** 2
    assert unfolded_bound(alone) == pytest.approx(wanted)


def test_the_norm_of_no_map_is_zero():
    norm, vector = bilinear_norm(np.zeros((2, 3, 4, 4)))
    np.testing.assert_array_equal(norm, 0.0)
    assert np.isfinite(vector).all()


# what they mean


@pytest.mark.parametrize("domain", DOMAINS)
def test_kg_bounds_how_gravity_changes_between_postures(rng, domain):
    x, y = (postures(rng, domain, 20_000) for _ in range(2))
    x[:5000] = y[:5000] + 0.01 * rng.normal(size=(5000, 4))
    change = np.linalg.norm(dynamics.gravity_torque(x) - dynamics.gravity_torque(y), axis=-1)
    share = change / np.linalg.norm(x - y, axis=-1)
    kg = lyapunov.constants(domain="torus" if domain == "torus" else "box").kg
    inside = domain_of(None, domain)
    kept = ((x >= inside.lower) & (x <= inside.upper)).all(axis=-1)
    assert share[kept].max() <= kg


@pytest.mark.parametrize("domain", DOMAINS)
def test_the_printed_recipes_are_above_the_tight_constants_by_far(domain):
    tight = lyapunov.constants(domain=domain)
    printed = lyapunov.constants(domain=domain, recipe="printed")
    assert printed.kg == 4 * tight.largest_slope
    assert printed.kc1 == 16 * tight.largest_symbol
    assert 3.9 < printed.kg / tight.kg < 4
    assert 13 < printed.kc1 / tight.kc1 < 14
    assert printed.ratio == tight.ratio


def test_a_larger_domain_has_wider_constants():
    box, torus = (lyapunov.constants(domain=domain) for domain in DOMAINS)
    for name in NAMES:
        inner, outer = getattr(box, name), getattr(torus, name)
        assert (inner > outer) if name == "lambda_min" else (inner < outer)


def test_an_arm_twice_as_long_has_constants_of_twice_and_four_times_the_size():
    once, twice = (lyapunov.constants(domain="torus", machine=m) for m in (BACKHOE, scaled(2.0)))
    assert twice.kg == pytest.approx(2 * once.kg)
    for name in ("kc1", "lambda_min", "lambda_max", "ratio"):
        assert getattr(twice, name) == pytest.approx(4 * getattr(once, name), rel=1e-7)


def test_a_full_bucket_makes_the_arm_heavier():
    empty, full = lyapunov.constants(), lyapunov.constants(machine=loaded(1000.0))
    assert full.kg > 1.3 * empty.kg
    assert full.lambda_max > 1.3 * empty.lambda_max


# over a movement


def test_constants_over_postures_are_the_extremes_of_the_profile(rng):
    q = np.cumsum(rng.normal(size=(300, 4)), axis=0) / 20
    c, p = lyapunov.constants(q), lyapunov.profile(q)
    assert c.domain == "postures"
    for name in ("kg", "kc1", "lambda_max", "ratio"):
        assert getattr(c, name) == pytest.approx(getattr(p, name).max(), rel=1e-9)
    assert c.lambda_min == pytest.approx(p.lambda_min.min())
    assert (c.largest_slope, c.largest_symbol) == (p.slope.max(), p.symbol.max())
    assert any((c.where["ratio"] == row).all() for row in q)


def test_a_profile_is_the_definitions_posture_by_posture(rng):
    q = rng.uniform(-2, 2, (3, 7, 4))
    p = lyapunov.profile(q)
    expected = quantities(q)
    fields = {"slope": "largest_slope", "symbol": "largest_symbol"}
    for name in p._fields:
        assert getattr(p, name).shape == (3, 7)
        np.testing.assert_allclose(getattr(p, name), expected[fields.get(name, name)], rtol=1e-9)
    one = lyapunov.profile(q[1, 2])
    assert one.kc1.shape == ()
    assert one.kc1 == pytest.approx(p.kc1[1, 2])


def test_the_swing_changes_nothing(rng):
    q = rng.uniform(-1, 1, (5, 4))
    turned = q + np.array([1.3, 0.0, 0.0, 0.0])
    for here, there in zip(lyapunov.profile(q), lyapunov.profile(turned), strict=True):
        np.testing.assert_allclose(here, there)


# bookkeeping


def test_the_constants_of_a_domain_are_counted_once():
    assert lyapunov.constants() is lyapunov.constants(domain="box")


def test_constants_can_be_replaced_but_not_changed():
    c = lyapunov.constants()
    assert c.replace(kg=24068.0).kg == 24068.0
    assert c.kg != 24068.0
    with pytest.raises(FrozenInstanceError):
        c.kg = 1.0
    with pytest.raises(ValueError, match="read-only"):
        c.where["kg"][0] = 1.0


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"domain": "ball"}, "domain must be one of box, torus, got 'ball'"),
        ({"domain": "postures"}, "domain must be one of box, torus, got 'postures'"),
        ({"recipe": "loose"}, "recipe must be one of tight, printed, got 'loose'"),
        ({"q": np.zeros((0, 4))}, "at least one posture"),
        ({"q": np.zeros((5, 3))}, "q must end in 4 joints"),
        ({"q": [0, 0, np.inf, 0]}, "q must be finite"),
    ],
)
def test_what_is_no_set_of_postures_or_recipe_is_refused(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        lyapunov.constants(**arguments)
