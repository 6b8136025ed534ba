"""Lines of any number of wires in the vertical plane under one lumped pantograph; an independent check of this program.

    python wires2d.py SCENE.toml [--contact-element 0.15] [--upper-element 0.4] [--step 0.00025]
                      [--statics statics.json] [--reference force.csv] [--summary summary.json] [--statics-only]
    python wires2d.py --self-test

assembly.py says what is read from the scene, hanging.py finds the static shape in closed form, frame_line.py has the
elements of the motion. The pantograph's masses are coordinates of the same system: head first, a spring and a damper
under each, the last one to the base, unstretched where the head is at the static height of the lowest contact wire over
start_x; the static force acts on the last mass, no weight.

One-way parts: contact i between strip and wire i has gap g_i and force F_i >= 0 with F_i/k + g_i >= 0, one of both
zero;
dropper j pulls with f_j + r_j, f_j = F0 + k e + c e', r_j >= 0 what a slack dropper takes back, one of both zero. The
trapezoidal rule makes each step a linear complementarity problem in (F, r) of the contacts and droppers, solved by
changes of the set of positive ones. All contact wires over which the strip is have a contact.
"""

import argparse
import json
import sys
import time
import tomllib

import numpy as np
from scipy import sparse

from assembly import Assembly
from frame_line import Factor, FrameLine
from line2d import low_pass

REACH = 0.1  # m, gap beyond which a contact is left out of a step


def complementary(offset, matrix, guess):
    """lam >= 0, w = offset + matrix lam >= 0, lam w = 0; from the set of positive ones `guess`. Returns lam, set."""
    active = guess.copy()
    for _ in range(100):
        lam = np.zeros(offset.size)
        if active.any():
            lam[active] = np.linalg.solve(matrix[np.ix_(active, active)], -offset[active])
        w = offset + matrix @ lam
        wrong = np.where(active, lam < 0, w < 0)
        if not wrong.any():
            return lam, active
        active = active ^ wrong
    # the sets may cycle: change one index at a time (Murty), which ends for a P-matrix
    for _ in range(10000):
        lam = np.zeros(offset.size)
        if active.any():
            lam[active] = np.linalg.solve(matrix[np.ix_(active, active)], -offset[active])
        w = offset + matrix @ lam
        wrong = np.flatnonzero(np.where(active, lam < 0, w < 0))
        if not wrong.size:
            return lam, active
        active[wrong[-1]] ^= True
    raise RuntimeError("contacts and droppers do not settle")


class Coupled:
    """Line and pantograph as one linear system with one-way parts."""

    def __init__(self, scene, contact_element, upper_element):
        self.scene = scene
        run, contact, pantograph = scene["run"], scene["contact"], scene["pantograph"][0]
        if contact["law"] != "penalty" or contact["damping"] != 0.0 or len(scene["pantograph"]) != 1:
            raise SystemExit("this model knows one pantograph and penalty contact without damping")
        self.line = FrameLine(Assembly(scene), contact_element, upper_element)
        self.contact_stiffness, self.speed = contact["stiffness"], run["speed_kmh"] / 3.6
        self.start_x = run["start_x"] + pantograph.get("offset_x", 0.0)
        masses, springs, dampers = (np.array(pantograph[key], float) for key in ("masses", "stiffnesses", "dampings"))
        count = masses.size
        chain = np.eye(count) - np.eye(count, k=1)
        self.head, self.size = self.line.size, self.line.size + count
        join = lambda of_line, own: sparse.block_diag([of_line, own]).tocsr()
        self.stiffness = join(self.line.stiffness, chain.T @ np.diag(springs) @ chain)
        self.damping = join(self.line.damping, chain.T @ np.diag(dampers) @ chain)
        self.mass = join(self.line.mass, np.diag(masses))
        self.load = np.zeros(self.size)
        self.load[-1] = pantograph["static_force"]
        self.elongation = sparse.hstack(
            [self.line.elongation, sparse.csr_matrix((self.line.elongation.shape[0], count))]
        ).tocsr()
        self.identity = np.zeros(self.size)
        self.identity[self.line.fixed] = 1.0
        self.reference = min(height for _, _, _, height in self.rows(self.start_x))

    def rows(self, x, u=None):
        """Of each contact wire over x its number, coordinates (7) and coefficients (7) of its gap, height, about the
        displacements u (0: None)."""
        out = []
        for number, chain in enumerate(self.line.contact_chains()):
            if chain.x[0] < x < chain.x[-1]:
                at, values, height = chain.row(x, u)
                out.append((number, np.append(at, self.head), np.append(values * self.line.keep[at], -1.0), height))
        return out

    def factor(self, matrix):
        return Factor(matrix + sparse.diags(self.identity * 1e5))

    def under_force(self, x, force, factor):
        """Rise at x, m, of the contact wires of the tension length that is lowest there (the first of equal ones) under
        a static vertical force that they share. Other tension lengths are not touched."""
        rows, section = self.rows(x), lambda number: self.line.contact_chains()[number].wire.section
        lowest = min(height for _, _, _, height in rows)
        chosen = next(section(number) for number, _, _, height in rows if height < lowest + 1e-9)
        rows = [(at[:-1], values[:-1]) for number, at, values, _ in rows if section(number) == chosen]
        share = np.zeros(self.size)
        for at, values in rows:
            share[at] += values / len(rows)
        u = factor.solve(share * force)
        columns = factor.solve(np.asfortranarray(self.elongation.T.toarray()))
        law = self.line.dropper_force / self.line.dropper_stiffness + self.elongation @ u
        effect = np.eye(law.size) / self.line.dropper_stiffness - self.elongation @ columns
        r, _ = complementary(law, effect, law < 0)
        return float(share @ (u - columns @ r))

    def elasticity(self, span):
        """(x, m/N) at supports, droppers and quarter points of a span between neighbouring supports, under 100 N."""
        supports = sorted({float(x) for _, section in self.line.assembly.support_reports for x, _ in section})
        left, right = supports[span - 1], supports[span]
        points = {round(d.x, 9) for d in self.line.assembly.droppers if left < d.x < right}
        points |= {round(left + (right - left) * part, 9) for part in (0.0, 0.25, 0.5, 0.75, 1.0)}
        factor = self.factor(self.stiffness)
        return [{"x": x, "m_per_N": self.under_force(x, 100.0, factor) / 100.0} for x in sorted(points)]

    def one_way(self, u, v, columns, effect, factor, gain, rate, x, guess, about):
        """Contact forces per wire, answer of `factor` to them and to the droppers' terms, set of positive ones.

        u, v: state without them; `columns`, `effect`: answer of `factor` to the droppers; displacement gain * answer,
        velocity rate * answer; `about`: displacements about which contact is linear, None for the static state.
        """
        line = self.line
        k, c = line.dropper_stiffness, line.dropper_damping
        elongation = self.elongation @ u
        law = (line.dropper_force + k * elongation + (c * (self.elongation @ v) if c else 0.0)) / k
        rows, numbers = [], []
        for number, at, values, height in self.rows(x, about):
            gap = height - self.reference + values @ u[at] - (0.0 if about is None else values[:-1] @ about[at[:-1]])
            if gap < REACH:
                rows.append((at, values, gap))
                numbers.append(number)
        n, total = len(rows), len(rows) + law.size
        lift = gain + rate * c / k
        push = np.zeros((self.size, n), order="F")
        for i, (at, values, _) in enumerate(rows):
            push[at, i] = values
        if n:
            push = factor.solve(push)
        offset = np.concatenate([[gap for _, _, gap in rows], law])
        matrix = np.zeros((total, total))
        for i, (at, values, _) in enumerate(rows):
            matrix[i, :n] = gain * (values @ push[at])
            matrix[i, i] += 1.0 / self.contact_stiffness
            matrix[i, n:] = -gain * (values @ columns[at])
        matrix[n:, :n] = lift * (self.elongation @ push)
        matrix[n:, n:] = np.eye(law.size) / k - lift * effect
        positive = np.concatenate(
            [[guess[0].get(number, offset[i] < 0) for i, number in enumerate(numbers)], guess[1]]
        ).astype(bool)
        lam, active = complementary(offset, matrix, positive)
        answer = push @ lam[:n]
        slack = active[n:]
        if slack.any():
            answer -= columns[:, slack] @ lam[n:][slack]
        forces = dict(zip(numbers, lam[:n]))
        return forces, answer, (dict(zip(numbers, active[:n])), slack)

    def simulate(self, h, progress=False, moved=True):
        """Runs the scene with the trapezoidal rule; returns time, x, force per contact wire (steps, wires).

        `moved`: contact on the moved wires; else to first order about the static state.
        """
        steps = round(self.scene["run"]["duration"] / h)
        times = np.arange(steps + 1) * h
        xs = self.start_x + self.speed * times
        forces = np.zeros((steps + 1, len(self.line.contact_chains())))
        across = np.asfortranarray(self.elongation.T.toarray())
        guess = ({}, np.zeros(self.elongation.shape[0], bool))

        rest = self.factor(self.stiffness)
        columns = rest.solve(across)
        free = rest.solve(self.load)
        u, v, a = np.zeros(self.size), np.zeros(self.size), np.zeros(self.size)
        for _ in range(30):
            before = u
            found, answer, guess = self.one_way(
                free, v, columns, self.elongation @ columns, rest, 1.0, 0.0, xs[0], guess, u if moved else None
            )
            u = free + answer
            if np.abs(u - before).max() < 1e-10:
                break
        for number, force in found.items():
            forces[0, number] = force

        factor = self.factor(self.mass + h / 2 * self.damping + h**2 / 4 * self.stiffness)
        columns = factor.solve(across)
        effect = self.elongation @ columns
        begun, most_slack = time.perf_counter(), 0
        for n in range(1, steps + 1):
            up, vp = u + h * v + h**2 / 4 * a, v + h / 2 * a
            a_free = factor.solve(self.load - self.damping @ vp - self.stiffness @ up)
            ahead = up + h**2 / 4 * a_free
            found, answer, guess = self.one_way(
                ahead,
                vp + h / 2 * a_free,
                columns,
                effect,
                factor,
                h**2 / 4,
                h / 2,
                xs[n],
                guess,
                ahead if moved else None,
            )
            a = a_free + answer
            u, v = up + h**2 / 4 * a, vp + h / 2 * a
            for number, force in found.items():
                forces[n, number] = force
            most_slack = max(most_slack, int(guess[1].sum()))
            if progress and n % 1000 == 0:
                print(f"\r{times[n]:.2f} s, {time.perf_counter() - begun:.0f} s of computing", end="", file=sys.stderr)
        if progress:
            print(file=sys.stderr)
        return {
            "time": times,
            "x": xs,
            "forces": forces,
            "most_slack": most_slack,
            "wall_s": time.perf_counter() - begun,
        }


def statics_report(coupled, span):
    """Statics as in `master check --json` for equal names; dropper lengths between the wires, stressed."""
    assembly = coupled.line.assembly
    droppers = [
        {
            "tension_length": d.section + 1,
            "span": d.span,
            "x": float(d.x),
            "stressed_length_m": float(d.length),
            "force_N": float(d.force),
        }
        for d in sorted(assembly.droppers, key=lambda d: (d.section, d.x))
    ]
    supports = [
        {"tension_length": number + 1, "x": float(x), "messenger_reaction_N": float(assembly.reaction[p])}
        for number, section in assembly.support_reports
        for x, p in section
    ]
    clamps = [
        {"x": float(assembly.x[p]), "z_m": float(assembly.z[p])}
        for wire in assembly.wires
        if wire.kind == "stitch"
        for p in (wire.points[0], wire.points[-1])
    ]
    return {"droppers": droppers, "supports": supports, "clamps": clamps, "elasticity": coupled.elasticity(span)}


def evaluated(scene, coupled):
    """First and last x of the evaluated spans between neighbouring supports."""
    supports = sorted({float(x) for _, section in coupled.line.assembly.support_reports for x, _ in section})
    first, last = scene["run"]["evaluate"]["spans"]
    return supports[first - 1], supports[last]


def main():
    parser = argparse.ArgumentParser(description="independent computation of lines of many wires in the vertical plane")
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--contact-element", type=float, default=0.15, help="longest element of the contact wires, m")
    parser.add_argument("--upper-element", type=float, default=0.4, help="longest element of the other wires, m")
    parser.add_argument("--step", type=float, default=0.00025, help="s")
    parser.add_argument("--span", type=int, default=4, help="span of the elasticity")
    parser.add_argument("--statics", help="JSON of the statics")
    parser.add_argument("--statics-only", action="store_true")
    parser.add_argument("--reference", help="CSV of the filtered force every 2 ms over the evaluated spans")
    parser.add_argument("--summary", help="JSON of the statistics")
    parser.add_argument("--contact-at-rest", action="store_true", help="contact to first order about the static state")
    parser.add_argument("--progress", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    args = parser.parse_args()
    if args.self_test:
        import self_test_wires

        raise SystemExit(self_test_wires.run())
    if not args.scene:
        parser.error("a scene is needed")
    with open(args.scene, "rb") as file:
        scene = tomllib.load(file)
    coupled = Coupled(scene, args.contact_element, args.upper_element)
    if args.statics:
        with open(args.statics, "w", encoding="utf-8") as file:
            json.dump(statics_report(coupled, args.span), file, indent=1)
            file.write("\n")
    if args.statics_only:
        return
    result = coupled.simulate(args.step, args.progress, not args.contact_at_rest)
    low, high = evaluated(scene, coupled)
    inside = np.flatnonzero((result["x"] >= low - 1e-9) & (result["x"] <= high + 1e-9))
    raw = result["forces"].sum(axis=1)
    total = low_pass(raw, args.step, scene["run"]["low_pass_hz"])
    figures = {
        "scene": scene["title"],
        "contact_element_m": args.contact_element,
        "upper_element_m": args.upper_element,
        "step_s": args.step,
        "coordinates": coupled.size,
        "mean_N": float(total[inside].mean()),
        "std_N": float(total[inside].std()),
        "max_N": float(total[inside].max()),
        "min_N": float(total[inside].min()),
        "raw_std_N": float(raw[inside].std()),
        "start_force_N": float(raw[0]),
        "most_slack_droppers": result["most_slack"],
        "open_percent": 100.0 * float(np.mean(raw[inside] <= 0)),
    }
    if args.reference:
        pick = inside[inside % round(0.002 / args.step) == 0]
        table = np.column_stack([result["x"][pick], total[pick], raw[pick]])
        np.savetxt(
            args.reference,
            table,
            delimiter=",",
            fmt=("%.6f", "%.4f", "%.4f"),
            comments="",
            header="x_m,force_filtered_N,force_raw_N",
        )
    if args.summary:
        with open(args.summary, "w", encoding="utf-8") as file:
            json.dump(figures, file, indent=1)
            file.write("\n")
    print(json.dumps(figures, indent=1))
    print(f"time loop {result['wall_s']:.1f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
