"""Static shape of wires that hang from each other, in closed form; for the assembly see assembly.py.

A wire is a row of segments between points at given x. H horizontal tension of a segment, q weight per arc length,
l its extent along x, all loads vertical. Unknown are the heights of the points, and of a wire with bending stiffness
its slopes there. Both kinds of segment are exact, so that the result knows no mesh:

rope (EI = 0), the catenary, with d the difference of height of its ends:

    z' = sinh(c - a + q s/H),    a = q l/(2 H),    sinh c = d q/(2 H sinh a)

tensioned beam of small slope, with lam = sqrt(EI/H), under the load w per x (q times the mean of ds/dx):

    z = A + B s + C exp(-s/lam) + D exp(-(l - s)/lam) + w s^2/(2 H)

A segment pulls its left point up by the vertical force V(0) and its right point by -V(l), with V = H z' of a rope and
V = H z' - EI z''' = H B + w s of a beam. Beams are continuous in slope and moment from segment to segment and free of
moments at their ends; ropes have kinks. Newton's method finds the heights at which all free points are in balance.
"""

import numpy as np

GAUSS = np.polynomial.legendre.leggauss(8)


class RopeSegment:
    """Catenary of horizontal tension `h` and weight `q` per arc length between points `l` apart."""

    def __init__(self, h, q, l):
        self.h, self.q, self.l, self.a = h, q, l, q * l / (2 * h)

    def set_ends(self, left, right):
        """Takes the heights of both ends."""
        self.left = left
        self.c = np.arcsinh((right - left) * self.q / (2 * self.h * np.sinh(self.a)))

    def pulls(self):
        """Upward pull on the left and the right point, and its derivatives by (right - left)."""
        rate = self.q / (2 * self.h * np.sinh(self.a)) / np.cosh(self.c)
        low, high = self.c - self.a, self.c + self.a
        return self.h * np.array([np.sinh(low), -np.sinh(high)]), self.h * rate * np.array(
            [np.cosh(low), -np.cosh(high)]
        )

    def height(self, s):
        low = self.c - self.a
        return self.left + self.h / self.q * (np.cosh(low + self.q * s / self.h) - np.cosh(low))

    def slope(self, s):
        return np.sinh(self.c - self.a + self.q * s / self.h)


class BeamSegment:
    """Tensioned beam of small slope; ends are (height, slope)."""

    def __init__(self, h, q, l, ei):
        self.h, self.q, self.l, self.ei, self.lam = h, q, l, ei, np.sqrt(ei / h)
        e = np.exp(-l / self.lam)
        rows = np.array(
            [[1, 0, 1, e], [0, 1, -1 / self.lam, e / self.lam], [1, l, e, 1], [0, 1, -e / self.lam, 1 / self.lam]]
        )
        self.inverse = np.linalg.inv(rows)
        self.w = q

    def set_ends(self, ends):
        """Takes (height, slope) of the left and of the right end."""
        load = self.w / self.h
        self.factors = self.inverse @ (ends - load * np.array([0.0, 0.0, self.l**2 / 2, self.l]))
        points = 0.5 * self.l * (GAUSS[0] + 1)
        self.next_w = self.q * 0.5 * GAUSS[1] @ np.sqrt(1 + self.slope(points) ** 2)

    def actions(self):
        """Upward pull and moment EI z'' on the left point, on the right point; and the matrix by (heights, slopes)."""
        e, h, l = np.exp(-self.l / self.lam), self.h, self.l
        # of the factors A, B, C, D: V(0), M(0), -V(l), -M(l)
        to = np.array([[0, h, 0, 0], [0, 0, h, h * e], [0, -h, 0, 0], [0, 0, -h * e, -h]])
        load = self.w * np.array([0.0, self.ei / h, -l, -self.ei / h])
        return to @ self.factors + load, to @ self.inverse

    def _parts(self, s):
        return np.exp(-np.asarray(s) / self.lam), np.exp(-(self.l - np.asarray(s)) / self.lam)

    def height(self, s):
        (a, b, c, d), (left, right) = self.factors, self._parts(s)
        return a + b * s + c * left + d * right + self.w * s**2 / (2 * self.h)

    def slope(self, s):
        (_, b, c, d), (left, right) = self.factors, self._parts(s)
        return b + (d * right - c * left) / self.lam + self.w * s / self.h


class HangingWire:
    """Segments of one wire through the points numbered `points`, with a horizontal tension for each segment."""

    def __init__(self, points, x, tensions, weight, ei):
        self.points, self.x, self.ei = np.asarray(points), np.asarray(x, float), ei
        spans = np.diff(self.x)
        if ei > 0:
            self.segments = [BeamSegment(h, weight, l, ei) for h, l in zip(tensions, spans)]
        else:
            self.segments = [RopeSegment(h, weight, l) for h, l in zip(tensions, spans)]
        self.tensions = np.asarray(tensions, float)

    def height(self, x):
        """Height at places x along the track; shape of x."""
        return self._piecewise(x, "height")

    def slope(self, x):
        return self._piecewise(x, "slope")

    def _piecewise(self, x, what):
        x = np.asarray(x, float)
        where = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.segments) - 1)
        out = np.empty_like(x)
        for i in np.unique(where):
            here = where == i
            out[here] = getattr(self.segments[i], what)(x[here] - self.x[i])
        return out


def hang(wires, heights, held, loads):
    """Brings `wires` into balance.

    heights (n) of all points, the final ones where `held` and a guess elsewhere; loads (n) upward forces on the points.
    Returns the heights (n) and the upward forces (n) that hold the held points, 0 elsewhere.
    """
    z, n = np.array(heights, float), len(heights)
    beams = [wire for wire in wires if wire.ei > 0]
    first_slope, total = {}, n
    for wire in beams:
        first_slope[id(wire)] = total
        total += len(wire.points)
    slopes = np.zeros(total - n)
    free = np.ones(total, bool)
    free[:n] = ~np.asarray(held)
    touched = np.zeros(total, bool)
    for _ in range(60):
        residual, matrix = np.zeros(total), np.zeros((total, total))
        residual[:n] = loads
        unsettled = 0.0
        for wire in wires:
            for i, segment in enumerate(wire.segments):
                left, right = wire.points[i], wire.points[i + 1]
                if wire.ei > 0:
                    s = first_slope[id(wire)] + i
                    at = np.array([left, s, right, s + 1])
                    segment.set_ends(np.array([z[left], slopes[s - n], z[right], slopes[s + 1 - n]]))
                    actions, tangent = segment.actions()
                    residual[at] += actions
                    matrix[np.ix_(at, at)] += tangent
                    unsettled = max(unsettled, abs(segment.next_w / segment.w - 1))
                    segment.w = segment.next_w
                else:
                    at = np.array([left, right])
                    segment.set_ends(z[left], z[right])
                    pulls, rate = segment.pulls()
                    residual[at] += pulls
                    matrix[np.ix_(at, at)] += np.outer(rate, [-1.0, 1.0])
                touched[at] = True
        solve = free & touched
        worst = np.abs(residual[solve]).max(initial=0.0)
        if worst < 1e-7 and unsettled < 1e-13:
            reaction = np.where(np.asarray(held) & touched[:n], -residual[:n], 0.0)
            return z, reaction
        change = np.linalg.solve(matrix[np.ix_(solve, solve)], -residual[solve])
        both = np.concatenate([z, slopes])
        both[solve] += change
        z, slopes = both[:n], both[n:]
    raise RuntimeError("the wires do not come into balance")
