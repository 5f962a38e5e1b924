#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""measure_repeats.py DFDYN [FOLDER]: diagnoses every recording of one UR5 with motion, with the same torque constants, and prints the tables of
docs/results/diagnosis-cases.md: each joint's friction by run, its scatter compared with plain least squares, the number of intervals that
contain the mean of all runs, and the agreement of the named causes (Jaccard index). FOLDER (build/repeats) receives the diagnoses."""

import csv
import itertools
import json
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "tests" / "data" / "ur5_kufieta"
ROBOT = ROOT / "tests" / "data" / "robots" / "ur5" / "ur5_robot.urdf"
TORQUE_CONSTANTS = "8.2,11.4,9.4,7.0,11.0,1.3"  # N·m/A, estimated from No6 alone
JOINTS = range(1, 7)
NAMED = 0.5  # least confidence of a named cause
LEAST_TRAVEL = 0.05  # rad; joints that move less have no friction to be seen
FRICTION = {"coulomb_friction": "coulomb", "viscous_friction": "viscous"}  # and its coefficient in least squares


def diagnosed(dfdyn, logs, folder, *more):
    """Returns the diagnosis of recordings. `more`: further options."""
    command = [
        dfdyn, "diagnose", "--robot", ROBOT, "--tip", "ee_link", "--outputs", "i", "--skip-bad-rows", "--log",
        ",".join(map(str, logs)), "--torque-constants", TORQUE_CONSTANTS, "--quiet", "-o", folder, *more]
    status = subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode
    if status not in (0, 1):  # 1: refused, with the reason in the diagnosis
        sys.exit(f"{sys.argv[0]}: {logs}: status {status}")
    return json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def short_name(log):
    """Returns No5 for Movement_No5_Acc_slow_no_disturbance.csv, and No5, person for the run with a disturbance."""
    parts = log.stem.split("_")
    suffix = {"WDist": ", person", "ForceSensor": ", sensor"}.get(parts[-1], "")
    return parts[1] + (", person" if log.stem.endswith(("w_disturbance", "with_disturbance")) else suffix)


def moving_joints(log):
    """Returns the joints that move in a recording."""
    with open(log, encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    travel = {joint: [float(row[f"q{joint}"]) for row in rows] for joint in JOINTS}
    return {joint for joint, positions in travel.items() if max(positions) - min(positions) >= LEAST_TRAVEL}


def main_value(diagnosis, effect, joint):
    """Returns the mean of the levels and the interval of a named cause, or None."""
    for finding in diagnosis["findings"]:
        if finding["effect"] == effect and finding["where"] == f"joint{joint}" and finding["confidence"] >= NAMED:
            values = [one["value"] for one in finding["parameters"]]
            lows, highs = zip(*(one["ci95"] for one in finding["parameters"]))
            return statistics.mean(values), min(lows), max(highs)
    return None


def scatter(values):
    """Returns the coefficient of variation in %."""
    return 100 * statistics.stdev(values) / abs(statistics.mean(values)) if len(values) > 1 else float("nan")


def jaccard(sets):
    """Returns the mean Jaccard index of all pairs."""
    return statistics.mean(len(a & b) / max(1, len(a | b)) for a, b in itertools.combinations(sets, 2))


def friction_table(runs, moving, effect, coefficient):
    """Prints the values of one kind of friction. Returns the number of intervals that contain the mean of the runs, and their number.
    `moving`: the joints that move in each run."""
    print(f"\n| joint | {' | '.join(runs)} | scatter (%) | of least squares |")
    print("| --- |" + " ---: |" * (len(runs) + 2))
    held = named = 0
    for joint in JOINTS:
        found = [main_value(run, effect, joint) for run in runs.values()]
        values = [one[0] for one in found if one]
        plain = [run["least_squares"]["coefficients"][joint - 1][coefficient] for name, run in runs.items() if joint in moving[name]]
        cells = " | ".join(f"{one[0]:.3g}" if one else "–" for one in found)
        print(f"| {joint} | {cells} | {scatter(values):.0f} | {scatter(plain):.0f} |")
        if values:
            mean = statistics.mean(values)
            named += len(values)
            held += sum(one[1] <= mean <= one[2] for one in found if one)
    return held, named


def logs_of_arm():
    """Returns the recordings of the arm in motion."""
    return sorted(DATA.glob("Movement_No*.csv"), key=lambda log: (int(log.stem.split("_")[1][2:]), log.stem))


def named_causes(diagnosis):
    """Returns effect and place of the named causes."""
    return {(one["effect"], one["where"]) for one in diagnosis["findings"] if one["confidence"] >= NAMED}


def main():
    """Diagnoses the runs and prints the tables."""
    dfdyn = sys.argv[1]
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "build/repeats")
    logs = logs_of_arm()
    runs = {short_name(log): diagnosed(dfdyn, [log], folder / log.stem) for log in logs}
    moving = {short_name(log): moving_joints(log) for log in logs}
    refused = [name for name, run in runs.items() if run["refused"]]
    runs = {name: run for name, run in runs.items() if not run["refused"]}
    print(f"{len(runs)} runs; refused: {', '.join(refused) or 'none'}")
    counts = [friction_table(runs, moving, *one) for one in FRICTION.items()]
    held, named = (sum(column) for column in zip(*counts))
    print(f"\nof {named} values of friction {held} have an interval that contains the mean of the runs")
    causes = [named_causes(run) for run in runs.values()]
    print(f"named causes agree by a Jaccard index of {jaccard(causes):.2f}, mean of all pairs of runs")


if __name__ == "__main__":
    main()
