"""Self-checks of line2d.py against closed forms and against itself: `python line2d.py --self-test`.

Closed forms: T tension, q weight and m mass per length, k = sqrt(T/EI), L span.
"""

import copy

import numpy as np
from scipy import linalg

from line2d import Pantograph, low_pass, simulate
from planar_line import CONTACT, MESSENGER, BandFactor, Line, Wire, active_set, gram, held, hermite, nodal, scatter

WIRE = {"mass_per_length": 1.35, "tension": 20000.0, "axial_stiffness": 1.7e7, "bending_stiffness": 195.0}
SCENE = {
    "title": "self-test",
    "run": {"speed_kmh": 250.0, "duration": 0.8, "start_x": 20.0, "evaluate": {"spans": [1, 2]}, "low_pass_hz": 20.0},
    "catenary": {
        "spans": 2, "span_length": 60.0, "contact_wire_height": 5.3, "encumbrance": 1.2, "presag": 0.0, "stagger": [0.0],
        "wire_ends": "constant_tension", "gravity": 9.81, "contact_wire": WIRE,
        "messenger_wire": {"mass_per_length": 1.07, "tension": 16000.0, "axial_stiffness": 1.1e7, "bending_stiffness": 131.7},
        "droppers": {"positions": [5.0, 17.0, 30.0, 43.0, 55.0], "stiffness": 1e5, "damping": 0.0, "mass": 0.0},
        "supports": {"messenger_vertical_stiffness": 5e5, "messenger_longitudinal_stiffness": 0.0},
        "registration_arms": {"vertical_stiffness": 0.0, "mass": 0.0}, "damping": {"alpha": 0.0125, "beta": 1e-4}},
    "contact": {"law": "penalty", "stiffness": 5e4, "damping": 0.0},
    "pantograph": [{"offset_x": 0.0, "static_force": 120.0, "masses": [7.2, 15.0], "stiffnesses": [4200.0, 50.0],
                    "dampings": [10.0, 90.0]}],
}


class SingleWire(Line):
    """Only the mesh that the statics of one wire needs."""

    def __init__(self, length, elements, gravity=9.81):
        self.x = np.linspace(0.0, length, elements + 1)
        self.nodes, self.gravity = elements + 1, gravity


def element_derivatives_follow_from_the_energy():
    rng = np.random.default_rng(1)
    wire, length = Wire(WIRE), np.array([0.7])
    cx = np.array([[0.0, 0.99, 0.68, 1.01]]) + 1e-3 * rng.standard_normal((1, 4))
    cz = 0.05 * rng.standard_normal((1, 4))
    _, gradient, hessian = wire.elements(length, cx, cz)
    q, h, worst = np.concatenate([cx[0], cz[0]]), 1e-6, 0.0
    for i in range(8):
        plus, minus = q.copy(), q.copy()
        plus[i] += h
        minus[i] -= h
        up, down = (wire.elements(length, p[None, :4], p[None, 4:]) for p in (plus, minus))
        worst = max(worst, abs((up[0] - down[0])[0] / (2 * h) - gradient[0].reshape(8)[i]) / np.abs(gradient).max())
        difference = (up[1] - down[1])[0].reshape(8) / (2 * h)
        worst = max(worst, np.abs(difference - hessian[0].reshape(8, 8)[i]).max() / np.abs(hessian).max())
    return worst, 1e-6, "finite differences of energy and gradient, relative"


def straight_wire_carries_its_nominal_tension():
    wire = Wire(WIRE)
    _, gradient, _ = wire.elements(np.array([0.7]), np.array([[0.0, 1.0, 0.7, 1.0]]), np.zeros((1, 4)))
    return abs(gradient[0, 0, 2] / wire.tension - 1), 1e-12, "axial force at |r'| = 1, relative"


def sag_of_a_flat_wire():
    mesh, wire, length = SingleWire(60.0, 120), Wire(WIRE), 60.0
    _, _, cz, _ = mesh.flat_statics(wire, np.diff(mesh.x), np.array([0, 120]), np.zeros(2), np.zeros(121))
    q, k = wire.m * 9.81, np.sqrt(wire.tension / wire.ei)
    exact = q * length**2 / (8 * wire.tension) - q * wire.ei / wire.tension**2 * (1 - 1 / np.cosh(k * length / 2))
    return abs(-cz[60, 0] / exact - 1), 1e-6, "pinned tensioned beam under its weight, relative"


def hanging_wire_takes_the_elastic_catenary():
    # Soft and heavy, so that sag, arc length and stretch all matter; EI so small that its end layer does not count.
    table = {"mass_per_length": 5.0, "tension": 16000.0, "axial_stiffness": 2.0e6, "bending_stiffness": 1e-3}
    wire, span, n = Wire(table), 60.0, 240
    mesh = SingleWire(span, n)
    lengths, _, cz, _ = mesh.form_finding(wire, np.diff(mesh.x), np.array([0, n]), np.zeros(2), np.zeros(n + 1))
    # Elastic catenary of the element's law, integrated: stretch mu = |r'| from EA lam (lam^2 mu^2 - 1)/2 mu = N.
    h = wire.tension

    def shape(total):
        point, weight = np.polynomial.legendre.leggauss(60)
        s = total / 4 * (point + 1)  # from the middle to the end, half of `total`
        normal = np.hypot(h, wire.m * 9.81 * s)
        mu = np.ones_like(s)
        for _ in range(50):
            f = 0.5 * wire.ea * wire.stretch * (wire.stretch**2 * mu**3 - mu) - normal
            mu -= f / (0.5 * wire.ea * wire.stretch * (3 * wire.stretch**2 * mu**2 - 1))
        return total / 4 * weight @ (mu * h / normal), total / 4 * weight @ (mu * wire.m * 9.81 * s / normal)

    low, high = 0.9 * span, 1.1 * span
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if shape(middle)[0] < span / 2 else (low, middle)
    sag = shape(low)[1]
    worst = max(abs(-cz[n // 2, 0] / sag - 1), abs(lengths.sum() / low - 1))
    return worst, 2e-6, f"sag {sag:.4f} m and length {low:.4f} m, relative"


def first_frequency_of_a_pinned_wire():
    wire, length, n = Wire(WIRE), 60.0, 40
    le = np.full(n, length / n)
    size = 2 * (n + 1)
    index = 2 * np.arange(n)[:, None] + np.arange(4)[None, :]
    k, m = np.zeros((size, size)), np.zeros((size, size))
    for e, i in enumerate(index):
        k[np.ix_(i, i)] += (wire.tension * gram(le, 1) + wire.ei * gram(le, 2))[e]
        m[np.ix_(i, i)] += wire.m * gram(le, 0)[e]
    free = np.setdiff1d(np.arange(size), [0, size - 2])
    lowest = linalg.eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True, subset_by_index=[0, 2])
    mode = np.arange(1, 4)
    exact = mode / (2 * length) * np.sqrt(wire.tension / wire.m * (1 + wire.ei * (mode * np.pi / length) ** 2 / wire.tension))
    return np.abs(np.sqrt(lowest) / (2 * np.pi) / exact - 1).max(), 1e-6, f"first {exact[0]:.5f} Hz and two more, relative"


def point_force_deflects_by_the_closed_form():
    mesh, wire, length, n = SingleWire(60.0, 240, gravity=0.0), Wire(WIRE), 60.0, 240
    load = np.zeros(n + 1)
    load[n // 2] = 100.0
    _, _, cz, _ = mesh.flat_statics(wire, np.diff(mesh.x), np.array([0, n]), np.zeros(2), load)
    k = np.sqrt(wire.tension / wire.ei)
    exact = 100.0 * length / (4 * wire.tension) * (1 - np.tanh(k * length / 2) / (k * length / 2))
    # the kink is rounded over 0.1 m, the elements are 0.25 m: 1e-4 of the deflection is the mesh
    return abs(cz[n // 2, 0] / exact - 1), 2e-4, f"{exact * 1e3:.4f} mm, relative"


def statics_balance_weight():
    worst = 0.0
    for model in ("flat", "sagging"):
        line = Line(SCENE, model, 4)
        total = sum(line.wires[w].m * 9.81 * line.static[w][0].sum() for w in (CONTACT, MESSENGER))
        carried = line.messenger_reaction.sum() + line.arm_force.sum()
        worst = max(worst, abs(carried / total - 1))
    return worst, 1e-7, "reactions of supports and arms against the weight, relative"


def linear_line_is_the_tangent_of_the_nonlinear_one():
    line = Line(SCENE, "sagging", 3)
    rng = np.random.default_rng(2)
    u = rng.standard_normal(line.size) * 1e-6
    u[line.fixed] = 0.0
    u[line.dof(MESSENGER, line.support_node, "z")] = 0.0  # leave the support springs out

    def internal(scale):
        out = np.zeros(line.size)
        for w, wire in enumerate(line.wires):
            length, cx, cz, _ = line.static[w]
            base = line.dof(w, np.arange(line.nodes), "x")
            q = scale * np.stack([u[base + i] for i in range(4)], 1)
            _, g, _ = wire.elements(length, nodal(cx + q[:, :2]), nodal(cz + q[:, 2:]))
            for axis in range(2):
                np.add.at(out, np.stack([base[:-1], base[:-1] + 1, base[1:], base[1:] + 1], 1) + 2 * axis, g[:, axis])
        return out

    numeric = 0.5 * (internal(1.0) - internal(-1.0))
    numeric += line.k_drop * line.elongation.T @ (line.elongation @ u)
    numeric[line.fixed] = 0.0
    numeric[line.dof(MESSENGER, line.support_node, "z")] = 0.0
    exact = line.stiffness @ u
    exact[line.dof(MESSENGER, line.support_node, "z")] = 0.0
    return np.abs(numeric - exact).max() / np.abs(exact).max(), 1e-6, "assembled matrix against finite differences, relative"


def contact_row_moves_the_height_at_fixed_x():
    # the wire moved by u: solve x0 + N u_x = xs anew and read z there; agreement to second order in u
    line, xs = Line(SCENE, "sagging", 3), 38.4
    rng = np.random.default_rng(3)
    u = 1e-5 * rng.standard_normal(line.size)
    index, row, z0 = line.contact_rows(np.array([xs]))
    linear = row[0] @ u[index[0]]
    base = line.dof(CONTACT, np.arange(line.nodes), "x")
    length, cx, cz, reaction = line.static[CONTACT]
    moved = copy.copy(line)
    moved.static = [(length, cx + np.stack([u[base], u[base + 1]], 1), cz + np.stack([u[base + 2], u[base + 3]], 1), reaction)]
    _, _, z1 = moved.contact_rows(np.array([xs]))
    return abs((z1 - z0)[0] - linear) / abs(linear), 1e-3, "height change at fixed x, relative"


def active_set_fulfils_the_complementarity():
    rng, worst = np.random.default_rng(4), 0.0
    for _ in range(50):
        a = rng.standard_normal((9, 9))
        gram_matrix = a @ a.T
        effect = 0.9 * gram_matrix / np.linalg.eigvalsh(gram_matrix)[-1]
        law, push = 30 * rng.standard_normal(9), 0.3 * rng.standard_normal(9)
        force, slack, r, closed = active_set(law, push, effect, law < 0, (5e4, 0.002, 1e-4, 1e-3 * push, True))
        full = np.zeros(9)
        full[slack] = r
        f = law + push * force - effect @ full
        penetration = 0.002 - 1e-4 * force + 1e-3 * push @ full
        worst = max(worst, np.max(-full, initial=0.0), np.abs(np.minimum(f + full, 0)).max(), np.abs((f + full)[slack]).max(),
                    abs(force - max(0.0, 5e4 * penetration)))
    return worst, 1e-8, "random cases, N"


def standing_pantograph_stays_in_balance():
    """With both ends at constant tension the wire may creep along x, so the sagging line is tested with held ends."""
    scene = copy.deepcopy(SCENE)
    scene["run"]["speed_kmh"] = 0.0
    scene["run"]["duration"] = 0.5
    worst = 0.0
    for model in ("flat", "sagging"):
        force = simulate(Line(scene, model, 3, "fixed"), 0.001)["force"]
        worst = max(worst, np.abs(force - force[0]).max())
    return worst, 1e-6, "change of force in 0.5 s at rest, N"


def steps_converge_to_second_order():
    forces = {}
    scene = copy.deepcopy(SCENE)
    scene["catenary"]["droppers"]["stiffness"] = 2e4  # no dropper goes slack in this short run: smooth
    for rho in (None, 0.8):
        for h in (0.002, 0.001, 0.0005):
            stride = round(0.002 / h)
            result = simulate(Line(scene, "flat", 3), h, rho, duration=0.3)
            forces[rho, h] = low_pass(result["force"], h, 20.0)[::stride]
    order = [np.log2(np.linalg.norm(forces[rho, 0.002] - forces[rho, 0.001]) / np.linalg.norm(forces[rho, 0.001] - forces[rho, 0.0005]))
             for rho in (None, 0.8)]
    return max(abs(o - 2) for o in order), 0.4, f"orders {order[0]:.2f} (trapezoid), {order[1]:.2f} (rho_inf 0.8), distance from 2"


def moving_force_lifts_a_string_as_in_closed_form():
    """A force P that enters the contact wire: the rise below is P v t/(T (1 + v/c)) less the rounding of the kink."""
    wire, n, length = Wire({**WIRE, "bending_stiffness": 1.0}), 600, 60.0
    mesh = SingleWire(length, n)
    le = np.diff(mesh.x)
    index = 2 * np.arange(n)[:, None] + np.arange(4)[None, :]
    fixed = np.array([0, 2 * n])
    k = held(scatter(wire.tension * gram(le, 1) + wire.ei * gram(le, 2), index, 2 * n + 2), fixed, 0.0)
    m = held(scatter(wire.m * gram(le, 0), index, 2 * n + 2), fixed, 0.0)
    v, h, force = 60.0, 2.5e-4, 100.0
    c = np.sqrt(wire.tension / wire.m)
    factor = BandFactor(held(m + h**2 / 4 * k, fixed, 1.0))
    u = np.zeros(2 * n + 2)
    du, ddu = u.copy(), u.copy()
    for step in range(1, 2401):
        x = v * step * h
        e = min(int(x / le[0]), n - 1)
        row = hermite((x - mesh.x[e]) / le[0], le[0])
        up, dp = u + h * du + h**2 / 4 * ddu, du + h / 2 * ddu
        rhs = -(k @ up)
        rhs[index[e]] += force * row
        rhs[fixed] = 0.0
        ddu = factor.solve(rhs)
        u, du = up + h**2 / 4 * ddu, dp + h / 2 * ddu
    moving = wire.tension - wire.m * v**2
    exact = force * x / (wire.tension * (1 + v / c)) - force * np.sqrt(wire.ei / moving) / (2 * moving)
    return abs(row @ u[index[e]] / exact - 1), 5e-3, f"{exact * 1e3:.3f} mm at x = {x:.1f} m, relative"


def pantograph_alone_has_its_frequencies():
    pan = Pantograph(SCENE["pantograph"][0])
    found = np.sort(linalg.eigh(pan.stiffness, pan.mass, eigvals_only=True))
    a, b, c = 7.2 * 15.0, -(7.2 * 4250.0 + 15.0 * 4200.0), 4200.0 * 50.0  # characteristic polynomial in omega^2
    root = np.sqrt(b * b - 4 * a * c)
    exact = np.array([2 * c / (-b + root), (-b + root) / (2 * a)])
    return np.abs(found / exact - 1).max(), 1e-10, "omega^2, relative"


def run():
    """Runs all checks; returns the number of failures."""
    failures = 0
    for check in (element_derivatives_follow_from_the_energy, straight_wire_carries_its_nominal_tension, sag_of_a_flat_wire,
                  hanging_wire_takes_the_elastic_catenary, first_frequency_of_a_pinned_wire,
                  point_force_deflects_by_the_closed_form, statics_balance_weight, linear_line_is_the_tangent_of_the_nonlinear_one,
                  contact_row_moves_the_height_at_fixed_x, active_set_fulfils_the_complementarity, standing_pantograph_stays_in_balance,
                  steps_converge_to_second_order, moving_force_lifts_a_string_as_in_closed_form,
                  pantograph_alone_has_its_frequencies):
        error, limit, what = check()
        good = bool(error <= limit)
        failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {check.__name__}: {error:.2e} <= {limit:.0e} ({what})")
    return failures
