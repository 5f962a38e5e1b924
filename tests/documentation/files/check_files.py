#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_files.py DFDYN [--long]: makes the program write its JSON and compares fields and types with the tables of docs/reference. --long
makes all files that need no CAN interface; without it, those that take a moment. A field without `optional` must be in each file."""

import json
import pathlib
import subprocess
import sys
import tempfile

from described_fields import SOURCE, complaints, described_columns, fields_of, read_tables

DATA = SOURCE / "tests" / "data"
UR5 = DATA / "ur5_kufieta"
NO6 = UR5 / "Movement_No6_Acc_slow_Verify_Model.csv"
PUSHED = UR5 / "Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv"
UR5_ROBOT = ["--robot", DATA / "robots" / "ur5" / "ur5_robot.urdf", "--tip", "ee_link"]
TX40 = DATA / "tx40_figaroh" / "tx40_5kHz.csv"
TX40_ROBOT = ["--robot", DATA / "robots" / "tx40" / "tx40.urdf", "--tip", "link_6"]
SMALL_ARM = DATA / "robots" / "small_arm" / "small_arm.urdf"
WITHOUT_CAN = {"dfdyn.playback/1"}  # not written without a CAN interface


class Writer:
    """Runs the program in a folder and collects the documents that it writes."""

    def __init__(self, dfdyn, folder):
        self.dfdyn, self.folder, self.documents = dfdyn, folder, []

    def run(self, *words, expected=(0,)):
        """Runs a command with --json and adds what it prints."""
        done = subprocess.run([self.dfdyn, *map(str, words), "--json"], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode in expected, f"{words}: status {done.returncode}: {done.stderr}"
        self.documents.append((" ".join(map(str, words[:1])), json.loads(done.stdout)))

    def add(self, *names):
        """Adds files that were written."""
        for name in names:
            self.documents.append((name, json.loads((self.folder / name).read_text())))

    def train(self, name, *words):
        self.run("train", "--starts", 1, "--likelihood-rows", 100, "--features", 20, "--quiet", "-o", name, *words)
        self.add(name)


def write_quick(writer):
    """Documents of a second."""
    log = ["--log", NO6, "--rows", ":2000", "--outputs", "i"]
    writer.train("np.json", *log)
    writer.train("dfsr.json", *log, "--input", "DFSR", "--units", "i=A")
    writer.train("std.json", *log, "--input", "STD", "--columns", "t=t")
    writer.train("cv.json", *log, "--input", "DF", "--lags", 3, "--hyper", "CV")
    writer.run("footprint", "--model", "np.json")
    writer.run("replay", "--model", "np.json", "--log", PUSHED, "--contacts", "--contact-list", "contacts.json",
               "-o", "out.csv")
    writer.add("contacts.json")
    devices = DATA / "can" / "devices"
    writer.run("buscheck", "--log", devices / "damiao.log")
    writer.run("buscheck", "--log", devices / "damiao.log", "--bus", devices / "moteus.json", expected=(0, 1))
    writer.run("convert", "--log", PUSHED, "--bus", DATA / "can" / "ur5_cia402.json", "-o", "run.log")


def write_long(writer):
    """Documents of minutes."""
    physics = ["--log", NO6, "--outputs", "i", *UR5_ROBOT]
    effects = ["--effects", "viscous_friction,coulomb_friction,stribeck_friction,torque_offset"]
    writer.train("p.json", *physics, "--model", "P", "--input", "DFSR", "--lags", 12, "--forgetting", 0.9999, *effects)
    writer.train("spk.json", *physics, "--rows", ":2000", "--model", "SPK", *effects)
    writer.train("sp.json", *physics, "--rows", ":2000", "--model", "SP")
    writer.train("p_std.json", *physics, "--rows", ":2000", "--model", "P", "--input", "STD")
    writer.run("replay", "--model", "p.json", *UR5_ROBOT, "--monitor", "--changes", "changes.json", "--log", f"{NO6},{PUSHED}")
    writer.add("changes.json")
    write_arm(writer)
    writer.run("identify", *TX40_ROBOT, "--log", TX40, "--outputs", "tau", "--consistent", "-o", "parameters.json")
    writer.add("parameters.json")
    writer.run("diagnose", *TX40_ROBOT, "--log", TX40, "--outputs", "tau", "--no-held-out", "--export", "json", "-o", "tx40")
    writer.add("tx40/diagnosis.json", "tx40/extended_model.json", "tx40/corrected_robot.json")
    writer.run("diagnose", *UR5_ROBOT, "--log", NO6, "--outputs", "i", "-o", "ur5")
    writer.add("ur5/diagnosis.json", "ur5/extended_model.json")
    write_experiment(writer)
    writer.run("bench", "--quick", "--loop", 1, "-o", "bench")
    writer.add("bench/bench.json")


def write_arm(writer):
    """Simulated arm: loop, a wrench, and `start` on a recording that is too short for a diagnosis."""
    scenarios = DATA / "scenarios"
    subprocess.run([writer.dfdyn, "simulate", "--robot", SMALL_ARM, "--scenario", scenarios / "small_arm.json", "-o", "arm.csv"],
                   cwd=writer.folder, check=True, capture_output=True)
    robot = ["--robot", SMALL_ARM]
    writer.train("arm.json", "--log", "arm.csv", "--outputs", "tau", "--model", "P", *robot, "--tip", "tool", "--no-setup-check")
    writer.train("wrench.json", "--log", "arm.csv", "--outputs", "wrench", "--model", "P", *robot, "--tip", "tool", "--no-setup-check")
    writer.run("loop", "--simulate", "--duration", 11, *robot, "--scenario", scenarios / "small_arm_loop.json", "--model", "arm.json",
               "-o", "loop")
    writer.add("loop/changes.json")
    rows = TX40.read_text().splitlines()
    (writer.folder / "short.csv").write_text("\n".join([rows[0], *rows[1:15001:10]]) + "\n")
    writer.run("start", "--log", "short.csv", *TX40_ROBOT, "--quick", "--flash", "48K", "--ram", "12K", "-o", "controller")
    writer.add("controller/model.json", "controller/diagnosis.json")
    writer.run("footprint", "--model", "controller/model.json")


def write_experiment(writer):
    """A plan with one case."""
    plan = {"schema": "dfdyn.plan/1", "name": "p", "title": "t", "outputs": "i",
            "training": {"log": str(NO6), "start_rows": 1500, "rows": 3000},
            "tests": [{"log": str(UR5 / "Movement_No7_Acc_slow_Verify_Model_short.csv"), "rows": 1500}],
            "groups": [{"name": "all", "outputs": ["i1", "i2"]}],
            "cases": [{"model": "NP", "input": "DFR", "hyper": "ML", "features": 20}]}
    (writer.folder / "plan.json").write_text(json.dumps(plan))
    writer.run("evaluate", "--plan", "plan.json", "-o", "evaluation")
    writer.add("evaluation/cases/NP-ML-DFR/1.json")


def check_predictions(path):
    """Compares the header of the predictions with their table; NAME is each of the outputs."""
    header = path.read_text().split("\n", 1)[0].split(",")
    outputs = [name.removesuffix("_pred") for name in header if name.endswith("_pred")]
    expected = []
    for column in described_columns("Predictions"):
        expected += [column.replace("NAME", output) for output in outputs] if "NAME" in column else [column]
    assert sorted(header) == sorted(expected), f"{path.name}: expected the columns {expected}, found {header}"


def main():
    tables = read_tables()
    with tempfile.TemporaryDirectory() as scratch:
        writer = Writer(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(scratch))
        write_quick(writer)
        check_predictions(writer.folder / "out.csv")
        everything = sys.argv[2:] == ["--long"]
        if everything:
            write_long(writer)
    schemas = {name: fields_of(tables, name) for name in tables if name.startswith("dfdyn.")}
    wrong, seen = [], set()
    for name, document in writer.documents:
        schema = document["schema"]
        seen.add(schema)
        found = complaints(document, schemas[schema]) if schema in schemas else [f"no table describes {schema}"]
        wrong += [f"{name} ({schema}): {one}" for one in found]
    if everything:
        wrong += [f"{schema}: no file of this test" for schema in sorted(set(schemas) - seen - WITHOUT_CAN)]
        for schema, fields in schemas.items():
            unseen = [field.path for field in fields if not field.seen]
            if unseen and schema in seen:
                print(f"{schema}: in no file of this test: {', '.join(unseen)}")
    print(*wrong, sep="\n")
    print(f"{len(writer.documents)} documents of {len(seen)} kinds, {len(wrong)} complaints")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
