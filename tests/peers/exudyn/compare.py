#!/usr/bin/env python3
"""Compares this program with Exudyn on the same line, mesh, step, tolerance and contact law: wall times, and the
difference of the contact forces. Needs Python 3.11 or later and, the first time, a way to the Python package index.

    python3 tests/peers/exudyn/compare.py [--repeats 3]
"""

import argparse
import csv
import hashlib
import json
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SCENE = HERE / "scene.toml"

# Goals of the comparison.
FASTER, SIGMA_PERCENT = 20.0, 1.0


def environment():
    """Python of a virtual environment with the pinned packages, made if missing."""
    pins = (HERE / "requirements.txt").read_bytes()
    folder = ROOT / "target" / "peers" / f"exudyn-{hashlib.sha256(pins + sys.version.encode()).hexdigest()[:12]}"
    python = folder / "bin" / "python"
    done = folder / "complete"
    if not done.exists():
        print(f"making {folder}", file=sys.stderr)
        subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--requirement", HERE / "requirements.txt"], check=True)
        done.touch()
    return python


def cpu_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_ours(master, folder):
    """A monolithic run: (series of the contact force, cost)."""
    before = cpu_of_children()
    done = subprocess.run(
        [master, "run", SCENE, "--mode", "monolithic", "--out", folder, "--quiet", "--json"], check=True, stdout=subprocess.PIPE
    )
    cpu = cpu_of_children() - before
    summary = json.loads(done.stdout)
    with open(folder / "timeseries.csv", newline="") as file:
        force = [float(row["contact[1].force"]) for row in csv.DictReader(file)]
    cost = summary["cost"]
    return force, {
        "wall_s": cost["wall_s"],
        "cpu_s": cpu,
        "newton_iterations": cost["newton_iterations"],
        "jacobians": cost["factorizations"],
        "coordinates": summary["model"]["coordinates"],
    }


def run_theirs(statics, folder):
    """A run in Exudyn, in a process of its own."""
    import numpy

    series = folder / "force.npy"
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, HERE / "model.py", statics, series], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment
    )
    if done.returncode != 0:
        raise SystemExit(f"Exudyn did not complete:\n{done.stdout[-4000:]}")
    return numpy.load(series), json.loads(done.stdout.strip().splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3, help="runs of each program, by turns (default 3)")
    parser.add_argument("--master", type=pathlib.Path, help="the program (default: target/release/master, built first)")
    options = parser.parse_args()
    python = environment()
    if pathlib.Path(sys.prefix) != python.parent.parent:
        os.execv(python, [python, __file__, *sys.argv[1:]])
    import numpy
    from scipy import signal

    master = options.master or ROOT / "target" / "release" / "master"
    if options.master is None:
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "--package", "master"], cwd=ROOT, check=True)
    with open(SCENE, "rb") as file:
        scene = tomllib.load(file)
    run = scene["run"]

    ours, theirs = [], []
    with tempfile.TemporaryDirectory(prefix="exudyn-", dir=ROOT / "target") as folder:
        folder = pathlib.Path(folder)
        statics = folder / "statics.json"
        with open(statics, "wb") as file:
            subprocess.run([master, "check", SCENE, "--json"], check=True, stdout=file)
        for turn in range(options.repeats):
            print(f"turn {turn + 1} of {options.repeats}", file=sys.stderr)
            our_force, cost = run_ours(master, folder / "ours")
            ours.append(cost)
            their_force, cost = run_theirs(statics, folder)
            theirs.append(cost)

    # Butterworth of order 4, forward and backward, over the whole record; then the range of evaluation.
    low_pass = signal.butter(4, run["low_pass_hz"], fs=1.0 / run["output_step"], output="sos")
    first, last = (round(t / run["output_step"]) for t in run["evaluate"]["time"])
    raw = [numpy.asarray(series)[first : last + 1] for series in (our_force, their_force)]
    filtered = [signal.sosfiltfilt(low_pass, series)[first : last + 1] for series in (our_force, their_force)]
    median = lambda runs, key: statistics.median(cost[key] for cost in runs)
    steps = run["duration"] / scene["solver"]["micro_step"]
    row = "{:<58}{:>14}{:>14}".format
    print(row("", "this program", "Exudyn"))
    for text, key, digits in (
        ("coordinates", "coordinates", 0),
        ("wall time of the time loop, s (median)", "wall_s", 3),
        ("CPU time, s (median; ours with set-up, theirs time loop)", "cpu_s", 3),
    ):
        print(row(text, *(f"{median(runs, key):.{digits}f}" for runs in (ours, theirs))))
    print(row("real-time factor", *(f"{median(runs, 'wall_s') / run['duration']:.4f}" for runs in (ours, theirs))))
    print(row("of which Python, s (median)", "0", f"{median(theirs, 'python_s'):.3f}"))
    print(row("Newton iterations per step", *(f"{median(runs, 'newton_iterations') / steps:.2f}" for runs in (ours, theirs))))
    print(row("factorisations", *(f"{median(runs, 'jacobians'):.0f}" for runs in (ours, theirs))))
    for text, of in (("mean of the filtered force, N", numpy.mean), ("standard deviation of the filtered force, N", numpy.std)):
        print(row(text, *(f"{of(series):.4f}" for series in filtered)))
    print(row("contact lost, % of the time", *(f"{100 * numpy.mean(series == 0.0):.3f}" for series in raw)))

    sigma = [series.std() for series in filtered]
    difference = 100 * (sigma[1] / sigma[0] - 1)
    rms = [100 * numpy.sqrt(numpy.mean((a - b) ** 2)) / sigma[0] for a, b in (filtered, raw)]
    costs = theirs[-1]
    print()
    print(f"statics: droppers within {costs['dropper_force_N']:.1e} N, contact wire level within {costs['level_m']:.1e} m")
    print(f"force at the start: {our_force[0]:.6f} N and {costs['start_force_N']:.6f} N")
    print(f"standard deviation: {difference:+.4f} %; rms difference of the filtered force {rms[0]:.4f} %, of the raw force {rms[1]:.4f} %")
    loop = median(theirs, "wall_s")
    ratio = loop / median(ours, "wall_s")
    compiled = (loop - median(theirs, "python_s")) / median(ours, "wall_s")
    print(f"Exudyn takes {ratio:.1f} times as long ({compiled:.1f} times without its Python part)")
    print(f"machine: {platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; one thread each; {options.repeats} runs each, by turns")
    fast, near = ratio >= FASTER, abs(difference) <= SIGMA_PERCENT
    print(f"{FASTER:.0f} times faster: {'yes' if fast else 'no'}; standard deviation within {SIGMA_PERCENT:.0f} %: {'yes' if near else 'no'}")
    return 0 if near else 1


if __name__ == "__main__":
    sys.exit(main())
