"""What decides each verdict on skid-steer vehicles, wheel motors and tracks; likely misprints.

Places in the plane are complex numbers, x forward and y to the left. Forms without a misprint's
name are the source's own, written out.
"""

import ast
from math import exp, log, pi
from xml.etree import ElementTree

import control
import numpy as np
import sympy as sp
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm
from scipy.signal import cont2discrete
from scipy.special import airy

from backhoe.arm.pid import DigitalPID
from backhoe.lessons.skid_steer import printed
from backhoe.machine import BACKHOE
from backhoe.simulation import TrackedPlant
from backhoe.vehicle import motor, skid_steer, travel
from backhoe.vehicle.motor import WHEELCHAIR, Load
from backhoe.vehicle.skid_steer import HUSKY, replace
from backhoe.view import shapes
from units import in_units

RNG = np.random.default_rng(4)
TWISTS = RNG.uniform(-1.5, 1.5, (20, 2))
WIDE = replace(HUSKY, mass=70.0, wheel_radius=0.2, half_track=0.4, inertia=5.0)
UNITS = {"kg": 3.0, "m": 0.4, "s": 1.7}


def _velocity(place, step=1e-4):
    """Central difference of a place that is a function of time."""
    return (place(step) - place(-step)) / (2 * step)


def _factor(kg, m, s):
    """Of a number in kg^a m^b s^c over the same in `UNITS`."""
    return UNITS["kg"] ** kg * UNITS["m"] ** m * UNITS["s"] ** s


def _close(found, expected, tolerance=1e-6):
    assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


# (2.1) to (2.6) kinematics


def velocity_is_turned_by_the_heading(world_velocity):
    for theta, v_x, v_y, omega in RNG.normal(size=(20, 4)):
        turned = (v_x + 1j * v_y) * np.exp(1j * theta)
        _close(world_velocity(theta, [v_x, v_y, omega]), [turned.real, turned.imag, omega])


def rotation_21(theta, velocity):
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ velocity


def rotation_turned_back(theta, velocity):
    return rotation_21(-theta, velocity)


def rims_run_as_fast_as_the_ground_under_them(wheel_speeds):
    sides = HUSKY.half_track * np.array([1j, -1j])
    for v, omega in TWISTS:
        ground = _velocity(lambda t, v=v, w=omega: v * t + sides * np.exp(1j * w * t)).real
        _close(HUSKY.wheel_radius * wheel_speeds([v, omega]), ground)


def wheels_22(twist, c=HUSKY.half_track, r=HUSKY.wheel_radius):
    v_x, omega = twist
    return np.array([(v_x - omega * c) / r, (v_x + omega * c) / r])


def wheels_for_the_whole_track(twist):
    return wheels_22(twist, 2 * HUSKY.half_track)


def the_twist_moves_the_wheels_as_their_rims_run(body_twist):
    sides = HUSKY.half_track * np.array([1j, -1j])
    for wheels in 5 * TWISTS:
        v, omega = body_twist(*wheels)
        ground = _velocity(lambda t, v=v, w=omega: v * t + sides * np.exp(1j * w * t)).real
        _close(ground, HUSKY.wheel_radius * wheels)


def twist_23(left, right):
    r, c = HUSKY.wheel_radius, HUSKY.half_track
    return r * np.array([(left + right) / 2, (-left + right) / (2 * c)])


def twist_on_half_a_half_track(left, right):
    return twist_23(left, right) * [1, 2]


def the_pose_moves_on_an_arc(pose_rate, x_icr=None):
    """A circle about the centre of rotation, which stands still; its place is x_ICR ahead."""
    at = () if x_icr is None else (x_icr,)
    for theta, (v, omega) in zip(RNG.uniform(-3, 3, 20), TWISTS, strict=True):
        centre = (x_icr or 0.0) + 1j * v / omega
        rate = _velocity(
            lambda t, c=centre, w=omega, a=theta: c * (1 - np.exp(1j * w * t)) * np.exp(1j * a)
        )
        _close(pose_rate(theta, [v, omega], *at), [rate.real, rate.imag, omega])


def differential_24(theta, twist):
    return np.array([[np.cos(theta), 0], [np.sin(theta), 0], [0, 1]]) @ twist


def differential_with_sine_and_cosine_swapped(theta, twist):
    return differential_24(theta, twist)[[1, 0, 2]]


def the_point_at_x_icr_never_moves_sideways(lateral_speed):
    """And with it between the axles, these slip to opposite sides."""
    for x_icr in (-0.2, 0.1, 0.25):
        places = np.array([x_icr, HUSKY.front, -HUSKY.rear])
        v = 1 + 1j * lateral_speed(x_icr, 0.7)
        slip = _velocity(lambda t, v=v, p=places: v * t + p * np.exp(0.7j * t)).imag
        assert abs(slip[0]) < 1e-7
        assert slip[1] > 0 > slip[2]


def lateral_speed(x_icr, omega):
    return skid_steer.pose_rate(0.0, [1.0, omega], x_icr)[1]


def lateral_speed_25(x_icr, omega):
    return -x_icr * omega


def lateral_speed_with_the_other_sign(x_icr, omega):
    return x_icr * omega


def the_pose_moves_on_an_arc_about_x_icr(pose_rate):
    for x_icr in (-0.1, 0.12):
        the_pose_moves_on_an_arc(pose_rate, x_icr)


def pose_rate_26(theta, twist, x_icr):
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, x_icr * s], [s, -x_icr * c], [0, 1]]) @ twist


def pose_rate_with_x_icr_behind(theta, twist, x_icr):
    return pose_rate_26(theta, twist, -x_icr)


def every_pose_can_be_reached(pose_rate, x_icr=0.12, step=1e-6):
    """The two fields and their Lie bracket span all directions (Chow)."""
    ahead, round_ = (lambda a, u=u: np.array(pose_rate(a, u, x_icr)) for u in ([1, 0], [0, 1]))
    for theta in (0.3, 2.0):
        slope = [(f(theta + step) - f(theta - step)) / (2 * step) for f in (ahead, round_)]
        bracket = slope[0] * round_(theta)[2] - slope[1] * ahead(theta)[2]
        assert np.linalg.matrix_rank([ahead(theta), round_(theta), bracket], tol=1e-6) == 3


def pose_rate_that_forgets_the_heading(theta, twist, x_icr):
    return pose_rate_26(0.0, twist, x_icr)


# (2.7) and what is said about the centre of rotation


def a_spin_gives_back_its_half_track(measure):
    """By (2.3) with that half track, the rims' ways, integrated by SciPy, make the turn."""
    t = np.linspace(0.0, 3.0, 301)
    for c_e in (0.3, 0.5):
        wheels = 2.0 * np.sin(pi * t / 3) ** 2
        way = HUSKY.wheel_radius * quad(lambda s: 2.0 * np.sin(pi * s / 3) ** 2, 0, 3)[0]
        _close(measure(t, -wheels, wheels, way / c_e), c_e, 1e-4)


def contact_points_move_with_the_body(contact_velocity):
    for velocity in ([0.5, 0.0, 1.0], [0.5, -0.12, 1.0], [0.0, 0.0, -0.4]):
        v_x, v_y, omega = velocity
        places = HUSKY.positions @ [1, 1j]
        moved = _velocity(
            lambda t, v=v_x + 1j * v_y, w=omega, p=places: v * t + p * np.exp(1j * w * t)
        )
        _close(np.asarray(contact_velocity(velocity))[:, 1], moved.imag)


def no_lateral_slip_without_x_icr(velocity):
    """What section 2.2.3 says of x_ICR = 0: no point slips sideways."""
    return np.stack([np.zeros(4), np.full(4, velocity[1])], axis=-1)


# (2.8) to (2.11) friction


def friction_grows_from_its_jump_by_the_viscous_slope(law):
    v = sp.symbols("v", positive=True)
    whole = 30 * sp.sign(v) + 5 * v
    for at in (0.001, 0.5, 2.0):
        exact = float(whole.subs(v, at))
        _close([law(at, 100.0, 0.3, 5.0), law(-at, 100.0, 0.3, 5.0)], [exact, -exact])


def friction_28(v, normal, mu, viscous):
    return mu * normal * np.sign(v) + viscous * v


def friction_with_viscosity_against_it(v, normal, mu, viscous):
    return mu * normal * np.sign(v) - viscous * v


def static_friction_holds_a_body_that_is_pushed_gently(friction):
    """At rest, pushed with less than mu N, it stays: the forces add up to nothing."""
    for push in (-20.0, 0.0, 5.0, 29.0):
        assert abs(push - friction(push, 100.0, 0.3)) < 1e-9


def static_friction(push, normal, mu):
    return np.clip(push, -mu * normal, mu * normal)


def coulomb_at_rest(push, normal, mu):
    return float(skid_steer.coulomb(0.0, normal, mu))


def what_is_left_when_the_speed_falls(law):
    """The limit of the whole law for v -> 0; what it neglects is the viscous share alone."""
    v, side = sp.symbols("v"), {1: "+", -1: "-"}
    for sign in side:
        limit = float(sp.limit(30 * sp.sign(v) + 5 * v, v, 0, side[sign]))
        for speed in (1e-6, 0.1, 3.0):
            _close(law(sign * speed, 100.0, 0.3), limit)
            _close(30 * sign + 5 * sign * speed - law(sign * speed, 100.0, 0.3), 5 * sign * speed)


def friction_29(v, normal, mu):
    return mu * normal * np.sign(v)


def friction_without_its_load(v, normal, mu):
    return mu * np.sign(v)


def the_limit_is_the_sign(smooth_sign):
    v = np.array([-1.0, -0.01, 0.01, 1.0])
    _close(smooth_sign(v, 1e7), v / abs(v), 1e-4)


def smooth_sign_210(v, k_s):
    return 2 / pi * np.arctan(k_s * v)


def smooth_sign_without_two_over_pi(v, k_s):
    return np.arctan(k_s * v)


def it_is_the_integral_of_its_slope_at_driving_speeds(law, mu=0.2, k_s=10.0):
    """mu N (2/pi) k_s / (1 + (k_s v)^2), which the source expands at 0, summed up to v."""
    for v in (0.26, 1.0):  # a turn's slip, and driving
        force = quad(lambda s: 100 * mu * 2 / pi * k_s / (1 + (k_s * s) ** 2), 0, v)[0]
        _close(law(v, 100.0, mu, k_s), force, 0.1)


def what_29_leaves_out_is_small(friction):
    for speed in (0.1, 0.5, 1.0):
        assert abs(friction(speed) - 20.0) < 0.1 * 20.0  # mu N >> mu_v v, with mu N = 20 N


def friction_of_the_premise(speed):
    return float(skid_steer.coulomb(speed, 100.0, 0.2, viscous=1.0))


def friction_of_hypothesis_8(speed):
    """Viscous friction above Coulomb's."""
    return float(skid_steer.coulomb(speed, 100.0, 0.2, viscous=1.01 * 20.0 / speed))


# (2.12) to (2.17) the linear model


def newton_for_four_wheels(accelerations):
    """Half of a side's force at each of its wheels; moments are imaginary parts."""
    p, places = HUSKY, HUSKY.positions @ [1, 1j]
    for left, right, R_x, M_r in RNG.uniform(-30, 30, (10, 4)):
        forces = np.array([left, right, left, right]) / 2
        moment = (places.conjugate() * forces).imag.sum() - M_r
        expected = (forces.sum() - R_x) / p.mass, moment / p.inertia
        _close(accelerations(left, right, R_x, M_r), expected)


def accelerations(left, right, R_x, M_r):
    """Of the library's model at rest, its wheels commanded so that they push with these forces."""
    p = replace(HUSKY, rolling=0.0, lateral=0.0)
    command = skid_steer.body_twist(*(F * p.wheel_radius / (2 * p.speed_gain)
                                      for F in (left, right)))  # fmt: skip
    dv, domega = (skid_steer.state_space(p).B @ command)[[1, 3]]
    return dv - R_x / p.mass, domega - M_r / p.inertia


def accelerations_212(left, right, R_x, M_r):
    p = HUSKY
    return (right + left - R_x) / p.mass, ((right - left) * p.half_track - M_r) / p.inertia


def accelerations_at_the_whole_track(left, right, R_x, M_r):
    dv, _ = accelerations_212(left, right, R_x, M_r)
    return dv, ((right - left) * 2 * HUSKY.half_track - M_r) / HUSKY.inertia


def a_force_that_four_wheels_share(resistance):
    for p in (HUSKY, WIDE):
        wheels = sum(p.mass * p.gravity / 4 * p.rolling * 0.8 for _ in range(4))
        _close(resistance(0.8, p), wheels)
    speed = 0.8 / UNITS["m"] * UNITS["s"]
    there = resistance(speed, in_units(HUSKY, **UNITS)) * _factor(1, 1, -2)
    _close(resistance(0.8, HUSKY), there)


def resistance(v, vehicle):
    return skid_steer.rates(vehicle).drag_v * vehicle.mass * v


def resistance_213a(v, vehicle):
    return vehicle.mass * vehicle.gravity * vehicle.rolling * v


def resistance_of_one_wheel(v, vehicle):
    return resistance_213a(v, vehicle) / 4


def a_moment_by_its_units(moment):
    there = moment(0.5 * UNITS["s"], in_units(HUSKY, **UNITS)) * _factor(1, 2, -2)
    _close(moment(0.5, HUSKY), there)


def moment(omega, vehicle):
    return skid_steer.rates(vehicle).drag_omega * vehicle.inertia * omega


def torques_by_their_units(torques):
    """And in metres those of a gain times what each rim lacks, in rad/s."""
    speed, turn = UNITS["s"] / UNITS["m"], UNITS["s"]
    here = torques(np.array([1.0, 0.5]), 0.3, 0.1, HUSKY)
    there = torques(
        np.array([speed, 0.5 * turn]), 0.3 * speed, 0.1 * turn, in_units(HUSKY, **UNITS)
    )
    _close(here, np.array(there) * _factor(1, 2, -2))


def torques(u, v, omega, vehicle):
    lacking = skid_steer.wheel_speeds(u, vehicle) - skid_steer.wheel_speeds([v, omega], vehicle)
    return vehicle.speed_gain * lacking


def rates_of_four_wheels_by_newton(rates):
    for p in (HUSKY, WIDE):
        x, y = p.positions.T
        load = p.mass * p.gravity / 4

        def accelerate(v_ref, omega_ref, v, omega, p=p, x=x, y=y, load=load):
            lacking = (v_ref - v - y * (omega_ref - omega)) / p.wheel_radius
            along = p.speed_gain * lacking / p.wheel_radius - load * p.rolling * v
            moment = x * -load * p.lateral * omega * x - y * along
            return np.array([along.sum() / p.mass, moment.sum() / p.inertia])

        drives = accelerate(1, 0, 0, 0)[0], accelerate(0, 1, 0, 0)[1]
        drags = -accelerate(1, 0, 1, 0)[0], -accelerate(0, 1, 0, 1)[1]
        _close(rates(p), np.ravel(list(zip(drives, drags, strict=True))))


def every_entry_is_a_rate(state_space):
    here, there = state_space(HUSKY), state_space(in_units(HUSKY, **UNITS))
    for entry in ((1, 1), (3, 3)):
        _close(here.A[entry], there.A[entry] * _factor(0, 0, -1))


def every_state_is_measured(state_space):
    """Simulated by python-control, the outputs are the states, started anywhere."""
    t = np.linspace(0, 0.5, 51)
    system = control.ss(*state_space(HUSKY))
    inputs = np.ones((2, len(t)))
    run = control.forced_response(system, t, inputs, [0.1, -0.2, 0.3, -0.4], return_states=True)
    _close(run.outputs, run.states)


def state_space_without_the_places(vehicle):
    found = skid_steer.state_space(vehicle)
    return found._replace(C=np.diag([0, 1, 0, 1]))


def each_command_moves_its_own_half(state_space):
    """By the matrix exponential of the system with its inputs held."""
    found = state_space(HUSKY)
    for which, still in ((0, [2, 3]), (1, [0, 1])):
        held = np.zeros((6, 6))
        held[:4] = np.hstack([found.A, found.B])
        state = expm(held * 0.3) @ np.r_[np.zeros(4), np.eye(2)[which]]
        assert np.abs(state[still]).max() == 0 < np.abs(state[:4]).min(where=state[:4] != 0,
                                                                       initial=1)  # fmt: skip


def state_space_with_a_turn_that_slows(vehicle):
    found = skid_steer.state_space(vehicle)
    A = found.A.copy()
    A[1, 3] = -1.0
    return found._replace(A=A)


# Section 2.3.3, the listings


def one_circle_has_these_errors_and_this_radius(step):
    v, omega = 1.0 - step["error_v"], 0.5 - step["error_omega"]
    run = solve_ivp(
        lambda _, q: [v * np.cos(q[2]), v * np.sin(q[2]), omega],
        (0, 2 * pi / omega),
        np.zeros(3),
        rtol=1e-10,
        max_step=0.02,
    )
    radius = np.ptp(run.y[0]) / 2
    assert abs(radius - step["radius"]) < 0.005
    assert abs(100 * (step["radius"] / 2 - 1) - step["increase_percent"]) < 0.5


_V, _OMEGA = (float(x) for x in skid_steer.steady_state(1.0, 0.5))
STEADY = {
    "error_v": 1 - _V,
    "error_omega": 0.5 - _OMEGA,
    "radius": skid_steer.radius(1.0, 0.5),
    "increase_percent": 100 * (skid_steer.radius(1.0, 0.5) / 2 - 1),
}
STEADY_WITH_ERRORS_SWAPPED = STEADY | {"error_v": STEADY["error_omega"],
                                       "error_omega": STEADY["error_v"]}  # fmt: skip


def an_error_that_only_an_infinite_gain_takes_away(steady_error):
    """By the final value theorem, python-control's `dcgain`, whatever stands for the drag."""
    for gain in (2.0, 8.0, 800.0):
        k = replace(HUSKY, speed_gain=gain)
        drive = 4 * gain / HUSKY.wheel_radius**2 / HUSKY.mass
        loop = control.tf([drive], [1, drive + HUSKY.gravity * HUSKY.rolling])
        _close(steady_error(k), 1 - control.dcgain(loop).real)


def steady_error(vehicle):
    return 1 - skid_steer.steady_state(1.0, 0.0, vehicle)[0]


def steady_error_of_215(vehicle):
    """(2.15a) at rest, with its rates repaired."""
    drive, drag, *_ = skid_steer.rates(vehicle)
    return drag / (drag + drive)


def no_steady_error(vehicle):
    return 0.0


def _ode45(rate, span, start):
    """Its pair of orders and its tolerances, by SciPy."""
    run = solve_ivp(rate, span, start, method="RK45", rtol=1e-3, atol=1e-6)
    return run.t, run.y.T


def a_square(listing):
    t, y = listing()
    _close(y[:, 0], t**2, 1e-3)


def listing_21():
    return _ode45(lambda t, y: [2 * t], (0, 5), [0.0])


def listing_21_of_y():
    return _ode45(lambda t, y: 2 * y, (0, 5), [0.0])


def an_airy_function(listing):
    """y'' = k t y, y(0) = 0, y'(0) = 0.01, with Ai and Bi of k^(1/3) t."""
    t, y = listing()
    root = 0.5 ** (1 / 3)
    at_0, here = airy(0.0), airy(root * t)
    a, b = np.linalg.solve([[at_0[0], at_0[2]], [root * at_0[1], root * at_0[3]]], [0, 0.01])
    assert_allclose(y[:, 0], a * here[0] + b * here[2], rtol=0.01, atol=1e-4)


def _odefcn(t, y, A, B):
    """Listing 2.2."""
    return [y[1], (A / B) * t * y[0]]


def listings_22_23():
    return _ode45(lambda t, y: _odefcn(t, y, 1, 2), (0, 5), [0.0, 0.01])


def listings_22_23_with_parameters_swapped():
    return _ode45(lambda t, y: _odefcn(t, y, 2, 1), (0, 5), [0.0, 0.01])


def the_area_under_the_input(odefcn):
    """y' = u(t) from 1: u goes up, down and up again, 0.5 each way."""
    ut, u = np.arange(4.0), np.array([0.0, 1.0, 0.0, 1.0])
    for seconds, area in ((1, 0.5), (2, 1.0), (2.5, 1.125), (3, 1.5)):
        run = solve_ivp(lambda t, y: odefcn(t, y, ut, u), (0, seconds), [1.0], max_step=0.05)
        _close(run.y[0, -1], 1 + area, 1e-3)


def listing_24(t, y, ut, u):
    return [np.interp(t, ut, u)]


def listing_24_with_the_nearest_value(t, y, ut, u):
    return [u[np.abs(ut - t).argmin()]]


def the_corners_of_the_input_are_expressions(corners):
    """No product without a sign, in MATLAB as in Python, whose parser judges."""
    try:
        values = [eval(ast.unparse(ast.parse(corner, mode="eval")), {"T": 1}) for corner in corners]
    except SyntaxError as error:
        raise AssertionError("this does not run") from error
    assert values == [0, 1, 2, 3]


CORNERS = ("0", "T", "2*T", "3*T")
CORNERS_OF_LISTING_25 = ("0", "T", "2T", "3T")


def the_exact_path_of_the_step(listing):
    """Speeds 1 - e^(-rate t), the heading in closed form, the place by quadrature."""
    k = skid_steer.rates(HUSKY)
    rate_v, rate_omega = sum(k[:2]), sum(k[2:])

    def heading(t):
        return _OMEGA * (t - (1 - exp(-rate_omega * t)) / rate_omega)

    def ahead(t):
        return _V * (1 - exp(-rate_v * t)) * np.exp(1j * heading(t))

    place = [quad(lambda t, f=f: f(ahead(t)), 0, 12.5, limit=200)[0] for f in (np.real, np.imag)]
    _close(listing()[-1], [*place, heading(12.5)], 0.02)


def listing_26(x_icr=0.0, columns=(1, 3)):
    """Two calls of the solver; the functions that it calls are not printed: (2.16), (2.6)."""
    A, B, *_ = skid_steer.state_space(HUSKY)
    t1, q1 = _ode45(lambda t, q: A @ q + B @ [1.0, 0.5], (0, 12.5), np.zeros(4))

    def kinematic(t, q):
        return pose_rate_26(q[2], [np.interp(t, t1, q1[:, k]) for k in columns], x_icr)

    return _ode45(kinematic, (0, 12.5), np.zeros(3))[1]


def listing_26_with_places_for_speeds():
    return listing_26(columns=(0, 2))


def the_step_of_the_library():
    t = np.linspace(0, 12.5, 2001)
    speeds = skid_steer.step_response(t, 1.0, 0.5)
    place = np.trapezoid(speeds[:, 1] * np.exp(1j * speeds[:, 2]), t)
    return np.array([[place.real, place.imag, speeds[-1, 2]]])


def a_world_with_a_sun_and_a_ground(world):
    root = ElementTree.fromstring(ElementTree.tostring(_sdf(*world)))
    uris = {uri.text for uri in root.findall("world/include/uri")}
    assert uris >= {"model://sun", "model://ground_plane"}
    assert root.tag == "sdf"
    assert root.get("version")
    assert root.find("world").get("name")


def _sdf(version, name, *uris):
    root = ElementTree.Element("sdf", version=version)
    world = ElementTree.SubElement(root, "world", name=name)
    for uri in uris:
        ElementTree.SubElement(ElementTree.SubElement(world, "include"), "uri").text = uri
    return root


LISTING_31 = ("1.5", "default", "model://sun", "model://ground_plane")
LISTING_31_WITHOUT_GROUND = LISTING_31[:3]


# Chapters 3 and 4


def cubes_of_these_masses_by_integration(inertias):
    """The integral of density (y^2 + z^2) over a cube of 0.1 m."""
    y, z, m = sp.symbols("y z m")
    half = sp.Rational(1, 20)
    per_area = sp.integrate(y**2 + z**2, (y, -half, half), (z, -half, half))
    exact = sp.lambdify(m, m * per_area / sp.Rational(1, 100))
    for mass, inertia in inertias.items():
        _close(inertia, float(exact(mass)))


def _cube_inertia(mass):
    """Of the library's box, as a sum over the tetrahedra of its surface."""
    vertices, faces = box = shapes.box(np.full(3, -0.05), np.full(3, 0.05))
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    sixth = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6
    second = sixth @ ((a**2 + b**2 + c**2 + a * b + b * c + c * a) / 10)
    return mass * (second[0] + second[1]) / shapes.volume(box)


CUBES = {mass: float(_cube_inertia(mass)) for mass in (0.6, 600.0)}
CUBES_32 = {0.6: 0.001, 600.0: 1.0}
CUBES_OF_THEIR_WHOLE_SIDE = {0.6: 0.006, 600.0: 6.0}


def statics_says_whether_the_wheels_can_turn_it(turns):
    """At rest each rim is pushed with K c omega / r^2; to turn, friction asks for mu N along it by
    the share of the wheel's lever a / sqrt(a^2 + c^2)."""
    p, omega = HUSKY, 0.5
    push = p.speed_gain * p.half_track * omega / p.wheel_radius**2
    for mu in (0.1, 0.2, 1.0, 1.5):
        asked = mu * p.mass * p.gravity / 4 * p.front / np.hypot(p.front, p.half_track)
        assert turns(mu) == (push > asked)


def turns(mu):
    """Whether the Husky with proportional wheels turns at a tenth of what is asked, or more."""
    floor = replace(HUSKY, friction_longitudinal=mu, friction_lateral=mu)
    held = np.ones(300)
    run = skid_steer.simulate(held, 0.5 * held, 0.02, floor)
    return bool(run.velocity[-1, 2] > 0.05)


def turns_as_printed(mu):
    return mu < 1.0


def turns_on_a_rough_floor_only(mu):
    return mu >= 1.0


DIRECT, LOAD = replace(WHEELCHAIR, gear=1.0), Load(0.04, 0.002)
J, B = DIRECT.inertia + LOAD.inertia, DIRECT.friction + LOAD.friction
R, L, K_M, K_B = DIRECT.resistance, DIRECT.inductance, DIRECT.torque_constant, DIRECT.back_emf
TAU, K_1 = R * J / (R * B + K_B * K_M), K_M / (R * J)


def transfer_of_winding_and_rotor(transfer):
    """The two differential equations, of current and speed, solved at a complex frequency."""
    A = np.array([[-R / L, -K_B / L], [K_M / J, -B / J]])
    for s in (0.0, 3.0j, -4.0 + 50.0j, 2000.0j):
        exact = np.linalg.solve(s * np.eye(2) - A, np.diag([1 / L, -1 / J]))[1]
        _close(transfer(s, DIRECT, LOAD), exact, 1e-9)


def transfer_without_back_emf(s, motor, load):
    return printed.transfer_41(s, replace(motor, back_emf=1e-9), load)


def pulse_transfer_of_a_zero_order_hold(pulse_transfer, h=0.02):
    for gain, which in ((K_1 * TAU, 0), (-TAU / J, 1)):
        sampled = control.sample_system(control.tf([gain], [TAU, 1]), h, method="zoh")
        for q in (1.0, 0.3 + 2.0j):
            _close(pulse_transfer(q, h)[which], sampled(q), 1e-8)


def pulse_transfer(q, h):
    step = motor.discretise(DIRECT, LOAD, h)
    return step.gain / (q - step.decay), -step.torque_gain / (q - step.decay)


def pulse_transfer_42(q, h):
    E = exp(-h / TAU)
    return K_1 * TAU * (1 - E) / (q - E), -TAU / J * (1 - E) / (q - E)


def pulse_transfer_of_euler(q, h):
    E = 1 - h / TAU
    return K_1 * TAU * (1 - E) / (q - E), -TAU / J * (1 - E) / (q - E)


def one_sample_of_the_differential_equation(step):
    for h in (0.001, 0.05, 1.0):
        run = solve_ivp(
            lambda _, w: K_1 * 7.0 - 0.1 / J - w / TAU, (0, h), [3.0], "DOP853", rtol=1e-10
        )
        _close(step(3.0, 7.0, 0.1, h), run.y[0, -1])


def sampled(speed, volts, torque, h):
    step = motor.discretise(DIRECT, LOAD, h)
    return step.decay * speed + step.gain * volts - step.torque_gain * torque


def sampled_43(speed, volts, torque, h):
    E = exp(-h / TAU)
    return E * speed + TAU * (1 - E) * (K_1 * volts - torque / J)


def sampled_with_a_torque_that_helps(speed, volts, torque, h):
    return sampled_43(speed, volts, -torque, h)


def torque_of_a_winding_that_has_settled(torque):
    for volts, speed in ((24.0, 0.0), (12.0, 90.0), (-5.0, 40.0)):
        run = solve_ivp(
            lambda _, i, V=volts, w=speed: (V - R * i - K_B * w) / L, (0, 30 * L / R), [0.0],
            rtol=1e-9, atol=1e-9,
        )  # fmt: skip
        _close(torque(DIRECT, volts, speed), K_M * run.y[0, -1])


def torque_45(motor, volts, speed):
    return motor.torque_constant / motor.resistance * (volts - motor.back_emf * speed)


def torque_of_a_motor_that_helps_itself(motor, volts, speed):
    return torque_45(motor, volts, -speed)


def a_hundred_times_the_inertia_by_simulation(slower):
    times = []
    for inertia in (J, 100 * J):
        tau = R * inertia / (R * B + K_B * K_M)
        risen = lambda t, w: w[0] - (1 - exp(-1))  # noqa: E731
        risen.terminal = True
        run = solve_ivp(lambda t, w, tau=tau: (1 - w) / tau, (0, 5e3), [0.0], events=risen,
                        rtol=1e-8)  # fmt: skip
        times.append(run.t[-1])
    assert abs(slower(100.0) / (times[1] / times[0]) - 1) < 0.05


def slower(factor):
    loads = (Load(factor * HUSKY.wheel_inertia), motor.hanging_wheel(HUSKY))
    heavy, usual = (motor.first_order(DIRECT, load).time_constant for load in loads)
    return heavy / usual


def slower_as_said(factor):
    return factor


def slower_by_the_root(factor):
    return factor**0.5


def the_rotor_feels_its_load_through_the_teeth(reflected):
    """Two bodies and the torque between them: the rotor's acceleration under 1 N m."""
    for load, n in ((0.044, 100.0), (2.0, 32.0)):
        bodies = [[WHEELCHAIR.inertia * n, 1 / n], [load, -1.0]]  # wheel's acceleration, torque
        rotor = n * np.linalg.solve(bodies, [1.0, 0.0])[0]
        _close(1 / rotor, WHEELCHAIR.inertia + reflected(load, n), 1e-9)


def reflected(load, n):
    geared = replace(WHEELCHAIR, gear=n)
    tau = motor.first_order(geared, Load(load)).time_constant
    return tau * geared.damping / n**2 - geared.inertia


def reflected_as_printed(load, n):
    return load / n**2


def reflected_once(load, n):
    return load / n


def a_gear_of_100_by_simulation(factors):
    """The wheel under (4.5) alone, as the plug-in has it: a motor without a rotor's inertia, and
    friction at the wheel such that the top speed falls by the factor that is said."""
    drag = K_M * K_B / R
    friction = 100 * drag * (100 - factors["speed"]) / (100 * factors["speed"] - 1)
    risen = lambda t, w: w[0] - 0.98  # noqa: E731
    risen.terminal = True
    times = []
    for n in (1.0, 100.0):
        tau = HUSKY.wheel_inertia / (n**2 * drag + friction)
        times.append(
            solve_ivp(
                lambda t, w, tau=tau: (1 - w) / tau, (0, 100 * tau), [0.0], events=risen,
                max_step=tau / 5,
            ).t[-1]
        )  # fmt: skip
    assert 0.5 < factors["settling_at_least"] / (times[0] / times[1]) < 2


def _gear_factors():
    bare = [replace(WHEELCHAIR, friction=0.0, inertia=1e-12, gear=n) for n in (1.0, 100.0)]
    direct, geared = (motor.first_order(m, motor.hanging_wheel(HUSKY)) for m in bare)
    return {
        "speed": direct.gain / geared.gain,
        "settling_at_least": direct.time_constant / geared.time_constant,
    }


GEAR = _gear_factors()


def what_stands_before_the_last_derivative_is_tustins(factor):
    for K_d, N, T_s in ((0.3, 8.0, 0.01), (0.1, 20.0, 0.002)):
        _, poles, _ = cont2discrete(([K_d, 0], [K_d / N, 1]), T_s, method="bilinear")
        _close(factor(K_d, N, T_s), -poles[1], 1e-9)


def derivative_kept_by_tustin(K_d, N, T_s):
    part = DigitalPID.from_factored(1.0, 0.0, K_d, T_s, derivative_filter=N, form="tustin")
    part(0.0, 0.0), part(0.0, -1.0)
    before = part.derivative
    part(0.0, -1.0)
    return part.derivative / before


def derivative_kept_by_46(K_d, N, T_s):
    return K_d / (K_d + N * T_s)


def some_pi_meets_these_demands(demands):
    """Of a grid of gains, on the printed motor behind its load, sampled here and now."""
    load = motor.vehicle_load(HUSKY)
    damping = WHEELCHAIR.damping + load.friction
    tau = (WHEELCHAIR.rotor_inertia + load.inertia) / damping
    E, gain = exp(-1e-3 / tau), WHEELCHAIR.torque_per_volt / damping
    kp, ki = np.meshgrid(np.linspace(2, 24, 45), np.linspace(5, 2000, 60))
    w, z, top, late, most = (np.zeros_like(kp) for _ in range(5))
    for k in range(200):
        e = demands["reference"] - w
        z = z + 1e-3 * e
        volts = kp * e + ki * z
        w = E * w + (1 - E) * gain * volts
        top, most = np.maximum(top, w), np.maximum(most, np.abs(volts))
        late = np.where(np.abs(w - demands["reference"]) > 0.02, (k + 1) * 1e-3, late)
    allowed = (1 - demands["faster_at_least"]) * tau * log(50)
    fits = top <= demands["reference"] * (1 + demands["overshoot"]) + 1e-3
    assert (fits & (late < allowed) & (most < WHEELCHAIR.voltage)).any()


def _demands_met():
    load = motor.vehicle_load(HUSKY)
    run = motor.control_wheel(WHEELCHAIR, load, motor.tune_wheel(WHEELCHAIR, load))
    alone = log(50) * motor.first_order(WHEELCHAIR, load).time_constant
    settled = motor.settling_time(run.time, run.speed, 1.0)
    return {"overshoot": motor.overshoot(run.speed, 1.0), "reference": 1.0,
            "faster_at_least": 1 - settled / alone - 0.02}  # fmt: skip


DEMANDS = _demands_met()
DEMANDS_BEYOND_THE_VOLTAGE = DEMANDS | {"faster_at_least": 0.9}


def two_and_four_motors_hold_their_speed_behind_a_gear_of_100(saved):
    """What a held wheel of the vehicle asks of its motor: volts and time constants by balance."""
    p, n, volts, taus = HUSKY, 100.0, [], []
    for driven in (2, 4):
        drag = p.mass * p.gravity * p.rolling * p.wheel_radius**2 / driven
        damping = n**2 * (WHEELCHAIR.friction + K_M * K_B / R) + drag
        volts.append(damping / (n * K_M / R))
        share = (4 * p.wheel_inertia + p.mass * p.wheel_radius**2) / driven
        taus.append((n**2 * WHEELCHAIR.inertia + share) / damping)
    assert abs(saved["excitation_less"] - (1 - volts[1] / volts[0])) < 0.01
    assert abs(saved["settling_ratio"] - taus[1] / taus[0]) < 0.1


def _four_against_two():
    four, two = (
        motor.first_order(WHEELCHAIR, motor.vehicle_load(HUSKY, driven)) for driven in (4, 2)
    )
    return {"excitation_less": 1 - two.gain / four.gain,
            "settling_ratio": four.time_constant / two.time_constant}  # fmt: skip


FOUR_MOTORS = _four_against_two()


# (3.35) to (3.38) and what is said of the tracks


def two_tracks_push_with_that_force_and_moment(shares, gauge=BACKHOE.tracks.gauge):
    """Statics: twice u_v ahead, and u_omega at both levers of half a gauge."""
    levers = gauge / 2 * np.array([1j, -1j])
    for u_v, u_omega in TWISTS:
        forces = np.array(shares(u_v, u_omega))
        _close(forces.sum(), 2 * u_v)
        _close((levers.conjugate() * forces).imag.sum(), gauge * u_omega)


def shares(u_v, u_omega):
    return travel.VelocityPI((1, 1), (0, 0), limit=np.inf)(u_v, u_omega, 0.0, 0.0, 0.02)


def shares_335(u_v, u_omega):
    return u_v - u_omega, u_v + u_omega


def shares_to_the_other_side(u_v, u_omega):
    return u_v + u_omega, u_v - u_omega


def shares_of_fig_316(u_v, u_omega):
    """u_r about -u_l, in a drive that turns and travels."""
    return -u_omega, u_omega


def tracks_pass_the_ground_under_them(sides, gauge=BACKHOE.tracks.gauge):
    places = gauge / 2 * np.array([1j, -1j])
    for v, omega in TWISTS:
        ground = _velocity(lambda t, v=v, w=omega: v * t + places * np.exp(1j * w * t)).real
        _close(sides(v, omega, gauge), ground)


def sides_336(v, omega, gauge):
    return v - gauge / 2 * omega, v + gauge / 2 * omega


def sides_at_the_whole_gauge(v, omega, gauge):
    return sides_336(v, omega, 2 * gauge)


def errors_are_what_each_track_lacks(errors, gauge=BACKHOE.tracks.gauge):
    """Wanted less present speed of a point of either track, both by differences of its place."""
    places = gauge / 2 * np.array([1j, -1j])

    def ground(v, omega):
        return _velocity(lambda t: v * t + places * np.exp(1j * omega * t)).real

    for wanted, present in zip(TWISTS[:10], TWISTS[10:], strict=True):
        lacking = ground(*wanted) - ground(*present)
        _close(errors(*(wanted - present), gauge), lacking)


def errors(e_v, e_omega, gauge):
    pi_ = travel.VelocityPI((1, 1), (0, 0), limit=np.inf, lever=gauge / 2)
    return pi_(e_v, e_omega, 0.0, 0.0, 0.02)


def errors_337(e_v, e_omega, gauge):
    return e_v - gauge / 2 * e_omega, e_v + gauge / 2 * e_omega


def errors_without_a_lever(e_v, e_omega, gauge):
    return errors_337(e_v, e_omega, 2.0)


def gains_that_make_rates_of_a_mass_and_of_an_inertia(units):
    """m de/dt^2 + K_p de/dt + K_i e = 0 must have the poles of its own units, 1/s."""
    for loop, body in (("translation", (1, 0, 0)), ("rotation", (1, 1, 0))):
        here = np.roots([20.0, 240.0, 180.0])
        there = np.roots([20.0 / _factor(*body), 240.0 / _factor(*units[loop]["kp"]),
                          180.0 / _factor(*units[loop]["ki"])])  # fmt: skip
        _close(here, there * _factor(0, 0, -1))


UNITS_OF_THE_GAINS = {  # powers of kg, m, s; a turn's force acts on a lever, inertia over lever
    "translation": {"kp": (1, 0, -1), "ki": (1, 0, -2)},
    "rotation": {"kp": (1, 1, -1), "ki": (1, 1, -2)},
}
_N_M = {"kp": (1, 2, -2), "ki": (1, 2, -2)}
UNITS_OF_338 = {"translation": _N_M, "rotation": _N_M}


def a_mass_settles_at_the_origin(gains):
    """The rule that they must satisfy (3.38): roots in the left half plane, for any mass."""
    for mass in (1.0, 8e3, 24e3, 1e6):
        assert np.roots([mass, gains["kp"], gains["ki"]]).real.max() < 0


GAINS = {"kp": travel.GAINS.kp[0], "ki": travel.GAINS.ki[0]}
GAINS_WITH_A_MINUS = GAINS | {"ki": -90e3}


def one_mass_has_both_figures(row):
    """Masses under the PI of Table 3.2, tried by python-control."""
    fits = []
    for mass in np.geomspace(4e3, 40e3, 40):
        loop = control.tf([240e3, 180e3], [mass, 240e3, 180e3])
        info = control.step_info(loop, T=np.linspace(0, 8, 801), SettlingTimeThreshold=0.02)
        overshoot = abs(info["Overshoot"] / row["overshoot_percent"] - 1)
        settling = abs(info["SettlingTime"] / row["settling_time"] - 1)
        fits.append(max(overshoot, settling))
    assert min(fits) < 0.1


def _step_of_our_mass():
    loop, t = travel.model().translation, np.linspace(0, 8, 8001)
    settled = motor.settling_time(t, loop.response(t), 1.0)
    return {"settling_time": settled, "overshoot_percent": 100 * loop.overshoot}


STEP_OF_OUR_MASS = _step_of_our_mass()


def a_free_inertia_overshoots_and_friction_ends_it(overshoots):
    """By python-control: a step of the turn, on an inertia and on the same with friction."""
    for friction in (0.0, 1.2e6):
        loop = control.tf([120e3, 90e3], [60e3, 120e3 + friction, 90e3])
        info = control.step_info(loop, T=np.linspace(0, 40, 801), final_output=1.0)
        assert overshoots(friction) == (info["Overshoot"] > 1e-3)


def overshoots(friction):
    return travel.StepModel(60e3, 120e3, 90e3, friction).overshoot > 1e-5


def overshoots_as_said(friction):
    return friction == 0.0


def overshoots_by_friction(friction):
    return friction > 0.0


def no_other_kind_does_better_against_rolling_resistance(gains):
    """ITAE of a step of 0.6 m/s by SciPy, with K_p as given; a derivative adds to the mass."""

    def cost(ki, kd, mass=24.1e3, kp=240e3, held=12e3):
        def rate(t, s):
            push = kp * (0.6 - s[0]) + ki * s[1] - held * np.tanh(s[0] / 1e-3)
            return [push / (mass + kd), 0.6 - s[0]]

        t = np.linspace(0, 10, 1001)
        run = solve_ivp(rate, (0, 10), [0.0, 0.0], "LSODA", t, rtol=1e-7)
        return np.trapezoid(t * np.abs(0.6 - run.y[0]), t)

    others = {"P": (0.0, 0.0), "PI": (180e3, 0.0), "PID": (180e3, 12e3), "PD": (0.0, 12e3)}
    costs = {name: cost(*parts) for name, parts in others.items()}
    assert min(costs, key=costs.get) == gains


OUR_KIND, KIND_351, KIND_WITH_A_DERIVATIVE = "PI", "PI", "PID"  # of `travel.VelocityPI`; printed


def yaw_comes_from_a_load_beside_the_middle(peak):
    """Newton: tracks that push alike turn a body whose mass lies y aside by m a y, and not else."""
    for swing_deg, beside in ((-90.0, False), (0.0, True)):
        _, com = travel.yaw_inertia(np.radians([swing_deg, 50.0, -60.0, 60.0]))
        assert (abs(com[1]) > 0.1) == beside
        assert (0.1 < peak(swing_deg) < 5.0) if beside else peak(swing_deg) < 0.01


def peak_of_yaw(swing_deg):
    """Largest turning rate while it starts, stops and reverses straight on [deg/s]."""
    posture, most = np.radians([swing_deg, 50.0, -60.0, 60.0]), 0.0
    with TrackedPlant(backend="analytic", posture=posture) as excavator:
        while excavator.time < 4.0:
            excavator.step(0.6 if excavator.time < 2 else -0.6, 0.0)
            most = max(most, abs(excavator.twist[1]))
    return np.degrees(most)


def peak_of_fig_313(swing_deg):
    """Below 5 deg/s, where the mass is not even on both tracks."""
    return 0.5 * 5.0 * abs(np.cos(np.radians(swing_deg)))


def peak_at_any_load(swing_deg):
    return 2.5


def a_body_keeps_its_speed_when_the_wish_jumps(largest_error):
    """Forces are finite, so just after a jump all of it is error."""
    for jump in (0.02, 0.3, 0.6):
        assert largest_error(jump) >= 0.999 * jump


def largest_error(jump):
    t = np.linspace(0, 5, 501)
    return float(jump * np.abs(1 - travel.model().translation.response(t)).max())


def largest_error_of_fig_317(jump):
    return 0.05
