"""The line and the lumped pantograph of a scene in Exudyn; run by `compare.py`, one process per run.

    python model.py STATICS.json FORCE.npy

runs `scene.toml`, whose statics `master check --json` printed, writes the contact force at every step, and prints
cost and checks as JSON in the last line. Planar: Exudyn's x is along the track, its y is up.
"""

import json
import pathlib
import sys
import time
import tomllib

sys.exudynFast = True  # build without range checks, chosen before the import

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    CartesianSpringDamper,
    CoordinateConstraint,
    CoordinateSpringDamper,
    LoadCoordinate,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    MarkerNodePosition,
    Mass1D,
    Node1D,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
    SpringDamper,
)
from exudyn.advancedUtilities import CreateSymbolicUserFunction

esym = exu.symbolic

# N, root mean square of all residuals. This program bounds every coordinate, which takes more iterations.
TOLERANCE = 1e-3


def dropper_force_in(step):
    """The law of droppers in steps of `step` s."""

    def dropper_force(mbs, t, item, elongation, rate, stiffness, damping, start):
        """Unilateral force: pulls and never pushes. In stretching the damping acts for the part of a step in which the
        dropper is taut half a step ahead; `start` is the elongation half a step ahead at the beginning of a step that
        begins slack, else 1, see `Line.before_step`."""
        taut = esym.max(0.0, elongation + 0.5 * step * rate)
        part = esym.max(esym.max(0.0, start), taut / (taut - esym.min(0.0, start) + 1e-300))
        return esym.max(0.0, stiffness * elongation + damping * (part * esym.max(0.0, rate) + esym.min(0.0, rate)))

    return dropper_force


def contact_force(mbs, t, item, apart, rate, stiffness, damping, offset):
    """Vertical penalty force; `apart` is the wire's point minus the strip."""
    return esym.Vector([0.0, stiffness[1] * esym.min(0.0, apart[1]), 0.0])


def slopes(length, xi):
    """First derivatives in x of the four cubics of an element at xi = x/length."""
    return np.array([(6 * xi**2 - 6 * xi) / length, 1 - 4 * xi + 3 * xi**2, (6 * xi - 6 * xi**2) / length, 3 * xi**2 - 2 * xi])


def hanging(x, section, gravity, held, hung):
    """A tensioned beam of small slope through the nodes `x` under its weight and the weights `hung` (node: N) on the
    nodes, at the heights `held` (node: m). Returns heights, slopes, and the reactions at the held nodes (node: N)."""
    tension, bending, weight = section["tension"], section["bending_stiffness"], section["mass_per_length"] * gravity
    matrix, load = np.zeros((2 * len(x), 2 * len(x))), np.zeros(2 * len(x))
    for i, h in enumerate(np.diff(x)):
        membrane = [[36, 3 * h, -36, 3 * h], [3 * h, 4 * h * h, -3 * h, -h * h], [-36, -3 * h, 36, -3 * h], [3 * h, -h * h, -3 * h, 4 * h * h]]
        plate = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h], [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]
        own = slice(2 * i, 2 * i + 4)
        matrix[own, own] += tension / (30 * h) * np.array(membrane) + bending / h**3 * np.array(plate)
        load[own] -= weight * h * np.array([0.5, h / 12, 0.5, -h / 12])
    for node, force in hung.items():
        load[2 * node] -= force
    q = np.zeros(len(load))
    fixed = np.array([2 * node for node in held])
    q[fixed] = list(held.values())
    free = np.setdiff1d(np.arange(len(load)), fixed)
    q[free] = np.linalg.solve(matrix[np.ix_(free, free)], load[free] - matrix[np.ix_(free, fixed)] @ q[fixed])
    return q[0::2], q[1::2], dict(zip(held, (matrix @ q - load)[fixed]))


class Wire:
    """Nodes and elements of one wire."""

    def __init__(self, mbs, x, height, slope, section, gravity):
        tension, axial, bending, mass = (section[key] for key in ("tension", "axial_stiffness", "bending_stiffness", "mass_per_length"))
        # Element lengths belong to the tensioned wire. Stretch of the wire under the strain ½ (λ² − 1), and the
        # stiffness of the same law about that stretch: derivative of EA λ ½ (λ²|r'|² − 1)|r'| at |r'| = 1.
        stretch = 1.0
        for _ in range(50):
            stretch -= (stretch * (stretch**2 - 1) - 2 * tension / axial) / (3 * stretch**2 - 1)
        stiffness = axial * stretch**3 + tension
        self.nodes = [
            mbs.AddNode(NodePoint2DSlope1(referenceCoordinates=[x[i], height[i], 1.0, slope[i]])) for i in range(len(x))
        ]
        self.elements, self.lengths = [], []
        gauss, weights = np.polynomial.legendre.leggauss(5)
        for i in range(len(x) - 1):
            dx = x[i + 1] - x[i]
            ends = np.array([height[i], slope[i], height[i + 1], slope[i + 1]])
            rise = np.array([slopes(dx, 0.5 * (1 + g)) @ ends for g in gauss])
            arc = dx * float(weights @ np.sqrt(1 + rise**2)) / 2
            # The horizontal part of the force is the nominal tension.
            length = arc / (1 + tension * (arc / dx - 1) / stiffness)
            self.lengths.append(length)
            element = mbs.AddObject(
                ObjectANCFCable2D(
                    length=length,
                    massPerLength=mass,
                    bendingStiffness=bending,
                    axialStiffness=stiffness,
                    referenceAxialStrain=-tension / stiffness,
                    nodeNumbers=[self.nodes[i], self.nodes[i + 1]],
                )
            )
            mbs.AddLoad(LoadMassProportional(markerNumber=mbs.AddMarker(MarkerBodyMass(bodyNumber=element)), loadVector=[0, -gravity, 0]))
            self.elements.append(element)


class Line:
    """Two wires, their droppers and supports, one lumped pantograph and its contact."""

    def __init__(self, scene, statics):
        self.scene = scene
        run, line, contact = scene["run"], scene["catenary"], scene["contact"]
        self.speed, self.start_x = run["speed_kmh"] / 3.6, run["start_x"]
        self.container = exu.SystemContainer()
        self.mbs = mbs = self.container.AddSystem()

        # The mesh: one node at every support and dropper, elements_per_interval elements between two of them.
        marks = []
        for span in range(line["spans"]):
            marks += [span * line["span_length"] + at for at in [0.0, *line["droppers"]["positions"]]]
        marks.append(line["spans"] * line["span_length"])
        n = line["mesh"]["elements_per_interval"]
        x = [a + (b - a) * k / n for a, b in zip(marks, marks[1:]) for k in range(n)] + [marks[-1]]
        self.x = x = np.array(x)
        supports = [int(np.argmin(abs(x - s * line["span_length"]))) for s in range(line["spans"] + 1)]
        droppers = [int(np.argmin(abs(x - mark))) for mark in marks]
        droppers = [node for node in droppers if node not in supports]
        gravity, cw, mw = line["gravity"], line["contact_wire"], line["messenger_wire"]

        # Form finding of small slope: a start for the static solution.
        wire_height = line["contact_wire_height"]
        low, low_slope, carried = hanging(x, cw, gravity, {node: wire_height for node in sorted(supports + droppers)}, {})
        high, high_slope, reaction = hanging(
            x, mw, gravity, {node: wire_height + line["encumbrance"] for node in supports}, {node: carried[node] for node in droppers}
        )

        self.contact_wire = Wire(mbs, x, low, low_slope, cw, gravity)
        self.messenger = Wire(mbs, x, high, high_slope, mw, gravity)
        ground = mbs.AddNode(NodePointGround())
        at_ground = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))

        def coordinate(wire, node, axis):
            return mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=wire.nodes[node], coordinate=axis))

        for wire in (self.contact_wire, self.messenger):
            for end in (0, len(x) - 1):
                for axis in (0, 1):
                    mbs.AddObject(CoordinateConstraint(markerNumbers=[at_ground, coordinate(wire, end, axis)]))
        # Arms carry their static force (their stiffness is zero), brackets are springs that carry theirs undeformed.
        self.arms, self.brackets = {}, {}
        for node in supports[1:-1]:
            self.arms[node] = mbs.AddLoad(LoadCoordinate(markerNumber=coordinate(self.contact_wire, node, 1), load=carried[node]))
            marker = coordinate(self.messenger, node, 1)
            mbs.AddObject(CoordinateSpringDamper(markerNumbers=[at_ground, marker], stiffness=line["supports"]["messenger_vertical_stiffness"]))
            self.brackets[node] = mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=reaction[node]))

        stiffness, damping = line["droppers"]["stiffness"], line["droppers"]["damping"]
        self.step = scene["solver"]["micro_step"]
        law = dropper_force_in(self.step)
        pull = CreateSymbolicUserFunction(mbs, law, "springForceUserFunction", itemTypeName="ObjectConnectorSpringDamper")
        self.droppers = []
        for node in droppers:
            ends = [mbs.AddMarker(MarkerNodePosition(nodeNumber=wire.nodes[node])) for wire in (self.contact_wire, self.messenger)]
            self.droppers.append(
                mbs.AddObject(
                    SpringDamper(
                        markerNumbers=ends,
                        referenceLength=high[node] - low[node] - carried[node] / stiffness,
                        stiffness=stiffness,
                        damping=damping,
                        force=1.0,
                        springForceUserFunction=pull,
                    )
                )
            )
        self.dropper_nodes = np.array(droppers)
        self.unstressed = np.array([mbs.GetObjectParameter(d, "referenceLength") for d in self.droppers])
        self.taut = np.ones(len(droppers), dtype=bool)
        ends = [4 * (self.dropper_nodes + wire * len(x)) for wire in (1, 0)]
        # x and z of the upper and of the lower ends
        self.places = np.stack([first + axis for first in ends for axis in (0, 1)])

        # Masses that rise and fall, head first; all springs unstretched at the reference height.
        pantograph = scene["pantograph"][0]
        upright = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        markers = []
        for mass in pantograph["masses"]:
            node = mbs.AddNode(Node1D(referenceCoordinates=[pantograph["reference_height"]]))
            body = mbs.AddObject(Mass1D(nodeNumber=node, physicsMass=mass, referenceRotation=upright))
            markers.append(mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0)))
            if len(markers) == 1:
                self.head_node = node
                head = mbs.AddMarker(MarkerBodyPosition(bodyNumber=body))
        for i, (k, c) in enumerate(zip(pantograph["stiffnesses"], pantograph["dampings"])):
            below = markers[i + 1] if i + 1 < len(markers) else at_ground
            mbs.AddObject(CoordinateSpringDamper(markerNumbers=[below, markers[i]], stiffness=k, damping=c))
        mbs.AddLoad(LoadCoordinate(markerNumber=markers[-1], load=pantograph["static_force"]))

        # One contact per element of the contact wire; only the one under the strip is active.
        push = CreateSymbolicUserFunction(mbs, contact_force, "springForceUserFunction", itemTypeName="ObjectConnectorCartesianSpringDamper")
        last = self.start_x + self.speed * run["duration"]
        self.contacts, self.points = {}, {}
        for i, element in enumerate(self.contact_wire.elements):
            if x[i + 1] >= self.start_x - 1 and x[i] <= last + 1:
                self.points[i] = mbs.AddMarker(MarkerBodyPosition(bodyNumber=element, localPosition=[0, 0, 0]))
                self.contacts[i] = mbs.AddObject(
                    CartesianSpringDamper(
                        markerNumbers=[head, self.points[i]],
                        stiffness=[0, contact["stiffness"], 0],
                        springForceUserFunction=push,
                        activeConnector=False,
                    )
                )
        self.under = None
        mbs.Assemble()
        self.coordinates = mbs.systemData.ODE2Size()
        self.find_form(statics, wire_height, cw, mw)

    def place_contact(self, t):
        """Puts the contact on the wire's point at the strip's x at time `t`, the wire continued from the last step."""
        mbs, x = self.mbs, self.start_x + self.speed * t
        q = mbs.systemData.GetODE2Coordinates()
        v = mbs.systemData.GetODE2Coordinates_t()
        h = self.scene["solver"]["micro_step"] if t > 0.0 else 0.0
        i = self.under
        if i is None:
            i = int(np.searchsorted(self.x, x, side="right")) - 1
        while True:
            # x and its derivative in the element's parameter at both ends. Plain numbers are cheaper than small arrays.
            x0, s0, x1, s1 = (float(self.reference[k] + q[k] + h * v[k]) for k in range(4 * i, 4 * i + 8, 2))
            if x <= x1:
                break
            i += 1
        length = self.contact_wire.lengths[i]
        xi = (x - x0) / (x1 - x0)
        for _ in range(3):
            square, cube = xi * xi, xi * xi * xi
            rise = 3 * square - 2 * cube
            at = x0 + rise * (x1 - x0) + length * (s0 * (xi - 2 * square + cube) + s1 * (cube - square))
            slope = 6 * (xi - square) * (x1 - x0) + length * (s0 * (1 - 4 * xi + 3 * square) + s1 * (3 * square - 2 * xi))
            xi -= (at - x) / slope
        if i != self.under:
            if self.under is not None:
                mbs.SetObjectParameter(self.contacts[self.under], "activeConnector", False)
            mbs.SetObjectParameter(self.contacts[i], "activeConnector", True)
            self.under = i
        mbs.SetMarkerParameter(self.points[i], "localPosition", [xi * length, 0, 0])

    def settings(self):
        settings = exu.SimulationSettings()
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
        settings.parallel.numberOfThreads = 1
        settings.solutionSettings.writeSolutionToFile = False
        for newton in (settings.staticSolver.newton, settings.timeIntegration.newton):
            newton.relativeTolerance = 1e-30
            newton.absoluteTolerance = TOLERANCE
            newton.weightTolerancePerCoordinate = True
            newton.maxIterations = 60
        return settings

    def settle(self):
        settings = self.settings()
        settings.staticSolver.newton.absoluteTolerance = 3e-7
        self.mbs.SolveStatic(settings, storeSolver=False)
        # The solution is the start of the next one.
        q = self.mbs.systemData.GetODE2Coordinates()
        self.mbs.systemData.SetODE2Coordinates(q, exu.ConfigurationType.Initial)
        self.mbs.systemData.SetAECoordinates(self.mbs.systemData.GetAECoordinates(), exu.ConfigurationType.Initial)
        return q

    def heights(self, q, wire):
        first = 4 * len(self.x) * wire
        return (q + self.reference)[first + 1 : first + 4 * len(self.x) : 4]

    def elongation(self, q):
        at = q[self.places] + self.reference[self.places]
        return np.hypot(at[0] - at[2], at[1] - at[3]) - self.unstressed

    def elongation_ahead(self, q, v):
        """Elongations half a step ahead, m."""
        at, v = q[self.places] + self.reference[self.places], v[self.places]
        x, z = at[0] - at[2], at[1] - at[3]
        rate = (x * (v[0] - v[2]) + z * (v[1] - v[3])) / np.hypot(x, z)
        return self.elongation(q) + 0.5 * self.step * rate

    def find_form(self, statics, wire_height, cw, mw):
        """Finds the droppers' unstressed lengths for a level contact wire under the forces of arms and brackets from
        the statics of this program; then the equilibrium with the pantograph."""
        mbs = self.mbs
        self.reference = mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference)
        for node, support in zip(self.arms, statics["supports"][1:-1]):
            mbs.SetLoadParameter(self.arms[node], "load", support["arm_force_N"])
            mbs.SetLoadParameter(self.brackets[node], "load", support["messenger_reaction_N"])
        n = 4 * len(self.x)
        for _ in range(100):
            q = self.settle()
            off = self.heights(q, 0)[self.dropper_nodes] - wire_height
            # Nodes above their nominal x, nominal tension at the ends.
            along = (q + self.reference)[: 2 * n].reshape(2, -1, 4)[:, :, 0]
            ends = mbs.systemData.GetAECoordinates().reshape(2, 2, 2)[:, :, 0]
            astray = 0.0
            for wire, at, (left, right), section in zip((self.contact_wire, self.messenger), along, ends, (cw, mw)):
                surplus = (0.5 * (right - left) - section["tension"]) / section["axial_stiffness"]
                change = np.diff(self.x) / np.diff(at) * (1.0 + surplus)
                astray = max(astray, abs(change - 1.0).max())
                wire.lengths = list(wire.lengths * change)
                for element, length in zip(wire.elements, wire.lengths):
                    mbs.SetObjectParameter(element, "length", length)
            self.unstressed += off
            for dropper, length in zip(self.droppers, self.unstressed):
                mbs.SetObjectParameter(dropper, "referenceLength", length)
            if abs(off).max() < 1e-7 and astray < 1e-10:
                break
        self.level = abs(off).max()
        self.ends = ends
        theirs = np.array([d["force_N"] for d in statics["droppers"]])
        self.dropper_difference = abs(self.scene["catenary"]["droppers"]["stiffness"] * self.elongation(q) - theirs).max()
        self.place_contact(0.0)
        self.start = self.settle()
        self.start_force = self.contact()

    def contact(self):
        return -self.mbs.GetObjectOutput(self.contacts[self.under], exu.OutputVariableType.Force)[1]

    def before_step(self, mbs, t):
        """Sets, once per step at the time of its end, the values held during a step and the force at its beginning."""
        begin = time.perf_counter()
        self.force.append(self.contact())
        self.place_contact(t)
        # Elongations with which droppers begin the step.
        data = mbs.systemData
        elongation = self.elongation_ahead(data.GetODE2Coordinates(), data.GetODE2Coordinates_t())
        taut = elongation > 0.0
        for i in np.flatnonzero(~(taut & self.taut)):
            mbs.SetObjectParameter(self.droppers[i], "force", 1.0 if taut[i] else elongation[i])
        self.taut = taut
        self.python_time += time.perf_counter() - begin
        return True

    def run(self):
        """Runs the whole scene in time: contact force at every step (N), and its cost."""
        scene, mbs = self.scene, self.mbs
        duration, step = scene["run"]["duration"], self.step
        settings = self.settings()
        integration = settings.timeIntegration
        integration.numberOfSteps = round(duration / step)
        integration.endTime = duration
        integration.generalizedAlpha.spectralRadius = scene["solver"]["rho_inf"]
        self.taut = self.elongation(self.start) > 0.0
        self.python_time, self.force = 0.0, []
        mbs.SetPreStepUserFunction(self.before_step)
        begin, begin_cpu = time.perf_counter(), time.process_time()
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha, storeSolver=True)
        wall, cpu = time.perf_counter() - begin, time.process_time() - begin_cpu
        self.force.append(self.contact())
        steps = mbs.sys["dynamicSolver"].it
        return np.array(self.force), {
            "wall_s": wall,
            "cpu_s": cpu,
            "python_s": self.python_time,
            "newton_iterations": steps.newtonStepsCount,
            "jacobians": steps.newtonJacobiCount,
        }


def main():
    with open(pathlib.Path(__file__).with_name("scene.toml"), "rb") as file:
        scene = tomllib.load(file)
    with open(sys.argv[1]) as file:
        statics = json.load(file)["statics"]
    line = Line(scene, statics)
    force, cost = line.run()
    np.save(sys.argv[2], force)
    checks = {
        "coordinates": line.coordinates,
        "level_m": line.level,
        "dropper_force_N": line.dropper_difference,
        "start_force_N": line.start_force,
    }
    print(json.dumps(cost | checks))


if __name__ == "__main__":
    main()
