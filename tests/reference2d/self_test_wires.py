"""Self-checks of wires2d.py against closed forms and against itself: `python wires2d.py --self-test`.

T tension, q weight and m mass per length, L span.
"""

import copy

import numpy as np
from scipy import linalg, sparse

from assembly import Assembly
from frame_line import Chain, Factor, FrameLine, cubic
from hanging import HangingWire, hang
from wires2d import Coupled, complementary

ROPE = {"mass_per_length": 1.08, "tension": 21000.0, "axial_stiffness": 1.3e7, "bending_stiffness": 0.0}
SCENE = {
    "title": "self-test",
    "run": {"speed_kmh": 200.0, "duration": 0.6, "start_x": 70.0, "evaluate": {"spans": [2, 2]}, "low_pass_hz": 20.0},
    "catenary": {
        "spans": 4,
        "span_length": 60.0,
        "contact_wire_height": 5.3,
        "encumbrance": 1.6,
        "presag": 0.0,
        "stagger": [0.0],
        "wire_ends": "constant_tension",
        "gravity": 9.81,
        "contact_wire": {
            "mass_per_length": 1.35,
            "tension": 20000.0,
            "axial_stiffness": 1.7e7,
            "bending_stiffness": 195.0,
        },
        "messenger_wire": ROPE,
        "droppers": {
            "positions": [5.0, 17.0, 30.0, 43.0, 55.0],
            "stiffness": 1e5,
            "damping": 0.0,
            "mass": 0.1,
            "upper_clamp_mass": 0.2,
            "lower_clamp_mass": 0.2,
        },
        "supports": {"messenger_vertical_stiffness": 5e6, "messenger_longitudinal_stiffness": 0.0},
        "registration_arms": {"vertical_stiffness": 0.0, "mass": 1.0},
        "damping": {"alpha": 0.0125, "beta": 1e-4},
    },
    "contact": {"law": "penalty", "stiffness": 5e4, "damping": 0.0},
    "pantograph": [
        {
            "offset_x": 0.0,
            "static_force": 120.0,
            "masses": [7.2, 15.0],
            "stiffnesses": [4200.0, 50.0],
            "dampings": [10.0, 90.0],
        }
    ],
}
STITCH = {
    **ROPE,
    "length": 18.0,
    "tension": 3500.0,
    "mass_per_length": 0.31,
    "axial_stiffness": 3.5e6,
    "clamp_mass": 0.3,
}


def scene(**of_the_line):
    out = copy.deepcopy(SCENE)
    out["catenary"].update(copy.deepcopy(of_the_line))
    return out


def rope_hangs_as_a_catenary():
    h, q, length = 16000.0, 50.0, 60.0
    wire = HangingWire([0, 1, 2], [0.0, 20.0, length], [h, h], q, 0.0)
    z, reaction = hang([wire], [2.0, 1.9, 2.0], [True, False, True], np.zeros(3))
    low = h / q * (np.cosh(q * 10.0 / h) - np.cosh(q * 30.0 / h))
    carried = 2 * h * np.sinh(q * length / (2 * h))
    return (
        max(abs(z[1] - 2.0 - low), abs(reaction.sum() / carried - 1)),
        1e-10,
        "height at a third of the span, m, and weight",
    )


def rope_with_a_load_has_the_moment_of_the_load_over_its_tension():
    h, load, length, at = 20000.0, 900.0, 60.0, 18.0
    wire = HangingWire([0, 1, 2], [0.0, at, length], [h, h], 1e-9, 0.0)
    z, _ = hang([wire], [0.0, -0.1, 0.0], [True, False, True], np.array([0.0, -load, 0.0]))
    return abs(-z[1] / (load * at * (length - at) / (length * h)) - 1), 1e-9, "deflection under the load, relative"


def pinned_tensioned_beam_sags_by_the_closed_form():
    h, ei, q, length = 20000.0, 195.0, 13.0, 60.0
    wire = HangingWire([0, 1, 2], [0.0, 30.0, length], [h, h], q, ei)
    z, _ = hang([wire], [0.0, 0.0, 0.0], [True, False, True], np.zeros(3))
    k = np.sqrt(h / ei)
    exact = q * length**2 / (8 * h) - q * ei / h**2 * (1 - 1 / np.cosh(k * length / 2))
    slope = q * length / (2 * h)
    return abs(-z[1] / exact - 1), slope**2, "middle of the span, relative, to the square of the slope"


def continuous_beam_over_supports_carries_equal_spans_alike():
    h, ei, q, length = 20000.0, 195.0, 13.0, 60.0
    x = np.arange(9) * length / 2
    wire = HangingWire(np.arange(9), x, np.full(8, h), q, ei)
    z, _ = hang([wire], np.zeros(9), np.arange(9) % 2 == 0, np.zeros(9))
    kappa = length / 4 * np.sqrt(h / ei)  # slopes vanish at inner supports
    exact = q * length**2 / (8 * h) * (1 - np.tanh(kappa) / kappa)
    return abs(-z[3] / exact - 1), 2e-4, "middle of the second of four spans, relative"


def assembly_carries_its_weight():
    worst = 0.0
    overlap = [
        {
            "spans": 3,
            "span_length": 60.0,
            "contact_wire_height": [5.3, 5.3, 5.34, 5.8],
            "encumbrance": 1.2,
            "presag": 0.02,
        },
        {
            "start_x": 60.0,
            "spans": 3,
            "span_length": 60.0,
            "contact_wire_height": [5.8, 5.34, 5.3, 5.3],
            "encumbrance": 1.2,
            "presag": 0.0,
        },
    ]
    for changes in ({"stitch_wires": STITCH}, {"contact_wire_spacing": 0.04}, {"tension_length": overlap}):
        assembly = Assembly(scene(**changes))
        weight = assembly.mass.sum() * assembly.gravity
        for wire, hanging in zip(assembly.wires, assembly.hanging):
            for segment, left in zip(hanging.segments, hanging.x):
                points, weights = np.polynomial.legendre.leggauss(8)
                s = 0.5 * segment.l * (points + 1)
                weight += wire.mass * assembly.gravity * 0.5 * segment.l * weights @ np.sqrt(1 + segment.slope(s) ** 2)
        held = sum(assembly.reaction[p] for p in assembly.messenger_supports + assembly.arms + assembly.ends)
        worst = max(worst, abs(held / weight - 1))
    return worst, 1e-9, "supports, arms and ends against the weight, relative"


def moment_balance_about_a_clamp_gives_the_sag_between_the_supports():
    """H times the sag of the messenger wire is the bending moment of a beam with its loads; the stitch wires, which
    pull at the clamps, add their tension to the messenger's over their length. For loads of half a span about the
    support in a row of equal spans: H_m z_m + H_s z_s at the support against H_m z at mid-span."""
    assembly = Assembly(scene(spans=12, stitch_wires=STITCH))
    span, left = 6, 5 * 60.0
    middle = left + 30.0
    messenger = next(i for i, wire in enumerate(assembly.wires) if wire.kind == "messenger")
    stitch = next(
        i
        for i, wire in enumerate(assembly.wires)
        if wire.kind == "stitch" and abs(assembly.x[wire.points[0]] - left + 9.0) < 1e-9
    )
    shape = lambda i, x: float(assembly.hanging[i].height(np.array([x]))[0])
    tension = assembly.wires[messenger].tension
    # cut at the support and at mid-span, where slopes vanish by symmetry: moments of the loads between, about the
    # support
    moment = 0.0
    for i in (messenger, stitch):
        wire, hanging = assembly.wires[i], assembly.hanging[i]
        end = min(middle, hanging.x[-1])
        for a, b in zip(hanging.x[:-1], hanging.x[1:]):
            a, b = max(a, left), min(b, end)
            if b > a:
                points, weights = np.polynomial.legendre.leggauss(12)
                x = a + 0.5 * (b - a) * (points + 1)
                arc = np.sqrt(1 + hanging.slope(x) ** 2)
                moment += wire.mass * assembly.gravity * 0.5 * (b - a) * weights @ (arc * (x - left))
    for dropper in assembly.droppers:
        if left < dropper.x <= middle + 1e-9:
            half = 0.5 if abs(dropper.x - middle) < 1e-9 else 1.0
            moment += half * (dropper.x - left) * (dropper.force + assembly.gravity * assembly.mass[dropper.upper])
    moment += 9.0 * assembly.gravity * STITCH["clamp_mass"]
    inside = (tension - STITCH["tension"]) * shape(messenger, left) + STITCH["tension"] * shape(stitch, left)
    return abs((inside - tension * shape(messenger, middle)) / moment - 1), 1e-4, "span 6 of 12, relative"


def twin_wires_are_one_of_twice_mass_tension_and_stiffness():
    twin = scene(contact_wire_spacing=0.04, wire_ends="fixed")
    single = scene(wire_ends="fixed")
    line = single["catenary"]
    for key in ("mass_per_length", "tension", "axial_stiffness", "bending_stiffness"):
        line["contact_wire"][key] *= 2
    for key in ("stiffness", "mass", "upper_clamp_mass", "lower_clamp_mass"):
        line["droppers"][key] *= 2
    line["registration_arms"]["mass"] *= 2
    single["contact"]["stiffness"] *= 2
    forces = [Coupled(s, 1.0, 1.0).simulate(0.001)["forces"].sum(axis=1) for s in (twin, single)]
    return np.abs(forces[0] - forces[1]).max(), 1e-6, "force over 0.6 s, N"


def two_equal_tension_lengths_share_the_strip_evenly():
    section = {
        key: SCENE["catenary"][key] for key in ("spans", "span_length", "contact_wire_height", "encumbrance", "presag")
    }
    both = Coupled(scene(tension_length=[section, section]), 1.0, 1.0).simulate(0.001)["forces"]
    return np.abs(both[:, 0] - both[:, 1]).max(), 1e-6, "difference of both forces over 0.6 s, N"


def weightless_stitch_wire_without_tension_leaves_the_simple_line():
    plain = Assembly(scene())
    stitched = Assembly(
        scene(stitch_wires={**STITCH, "length": 8.0, "tension": 1e-3, "mass_per_length": 1e-9, "clamp_mass": 0.0})
    )
    pairs = zip(plain.droppers, stitched.droppers)
    return max(abs(a.length - b.length) for a, b in pairs), 1e-6, "dropper lengths, m"


def one_chain(ei, n, length=60.0, sag=0.0):
    """A pinned wire of n elements as a Chain, with the rotations of its hinges merged, and its matrices."""

    class Material:
        mass, ea = 1.35, 1.7e7

    material, x = Material(), np.linspace(0.0, length, n + 1)
    material.ei = ei
    z = -4 * sag * x * (length - x) / length**2
    coordinates = 3 * np.arange(n)[:, None] + np.arange(6)[None, :]
    chain = Chain(material, None, x, z, coordinates, np.full(n, 20000.0))
    size = 3 * (n + 1)
    gather = lambda m: sparse.csr_matrix(
        (m.ravel(), (np.repeat(coordinates, 6, axis=1).ravel(), np.tile(coordinates, (1, 6)).ravel())),
        shape=(size, size),
    ).toarray()
    return chain, [gather(m) for m in chain.matrices()]


def straight_wire_has_the_frequencies_of_a_tensioned_beam():
    length, worst = 60.0, 0.0
    for ei in (195.0, 0.0):
        _, (k, m, _) = one_chain(ei, 40)
        free = np.setdiff1d(np.arange(k.shape[0]), [0, 1, 120, 121])
        values = linalg.eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True, subset_by_index=[0, 2])
        mode = np.arange(1, 4) * np.pi / length
        worst = max(worst, np.abs(values / (mode**2 * (20000.0 + ei * mode**2) / 1.35) - 1).max())
    return worst, 1e-6, "three lowest omega^2, beam and rope, relative"


def sagging_rope_has_the_frequencies_of_irvine():
    """Symmetric mode of a shallow cable, tan(w) = w - 4 w^3/P, w = k L/2, P = (8 f/L)^2 EA L/(T L_e) [Irvine 1974]."""
    length, sag, tension, ea = 60.0, 0.6, 20000.0, 1.7e7
    _, (k, m, _) = one_chain(0.0, 240, sag=sag)
    free = np.setdiff1d(np.arange(k.shape[0]), [0, 1, 720, 721])
    values = linalg.eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True, subset_by_index=[0, 1])
    parameter = (8 * sag / length) ** 2 * ea / (tension * (1 + 8 * (sag / length) ** 2))
    low, high = 0.5 * np.pi + 1e-6, 1.5 * np.pi - 1e-6
    for _ in range(100):
        w = 0.5 * (low + high)
        low, high = (w, high) if np.tan(w) - w + 4 * w**3 / parameter < 0 else (low, w)
    exact = 2 * low / length * np.sqrt(tension / 1.35)
    found = np.sqrt(values)
    return (
        np.abs(found - exact).min() / exact,
        1e-3,
        f"symmetric mode {exact / (2 * np.pi):.4f} Hz, parameter {parameter:.2f}, relative",
    )


def height_at_a_place_is_that_of_the_moved_curve():
    """The wire moved by large u: height of the curve at x against the row of the contact about u, and the
    change of height under a further small displacement against the row's coefficients."""
    line = FrameLine(Assembly(scene(contact_wire_height=[5.3, 5.5, 5.7, 5.5, 5.3])), 0.5, 0.5)
    chain, x, rng, worst = line.contact_chains()[0], 101.37, np.random.default_rng(5), 0.0

    def height(u):
        e = np.arange(200, 212)
        xi = np.linspace(0, 1, 4001)[None, :]
        c, s, l, q = chain.c[e, None], chain.s[e, None], chain.l[e, None], u[chain.coordinates[e]][:, :, None]
        a = (1 - xi) * (c * q[:, 0] + s * q[:, 1]) + xi * (c * q[:, 3] + s * q[:, 4])
        across = np.concatenate(
            [
                (c * q[:, 1] - s * q[:, 0])[:, None],
                q[:, 2][:, None],
                (c * q[:, 4] - s * q[:, 3])[:, None],
                q[:, 5][:, None],
            ],
            axis=1,
        )
        t = np.einsum("xj,ejn->ex", cubic(xi[0], 1.0)[:, [0, 2]], across[:, [0, 2]])
        t += np.einsum("xj,ejn->ex", cubic(xi[0], 1.0)[:, [1, 3]], across[:, [1, 3]]) * l
        at = chain.x[e, None] + xi * c * l
        px, pz = at + c * a - s * t, chain.hanging.height(at) + s * a + c * t
        return np.interp(x, px.ravel(), pz.ravel())

    u = np.zeros(line.size)
    for e in range(198, 214):
        u[chain.coordinates[e]] = np.tile([0.05, 0.02, 0.0], 2) + 1e-3 * rng.standard_normal(6)
    small = np.zeros(line.size)
    small[chain.coordinates[198:214].ravel()] = 1e-5 * rng.standard_normal(16 * 6)
    for about in (np.zeros(line.size), u):
        at, row, z = chain.row(x, about)
        numeric = 0.5 * (height(about + small) - height(about - small))
        worst = max(worst, abs(height(about) - z) * 1e2, abs(numeric - row @ small[at]) / 1e-5)
    return worst, 1e-3, "height in cm, its change relative to the displacements"


def stiffness_is_symmetric_and_moves_freely_along_the_track():
    line = FrameLine(Assembly(scene(stitch_wires=STITCH)), 1.0, 1.0)
    asymmetry = abs(line.stiffness - line.stiffness.T).max() / abs(line.stiffness).max()
    coupled = Coupled(scene(), 1.0, 1.0)
    slid = np.zeros(coupled.line.size)
    for chain in coupled.line.chains:
        slid[chain.coordinates[:, [0, 3]]] = 1.0
    force = coupled.line.stiffness @ slid
    springs = 2 * len(coupled.line.chains) * 10.0  # both ends of each wire
    return (
        max(asymmetry, abs(force.sum() - springs) / springs),
        1e-6,
        "asymmetry; springs of the ends under a shift, relative",
    )


def one_way_parts_fulfil_the_complementarity():
    rng, worst = np.random.default_rng(4), 0.0
    for _ in range(100):
        a = rng.standard_normal((9, 9))
        matrix, offset = a @ a.T + 0.1 * np.eye(9), rng.standard_normal(9)
        lam, _ = complementary(offset, matrix, rng.random(9) < 0.5)
        w = offset + matrix @ lam
        worst = max(worst, -lam.min(), -w.min(), np.abs(lam * w).max())
    return worst, 1e-9, "random cases"


def standing_pantograph_stays_in_balance():
    standing = scene(stitch_wires=STITCH)
    standing["run"]["speed_kmh"] = 0.0
    force = Coupled(standing, 1.0, 1.0).simulate(0.001)["forces"].sum(axis=1)
    return np.abs(force - force[0]).max(), 1e-5, "change of force in 0.6 s at rest, N"


def moving_force_lifts_a_wire_as_in_closed_form():
    """A force P that enters a straight wire: the rise below is P v t/(T (1 + v/c)) less the rounding of the kink."""
    length, n, v, h, force = 60.0, 600, 60.0, 2.5e-4, 100.0
    chain, (k, m, _) = one_chain(1.0, n)
    size = k.shape[0]
    keep = np.ones(size)
    keep[[0, 1, size - 3, size - 2]] = 0.0
    k, m = (sparse.csr_matrix(keep[:, None] * x * keep[None, :]) for x in (k, m))
    factor = Factor(m + h**2 / 4 * k + sparse.diags(1 - keep))
    chain.hanging = type("Flat", (), {"height": staticmethod(lambda x: 0.0)})
    u, du, ddu = np.zeros(size), np.zeros(size), np.zeros(size)
    for step in range(1, 2401):
        x = v * step * h
        at, row, _ = chain.row(x)
        up, dp = u + h * du + h**2 / 4 * ddu, du + h / 2 * ddu
        rhs = -(k @ up)
        rhs[at] += force * row
        ddu = factor.solve(rhs * keep)
        u, du = up + h**2 / 4 * ddu, dp + h / 2 * ddu
    moving = 20000.0 - 1.35 * v**2
    exact = force * x / (20000.0 * (1 + v / np.sqrt(20000.0 / 1.35))) - force * np.sqrt(1.0 / moving) / (2 * moving)
    return abs(row @ u[at] / exact - 1), 5e-3, f"{exact * 1e3:.3f} mm at x = {x:.1f} m, relative"


CHECKS = (
    rope_hangs_as_a_catenary,
    rope_with_a_load_has_the_moment_of_the_load_over_its_tension,
    pinned_tensioned_beam_sags_by_the_closed_form,
    continuous_beam_over_supports_carries_equal_spans_alike,
    assembly_carries_its_weight,
    moment_balance_about_a_clamp_gives_the_sag_between_the_supports,
    twin_wires_are_one_of_twice_mass_tension_and_stiffness,
    two_equal_tension_lengths_share_the_strip_evenly,
    weightless_stitch_wire_without_tension_leaves_the_simple_line,
    straight_wire_has_the_frequencies_of_a_tensioned_beam,
    sagging_rope_has_the_frequencies_of_irvine,
    height_at_a_place_is_that_of_the_moved_curve,
    stiffness_is_symmetric_and_moves_freely_along_the_track,
    one_way_parts_fulfil_the_complementarity,
    standing_pantograph_stays_in_balance,
    moving_force_lifts_a_wire_as_in_closed_form,
)


def run():
    """Runs all checks; returns the number of failures."""
    failures = 0
    for check in CHECKS:
        error, limit, what = check()
        good = bool(error <= limit)
        failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {check.__name__}: {error:.2e} <= {limit:.0e} ({what})")
    return failures
