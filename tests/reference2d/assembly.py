"""Planar assembly of the wires of a scene: any number of wires, droppers between them, clamps, supports, arms, masses.

Keys are those of docs/scenes/reference.md. A *point* is a place of a wire at which something is fastened; a clamp is
one point of two wires. Definitions taken from the scene: tension is the horizontal force in the wire at its ends;
mass_per_length, EA and EI belong to the wire under its tension; contact wires lie at their heights at droppers and
supports, h - presag 4 xi (1 - xi) with h on the chord of the supports; a dropper of mass m puts m/2 and its clamp on
either end; an arm puts its mass on each contact wire; the messenger wire between the clamps of a stitch wire carries
its own tension less that of the stitch wire; droppers between the clamps hang from the stitch wire.
"""

from dataclasses import dataclass, field

import numpy as np

from hanging import HangingWire, hang


@dataclass
class Wire:
    """A wire through points, ascending in x."""

    kind: str
    section: int
    mass: float
    tension: float
    ea: float
    ei: float
    points: list = field(default_factory=list)


@dataclass
class Dropper:
    section: int
    span: int
    x: float
    upper: int
    lower: int
    force: float = 0.0
    length: float = 0.0


def listed(value, count):
    """`value` for each of `count` places: one for all, or a list."""
    return np.full(count, float(value)) if np.isscalar(value) else np.asarray(value, float)


def positions(catenary, length):
    """Dropper positions in a span of that length, m, by list or by rule."""
    droppers = catenary["droppers"]
    if "positions" in droppers:
        return np.array(droppers["positions"], float)
    first, longest = droppers["rule"]["first"], droppers["rule"]["longest"]
    between = length - 2 * first
    return np.linspace(first, length - first, int(np.ceil(between / longest - 1e-9)) + 1)


class Assembly:
    """Points, wires, droppers and masses of a scene in the vertical plane, in static balance.

    x, z (points), mass (points) lumped masses, wires, hanging (their static shape, in the same order), droppers,
    messenger_supports and arms: inner points of messenger and contact wires at supports, with ends beside them.
    """

    def __init__(self, scene):
        self.catenary = catenary = scene["catenary"]
        if any(key in catenary for key in ("surface", "change", "curve_radius", "table", "from", "point_mass")):
            raise SystemExit("this planar model knows lines as erected, straight and given by keys")
        self.gravity = catenary["gravity"]
        self.x, self.z, self.held, self.mass = [], [], [], []
        self.wires, self.droppers = [], []
        self.messenger_supports, self.arms, self.ends = [], [], []
        self.support_reports = []
        for number, section in enumerate(catenary.get("tension_length", [catenary])):
            self._add_section(number, section)
        self.x, self.z = np.array(self.x), np.array(self.z)
        self.held, self.mass = np.array(self.held), np.array(self.mass)
        self._statics()

    def _point(self, x, z, held):
        self.x.append(x)
        self.z.append(z)
        self.held.append(held)
        self.mass.append(0.0)
        return len(self.x) - 1

    def _wire(self, kind, number, table):
        wire = Wire(
            kind,
            number,
            table["mass_per_length"],
            table["tension"],
            table["axial_stiffness"],
            table["bending_stiffness"],
        )
        self.wires.append(wire)
        return wire

    def _add_section(self, number, section):
        catenary = self.catenary
        spans = section["spans"]
        lengths = listed(section["span_length"], spans)
        supports = section.get("start_x", 0.0) + np.concatenate([[0.0], np.cumsum(lengths)])
        heights = listed(section["contact_wire_height"], spans + 1)
        presag, encumbrance = listed(section["presag"], spans), listed(section["encumbrance"], spans + 1)
        above = heights + encumbrance
        half = 0.5 * catenary["stitch_wires"]["length"] if "stitch_wires" in catenary else 0.0
        droppers = [(span, supports[span] + p) for span in range(spans) for p in positions(catenary, lengths[span])]

        def contact_height(span, x):
            xi = (x - supports[span]) / lengths[span]
            return heights[span] + xi * (heights[span + 1] - heights[span]) - presag[span] * 4 * xi * (1 - xi)

        # messenger wire and stitch wires
        messenger = self._wire("messenger", number, catenary["messenger_wire"])
        top, upper = {}, {}
        for i, x in enumerate(supports):
            top[x] = self._point(x, above[i], True)
            (self.ends if i in (0, spans) else self.messenger_supports).append(top[x])
        for i, x in enumerate(supports):
            if half == 0.0 or i in (0, spans):
                continue
            stitch = self._wire("stitch", number, catenary["stitch_wires"])
            clamps = [self._point(x + side * half, above[i], False) for side in (-1, 1)]
            for clamp in clamps:
                top[self.x[clamp]] = clamp
                self.mass[clamp] += catenary["stitch_wires"].get("clamp_mass", 0.0)
            carried = [(span, at) for span, at in droppers if abs(at - x) < half]
            for _, at in carried:
                upper[at] = self._point(at, above[i] - 0.1, False)
            stitch.points = [clamps[0], *(upper[at] for _, at in carried), clamps[1]]
        for span, at in droppers:
            if at not in upper:
                upper[at] = top[at] = self._point(at, above[span] - 0.3, False)
        messenger.points = [top[x] for x in sorted(top)]

        # contact wires, one or two
        for _ in range(2 if "contact_wire_spacing" in catenary else 1):
            wire = self._wire("contact", number, catenary["contact_wire"])
            low = {}
            for i, x in enumerate(supports):
                low[x] = self._point(x, heights[i], True)
                if i in (0, spans):
                    self.ends.append(low[x])
                else:
                    self.arms.append(low[x])
                    self.mass[low[x]] += catenary["registration_arms"]["mass"]
            table = catenary["droppers"]
            for span, at in droppers:
                low[at] = self._point(at, contact_height(span, at), True)
                self.droppers.append(Dropper(number, span + 1, at, upper[at], low[at]))
                self.mass[upper[at]] += 0.5 * table["mass"] + table.get("upper_clamp_mass", 0.0)
                self.mass[low[at]] += 0.5 * table["mass"] + table.get("lower_clamp_mass", 0.0)
            wire.points = [low[x] for x in sorted(low)]
        self.support_reports.append((number, [(x, top[x]) for x in supports]))

    def _tensions(self, wire):
        """Horizontal tension of each segment."""
        middle = 0.5 * (self.x[wire.points[:-1]] + self.x[wire.points[1:]])
        tension = np.full(middle.size, wire.tension)
        if wire.kind == "messenger":
            for stitch in (w for w in self.wires if w.kind == "stitch" and w.section == wire.section):
                left, right = self.x[stitch.points[0]], self.x[stitch.points[-1]]
                tension[(middle > left) & (middle < right)] -= stitch.tension
        return tension

    def _statics(self):
        shape = {
            id(wire): HangingWire(
                wire.points, self.x[wire.points], self._tensions(wire), wire.mass * self.gravity, wire.ei
            )
            for wire in self.wires
        }
        self.hanging = [shape[id(wire)] for wire in self.wires]
        weights = -self.gravity * self.mass
        of = lambda *kinds: [shape[id(wire)] for wire in self.wires if wire.kind in kinds]
        self.z, below = hang(of("contact"), self.z, self.held, weights)
        loads = weights.copy()
        for dropper in self.droppers:
            dropper.force = below[dropper.lower]
            loads[dropper.upper] -= dropper.force
        self.z, above = hang(of("messenger", "stitch"), self.z, self.held, loads)
        self.reaction = below + above
        for dropper in self.droppers:
            dropper.length = self.z[dropper.upper] - self.z[dropper.lower]

    def contact_wires(self):
        """Numbers of the contact wires."""
        return [i for i, wire in enumerate(self.wires) if wire.kind == "contact"]
