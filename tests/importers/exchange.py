"""Settings of every importer: the same two FMUs, the same connections, the same step."""
import csv
import json
import sys
import time
import zipfile
from xml.etree import ElementTree

STRIP = [f"strip[1].{name}" for name in ("x", "y", "z", "vx", "vy", "vz", "roll")]
LOAD = [f"contact[1].{name}" for name in ("fx", "fy", "fz", "y")]

# From an FMU's output to the other one's input of the same name.
CONNECTIONS = [("Pantograph", "Catenary", name) for name in STRIP] + [("Catenary", "Pantograph", name) for name in LOAD]

# `contact[1].force` follows inputs that were set since the step; the last sample is the force at the end of the step.
FORCE = "contact[1].sample[10]"
HEIGHT = "strip[1].z"


class Plan:
    """A comparison, as `tests/importers.rs` writes it."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            plan = json.load(file)
        self.fmus = plan["fmus"]
        self.nanoseconds = plan["nanoseconds"]
        self.step = self.nanoseconds * 1e-9
        self.steps = plan["steps"]
        self.parameters = plan["parameters"]

    @classmethod
    def given(cls):
        """The plan and the table that the command line names."""
        return cls(sys.argv[1]), sys.argv[2]


class Description:
    """Part of `modelDescription.xml` for importers that connect by value references."""

    def __init__(self, path):
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        self.references = {v.get("name"): int(v.get("valueReference")) for v in root.find("ModelVariables")}

    def __getitem__(self, name):
        return self.references[name]


class Table:
    """Force and height at the end of each step, and the wall time since the table was made."""

    def __init__(self):
        self.rows = []
        self.begin = time.perf_counter()

    def add(self, force, height):
        self.rows.append((repr(float(force)), repr(float(height))))

    def write(self, path, importer, version):
        """Writes the rows, and prints the name of the importer."""
        wall = time.perf_counter() - self.begin
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(("force", "z"))
            writer.writerows(self.rows)
        print(json.dumps({"importer": importer, "version": version, "wall": wall}))
