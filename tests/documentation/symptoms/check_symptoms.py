#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_symptoms.py DFDYN [--long]: every message that docs/guide/troubleshooting.md quotes is in the sources (for names and options see
troubleshooting_test.cpp). With --long it also produces a part of messages and names: spoils a recording, a description or a model, runs the program, and searches the message in its output."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent.parent
DATA = SOURCE / "tests" / "data"
NO6 = DATA / "ur5_kufieta" / "Movement_No6_Acc_slow_Verify_Model.csv"
UR5 = ["--robot", DATA / "robots" / "ur5" / "ur5_robot.urdf", "--tip", "ee_link"]
DEVICES = DATA / "can" / "devices"
LEAST_SYMPTOMS = 30


def quotations():
    """Returns (number of symptoms, messages, names) of the page."""
    rows = re.findall(r"^\| (?!what you see|---)(.*) \|$", (SOURCE / "docs" / "guide" / "troubleshooting.md").read_text(), re.MULTILINE)
    quoted = [part.strip() for row in rows for one in re.findall(r'"([^"]+)"', row) for part in one.split("…")]
    return len(rows), [one for one in quoted if one], [name for row in rows for name in re.findall(r"`([a-z_0-9]+)`", row)]


def sources():
    """Returns the text of the product's sources; literals that are continued on the next line are joined."""
    files = [one for folder in ("tools", "hal", "firmware_lib") for one in (SOURCE / folder).rglob("*.?pp")]
    return re.sub(r'"\s*\n\s*"', "", "\n".join(one.read_text() for one in files))


class Trial:
    """Spoils copies of a recording of 27 s and runs the program on them."""

    def __init__(self, dfdyn, folder):
        self.dfdyn, self.folder, self.shown = dfdyn, folder, []
        with NO6.open() as file:
            names = next(file).strip().split(",")
            kept = [names.index(name) for name in ["t"] + [kind + str(joint) for kind in "qi" for joint in range(1, 7)]]
            self.rows = [[float(line.split(",")[column]) for column in kept] for line, _ in zip(file, range(3421))]
        self.header = [names[column] for column in kept]
        self.run("train", *self.quickly(), "-o", "model.json", "--log", self.recording(self.rows))

    @staticmethod
    def quickly():
        return ["--outputs", "i", "--features", 20, "--likelihood-rows", 100, "--starts", 1, "--quiet"]

    def recording(self, rows, name="run.csv"):
        text = [",".join(self.header)] + [",".join(f"{value:.9g}" for value in row) for row in rows]
        (self.folder / name).write_text("\n".join(text) + "\n")
        return name

    def scaled(self, first, last, factor):
        """Returns the rows with the columns `first` to `last` times `factor`."""
        return [[value * factor if first <= column <= last else value for column, value in enumerate(row)] for row in self.rows]

    def run(self, *words):
        done = subprocess.run(list(map(str, [self.dfdyn, *words])), cwd=self.folder, capture_output=True, text=True, check=False)
        return done.stdout + done.stderr

    def shows(self, message, output):
        """Registers that the output has the message."""
        assert message in output, f"expected {message!r} in the output:\n{output}"
        self.shown.append(message)

    def train(self, rows, *words):
        return self.run("train", *self.quickly(), "-o", "other.json", "--log", self.recording(rows), *words)

    def replay(self, rows, *words):
        return self.run("replay", "--quiet", "--log", self.recording(rows), *(words or ["--model", "model.json"]))


def recordings(trial):
    """Messages of training and replay."""
    rows = trial.rows
    trial.shows("looks like degrees", trial.train(trial.scaled(1, 6, 57.3)))
    trial.shows("looks like milliseconds", trial.train(trial.scaled(0, 0, 1000)))
    trial.shows("looks like mA", trial.train(trial.scaled(7, 12, 1000)))
    trial.shows("expected the sign of the robot's model, found the opposite", trial.train(trial.scaled(7, 12, -1), *UR5))
    trial.shows("training data: expected at least", trial.train(rows[:25]))
    trial.shows("expected room for the smallest model", trial.run("train", "--log", trial.recording(rows), "--outputs", "i", "--flash", "2K",
                                                                  "--quiet", "-o", "other.json"))
    columns = trial.run("train", "--log", "run.csv", "--outputs", "tau", "-o", "other.json")
    trial.shows("expected columns t, q1,", columns)
    trial.shows("found no tau1", columns)
    trial.shows("expected a link", trial.run("train", "--log", "run.csv", "--outputs", "i", UR5[0], UR5[1], "--tip", "hand", "-o", "other.json"))
    trial.shows("expected a time after that of the row before", trial.replay(rows[:100] + rows[99:]))
    trial.shows("nothing was predicted:", trial.replay(rows[::3]))
    lossy = trial.replay([row for number, row in enumerate(rows) if number % 40])
    trial.shows("gap", lossy)
    trial.shows("window_filling", lossy)
    changed = trial.replay(rows[:1500] + trial.scaled(7, 7, 10)[1500:])
    trial.shows("innovation_too_large", changed)
    trial.shows("prediction_bounded", changed)
    trial.run("train", *trial.quickly(), "-o", "physics.json", "--model", "SPK", *UR5, "--log", trial.recording(rows))
    far = [[value + 20 * (number == 1000 and column == 1) for column, value in enumerate(row)] for number, row in enumerate(rows)]
    outside = trial.replay(far, "--model", "physics.json")
    trial.shows("input_out_of_range", outside)
    trial.shows("identified rigid body", outside)
    trial.shows("beyond the budget: flash", trial.run("footprint", "--model", "model.json", "--flash", "10K"))


def whole_recording(trial):
    """A reversed current, found from friction alone; the diagnosis."""
    names, *lines = NO6.read_text().splitlines()
    column = names.split(",").index("i1")
    reversed_rows = [",".join(str(-float(value)) if place == column else value for place, value in enumerate(line.split(","))) for line in lines]
    (trial.folder / "reversed.csv").write_text("\n".join([names, *reversed_rows]) + "\n")
    trial.shows("expected an output that overcomes the joint's friction, found one that falls when the joint begins to move",
                trial.run("train", *trial.quickly(), "--log", "reversed.csv", "-o", "other.json"))
    diagnosis = trial.run("diagnose", *UR5, "--log", NO6, "--outputs", "i", "--quiet", "-o", "diagnosis")
    trial.shows("the causes found err more than plain least squares per joint", diagnosis)
    trial.shows("expected a new or empty folder, found files in it", trial.run("start", "--log", NO6, "--outputs", "i", "-o", "diagnosis"))
    jittering = DATA / "ur5_kufieta" / "Movement_No3_Acc.csv"
    trial.shows("the time steps are not constant:", trial.run("start", "--log", jittering, "--outputs", "i", "--quick", "-o", "look"))


def small_motion(trial):
    """A payload and an error of the last link do nearly the same while the arm moves little."""
    arm = ["--robot", DATA / "robots" / "small_arm" / "small_arm.urdf"]
    scenario = json.loads((DATA / "scenarios" / "small_arm.json").read_text())
    scenario["recording"].update(samples=3000, columns=["q", "tau"])
    scenario["task"]["amplitude_rad"] = [0.33, 0.39]
    scenario["payloads"] = [{"mass_kg": 0.5, "centre_m": [0, 0, 0.1]}]
    (trial.folder / "small_motion.json").write_text(json.dumps(scenario))
    trial.run("simulate", *arm, "--scenario", "small_motion.json", "-o", "small_motion.csv", "--quiet")
    trial.shows("this motion hardly distinguishes it from:",
                trial.run("diagnose", *arm, "--tip", "tool", "--log", "small_motion.csv", "--outputs", "tau", "--quiet", "-o", "small_motion"))


def buses_and_loops(trial):
    """Findings of buscheck, a stop of a loop, a snapshot of another model."""
    described = json.loads((DEVICES / "damiao.json").read_text())
    described["joints"]["boards"][0].update(motor_id=4, feedback_id="0x14")
    (trial.folder / "wrong.json").write_text(json.dumps(described))
    trial.shows("wrong_identifier", trial.run("buscheck", "--log", DEVICES / "damiao.log", "--bus", "wrong.json"))
    trial.shows("silent_source", trial.run("buscheck", "--log", DEVICES / "damiao.log", "--bus", DEVICES / "moteus.json"))
    loop = ["loop", "--simulate", "--quiet"]
    trial.shows("frozen_encoder", trial.run(*loop, *UR5[:2], "--scenario", DATA / "loop_faults" / "encoder_frozen.json", "--bus",
                                            DATA / "can" / "ur5_loop.json", "--duration", 45))
    arm = ["--robot", DATA / "robots" / "small_arm" / "small_arm.urdf", "--scenario"]
    trial.run("simulate", *arm, DATA / "scenarios" / "small_arm.json", "-o", "arm.csv")
    for name, features in (("small.json", 20), ("large.json", 30)):
        trial.run("train", "--log", "arm.csv", "--outputs", "tau", "--features", features, "--likelihood-rows", 100, "--starts", 1, "-o", name)
    arm += [DATA / "scenarios" / "small_arm_loop.json", "--duration", 2]
    trial.run(*loop, *arm, "--model", "small.json", "--save", "learned")
    trial.shows("has learned, whole, found something else", trial.run(*loop, *arm, "--model", "large.json", "--restore", "learned"))


def compiler(trial):
    """A flag that the library refuses."""
    (trial.folder / "one.cpp").write_text("#include <dfdyn/dfdyn.hpp>\n")
    done = subprocess.run(["c++", "-std=c++20", "-ffast-math", f"-I{SOURCE}/firmware_lib/include", "-fsyntax-only", "one.cpp"],
                          cwd=trial.folder, capture_output=True, text=True, check=False)
    trial.shows("dfdyn does not work with -ffast-math, -Ofast or -ffinite-math-only", done.stderr)


def main():
    symptoms, quoted, names = quotations()
    program = sources()
    missing = [one for one in quoted if one not in program and one not in COMPOSED]
    print(f"{symptoms} symptoms, {len(quoted)} messages; not in the sources: {missing or 'none'}")
    if sys.argv[2:] == ["--long"]:
        with tempfile.TemporaryDirectory() as scratch:
            trial = Trial(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(scratch))
            for part in (recordings, whole_recording, small_motion, buses_and_loops, compiler):
                part(trial)
        missing += [one for one in COMPOSED if one not in trial.shown]
        strangers = [one for one in trial.shown if one not in names and not any(one in text or text in one for text in quoted)]
        print(f"{len(trial.shown)} produced; not quoted on the page: {strangers or 'none'}")
        missing += strangers
    return 1 if missing or symptoms < LEAST_SYMPTOMS else 0


# Composed at run time from several literals; --long produces them.
COMPOSED = ("expected columns t, q1,", "found no tau1", "looks like milliseconds", "beyond the budget: flash")

if __name__ == "__main__":
    sys.exit(main())
