"""A life of a slider-crank with one worn clearance joint, as one would write it with SciPy and numba.

Unknowns are the rod's angle theta and the slider's position s; crank pin and guide are ideal and leave no others. The
right-hand side is compiled. Every cycle is one `solve_ivp`; the contact at the solver's own steps gives Archard's wear
by the trapezoidal rule, shared out over the control points by their hat functions, and the wear of that cycle is repeated
`jump` times in an explicit jump. Contact law, arc of contact and spline of the bore are those of the scene language's
`local-hertz`.
"""

import math
import tomllib

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

UNITS = {
    "mm": 1e-3, "um": 1e-6, "kg": 1.0, "kg m^2": 1.0, "GPa": 1e9, "r/min": math.tau / 60, "deg": math.pi / 180,
    "s/m": 1.0, "N s/m": 1.0, "mm/s": 1e-3, "1/Pa": 1.0,
}
SUBDIVISION = 8  # intervals of the table of the bore per control point
WARM_UP = 0.05  # after each jump, as a fraction of the cycle

# Names of the entries of the vector of parameters.
(OMEGA, CRANK, ROD, ROD_MASS, ROD_INERTIA, ROD_CENTRE, SLIDER_MASS, JOURNAL, STIFFNESS, DAMPING, FILM, FRICTION,
 FRICTION_SPEED, WIDTH, WEAR, BUSHING, COUNT) = range(17)


def si(text):
    """A number, or a number with a unit, in SI."""
    if not isinstance(text, str):
        return float(text)
    number, _, unit = text.partition(" ")
    return float(number) * UNITS[unit]


class Scene:
    """What both programs read from the scene file."""

    def __init__(self, path):
        with open(path, "rb") as file:
            scene = tomllib.load(file)
        bodies = {body["name"]: body for body in scene["bodies"]}
        joint = next(j for j in scene["joints"] if j["type"] == "clearance")
        steel = scene["materials"]["steel"]
        compliance = (1 - steel["poisson_ratio"] ** 2) / (math.pi * si(steel["elastic_modulus"]))
        journal = si(joint["journal_radius"])
        bushing = journal + si(joint["radial_clearance"])
        rod = bodies["rod"]
        p = np.zeros(COUNT)
        p[OMEGA] = si(bodies["crank"]["speed"])
        p[CRANK] = si(bodies["crank"]["points"]["pin"][0])
        p[ROD] = si(rod["points"]["slider_pin"][0])
        p[ROD_MASS], p[ROD_INERTIA] = si(rod["mass"]), si(rod["inertia"])
        p[ROD_CENTRE] = si(rod["centre_of_mass"][0])
        p[SLIDER_MASS] = si(bodies["slider"]["mass"])
        p[JOURNAL], p[BUSHING] = journal, bushing
        p[STIFFNESS] = 4 / (3 * math.pi * 2 * compliance) * math.sqrt(journal * bushing / (bushing - journal))
        p[DAMPING] = si(joint["contact_damping"]["hunt_crossley"])
        p[FILM] = si(joint["film_damping"])
        p[FRICTION], p[FRICTION_SPEED] = si(joint["friction"]), si(joint["friction_speed"])
        p[WIDTH], p[WEAR] = si(joint["width"]), si(joint["wear_coefficient"])
        self.p = p
        self.points = joint["control_points"]
        self.period = math.tau / p[OMEGA]
        self.cycles = scene["life"]["cycles"]
        self.every = scene["life"]["checkpoint_every"]
        self.settle = scene["life"]["settle_cycles"]


def spline(bushing, depth):
    """Periodic cubic spline through the control points, as coefficients of powers `(points, 4)` [m]."""
    n = len(depth)
    matrix = np.diag(np.full(n, 4.0))
    for i in range(n):
        matrix[i, i - 1] = matrix[i - 1, i] = 1.0
    second = 6 * (np.roll(depth, 1) - 2 * depth + np.roll(depth, -1))
    m = np.linalg.solve(matrix, second)
    next_m, rise = np.roll(m, -1), np.roll(depth, -1) - depth
    return np.stack([bushing + depth, rise - (2 * m + next_m) / 6, m / 2, (next_m - m) / 6], axis=1)


@njit(cache=True)
def radius(cubic, psi):
    """Radius of the bore at an angle and its slope to the angle [m, m/rad]."""
    n = cubic.shape[0]
    x = (psi / math.tau % 1.0) * n
    k = min(int(x), n - 1)
    s = x - k
    a, b, c, d = cubic[k, 0], cubic[k, 1], cubic[k, 2], cubic[k, 3]
    return a + s * (b + s * (c + s * d)), (b + s * (2 * c + 3 * s * d)) * n / math.tau


@njit(cache=True)
def contact(t, theta, s, theta_d, s_d, p, cubic):
    """Contact of the piston pin: force on the slider (x, y), torque on the rod about the bore's centre, angle and
    size of the eccentricity in the rod's frame, penetration, normal force, sliding speed, whole force."""
    sin, cos = math.sin(theta), math.cos(theta)
    phase = p[OMEGA] * t
    ex = s - p[CRANK] * math.cos(phase) - p[ROD] * cos
    ey = -p[CRANK] * math.sin(phase) - p[ROD] * sin
    wx = s_d + p[OMEGA] * p[CRANK] * math.sin(phase) + p[ROD] * sin * theta_d
    wy = -p[OMEGA] * p[CRANK] * math.cos(phase) - p[ROD] * cos * theta_d
    # Into the rod's frame.
    e0, e1 = cos * ex + sin * ey, -sin * ex + cos * ey
    w0, w1 = cos * wx + sin * wy, -sin * wx + cos * wy
    r = math.sqrt(e0 * e0 + e1 * e1)
    f0, f1, torque, normal, sliding = -p[FILM] * w0, -p[FILM] * w1, 0.0, 0.0, 0.0
    psi = math.atan2(e1, e0)
    bore, slope = radius(cubic, psi)
    delta = r + p[JOURNAL] - bore
    if delta > 0.0:
        u0, u1 = e0 / r, e1 / r
        wu, wt = w0 * u0 + w1 * u1, -w0 * u1 + w1 * u0
        rate = wu - slope * (wt / r - theta_d)
        normal = p[STIFFNESS] * delta * math.sqrt(delta) * max(0.0, 1.0 + p[DAMPING] * rate)
        sliding = wt - theta_d * bore
        friction = p[FRICTION] * math.tanh(sliding / p[FRICTION_SPEED]) * normal
        f0 += -normal * u0 + friction * u1
        f1 += -normal * u1 - friction * u0
        torque = bore * friction
    fx, fy = cos * f0 - sin * f1, sin * f0 + cos * f1
    return fx, fy, torque, psi, r, delta, normal, sliding, math.sqrt(fx * fx + fy * fy)


@njit(cache=True)
def rhs(t, y, p, cubic):
    """d/dt of (theta, s, theta_d, s_d): the rod about the moving crank pin, the slider along its guide."""
    theta, s, theta_d, s_d = y
    fx, fy, torque, _, _, _, _, _, _ = contact(t, theta, s, theta_d, s_d, p, cubic)
    sin, cos = math.sin(theta), math.cos(theta)
    phase = p[OMEGA] * t
    # Acceleration of the crank pin.
    a = -p[OMEGA] * p[OMEGA] * p[CRANK]
    ax, ay = a * math.cos(phase), a * math.sin(phase)
    moment = p[ROD] * (-cos * fy + sin * fx) + torque - p[ROD_MASS] * p[ROD_CENTRE] * (cos * ay - sin * ax)
    out = np.empty(4)
    out[0], out[1] = theta_d, s_d
    out[2] = moment / (p[ROD_INERTIA] + p[ROD_MASS] * p[ROD_CENTRE] ** 2)
    out[3] = fx / p[SLIDER_MASS]
    return out


@njit(cache=True)
def ideal(t, p):
    """The state with a closed piston pin."""
    phase = p[OMEGA] * t
    sin = -p[CRANK] / p[ROD] * math.sin(phase)
    cos = math.sqrt(1 - sin * sin)
    theta_d = -p[CRANK] / p[ROD] * p[OMEGA] * math.cos(phase) / cos
    s = p[CRANK] * math.cos(phase) + p[ROD] * cos
    s_d = -p[OMEGA] * p[CRANK] * math.sin(phase) - p[ROD] * sin * theta_d
    return np.array([math.asin(sin), s, theta_d, s_d])


@njit(cache=True)
def end_of_arc(psi, e, journal, cubic, table, up):
    """Angle from psi to the end of the contact arc: where the journal's circle meets the tabulated bore again."""
    n = len(table)
    spacing = math.tau / n
    x = (psi / math.tau % 1.0) * n
    lead = x - math.floor(x)
    k = int(x) % n
    phi = (1.0 - lead) * spacing if up else lead * spacing
    if up:
        k = (k + 1) % n
    bore, slope = radius(cubic, psi)
    before, at = e + journal - bore, 0.0
    for first in range(n // 2):
        sin, cos = math.sin(phi), math.cos(phi)
        beyond = e * cos + math.sqrt(journal * journal - e * e * sin * sin) - table[k]
        if beyond <= 0.0:
            if first == 0:
                # Parabola through both ends with the slope at psi.
                b = -slope if up else slope
                q = (beyond - before - b * phi) / (phi * phi) if phi > 0.0 else 0.0
                root = math.sqrt(max(b * b - 4 * q * before, 0.0))
                end = (b + root) / (-2 * q) if b >= 0.0 else 2 * before / (root - b)
                return min(end, phi) if end > 0.0 else phi
            return at + spacing * before / (before - beyond)
        before, at = beyond, phi
        k = (k + 1) % n if up else k - 1 if k > 0 else n - 1
        phi += spacing
    return phi


@njit(cache=True)
def hat_integral(x):
    """Integral up to x of the hat function, which is 1 at 0 and falls to 0 at -1 and 1."""
    x = min(max(x, -1.0), 1.0)
    return 0.5 * (1.0 + x) ** 2 if x < 0.0 else 1.0 - 0.5 * (1.0 - x) ** 2


@njit(cache=True)
def observe(t, y, p, cubic, table, points):
    """Wear of one cycle at the control points, peak of the joint's force, largest error of the slider's position, from
    states `y (4, m)` at times `t`."""
    wear = np.zeros(points)
    peak, error = 0.0, 0.0
    spacing = math.tau / points
    for i in range(len(t)):
        _, _, _, psi, r, delta, normal, sliding, force = contact(t[i], y[0, i], y[1, i], y[2, i], y[3, i], p, cubic)
        peak = max(peak, force)
        error = max(error, abs(y[1, i] - ideal(t[i], p)[1]))
        if normal <= 0.0:
            continue
        duration = 0.5 * ((t[i + 1] - t[i] if i + 1 < len(t) else 0.0) + (t[i] - t[i - 1] if i > 0 else 0.0))
        before = end_of_arc(psi, r, p[JOURNAL], cubic, table, False)
        after = end_of_arc(psi, r, p[JOURNAL], cubic, table, True)
        low, middle, high = radius(cubic, psi - before)[0], radius(cubic, psi)[0], radius(cubic, psi + after)[0]
        length = (low + 4 * middle + high) / 6 * (before + after)
        share = p[WEAR] / p[WIDTH] * normal * abs(sliding) * duration / length
        start, end = (psi - before) / spacing, (psi + after) / spacing
        for k in range(math.floor(start), math.ceil(end) + 1):
            wear[k % points] += share * (hat_integral(end - k) - hat_integral(start - k))
    return wear, peak, error


def tabulate(cubic):
    """Radius at SUBDIVISION equal angles between control points [m]."""
    s = np.arange(SUBDIVISION) / SUBDIVISION
    return (cubic @ np.stack([s**0, s, s**2, s**3])).ravel()


def lsoda(rtol):
    """Integration by `solve_ivp(LSODA)`. Errors are bounded in proportion to rtol by lengths of 1 m, and by speeds that a
    radian of the crank makes of them: penetrations of micrometres want an rtol of 1e-7 and less."""

    def integrate(start, duration, y, p, cubic):
        atol = rtol * np.array([1.0, 0.1, p[OMEGA], 0.1 * p[OMEGA]])
        span = (start, start + duration)
        done = solve_ivp(rhs, span, y, method="LSODA", rtol=rtol, atol=atol, args=(p, cubic))
        if not done.success:
            raise RuntimeError(done.message)
        return done.t, done.y, done.nfev

    return integrate


@njit(cache=True)
def runge_kutta(start, h, steps, y, p, cubic):
    """Classical Runge-Kutta steps of constant length, compiled as a whole."""
    t, states = np.empty(steps + 1), np.empty((4, steps + 1))
    for k in range(steps + 1):
        now = start + k * h
        t[k], states[:, k] = now, y
        k1 = rhs(now, y, p, cubic)
        k2 = rhs(now + h / 2, y + h / 2 * k1, p, cubic)
        k3 = rhs(now + h / 2, y + h / 2 * k2, p, cubic)
        k4 = rhs(now + h, y + h * k3, p, cubic)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return t, states


def compiled(steps):
    """Integration by so many compiled Runge-Kutta steps per turn of the crank: what the reference is made of."""

    def integrate(start, duration, y, p, cubic):
        count = math.ceil(steps * duration * p[OMEGA] / math.tau - 1e-9)
        return *runge_kutta(start, duration / count, count, y, p, cubic), 4 * count

    return integrate


class Life:
    """A whole life of the mechanism under one way to integrate.

    `outputs (cycles / every + 1, 3)` at every so many cycles, the new mechanism first: largest wear [m], peak of the
    joint's force [N], largest error of the slider's position [m]. `calls` counts evaluations of the right-hand side."""

    def __init__(self, scene, integrate, jump, second_order=False):
        """Explicit jumps: each repeats the wear of the cycle simulated at its start `jump` times; with `second_order`
        by Heun's rule."""
        self.scene, self.integrate, self.calls = scene, integrate, 0
        self.start, self.y = 0.0, ideal(0.0, scene.p)
        depth, outputs = np.zeros(scene.points), []
        self.wear_to(depth)
        for _ in range(scene.settle):
            self.carry(scene.period)
        for done in range(0, scene.cycles + 1, jump):
            wear, *motion = self.measure()
            if done % scene.every == 0:
                outputs.append((depth.max(), *motion))
            if second_order:
                self.wear_to(depth + jump * wear)
                wear = 0.5 * (wear + self.measure()[0])
            depth = depth + jump * wear
            self.wear_to(depth)
        self.outputs = np.array(outputs)

    def wear_to(self, depth):
        """A bore worn to `depth` at its control points [m]."""
        self.cubic = spline(self.scene.p[BUSHING], depth)

    def carry(self, duration):
        """Goes on for so long [s]; times and states on the way."""
        t, states, calls = self.integrate(self.start, duration, self.y, self.scene.p, self.cubic)
        self.start, self.y = t[-1], states[:, -1].copy()
        self.calls += calls
        return t, states

    def measure(self):
        """Lets the pin find the bore as worn by now, then observes a whole turn."""
        self.carry(WARM_UP * self.scene.period)
        t, states = self.carry(self.scene.period)
        return observe(t, states, self.scene.p, self.cubic, tabulate(self.cubic), self.scene.points)
