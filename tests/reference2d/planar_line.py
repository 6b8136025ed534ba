"""Mesh, statics and constant matrices of the overhead line in the vertical plane; for the model see line2d.py."""

import numpy as np
from scipy import linalg, sparse

CONTACT, MESSENGER = 0, 1
GAUSS = np.polynomial.legendre.leggauss(4)  # exact to degree 7: mass of cubics


# ---------------------------------------------------------------------------------------------- Hermite element

def hermite(xi, length, order=0):
    """The four cubic Hermite functions (or derivatives in s) at xi in [0, 1]; shape (..., 4)."""
    xi, length = np.broadcast_arrays(np.asarray(xi, float), np.asarray(length, float))
    one = np.ones_like(xi)
    if order == 0:
        rows = (1 - 3 * xi**2 + 2 * xi**3, length * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, length * (xi**3 - xi**2))
    elif order == 1:
        rows = (6 * (xi**2 - xi) / length, 1 - 4 * xi + 3 * xi**2, 6 * (xi - xi**2) / length, 3 * xi**2 - 2 * xi)
    else:
        rows = ((12 * xi - 6) / length**2, (6 * xi - 4) / length, (6 - 12 * xi) / length**2, (6 * xi - 2) / length)
    return np.stack([r * one for r in rows], axis=-1)


def gram(lengths, order):
    """Element matrices int N_k^T N_k ds of the k-th derivative; shape (elements, 4, 4)."""
    total = 0.0
    for node, weight in zip(*GAUSS):
        n = hermite(0.5 * (node + 1), lengths, order)
        total = total + 0.5 * weight * lengths[:, None, None] * n[:, :, None] * n[:, None, :]
    return total


def stretch(ea, tension):
    """lam under a tension, N: EA (lam^2 - 1)/2 lam = T."""
    strain = tension / ea
    lam = 1.0 + strain
    for _ in range(50):  # Newton's method
        lam = lam - (0.5 * (lam**3 - lam) - strain) / (1.5 * lam**2 - 0.5)
    return lam


class Wire:
    """Material of a wire; `stretch` is lam of the module docstring."""

    def __init__(self, table):
        self.m, self.tension = table["mass_per_length"], table["tension"]
        self.ea, self.ei = table["axial_stiffness"], table["bending_stiffness"]
        self.stretch = stretch(self.ea, self.tension)

    def elements(self, lengths, cx, cz):
        """Energy, gradient (e, 2, 4) and Hessian (e, 2, 4, 2, 4) of the elements; cx, cz: (e, 4)."""
        lam, a, b = self.stretch, gram(lengths, 1), gram(lengths, 2)
        c = np.stack([cx, cz], axis=1)
        ac, bc = np.einsum("eij,ekj->eki", a, c), np.einsum("eij,ekj->eki", b, c)
        strain = 0.5 * (lam**2 * np.einsum("eki,eki->e", c, ac) / lengths - 1)
        energy = 0.5 * self.ea * strain**2 * lengths / lam + 0.5 * self.ei * np.einsum("eki,eki->e", c, bc)
        axial = self.ea * lam * strain
        gradient = axial[:, None, None] * ac + self.ei * bc
        hessian = np.einsum("e,eki,elj->ekilj", self.ea * lam**3 / lengths, ac, ac)
        for k in range(2):
            hessian[:, k, :, k, :] += axial[:, None, None] * a + self.ei * b
        return energy, gradient, hessian


# ---------------------------------------------------------------------------------------------- linear algebra

class BandFactor:
    """Cholesky factor of a symmetric positive definite band matrix."""

    def __init__(self, matrix):
        coo = sparse.coo_matrix(matrix)
        coo.sum_duplicates()
        width = int(np.max(coo.row - coo.col))
        band = np.zeros((width + 1, matrix.shape[0]))
        lower = coo.row >= coo.col
        band[coo.row[lower] - coo.col[lower], coo.col[lower]] = coo.data[lower]
        self.factor = linalg.cholesky_banded(band, lower=True)
        (self.solve_band,) = linalg.get_lapack_funcs(("pbtrs",), (band,))

    def solve(self, rhs):
        result, info = self.solve_band(self.factor, rhs, lower=1)
        if info:
            raise RuntimeError(f"pbtrs returned {info}")
        return result


def scatter(blocks, index, size):
    """Sums element matrices (e, n, n) with coordinates index (e, n) into a sparse matrix."""
    n = index.shape[1]
    rows, cols = np.repeat(index, n, axis=1), np.tile(index, (1, n))
    return sparse.csr_matrix((blocks.reshape(-1), (rows.reshape(-1), cols.reshape(-1))), shape=(size, size))


def held(matrix, fixed, diagonal):
    """Matrix with rows and columns of the fixed coordinates emptied and `diagonal` put there."""
    free = np.ones(matrix.shape[0])
    free[fixed] = 0.0
    keep = sparse.diags(free)
    return (keep @ matrix @ keep + diagonal * sparse.diags(1.0 - free)).tocsr()


def active_set(law, coupling, self_effect, slack, contact=None):
    """Unilateral droppers and contact: r >= 0 takes away the force of the slack droppers, F >= 0 is the contact force.

    Dropper law force f = law + coupling F - self_effect r, wanted f + r = 0 or (r = 0 and f >= 0).
    contact = (k, penetration without F and r, its decrease per F, its increase per r, closed), or None.
    Returns F, slack, r, closed.
    """
    slack = np.asarray(slack)
    closed = contact is not None and contact[4]
    for _ in range(60):
        a = np.flatnonzero(slack)
        n = a.size
        lhs, rhs = np.eye(n + 1), np.zeros(n + 1)
        lhs[:n, :n] -= self_effect[np.ix_(a, a)]
        rhs[:n] = -law[a]
        if closed:
            k, free, per_force, per_slack, _ = contact
            lhs[:n, n] = coupling[a]
            lhs[n, n] = 1.0 + k * per_force
            lhs[n, :n] = -k * per_slack[a]
            rhs[n] = k * free
        if n:
            solution = np.linalg.solve(lhs, rhs)
        else:
            solution = rhs / lhs[n, n]
        r, force = solution[:n], solution[n]
        f = law + coupling * force - self_effect[:, a] @ r
        new_slack = f < 0  # for the slack ones f = -r
        new_closed = closed
        if contact is not None:
            new_closed = force > 0 if closed else contact[1] + contact[3][a] @ r > 0
        if new_closed == closed and np.array_equal(new_slack, slack):
            return force, slack, r, closed
        slack, closed = new_slack, new_closed
    raise RuntimeError("active set of droppers and contact does not settle")


# ---------------------------------------------------------------------------------------------- the line

class Line:
    """Mesh, statics and constant matrices of the line of a scene."""

    def __init__(self, scene, model, per_interval, wire_ends=None, dropper_rotation=False, anchor=False):
        cat = scene["catenary"]
        if any(cat["stagger"]):
            raise SystemExit("stagger: must be 0 everywhere in this two-dimensional model")
        self.model, self.scene, self.components = model, scene, 2 if model == "sagging" else 1
        self.wires = [Wire(cat["contact_wire"]), Wire(cat["messenger_wire"])]
        self.gravity, self.spans, self.span = cat["gravity"], cat["spans"], cat["span_length"]
        self.ends = wire_ends or cat["wire_ends"]
        drop, positions = cat["droppers"], np.array(cat["droppers"]["positions"])

        breaks = np.concatenate([[0.0], positions, [self.span]])
        pieces = [np.linspace(a, b, per_interval + 1)[:-1] for a, b in zip(breaks[:-1], breaks[1:])]
        one = np.concatenate(pieces)
        self.x = np.concatenate([one + self.span * i for i in range(self.spans)] + [[self.span * self.spans]])
        self.nodes, self.size = self.x.size, self.x.size * 4 * self.components
        self.support_node = np.arange(self.spans + 1) * one.size
        self.dropper_node = (np.arange(self.spans)[:, None] * one.size
                             + per_interval * np.arange(1, positions.size + 1)[None, :]).reshape(-1)
        dx = np.diff(self.x)
        inside = (self.x % self.span) / self.span
        self.nominal = cat["contact_wire_height"] - 4 * cat["presag"] * inside * (1 - inside)
        half_weight = 0.5 * drop["mass"] * self.gravity

        # statics: contact wire held at droppers and supports, then messenger wire held at supports
        support_z = np.full(self.spans + 1, cat["contact_wire_height"] + cat["encumbrance"])
        nodes = np.sort(np.concatenate([self.support_node, self.dropper_node]))
        load = np.zeros(self.nodes)
        load[self.dropper_node] = -half_weight
        find = self.form_finding if model == "sagging" else self.flat_statics
        contact = find(self.wires[CONTACT], dx, nodes, self.nominal[nodes], load)
        reaction = np.zeros(self.nodes)
        reaction[nodes] = contact[3]
        self.dropper_force, self.arm_force = reaction[self.dropper_node], reaction[self.support_node]
        load = np.zeros(self.nodes)
        load[self.dropper_node] = -self.dropper_force - half_weight
        messenger = find(self.wires[MESSENGER], dx, self.support_node, support_z, load)
        self.messenger_reaction = messenger[3]
        self.static = [contact, messenger]  # (element lengths, c_x, c_z, reactions); c_*: (nodes, 2)
        self.dropper_length = messenger[2][self.dropper_node, 0] - contact[2][self.dropper_node, 0]

        # constant matrices
        z_of = [self.dof(w, np.arange(self.nodes), "z") for w in (CONTACT, MESSENGER)]
        stiffness, mass, wire_mass, transverse = [], [], [], []
        for w, wire in enumerate(self.wires):
            length, cx, cz, _ = self.static[w]
            node = np.arange(self.nodes - 1)
            m, t = wire.m * gram(length, 0), wire.tension * gram(length, 1) + wire.ei * gram(length, 2)
            index = {}
            for axis in "xz"[2 - self.components:]:
                i = self.dof(w, node, axis)[:, None]
                j = self.dof(w, node + 1, axis)[:, None]
                index[axis] = np.hstack([i, i + 1, j, j + 1])
                wire_mass.append(scatter(m, index[axis], self.size))
                transverse.append(scatter(t, index[axis], self.size))
            if model == "sagging":
                _, _, hessian = wire.elements(length, nodal(cx), nodal(cz))
                both = np.hstack([index["x"], index["z"]])
                stiffness.append(scatter(hessian.reshape(-1, 8, 8), both, self.size))
            else:
                stiffness.append(transverse[-1])
        damping = cat["damping"]["alpha"] * sum(wire_mass) + cat["damping"]["beta"] * sum(transverse)

        self.k_drop, self.c_drop = drop["stiffness"], drop["damping"]
        self.low, self.high = z_of[CONTACT][self.dropper_node], z_of[MESSENGER][self.dropper_node]
        count = self.dropper_node.size
        self.elongation = sparse.csr_matrix(
            (np.tile([1.0, -1.0], (count, 1)).reshape(-1),
             (np.repeat(np.arange(count), 2), np.stack([self.high, self.low], 1).reshape(-1))), shape=(count, self.size))
        stiffness.append(self.k_drop * self.elongation.T @ self.elongation)
        damping = damping + self.c_drop * self.elongation.T @ self.elongation
        extra_k, extra_m = np.zeros(self.size), np.zeros(self.size)
        inner = self.support_node[1:-1]
        sup, arm = cat["supports"], cat["registration_arms"]
        extra_k[z_of[MESSENGER][inner]] += sup["messenger_vertical_stiffness"]
        extra_k[z_of[CONTACT][inner]] += arm["vertical_stiffness"]
        for axis in "xz"[2 - self.components:]:
            extra_m[self.dof(CONTACT, inner, axis)] += arm["mass"]
            for w in (CONTACT, MESSENGER):
                extra_m[self.dof(w, self.dropper_node, axis)] += 0.5 * drop["mass"]
        ends = np.array([0, self.nodes - 1])
        fixed = [z_of[w][ends] for w in (CONTACT, MESSENGER)]
        pinned = list(fixed)
        if model == "sagging":
            extra_k[self.dof(MESSENGER, inner, "x")] += sup["messenger_longitudinal_stiffness"]
            x_ends = [self.dof(w, ends, "x") for w in (CONTACT, MESSENGER)]
            pinned += [e[:1] for e in x_ends]
            if self.ends == "fixed":
                fixed += x_ends
                pinned = fixed
            elif self.ends != "constant_tension":
                raise SystemExit(f"catenary.wire_ends = {self.ends!r}: must be 'fixed' or 'constant_tension'")
            elif anchor:
                fixed = pinned
            if dropper_rotation:
                across = sparse.csr_matrix(
                    (self.elongation.data, (self.elongation.tocoo().row, self.elongation.indices - 2)),
                    shape=self.elongation.shape)
                stiffness.append(across.T @ sparse.diags(self.dropper_force / self.dropper_length) @ across)
        self.fixed, pinned = np.concatenate(fixed), np.concatenate(pinned)
        total = sum(stiffness) + sparse.diags(extra_k)
        self.stiffness = held(total, self.fixed, 0.0)
        self.mass = held(sum(wire_mass) + sparse.diags(extra_m), self.fixed, 0.0)
        self.damping = held(damping, self.fixed, 0.0)
        self.static_factor = BandFactor(held(total, pinned, 1.0e5))
        self.static_columns = self.static_factor.solve(self.elongation.T.toarray())
        self.static_columns[pinned] = 0.0
        self.static_compliance = self.elongation @ self.static_columns

    def dof(self, wire, node, axis):
        """Index of a position coordinate; its slope follows it. Nodes of both wires are interleaved."""
        offset = 2 if (axis == "z" and self.components == 2) else 0
        return np.asarray(node) * 4 * self.components + wire * 2 * self.components + offset

    def flat_statics(self, wire, dx, nodes, heights, load):
        """Flat wire held at `nodes`: (lengths, c_x, c_z, reactions)."""
        index = 2 * np.arange(self.nodes - 1)[:, None] + np.arange(4)[None, :]
        matrix = scatter(wire.tension * gram(dx, 1) + wire.ei * gram(dx, 2), index, 2 * self.nodes)
        rhs = weight(wire, dx, self.gravity).reshape(-1)
        rhs[::2] += load
        q = np.zeros(2 * self.nodes)
        q[2 * nodes] = heights
        step = rhs - matrix @ q
        step[2 * nodes] = 0.0
        q += BandFactor(held(matrix, 2 * nodes, 1.0)).solve(step)
        reaction = (matrix @ q - rhs)[2 * nodes]
        cx = np.stack([self.x, np.ones(self.nodes)], 1)
        return dx, cx, q.reshape(-1, 2), reaction

    def form_finding(self, wire, dx, nodes, heights, load):
        """Sagging wire under horizontal tension T held in z at `nodes`, every node at its nominal x."""
        _, _, cz, _ = self.flat_statics(wire, dx, nodes, heights, load)
        slope = np.diff(cz[:, 0]) / dx
        lengths = dx * np.sqrt(1 + slope**2)
        cosine = 1 / np.sqrt(1 + cz[:, 1] ** 2)
        q = np.stack([self.x, cosine, cz[:, 0], cz[:, 1] * cosine], 1)
        node = 4 * np.arange(self.nodes - 1)[:, None]
        index = np.hstack([node + i for i in (0, 1, 4, 5, 2, 3, 6, 7)])  # x part, then z part
        fixed = np.concatenate([[0], 4 * nodes + 2])
        for _ in range(30):
            for iteration in range(60):
                _, gradient, hessian = wire.elements(lengths, nodal(q[:, :2]), nodal(q[:, 2:]))
                residual = np.bincount(index.reshape(-1), gradient.reshape(-1), 4 * self.nodes)
                outer = np.zeros((self.nodes, 4))
                outer[:, 2:] = weight(wire, lengths, self.gravity)
                outer[:, 2] += load
                outer[-1, 0] += wire.tension
                residual -= outer.reshape(-1)
                reaction = residual[4 * nodes + 2].copy()
                residual[fixed] = 0.0
                matrix = held(scatter(hessian.reshape(-1, 8, 8), index, 4 * self.nodes), fixed, 1e5)
                change = BandFactor(matrix).solve(-residual).reshape(-1, 4)
                q += change
                if np.abs(change).max() < 1e-9 and np.abs(residual).max() < 1e-4:
                    break
            else:
                raise RuntimeError("form finding does not converge")
            q[nodes, 2] = heights
            if np.abs(q[:, 0] - self.x).max() < 1e-8:
                return lengths, q[:, :2].copy(), q[:, 2:].copy(), reaction
            lengths = lengths * dx / np.diff(q[:, 0])
        raise RuntimeError("node positions do not settle")

    def contact_rows(self, xs):
        """Coordinates (n, 4 per component) and coefficients b of the wire's height at xs, static height z0."""
        length, cx, cz, _ = self.static[CONTACT]
        e = np.clip(np.searchsorted(self.x, xs, side="right") - 1, 0, self.nodes - 2)
        l, px, pz = length[e], nodal(cx)[e], nodal(cz)[e]
        xi = (xs - self.x[e]) / (self.x[e + 1] - self.x[e])
        for _ in range(20):  # material point with static x0 = xs
            miss = np.sum(hermite(xi, l) * px, 1) - xs
            xi = xi - miss / (l * np.sum(hermite(xi, l, 1) * px, 1))
        n, n_s = hermite(xi, l), hermite(xi, l, 1)
        z0 = np.sum(n * pz, 1)
        i, j = self.dof(CONTACT, e, "z")[:, None], self.dof(CONTACT, e + 1, "z")[:, None]
        index = np.hstack([i, i + 1, j, j + 1])
        if self.model == "flat":
            return index, n, z0
        slope = np.sum(n_s * pz, 1) / np.sum(n_s * px, 1)
        return np.hstack([index - 2, index]), np.hstack([-slope[:, None] * n, n]), z0

    def under_force(self, x, force):
        """Displacement of the static line under a vertical force, and the height change of the wire there."""
        index, row, _ = self.contact_rows(np.array([x]))
        if self.model == "sagging":
            row[:, :4] = 0.0  # vertical force, rise of the material point
        rhs = np.zeros(self.size)
        rhs[index[0]] = force * row[0]
        rhs[self.fixed] = 0.0
        u = self.static_factor.solve(rhs)
        law = self.dropper_force + self.k_drop * (self.elongation @ u)
        _, slack, r, _ = active_set(law, np.zeros_like(law), self.k_drop * self.static_compliance, law < 0)
        u -= self.static_columns[:, slack] @ r
        return u, row[0] @ u[index[0]], int(slack.sum())

    def statics_report(self):
        """Results of statics, in the layout of `master check --json` for equal names."""
        positions = self.scene["catenary"]["droppers"]["positions"]
        low, high = self.evaluated()
        points = {round(self.span * s + p, 6) for s in range(low - 1, high)
                  for p in [0.0, *positions, 0.25 * self.span, 0.5 * self.span, 0.75 * self.span, self.span]}
        elasticity = []
        for x in sorted(points):
            _, rise, slack = self.under_force(x, 100.0)
            elasticity.append({"x": x, "m_per_N": rise / 100.0, "slack_droppers": slack})
        return {
            "model": self.model, "wire_ends": self.ends,
            "elements_per_interval": (self.nodes - 1) // (self.spans * (len(positions) + 1)),
            "droppers": [{"span": i // len(positions) + 1, "x": float(self.x[n]), "length_m": float(self.dropper_length[i]),
                          "force_N": float(self.dropper_force[i])} for i, n in enumerate(self.dropper_node)],
            "supports": [{"x": float(self.x[n]), "messenger_reaction_N": float(self.messenger_reaction[i]),
                          "arm_force_N": float(self.arm_force[i]), "contact_wire_z_m": float(self.static[CONTACT][2][n, 0])}
                         for i, n in enumerate(self.support_node)],
            "messenger_sag_m": [float(self.static[MESSENGER][2][0, 0] - self.static[MESSENGER][2][a:b + 1, 0].min())
                                for a, b in zip(self.support_node[:-1], self.support_node[1:])],
            "elasticity": elasticity,
        }

    def evaluated(self):
        spans = self.scene["run"]["evaluate"]["spans"]
        return spans[0], spans[-1]


def nodal(c):
    """(nodes, 2) positions and slopes to (elements, 4)."""
    return np.hstack([c[:-1], c[1:]])


def weight(wire, lengths, gravity):
    """Nodal forces (nodes, 2) of the wire's weight: int N ds = l/2, l^2/12, l/2, -l^2/12."""
    out = np.zeros((lengths.size + 1, 2))
    out[:-1, 0] += lengths / 2
    out[1:, 0] += lengths / 2
    out[:-1, 1] += lengths**2 / 12
    out[1:, 1] -= lengths**2 / 12
    return -wire.m * gravity * out
