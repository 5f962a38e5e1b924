# SPDX-License-Identifier: Apache-2.0
"""Makes every kind of page that the program writes, with the figures that the command's JSON has for it."""

import csv
import json
import pathlib
import subprocess

DATA = pathlib.Path(__file__).resolve().parent.parent.parent / "data"
UR5 = DATA / "ur5_kufieta"
NO6 = UR5 / "Movement_No6_Acc_slow_Verify_Model.csv"
NO7 = UR5 / "Movement_No7_Acc_slow_Verify_Model_short.csv"
PUSHED = UR5 / "Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv"
TX40 = DATA / "tx40_figaroh" / "tx40_5kHz.csv"
TX40_ROBOT = ["--robot", DATA / "robots" / "tx40" / "tx40.urdf", "--tip", "link_6"]
EPOCH_S = 1_700_000_000  # a time since 1970, which a page shows as a date


class Pages:
    """Runs the program in a folder. `pages` is {name: (page, [(row, column, value)])}: numbers of its tables."""

    def __init__(self, dfdyn, folder):
        self.dfdyn, self.folder, self.pages = dfdyn, folder, {}

    def run(self, *words, expected=0):
        """Returns the JSON that a command prints."""
        done = subprocess.run([self.dfdyn, *map(str, words), "--json", "--quiet"], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == expected, f"{words}: status {done.returncode}: {done.stderr}"
        return json.loads(done.stdout)

    def add(self, name, page, figures):
        assert figures, f"{name}: expected figures"
        self.pages[name] = self.folder / page, figures


def train(pages):
    pages.run("train", "--outputs", "i", "--lags", 10, "--features", 30, "--likelihood-rows", 100, "--starts", 1, "--log", NO6,
              "--rows", ":3421", "-o", "model.json")


def errors_of(replay):
    """Returns the errors of a replay as figures, also those of the forecasts for comparison."""
    figures = []
    for name, errors in [("nRMSE, one step", replay["recordings"][0]["nrmse"]),
                         ("share within 2σ", replay["recordings"][0]["within_two_deviations"]),
                         *[(f"nRMSE, one step, {one['name']}", one["nrmse"]) for one in replay["recordings"][0]["others"]]]:
        figures += [(name, output, value) for output, value in zip(replay["outputs"], errors) if value is not None]
    return figures


def replays(pages):
    """A replay with contacts; one with dates, a gap and two models."""
    replay = pages.run("replay", "--model", "model.json", "--contacts", "--report", "replay.html", "--log", PUSHED)
    pages.add("replay", "replay.html", errors_of(replay))
    with PUSHED.open() as file:
        rows = list(csv.reader(file))
    time = rows[0].index("t")
    for number, row in enumerate(rows[1:]):
        row[time] = f"{EPOCH_S + float(row[time]) + 5 * (number > 1500):.6f}"
    with (pages.folder / "dated.csv").open("w") as file:
        csv.writer(file).writerows(rows)
    dated = pages.run("replay", "--model", "model.json,model.json", "--report", "dated.html", "--log", "dated.csv")
    pages.add("replay_dated", "dated.html", errors_of(dated))


def diagnosis_figures(document):
    """Returns the errors before and after of each output, and of each likely cause."""
    figures = []
    for place, output in enumerate(document["outputs"]):
        figures += [(output, "simulated, rms", document["nominal"]["rms"][place]),
                    (output, "extended, rms", document["extended"]["rms"][place])]
    for one in (one for one in document["findings"] if one["confidence"] >= 0.5):
        cause = f"{one['effect'].replace('_', ' ')} at {one['where']}"
        figures += [(cause, "confidence", one["confidence"]), (cause, "after", one["gain"]["rms_after"])]
    return figures


def diagnoses(pages):
    """A diagnosis, and one that is refused."""
    found = pages.run("diagnose", *TX40_ROBOT, "--log", TX40, "--outputs", "tau", "--no-held-out", "-o", "diagnosis")
    pages.add("diagnosis", "diagnosis/report.html", diagnosis_figures(found))
    lines = TX40.read_text().splitlines()
    reversed_torque = [lines[0].replace("tau1", "x").replace("tau2", "tau1").replace("x", "tau2"), *lines[1:]]
    (pages.folder / "exchanged.csv").write_text("\n".join(reversed_torque) + "\n")
    refused = pages.run("diagnose", *TX40_ROBOT, "--log", "exchanged.csv", "--outputs", "tau", "--no-held-out", "-o", "refused", expected=1)
    pages.pages["refused"] = pages.folder / "refused" / "report.html", [(None, None, refused["refusals"][0]["text"])]


def start(pages):
    """The pages in the folder of `start`; the recording is too short for a diagnosis."""
    lines = TX40.read_text().splitlines()
    (pages.folder / "short.csv").write_text("\n".join([lines[0], *lines[1::5]]) + "\n")
    pages.run("start", "--log", "short.csv", *TX40_ROBOT, "--quick", "--flash", "48K", "--ram", "24K", "-o", "controller")
    found = json.loads((pages.folder / "controller" / "diagnosis.json").read_text())
    judged = pages.run("replay", "--model", "controller/model.json", "--log", "short.csv", "--rows", f"{int(0.7 * len(lines[1::5]))}:")
    pages.add("start", "controller/report.html", errors_of(judged))
    pages.add("start_diagnosis", "controller/diagnosis.html", diagnosis_figures(found))


def loop(pages):
    arm = DATA / "robots" / "small_arm" / "small_arm.urdf"
    result = pages.run("loop", "--simulate", "--duration", 11, "--robot", arm, "--scenario", DATA / "scenarios" / "small_arm_loop.json",
                       "-o", "loop")
    figures = [(f"{window['start_s']:g} to {window['end_s']:g}", run["name"], 1e3 * window["rms_all_rad"])
               for run in result["runs"] for window in run["windows"]]
    pages.add("loop", "loop/tracking.html", figures)


def evaluation(pages):
    """Two cases with a claim and a finding; figures of results.csv."""
    plan = {"schema": "dfdyn.plan/1", "name": "inputs", "title": "Two inputs", "outputs": "i",
            "training": {"log": str(NO6), "start_rows": 2500, "rows": 5000},
            "tests": [{"log": str(NO7), "rows": 1500, "count": 2}], "draws": 2, "steady_after_s": 5,
            "groups": [{"name": "shoulder", "outputs": ["i1", "i2"]}],
            "defaults": {"features": 20, "likelihood_rows": 150, "starts": 1},
            "cases": [{"model": "NP", "input": ["DFR", "DFSR"], "hyper": "ML"}],
            "findings": [{"name": "A", "statement": "Free rows err less than filters.",
                          "comparisons": [{"better": "NP-ML-DFR", "worse": "NP-ML-DFSR", "phase": "steady"}]}]}
    (pages.folder / "plan.json").write_text(json.dumps(plan))
    pages.run("evaluate", "--plan", "plan.json", "-o", "evaluation")
    figures = []
    for row in csv.DictReader((pages.folder / "evaluation" / "results.csv").open()):
        if row["case"] in ("persistence", "AR(2)"):
            figures += [(row["case"], output, float(row[f"nrmse_{output}"])) for output in ("i1", "i2", "i6")]
        elif row["seed"] == "1":
            figures.append((row["case"], "multiply-adds per tick", float(row["operations"])))
    pages.add("evaluation", "evaluation/report.html", figures)
    plan["steady_after_s"] = 30  # after the end of the subsets
    (pages.folder / "plan.json").write_text(json.dumps(plan))
    pages.run("evaluate", "--plan", "plan.json", "-o", "evaluation_short")
    pages.add("evaluation_short", "evaluation_short/report.html", [one for one in figures if one[0] == "persistence"])


def make_pages(dfdyn, folder):
    """Writes all pages; returns {name: (page, figures)}."""
    pages = Pages(dfdyn, folder)
    for part in (train, replays, diagnoses, start, loop, evaluation):
        part(pages)
    return pages.pages
