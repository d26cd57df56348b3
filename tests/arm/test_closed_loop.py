"""The batch against SciPy's integrator sample by sample, its laws against the library's parts."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe.arm import closed_loop, dynamics, movement, pid
from backhoe.arm.closed_loop import COULOMB_SMOOTHING, plain, simulate
from backhoe.arm.closed_loop.task import Task
from backhoe.arm.movement import Movement
from backhoe.arm.pid import ARM_GAINS, DigitalPID, Gains
from backhoe.machine import BACKHOE, variants

LOAD = 850.0
COMPUTED = Gains(kp=[40.0] * 4, ki=[20.0] * 4, kd=[12.0] * 4)
MEASURES = (
    "rms_error",
    "peak_error",
    "final_error",
    "peak_torque",
    "effort",
    "saturated",
    "overrun",
    "diverged",
    "stopped_at",
)


@pytest.fixture(scope="module")
def loading():
    return movement.loading()


@pytest.fixture(scope="module")
def swing(loading):
    """1.5 s of the swing to the truck, in which all joints move."""
    return part(loading, 13.0, 14.5)


def part(whole, start, end):
    rows = slice(round(start / whole.dt), round(end / whole.dt) + 1)
    return Movement(whole.t[rows], whole.q[rows], whole.dq[rows], whole.ddq[rows])


def exact(law, reference, machine, q0=None, friction=True):
    """Angles and torques at the samples, by DOP853 from each sample to the next."""

    def resistance(dq):
        return dynamics.friction_torque(dq, machine, COULOMB_SMOOTHING)

    def rate(t, x, torque):
        q, dq = np.split(x, 2)
        return np.r_[dq, dynamics.forward_dynamics(q, dq, torque, friction, machine=machine)]

    friction = resistance if friction else None
    x = np.r_[reference.q[0] if q0 is None else q0, reference.dq[0]]
    angles, torques = [], []
    for step in range(len(reference)):
        torque = law(step, *np.split(x, 2))
        angles.append(x[:4])
        torques.append(torque)
        solved = solve_ivp(
            rate, (0, reference.dt), x, "DOP853", args=(torque,), rtol=1e-12, atol=1e-12
        )
        x = solved.y[:, -1]
    return np.array(angles), np.array(torques)


def of_library(gains, reference, limit=None):
    controller = pid.PID(*gains, limit)

    def law(step, q, dq):
        return controller(reference.q[step], reference.dq[step], q, dq, reference.dt)

    return law


def recorded(gains, reference, **options):
    return simulate(gains, reference, record=[0], **options).trajectory(0)


def test_pid_follows_scipy_to_a_nanoradian_with_friction_and_limits(swing):
    limit = np.array([50e3, 140e3, 18e3, 12e3])
    q0 = swing.q[0] + [0.02, -0.03, 0.02, 0.05]
    law = of_library(ARM_GAINS, swing, limit)
    q, torque = exact(law, swing, BACKHOE, q0)
    found = recorded(ARM_GAINS, swing, torque_limit=limit, q0=q0)
    assert (np.abs(torque) == limit).any(axis=0).all()
    np.testing.assert_allclose(found.q, q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.torque, torque, rtol=1e-6, atol=1.0)


def test_a_bucket_that_turns_back_slowly_through_its_friction_stays_within_a_nanoradian(loading):
    """From a jerky start, where smoothed friction is stiff: what one Runge-Kutta step a sample
    would get wrong by more."""
    cut = part(loading, 7.0, 7.8)
    q, _ = exact(of_library(ARM_GAINS, cut), cut, BACKHOE)
    found = recorded(ARM_GAINS, cut)
    speed = found.dq[:, 3]
    assert speed.min() < 0 < speed.max()
    np.testing.assert_allclose(found.q, q, rtol=0, atol=1e-9)


def test_gravity_compensation_knows_the_empty_bucket_only(swing):
    feedback = of_library(ARM_GAINS, swing)

    def law(step, q, dq):
        return feedback(step, q, dq) + dynamics.gravity_torque(q)

    q, _ = exact(law, swing, variants.loaded(LOAD))
    found = recorded(ARM_GAINS, swing, law="pid+gravity", payload=LOAD)
    np.testing.assert_allclose(found.q, q, rtol=0, atol=1e-9)


def test_computed_torque_is_its_formula_with_the_law_s_own_model(swing):
    model = variants.loaded(300.0)
    feedback = of_library(COMPUTED, swing)

    def law(step, q, dq):
        M = dynamics.mass_matrix(q, model)
        C = dynamics.coriolis_matrix(q, dq, model)
        wanted = swing.ddq[step] + feedback(step, q, dq)
        return M @ wanted + C @ dq + dynamics.gravity_torque(q, model)

    q, _ = exact(law, swing, variants.loaded(LOAD), friction=False)
    found = recorded(
        COMPUTED, swing, law="computed_torque", model=model, payload=LOAD, friction=False
    )
    np.testing.assert_allclose(found.q, q, rtol=0, atol=1e-9)


def test_computed_torque_with_the_right_model_needs_no_feedback(swing):
    """Up to the torque that stands still for a millisecond: an error of first order in dt."""
    off = Gains(*[[0.0] * 4] * 3)
    fine = movement.loading(dt=1e-3)
    errors = []
    for dt in (2e-3, 1e-3):
        reference = part(movement.loading(dt=dt) if dt != fine.dt else fine, 13.0, 14.0)
        run = simulate(off, reference, law="computed_torque", friction=False)
        errors.append(run.peak_error.max())
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)


PLAINLY = {
    "limits": {"torque_limit": [20e3, 150e3, 12e3, 6e3], "q0": [0.02, -0.03, 0.02, 0.05]},
    "differences": {"rate": "difference", "filter_time": 0.02, "state_every": 10},
    "gravity": {"law": "pid+gravity", "payload": LOAD, "settled": True},
    "model": {"law": "computed_torque", "model": variants.loaded(300.0), "friction": False},
}


@pytest.mark.parametrize("case", PLAINLY)
def test_the_engine_does_what_the_plain_loop_does(case, loading):
    """To 1e-12 of their size, in 0.3 s in which all joints move and the bucket turns back."""
    cut, options = part(loading, 7.3, 7.6), dict(PLAINLY[case])
    if "q0" in options:
        options["q0"] = cut.q[0] + options["q0"]
    gains = COMPUTED if case == "model" else ARM_GAINS
    found = recorded(gains, cut, **options)
    q, dq, torque = plain.follow(Task(gains, cut, **options))
    np.testing.assert_allclose(found.q, q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.dq, dq, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.torque, torque, rtol=0, atol=1e-12 * np.abs(torque).max())


def test_integral_stops_at_the_limit_exactly_as_in_pid(swing):
    """Torques equal to rounding over 300 samples in which every joint saturates."""
    limit = np.array([5e3, 160e3, 9e3, 4e3])
    q0 = swing.q[0] + 0.02
    found = recorded(ARM_GAINS, swing, torque_limit=limit, q0=q0)
    law = of_library(ARM_GAINS, swing, limit)
    speeds = np.array([found.q, found.dq])
    torque = [law(step, *speeds[:, step]) for step in range(300)]
    np.testing.assert_allclose(found.torque[:300], torque, rtol=1e-12)


def test_difference_and_held_state_are_the_digital_pid_on_every_tenth_state(swing):
    time = 0.02
    loops = DigitalPID(*ARM_GAINS, swing.dt, filter_time=time, derivative_of="error")
    found = recorded(ARM_GAINS, swing, state_every=10, rate="difference", filter_time=time)
    torque = [loops(swing.q[k], found.q[k - k % 10]) for k in range(len(swing))]
    np.testing.assert_allclose(found.torque, torque, rtol=1e-9, atol=1e-4)


@pytest.mark.parametrize("law", closed_loop.LAWS)
@pytest.mark.parametrize("payload", [0.0, LOAD])
def test_a_settled_arm_stays_where_it_is(law, payload):
    q = np.radians([30.0, 20.0, -10.0, 40.0])
    reference = movement.from_postures([0, 0.5], [q, q])
    gains = COMPUTED if law == "computed_torque" else ARM_GAINS
    run = simulate(gains, reference, law=law, payload=payload, settled=True)
    assert run.peak_error.max() < 1e-12
    if law == "pid" or payload:
        assert simulate(gains, reference, law=law, payload=payload).peak_error.max() > 1e-4


def test_friction_is_that_of_the_simulation():
    from backhoe.simulation import forces

    assert COULOMB_SMOOTHING == forces.COULOMB_SMOOTHING


def varied(count, seed=0):
    rng = np.random.default_rng(seed)
    return Gains(*(np.array(gain) * rng.uniform(0.5, 1.5, (count, 4)) for gain in ARM_GAINS))


def assert_same(a, b):
    for name in MEASURES:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    assert list(a.trajectories) == list(b.trajectories)
    for index, trajectory in a.trajectories.items():
        for ours, theirs in zip(trajectory, b.trajectory(index), strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_each_run_is_what_it_would_be_alone(swing):
    gains, loads = varied(20), np.linspace(0, LOAD, 20)
    together = simulate(gains, swing, payload=loads)
    for index in (0, 7, 19):
        own = Gains(*(gain[index] for gain in gains))
        alone = simulate(own, swing, payload=loads[index])
        for name in MEASURES:
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(together, name)[index])


def test_measures_are_those_of_the_trajectory(swing):
    limit = np.array([30e3, 200e3, 30e3, 12e3])
    run = simulate(ARM_GAINS, swing, torque_limit=limit, record="all")
    found = run.trajectory(0)
    error, torque = swing.q - found.q, found.torque
    np.testing.assert_allclose(run.rms_error[0], np.sqrt((error**2).mean(axis=0)))
    np.testing.assert_array_equal(run.peak_error[0], np.abs(error).max(axis=0))
    np.testing.assert_array_equal(run.final_error[0], error[-1])
    np.testing.assert_array_equal(run.peak_torque[0], np.abs(torque).max(axis=0))
    np.testing.assert_allclose(run.effort[0], (torque[:-1] ** 2).sum(axis=0) * swing.dt)
    at_limit = (np.abs(torque) == limit)[:-1].mean(axis=0)
    np.testing.assert_allclose(run.saturated[0], at_limit)
    np.testing.assert_array_equal(found.error, error)
    assert run.stopped_at[0] == swing.t[-1]


def test_recording_every_tenth_sample_keeps_those(swing):
    whole = recorded(ARM_GAINS, swing)
    tenth = recorded(ARM_GAINS, swing, record_every=10)
    for name in ("t", "q", "dq", "torque", "q_ref"):
        np.testing.assert_array_equal(getattr(tenth, name), getattr(whole, name)[::10])


def too_stiff(count=3):
    """The second run's K_d is above 2 J / dt of the bucket: sampling makes it unstable."""
    gains = Gains(*(np.tile(gain, (count, 1)) for gain in ARM_GAINS))
    gains.kd[1, 3] = 5e6
    return gains


def test_a_run_that_diverges_is_stopped_and_spoils_no_other(swing):
    run = simulate(too_stiff(), swing, record="all")
    assert run.diverged.tolist() == [False, True, False]
    assert swing.t[0] < run.stopped_at[1] < swing.t[-1]
    for name in MEASURES[:7]:
        values = getattr(run, name)
        assert np.isinf(values[1]).all()
        assert np.isfinite(values[[0, 2]]).all()
        np.testing.assert_array_equal(values[0], values[2])
    stopped = run.trajectory(1)
    assert stopped.t[-1] == run.stopped_at[1]
    assert np.isfinite(stopped.q).all() and np.isfinite(stopped.torque).all()


def test_gains_beyond_all_floats_are_marked_too(swing):
    run = simulate(Gains(*[np.full(4, 1e308)] * 3), swing, q0=swing.q[0] + 0.1)
    assert run.diverged.all()
    assert not any(np.isnan(getattr(run, name)).any() for name in MEASURES)


def test_overrun_tells_of_stops_that_are_not_there():
    q = np.array([0.0, 0.0, 0.0, BACKHOE.upper[3]])
    reference = movement.from_postures([0, 1], [q, q])
    outside = q + np.array([0, 0, 0, 0.05])
    weak = simulate(ARM_GAINS, reference, q0=outside)
    assert weak.overrun[0, 3] == pytest.approx(0.05, abs=1e-6)
    assert not weak.overrun[0, :3].any()


@pytest.mark.parametrize("options", [{}, {"chunks": 5}, {"backend": "threading", "chunks": 3}])
def test_a_sweep_is_the_batch_to_the_last_bit(swing, options):
    short = part(swing, 0.0, 0.3)
    gains = varied(40)
    batch = simulate(gains, short, record=[3, 21], payload=np.linspace(0, LOAD, 40))
    again = closed_loop.sweep(
        gains, short, record=[3, 21], payload=np.linspace(0, LOAD, 40), progress=False, **options
    )
    assert_same(batch, again)


def test_a_sweep_goes_to_a_dask_cluster_unchanged(swing):
    import joblib

    distributed = pytest.importorskip("dask.distributed")
    gains = too_stiff(12)
    batch = simulate(gains, swing, record=[10], settled=True)
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    )
    with cluster, distributed.Client(cluster) as client:
        with joblib.parallel_config(backend="dask"):
            again = closed_loop.sweep(gains, swing, record=[10], settled=True, chunks=4)
        done = client.run(lambda dask_worker: dask_worker.state.executed_count)
    assert_same(batch, again)
    assert sum(done.values()) >= 4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gains": Gains(*[[1.0] * 3] * 3)}, r"kp must be one row a run, shape \(n, 4\)"),
        (
            {"gains": Gains(np.ones((2, 4)), np.ones(4), np.ones(4))},
            r"kp and ki and kd must be alike, got shapes \(2, 4\), \(1, 4\), \(1, 4\)",
        ),
        ({"gains": Gains(*[np.ones((0, 4))] * 3)}, "kp must be one row a run"),
        ({"gains": ARM_GAINS._replace(kp=[-1.0, 1, 1, 1])}, "kp must not be negative, got -1 in"),
        ({"gains": ARM_GAINS._replace(ki=[np.nan] * 4)}, "ki must be finite"),
        ({"gains": ARM_GAINS._replace(kp=[np.inf, 1, 1, 1])}, "kp must be finite, got inf"),
        ({"gains": Gains("a", "b", "c")}, "kp must be numbers"),
        ({"law": "PD"}, r"law must be one of pid, pid\+gravity, computed_torque"),
        ({"rate": "guessed"}, "rate must be one of"),
        ({"torque_limit": [1.0, 2.0]}, r"torque_limit must be one torque a joint, shape \(4,\)"),
        ({"torque_limit": [1.0, 2.0, 0.0, 1.0]}, "torque_limit must be positive"),
        ({"torque_limit": [1.0, 2.0, np.nan, 1.0]}, "torque_limit must be positive"),
        ({"payload": -1.0}, "payload must not be negative"),
        ({"payload": np.nan}, "payload must be finite"),
        ({"payload": [1.0, 2.0]}, "one mass or one for each of 1 runs"),
        ({"q0": np.zeros((3, 4))}, r"q0 must have shape \(4,\) or \(1, 4\)"),
        ({"q0": [0, 0, np.nan, 0]}, "finite"),
        ({"state_every": 0}, "state_every must be one whole number at least 1"),
        ({"record_every": 1.5}, "record_every must be one whole number"),
        ({"filter_time": -1.0}, r"filter_time must be one number at least 0 \[s\]"),
        ({"filter_time": 0.02}, 'filter_time goes with rate="difference"'),
        ({"threads": 0}, "threads must be one whole number at least 1"),
        ({"threads": 1.5}, "threads must be one whole number at least 1"),
        ({"record": [1]}, "record must be indices from 0 to 0"),
        ({"record": "some"}, "record must be indices"),
        ({"record": [0.5]}, "record must be indices"),
        ({"gains": ARM_GAINS._replace(ki=[0.0] * 4), "settled": True}, "boom has ki = 0"),
    ],
)
def test_bad_arguments_are_named(swing, options, message):
    arguments = {"gains": ARM_GAINS} | options
    with pytest.raises(ValueError, match=message):
        simulate(arguments.pop("gains"), swing, **arguments)


def test_a_reference_must_be_a_movement_and_gains_must_be_gains(swing):
    with pytest.raises(TypeError, match="movement must be a Movement, got ndarray"):
        simulate(ARM_GAINS, swing.q)
    with pytest.raises(TypeError, match=r"gains must be a Gains, got tuple: give pid\.Gains"):
        simulate(tuple(ARM_GAINS), swing)
    with pytest.raises(TypeError, match="brakes"):
        simulate(ARM_GAINS, swing, brakes=True)


@pytest.mark.parametrize("chunks", [0, 4, 1.0])
def test_chunks_must_be_as_many_as_runs_at_most(swing, chunks):
    with pytest.raises(
        ValueError, match="chunks must be one whole number at least 1 and at most 3"
    ):
        closed_loop.sweep(varied(3), swing, chunks=chunks, progress=False)


def test_a_run_that_was_not_recorded_is_named(swing):
    with pytest.raises(KeyError, match="run 0 was not recorded"):
        simulate(ARM_GAINS, part(swing, 0.0, 0.01)).trajectory(0)
