#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""measure_recording.py DFDYN [PICTURES]: adds common faults to recordings of a real UR5 (125 Hz), trains a model on each, and predicts,
without learning, the last 30 % of the original recording. Prints the errors of docs/guide/recording.md and draws its pictures
(with matplotlib). The error is the mean over the outputs of rms(error) / std(measured)."""

import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # pylint: disable=wrong-import-position

DATA = pathlib.Path(__file__).resolve().parent.parent / "tests" / "data" / "ur5_kufieta"
NO6 = DATA / "Movement_No6_Acc_slow_Verify_Model.csv"
NO9 = DATA / "Movement_No9_Singularity_Free_NoDist.csv"
JOINTS = 6
SHOWN = 2  # joint whose curve is drawn
TRAINING_SHARE = 0.7


def read(path):
    """Returns the columns t, q1..q6, i1..i6 of a recording."""
    names = ["t"] + [f"{kind}{joint + 1}" for kind in "qi" for joint in range(JOINTS)]
    with open(path, encoding="ascii") as file:
        header = file.readline().strip().split(",")
        rows = numpy.loadtxt(file, delimiter=",")
    return rows[:, [header.index(name) for name in names]]


def low_pass(values, hertz, period):
    """Filters columns with a first-order low pass, as a drive does."""
    share = 1 - numpy.exp(-2 * numpy.pi * hertz * period)
    filtered = values.copy()
    for row in range(1, len(values)):
        filtered[row] = filtered[row - 1] + share * (values[row] - filtered[row - 1])
    return filtered


class Judge:
    """Trains on a table of rows, and judges on another."""

    def __init__(self, dfdyn, folder):
        self.dfdyn, self.folder = dfdyn, pathlib.Path(folder)

    def write(self, name, rows):
        header = ",".join(["t"] + [f"{kind}{joint + 1}" for kind in "qi" for joint in range(JOINTS)])
        numpy.savetxt(self.folder / name, rows, delimiter=",", header=header, comments="", fmt="%.9g")
        return self.folder / name

    def run(self, *words):
        done = subprocess.run([self.dfdyn, *map(str, words)], capture_output=True, text=True, check=False)
        return done.stdout if done.returncode == 0 else None

    def error(self, training, judging):
        """Returns the error; None if the set-up check refuses the recording."""
        model = self.folder / "model.json"
        if self.run("train", "--log", self.write("training.csv", training), "--outputs", "i", "--features", 60, "--starts", 1,
                    "--likelihood-rows", 300, "--window", 0.08, "--quiet", "-o", model) is None:
            return None
        text = self.run("replay", "--frozen", "--model", model, "--log", self.write("judging.csv", judging), "--json", "--quiet")
        return None if text is None else float(numpy.mean(json.loads(text)["recordings"][0]["nrmse"]))


def cut(rows, share=TRAINING_SHARE):
    """Divides rows into the first part and the rest."""
    at = int(share * len(rows))
    return rows[:at], rows[at:]


def changed(rows, columns, change):
    """Returns a copy of the rows whose columns `columns` are `change` of them."""
    copy = rows.copy()
    copy[:, columns] = change(copy[:, columns])
    return copy


def spoiled_recordings(rows):
    """Returns {title: [(name, training rows)]}, the recording as it was first."""
    period = float(numpy.median(numpy.diff(rows[:, 0])))
    positions, currents = slice(1, 1 + JOINTS), slice(1 + JOINTS, 1 + 2 * JOINTS)
    chance = numpy.random.default_rng(1)
    whole = ("as recorded", rows)
    limits = numpy.abs(rows[:, currents]).max(axis=0)
    delayed = lambda count: changed(rows, currents, lambda values: numpy.vstack([values[:1].repeat(count, 0), values[:-count]]))
    kept = lambda share: rows[numpy.sort(chance.choice(len(rows), int(share * len(rows)), replace=False))]
    return {
        "rate": [whole] + [(f"{125 / step:.3g} Hz", rows[::step]) for step in (2, 5, 10, 25)],
        "filter": [whole] + [(f"low pass {hertz} Hz", changed(rows, currents, lambda values, hertz=hertz: low_pass(values, hertz, period)))
                             for hertz in (10, 3, 1, 0.3)],
        "duration": [whole] + [(f"first {seconds} s", rows[:int(seconds / period)]) for seconds in (40, 20, 10, 5)],
        "delay": [whole] + [(f"{count * 8} ms late", delayed(count)) for count in (5, 12, 25, 62)],
        "rounding": [whole] + [(f"{step:g} rad", changed(rows, positions, lambda values, step=step: numpy.round(values / step) * step))
                               for step in (0.001, 0.01, 0.03)],
        "clipping": [whole] + [(f"at {share:.0%} of the peak", changed(rows, currents, lambda values, share=share: numpy.clip(
            values, -share * limits, share * limits))) for share in (0.5, 0.3, 0.2)],
        "lost rows": [whole] + [(f"{1 - share:.0%} lost", kept(share)) for share in (0.99, 0.95, 0.8)],
    }


def shown_span(title, rows):
    """Returns the times that the picture shows: the three seconds with the largest motion, for the duration everything."""
    if title == "duration":
        return rows[0, 0], rows[-1, 0]
    length = int(3 / numpy.median(numpy.diff(rows[:, 0])))
    travel = [numpy.ptp(rows[row:row + length, 1 + SHOWN]) for row in range(0, len(rows) - length, length // 4)]
    start = rows[int(numpy.argmax(travel)) * (length // 4), 0]
    return start, start + 3


def draw(path, title, curves, errors):
    """Draws a part of one column of each recording, and the errors."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 2.8), layout="constrained")
    column = 1 + SHOWN + (0 if title in ("rounding", "duration") else JOINTS)
    begin, end = shown_span(title, curves[0][1])
    for name, rows in curves:
        shown = rows[(rows[:, 0] >= begin) & (rows[:, 0] <= end)]
        left.plot(shown[:, 0], shown[:, column], linewidth=1, label=name,
                  marker="." if title in ("rate", "lost rows") else None, markersize=3)
    left.set_xlabel("time, s")
    left.set_ylabel(f"q{SHOWN + 1}, rad" if column <= JOINTS else f"i{SHOWN + 1}, A")
    left.legend(fontsize=7)
    names = [name for name, _ in errors]
    values = [0 if value is None else value for _, value in errors]
    right.barh(names, values, color=["#4a7" if row == 0 else "#58c" for row in range(len(names))])
    for row, (_, value) in enumerate(errors):
        right.text(values[row], row, " refused" if value is None else f" {value:.2f}", va="center", fontsize=8)
    right.invert_yaxis()
    right.set_xlabel("error on the rest of the recording")
    right.margins(x=0.2)
    figure.savefig(path, dpi=80)
    plt.close(figure)


def measure_motions(judge):
    """Prints the errors of models on another motion of the same arm."""
    print("motion")
    halves = {name: cut(read(path)) for name, path in (("No6", NO6), ("No9", NO9))}
    for trained in ("No6", "No9"):
        for judged, (_, rest) in halves.items():
            print(f"  trained on {trained}, judged on {judged}: {judge.error(halves[trained][0], rest):.2f}")


def main():
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(sys.argv[1], folder)
        training, judging = cut(read(NO6))
        for title, recordings in spoiled_recordings(training).items():
            rates = title == "rate"
            errors = []
            for name, rows in recordings:
                step = round(numpy.median(numpy.diff(rows[:, 0])) / numpy.median(numpy.diff(judging[:, 0]))) if rates else 1
                errors.append((name, judge.error(rows, judging[::step])))
            print(title)
            for name, value in errors:
                print(f"  {name}: {'refused' if value is None else f'{value:.2f}'}")
            if pictures:
                draw(pictures / f"recording_{title.replace(' ', '_')}.png", title, [recordings[0], recordings[-1]], errors)
        measure_motions(judge)


if __name__ == "__main__":
    main()
