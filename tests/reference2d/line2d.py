"""Two-dimensional reference computation of an overhead line under one lumped pantograph.

An independent check of the simulation code of this repository, with only the scene file in common.

    python line2d.py SCENE.toml --model flat|sagging [--elements-per-interval 16] [--step 0.00025]
                     [--statics-only] [--json statics.json] [--out force.csv] [--reference force_1ms.csv]
    python line2d.py --self-test

Units: SI. x along the track, z up. A wire is a chain of C1 cubic Hermite elements; the nodes of contact and
messenger wire lie at the same x, equally spaced between neighbouring droppers or supports.

**Model `sagging`**: four coordinates per node (x, x', z, z'; the prime is d/ds, s the arc length at nominal tension).
Strain energy of an element of parameter length l, unstressed length l/lam, EA (lam^2 - 1)/2 lam = T:

    U = 1/2 EA E^2 l/lam + 1/2 EI int |r''|^2 ds,     E = 1/2 (lam^2 I - 1),     I = 1/l int |r'|^2 ds

(element mean of the Green-Lagrange strain). mass_per_length, weight and EI refer to s. Statics: each wire carries the
horizontal force T; the contact wire is held at its nominal height (less a presag parabola) at droppers and supports;
the reactions of the droppers hang on the messenger wire, which is held at the supports. Element lengths are corrected
until every node has its nominal x. Dynamics is *linear about that state*: K is the exact second derivative of U there,
axial coordinates included, plus taut droppers (k d d^T, static direction, which is vertical), messenger supports and
registration arms. Static reactions of arms and supports remain as dead forces.

Contact: strip at x_s, material point s of the wire with static x0(s) = x_s. First order in u:

    z_w(x_s) = z0 + N u_z - (z0'/x0') N u_x = z0 + b.u        (the wire's own x motion shifts the material point)

and the contact force, normal to the static wire, acts as load b F: F is its vertical part, the horizontal part is
-F z0'/x0', so that kinematics and load are work-conjugate. Products of displacements are dropped (F times rotation of
the wire, u_x times u_z').

**Model `flat`**: the same without sag: (w, w') per node, energy 1/2 int T w'^2 + EI w''^2 dx, static heights and
dropper forces from the same flat wires. The static shape between droppers is part of the contact height in both.

Both: dropper force max(0, F0 + k delta + c delta_rate); support 1 and the last one hold both wires in z; wire ends
`constant_tension`: x of both ends free; `fixed`: x held. Damping of wires: alpha M + beta (T K1 + EI K2),
K1 = int N'^T N', K2 = int N''^T N'', on each component. Pantograph: masses in a chain, head first; the last spring
goes to the base and is unstretched at the static height of the wire over start_x; static force on the last mass; no weight. Contact: penalty,
unilateral. Time: Newmark trapezoid, or generalized-alpha (Chung and Hulbert) with --rho-inf. Each step solves
the complementarity of contact and droppers exactly (active set on top of one constant Cholesky factor). Start at
rest in balance with the pantograph; for that solution only the x of both wires is held at the left end.
"""

import argparse
import json
import sys
import time
import tomllib

import numpy as np
from scipy import signal

from planar_line import CONTACT, BandFactor, Line, active_set, held


class Pantograph:
    """Chain of masses, head first; the last spring and damper go to the base."""

    def __init__(self, table):
        masses, k, c = (np.array(table[key], float) for key in ("masses", "stiffnesses", "dampings"))
        n = masses.size
        chain = np.eye(n) - np.eye(n, k=1)  # y_i - y_(i+1); the last row: y_n
        self.mass, self.stiffness, self.damping = np.diag(masses), chain.T @ np.diag(k) @ chain, chain.T @ np.diag(c) @ chain
        self.load = np.zeros(n)
        self.load[-1] = table["static_force"]  # heights are counted from the reference height


def simulate(line, step, rho_inf=None, duration=None, progress=False):
    """Runs the scene; returns time, strip position, contact force (raw) and largest uplift per support."""
    scene = line.scene
    run, contact = scene["run"], scene["contact"]
    if contact["law"] != "penalty" or contact["damping"] != 0.0 or len(scene["pantograph"]) != 1:
        raise SystemExit("this model knows one pantograph and penalty contact without damping")
    pan, k_contact = Pantograph(scene["pantograph"][0]), contact["stiffness"]
    if rho_inf is None:  # trapezoid
        alpha_m, alpha_f = 0.0, 0.0
    else:
        alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma = 0.5 - alpha_m + alpha_f
    beta = 0.25 * (0.5 + gamma) ** 2
    h, now = step, 1 - alpha_f
    steps = round((duration or run["duration"]) / h)
    times = np.arange(steps + 1) * h
    xs = run["start_x"] + scene["pantograph"][0]["offset_x"] + run["speed_kmh"] / 3.6 * times
    index, rows, z0 = line.contact_rows(xs)
    z0 = z0 - z0[0]

    # start: both sides at rest in balance
    b = np.zeros(line.size)
    b[index[0]] = rows[0]
    b[line.fixed] = 0.0
    column = line.static_factor.solve(b)
    push = line.elongation @ column
    head = np.linalg.solve(pan.stiffness, np.eye(pan.load.size)[0])
    strip = np.linalg.solve(pan.stiffness, pan.load)
    slack = np.zeros(line.dropper_force.size, bool)
    force, slack, r, closed = active_set(
        line.dropper_force, line.k_drop * push, line.k_drop * line.static_compliance, slack,
        (k_contact, strip[0], head[0] + rows[0] @ column[index[0]], push, True))
    u = column * force - line.static_columns[:, slack] @ r
    y = strip - head * force
    v, a, yv, ya = np.zeros_like(u), np.zeros_like(u), np.zeros_like(y), np.zeros_like(y)
    forces = np.empty(steps + 1)
    forces[0] = force
    outer = b * force
    if slack.any():
        outer -= line.elongation.T[:, slack] @ r
    strip_outer = pan.load - np.eye(y.size)[0] * force

    matrix = (1 - alpha_m) * line.mass + now * (gamma * h * line.damping + beta * h**2 * line.stiffness)
    factor = BandFactor(held(matrix, line.fixed, 1.0))
    columns = factor.solve(line.elongation.T.toarray())
    columns[line.fixed] = 0.0
    compliance = line.elongation @ columns
    law_gain = now * (line.k_drop * beta * h**2 + line.c_drop * gamma * h)
    self_effect = law_gain * compliance
    strip_matrix = (1 - alpha_m) * pan.mass + now * (gamma * h * pan.damping + beta * h**2 * pan.stiffness)
    strip_column = np.linalg.solve(strip_matrix, np.eye(y.size)[0])
    height_gain = now * beta * h**2

    uplift_dof = line.dof(CONTACT, line.support_node, "z")
    uplift0, uplift = u[uplift_dof].copy(), np.zeros(uplift_dof.size)
    most_slack = 0
    free = np.ones(line.size)
    free[line.fixed] = 0.0
    rhs = np.empty((line.size, 2), order="F")
    begun = time.perf_counter()
    for n in range(1, steps + 1):
        up, vp = u + h * v + (0.5 - beta) * h**2 * a, v + (1 - gamma) * h * a
        yp, yvp = y + h * yv + (0.5 - beta) * h**2 * ya, yv + (1 - gamma) * h * ya
        right = -(line.damping @ (now * vp + alpha_f * v)) - line.stiffness @ (now * up + alpha_f * u)
        strip_right = -pan.damping @ (now * yvp + alpha_f * yv) - pan.stiffness @ (now * yp + alpha_f * y) + now * pan.load
        if rho_inf is not None:
            right += alpha_f * outer - alpha_m * (line.mass @ a)
            strip_right += alpha_f * strip_outer - alpha_m * pan.mass @ ya
        rhs[:, 0], rhs[:, 1] = right * free, 0.0
        rhs[index[n], 1] = rows[n]
        rhs[:, 1] *= free
        both = factor.solve(rhs)
        a_free, column = both[:, 0], both[:, 1]
        ya_free = np.linalg.solve(strip_matrix, strip_right)

        # forces at the end of the step
        stretch = line.elongation @ (up + beta * h**2 * a_free)
        law = line.dropper_force + line.k_drop * stretch
        if line.c_drop:
            law += line.c_drop * (line.elongation @ (vp + gamma * h * a_free))
        push = column[line.high] - column[line.low]
        wire = z0[n] + rows[n] @ (up[index[n]] + beta * h**2 * a_free[index[n]])
        penetration = yp[0] + beta * h**2 * ya_free[0] - wire
        force, slack, r, closed = active_set(
            law, law_gain * push, self_effect, slack,
            (k_contact, penetration, height_gain * (strip_column[0] + rows[n] @ column[index[n]]), height_gain * push, closed))
        a = a_free + now * force * column
        ya = ya_free - now * force * strip_column
        if slack.any():
            a -= now * (columns[:, slack] @ r)
            most_slack = max(most_slack, int(slack.sum()))
        u, v = up + beta * h**2 * a, vp + gamma * h * a
        y, yv = yp + beta * h**2 * ya, yvp + gamma * h * ya
        if rho_inf is not None:
            outer = np.zeros(line.size)
            outer[index[n]] = rows[n] * force
            if slack.any():
                outer -= line.elongation.T[:, slack] @ r
            outer *= free
            strip_outer = pan.load - np.eye(y.size)[0] * force
        forces[n] = force
        np.maximum(uplift, u[uplift_dof] - uplift0, out=uplift)
        if progress and n % 2000 == 0:
            print(f"\r{times[n]:.2f} s, {time.perf_counter() - begun:.0f} s of computing", end="", file=sys.stderr)
    if progress:
        print(file=sys.stderr)
    return {"time": times, "x": xs, "force": forces, "uplift": uplift, "most_slack_droppers": most_slack,
            "wall_s": time.perf_counter() - begun}


def low_pass(force, step, frequency):
    """Butterworth of order 4 per pass, forward and backward, odd padding."""
    sos = signal.butter(4, frequency, fs=1 / step, output="sos")
    return signal.sosfiltfilt(sos, force, padtype="odd", padlen=min(force.size - 1, round(0.5 / step)))


def statistics(line, result, step):
    """Figures of the evaluation range: raw and filtered."""
    low, high = line.evaluated()
    x0, x1 = (low - 1) * line.span, high * line.span
    result["filtered"] = low_pass(result["force"], step, line.scene["run"]["low_pass_hz"])
    inside = (result["x"] >= x0 - 1e-9) & (result["x"] <= x1 + 1e-9)
    out = {}
    for key, series in (("filtered", result["filtered"]), ("raw", result["force"])):
        f = series[inside]
        mean, std = float(f.mean()), float(f.std())
        out[key] = {"mean": mean, "std": std, "max": float(f.max()), "min": float(f.min()),
                    "statistical_max": mean + 3 * std, "statistical_min": mean - 3 * std}
    out["loss_of_contact_percent"] = 100.0 * float(np.mean(result["force"][inside] <= 0))
    bounding = slice(low - 1, high + 1)
    out["uplift_m"] = {f"{x:g}": float(w) for x, w in zip(line.x[line.support_node[bounding]], result["uplift"][bounding])}
    out["max_uplift_m"] = float(result["uplift"][bounding].max())
    out["start_force_N"] = float(result["force"][0])
    out["most_slack_droppers"] = result["most_slack_droppers"]
    return out, inside


def write_reference(path, result, step, inside):
    """1 ms grid over the evaluation range: x_m, force_filtered_N, force_raw_N."""
    stride = round(0.001 / step)
    if stride < 1 or abs(stride * step - 0.001) > 1e-12:
        raise SystemExit("--reference needs a step that divides 1 ms")
    pick = np.flatnonzero(inside)
    pick = pick[pick % stride == 0]
    with open(path, "w", encoding="utf-8") as file:
        file.write("x_m,force_filtered_N,force_raw_N\n")
        for i in pick:
            file.write(f"{result['x'][i]:.6f},{result['filtered'][i]:.5f},{result['force'][i]:.5f}\n")


def main():
    parser = argparse.ArgumentParser(description="two-dimensional reference computation of an overhead line")
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--model", choices=("flat", "sagging"), default="sagging")
    parser.add_argument("--elements-per-interval", type=int, default=16)
    parser.add_argument("--step", type=float, default=0.00025, help="s")
    parser.add_argument("--rho-inf", type=float, help="generalized-alpha instead of the trapezoid")
    parser.add_argument("--wire-ends", choices=("fixed", "constant_tension"), help="instead of the scene's")
    parser.add_argument("--speed-kmh", type=float, help="instead of the scene's")
    parser.add_argument("--anchor", action="store_true", help="constant tension at the right end only, x held at the left")
    parser.add_argument("--dropper-rotation", action="store_true", help="add F0/l of the droppers across their direction")
    parser.add_argument("--statics-only", action="store_true")
    parser.add_argument("--out", help="CSV time, x, force of every step")
    parser.add_argument("--reference", help="CSV x_m, force_filtered_N, force_raw_N on 1 ms over the evaluated spans")
    parser.add_argument("--json", help="statics")
    parser.add_argument("--summary", help="statistics as JSON (stdout has them anyway)")
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--progress", action="store_true")
    args = parser.parse_args()
    if args.self_test:
        import self_test
        raise SystemExit(self_test.run())
    if not args.scene:
        parser.error("a scene is needed")
    with open(args.scene, "rb") as file:
        scene = tomllib.load(file)
    if args.speed_kmh:
        scene["run"]["speed_kmh"] = args.speed_kmh
    line = Line(scene, args.model, args.elements_per_interval, args.wire_ends, args.dropper_rotation, args.anchor)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(line.statics_report(), file, indent=1)
            file.write("\n")
    if args.statics_only:
        if not args.json:
            json.dump(line.statics_report(), sys.stdout, indent=1)
            print()
        return
    result = simulate(line, args.step, args.rho_inf, progress=args.progress)
    figures, inside = statistics(line, result, args.step)
    figures = {"scene": scene["title"], "model": args.model, "wire_ends": line.ends, "speed_kmh": scene["run"]["speed_kmh"],
               "elements_per_interval": args.elements_per_interval, "step_s": args.step, "rho_inf": args.rho_inf, **figures}
    if args.out:
        table = np.column_stack([result["time"], result["x"], result["force"]])
        np.savetxt(args.out, table, delimiter=",", header="time,x,force", comments="", fmt=("%.6f", "%.6f", "%.6f"))
    if args.reference:
        write_reference(args.reference, result, args.step, inside)
    if args.summary:
        with open(args.summary, "w", encoding="utf-8") as file:
            json.dump(figures, file, indent=1)
            file.write("\n")
    print(json.dumps(figures, indent=1))
    print(f"time loop {result['wall_s']:.1f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
