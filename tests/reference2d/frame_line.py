"""Small motion of an assembly about its static state: straight frame elements with the static tension in them.

A wire is a chain of straight elements between nodes on its static curve. Node coordinates are u along x, w up and the
rotation phi; in the frame of the element (cosine c, sine s of its chord, length l) a = c u + s w along it and
t = c w - s u across it. Incremental energy, with N = H l/dx the static tension of the element:

    U = 1/2 S/l (a2 - a1)^2 + 1/2 int N t'^2 + EI t''^2,    t cubic in (t1, phi1, t2, phi2), a linear

A wire of length lam L0 pulls with N = EA lam (lam^2 - 1)/2 [Green and Lagrange, docs/theory/ancf.md], so that
S = l dN/dl = EA lam (3 lam^2 - 1)/2: by 4 N/EA above EA.

Mass is consistent with the same fields; damping of a wire is alpha M + beta (N int t'^2 + EI int t''^2, and N/l
(a2 - a1)^2 along it). A wire with EI = 0 has a hinge at each point (rotations of both sides are free), others have one
rotation at each node. A dropper is a bar of stiffness k that hangs vertically under its static force F0 and turns with
its ends: k (w1 - w2)^2 + F0/L (u1 - u2)^2. Both ends of each wire have w = 0 and a spring of END_SPRING along x: the
weights give a constant force and the spring a place.

Strip at x: the height z of the wire there is that of the material point that has come to x, and the contact force F is
normal to the moved wire, so that its work is F dz. About a displacement the height changes by u_z - z' u_x, z' slope
of the moved wire; about the static state this is t/c.
"""

import numpy as np
from scipy import linalg, sparse

from planar_line import stretch

END_SPRING = 10.0  # N/m, as docs/theory/ancf.md gives it for ends under constant tension
GAUSS = np.polynomial.legendre.leggauss(4)


def cubic(xi, l, order=0):
    """Cubic functions of (t1, phi1, t2, phi2) at xi in [0, 1] or their derivatives by length; shape (..., 4)."""
    xi, l = np.broadcast_arrays(np.asarray(xi, float), np.asarray(l, float))
    if order == 0:
        rows = ((1 - xi) ** 2 * (1 + 2 * xi), l * xi * (1 - xi) ** 2, xi**2 * (3 - 2 * xi), -l * xi**2 * (1 - xi))
    elif order == 1:
        rows = (-6 * xi * (1 - xi) / l, (1 - xi) * (1 - 3 * xi), 6 * xi * (1 - xi) / l, xi * (3 * xi - 2))
    else:
        rows = ((12 * xi - 6) / l**2, (6 * xi - 4) / l, (6 - 12 * xi) / l**2, (6 * xi - 2) / l)
    return np.stack(rows, axis=-1)


def products(l, order):
    """int f_i f_j ds of the cubic functions or derivatives; shape (elements, 4, 4)."""
    total = 0.0
    for node, weight in zip(*GAUSS):
        f = cubic(0.5 * (node + 1), l, order)
        total = total + 0.5 * weight * l[:, None, None] * f[:, :, None] * f[:, None, :]
    return total


def in_frame(c, s, along, across):
    """Element matrices (e, 6, 6) of (u1, w1, phi1, u2, w2, phi2) from those of (a1, a2) and (t1, phi1, t2, phi2)."""
    n = c.size
    to_a, to_t = np.zeros((n, 2, 6)), np.zeros((n, 4, 6))
    for end in range(2):
        to_a[:, end, 3 * end], to_a[:, end, 3 * end + 1] = c, s
        to_t[:, 2 * end, 3 * end], to_t[:, 2 * end, 3 * end + 1] = -s, c
        to_t[:, 2 * end + 1, 3 * end + 2] = 1.0
    return to_a.transpose(0, 2, 1) @ along @ to_a + to_t.transpose(0, 2, 1) @ across @ to_t


class Chain:
    """Elements of one wire: nodes x, z; per element its coordinates (e, 6) and its geometry."""

    def __init__(self, wire, hanging, x, z, coordinates, tensions):
        self.wire, self.hanging, self.x, self.coordinates = wire, hanging, x, coordinates
        dx, dz = np.diff(x), np.diff(z)
        self.l = np.hypot(dx, dz)
        self.c, self.s, self.n = dx / self.l, dz / self.l, tensions * self.l / dx

    def matrices(self):
        """Stiffness, mass and transverse stiffness for damping, each (e, 6, 6)."""
        w, l = self.wire, self.l
        pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
        bend = self.n[:, None, None] * products(l, 1) + w.ei * products(l, 2)
        lam = stretch(w.ea, self.n)
        along = w.ea * lam * (3 * lam**2 - 1) / 2 / l
        stiffness = in_frame(self.c, self.s, along[:, None, None] * pair, bend)
        halves = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
        mass = in_frame(self.c, self.s, (w.mass * l)[:, None, None] * halves, w.mass * products(l, 0))
        damped = in_frame(self.c, self.s, (self.n / l)[:, None, None] * pair, bend)
        return stiffness, mass, damped

    def row(self, x, u=None):
        """Coordinates (6) and coefficients (6) of the height at x, and the height, about displacements u (0: None)."""
        at, shift = x, 0.0
        for _ in range(1 if u is None else 6):  # the material point that u moves to x
            e = min(max(int(np.searchsorted(self.x, at, side="right")) - 1, 0), self.l.size - 1)
            xi, l, c, s = (at - self.x[e]) / (self.x[e + 1] - self.x[e]), self.l[e], self.c[e], self.s[e]
            linear, f, turn, slope, rise = np.array([1 - xi, xi]), cubic(xi, l), 0.0, s / c, 0.0
            if u is None:
                break
            q = u[self.coordinates[e]]
            along, across = (
                c * q[[0, 3]] + s * q[[1, 4]],
                np.array([c * q[1] - s * q[0], q[2], c * q[4] - s * q[3], q[5]]),
            )
            a, t, rate, turn = linear @ along, f @ across, (along[1] - along[0]) / l, cubic(xi, l, 1) @ across
            slope, rise = (s + c * turn + s * rate) / (c - s * turn + c * rate), s * a + c * t
            before, shift = shift, c * a - s * t
            at = x - shift
            if abs(shift - before) < 1e-9:
                break
        # height = z + u_z at the material point, less slope times the u_x by which another point comes to x
        on_a, on_t, out = (s - slope * c) * linear, (c + slope * s) * f, np.zeros(6)
        for end in range(2):
            out[3 * end] = c * on_a[end] - s * on_t[2 * end]
            out[3 * end + 1] = s * on_a[end] + c * on_t[2 * end]
            out[3 * end + 2] = on_t[2 * end + 1]
        return self.coordinates[e], out, float(self.hanging.height(x - shift)) + rise


class FrameLine:
    """Constant matrices of an assembly; coordinates are numbered along the track."""

    def __init__(self, assembly, contact_element, upper_element):
        self.assembly = assembly
        catenary = assembly.catenary
        places = self._nodes(contact_element, upper_element)
        order = np.argsort([place[0] for place in places], kind="stable")
        number = np.empty(len(places), int)
        number[order] = np.arange(len(places))
        self.size = len(places)
        point = lambda p: number[[self.point_u[p], self.point_u[p] + 1]]
        self.chains = []
        for i, wire in enumerate(assembly.wires):
            x, z, raw, tensions = self.plan[i]
            self.chains.append(Chain(wire, assembly.hanging[i], x, z, number[raw], tensions))

        stiffness, mass, damping = [], [], []
        for chain in self.chains:
            k, m, b = chain.matrices()
            rows, columns = np.repeat(chain.coordinates, 6, axis=1).ravel(), np.tile(chain.coordinates, (1, 6)).ravel()
            gathered = lambda values: sparse.csr_matrix((values.ravel(), (rows, columns)), (self.size, self.size))
            stiffness.append(gathered(k))
            mass.append(gathered(m))
            damping.append(gathered(catenary["damping"]["alpha"] * m + catenary["damping"]["beta"] * b))
        extra, lumped = np.zeros(self.size), np.zeros(self.size)
        for p in range(assembly.x.size):
            lumped[point(p)] += assembly.mass[p]
        for p in assembly.messenger_supports:
            extra[point(p)] += (
                catenary["supports"]["messenger_longitudinal_stiffness"],
                catenary["supports"]["messenger_vertical_stiffness"],
            )
        for p in assembly.arms:
            extra[point(p)[1]] += catenary["registration_arms"]["vertical_stiffness"]
        self.fixed = []
        for p in assembly.ends:
            u, w = point(p)
            self.fixed += [u, w] if catenary["wire_ends"] == "fixed" else [w]
            extra[u] += END_SPRING
        self.dropper_stiffness, self.dropper_damping = (
            catenary["droppers"]["stiffness"],
            catenary["droppers"]["damping"],
        )
        self.dropper_force = np.array([dropper.force for dropper in assembly.droppers])
        lengths = np.array([dropper.length for dropper in assembly.droppers])
        self.elongation, across = (self._differences(point, axis) for axis in (1, 0))
        stiffness += [
            self.dropper_stiffness * self.elongation.T @ self.elongation,
            across.T @ sparse.diags(self.dropper_force / lengths) @ across,
            sparse.diags(extra),
        ]
        damping.append(self.dropper_damping * self.elongation.T @ self.elongation)
        keep = np.ones(self.size)
        keep[self.fixed] = 0.0
        self.keep = keep
        hold = sparse.diags(keep)
        self.stiffness, self.mass, self.damping = (
            (hold @ m @ hold).tocsr() for m in (sum(stiffness), sum(mass) + sparse.diags(lumped), sum(damping))
        )
        self.elongation = (self.elongation @ hold).tocsr()

    def _nodes(self, contact_element, upper_element):
        """Coordinates as (x, ...) in the order of their making; fills `plan` and `point_u`."""
        assembly, places = self.assembly, []
        self.point_u, self.plan = {}, []

        def add(x, count):
            first = len(places)
            places.extend([(x,)] * count)
            return first

        for p, x in enumerate(assembly.x):
            self.point_u[p] = add(x, 2)
        for wire, hanging in zip(assembly.wires, assembly.hanging):
            longest = contact_element if wire.kind == "contact" else upper_element
            x, raw, tensions, turn = [assembly.x[wire.points[0]]], [], [], None
            for left, right, tension in zip(wire.points[:-1], wire.points[1:], hanging.tensions):
                a, b = assembly.x[left], assembly.x[right]
                cuts = np.linspace(a, b, int(np.ceil((b - a) / longest - 1e-9)) + 1)
                before = self.point_u[left]
                if turn is None or wire.ei == 0:
                    turn = add(a, 1)
                for i, at in enumerate(cuts[1:], 1):
                    last = i == cuts.size - 1
                    u = self.point_u[right] if last else add(at, 2)
                    next_turn = add(at, 1)
                    raw.append([before, before + 1, turn, u, u + 1, next_turn])
                    before, turn = u, next_turn
                x.extend(cuts[1:])
                tensions.extend([tension] * (cuts.size - 1))
            x = np.array(x)
            z = hanging.height(x)
            self.plan.append((x, z, np.array(raw), np.array(tensions)))
        return places

    def _differences(self, point, axis):
        """Upper less lower coordinate of the droppers as a sparse matrix (droppers, size)."""
        pairs = np.array([[point(d.upper)[axis], point(d.lower)[axis]] for d in self.assembly.droppers])
        count = len(pairs)
        return sparse.csr_matrix(
            (np.tile([1.0, -1.0], count), (np.repeat(np.arange(count), 2), pairs.ravel())), shape=(count, self.size)
        )

    def contact_chains(self):
        return [self.chains[i] for i in self.assembly.contact_wires()]


class Factor:
    """Cholesky factor of a symmetric positive definite band matrix."""

    def __init__(self, matrix):
        coo = sparse.coo_matrix(matrix)
        coo.sum_duplicates()
        self.width = int(np.abs(coo.row - coo.col).max())
        band = np.zeros((self.width + 1, matrix.shape[0]))
        lower = coo.row >= coo.col
        band[coo.row[lower] - coo.col[lower], coo.col[lower]] = coo.data[lower]
        self.band = linalg.cholesky_banded(band, lower=True, overwrite_ab=True)
        (self.routine,) = linalg.get_lapack_funcs(("pbtrs",), (band,))

    def solve(self, rhs):
        out, info = self.routine(self.band, rhs, lower=1)
        if info:
            raise RuntimeError(f"pbtrs returned {info}")
        return out
