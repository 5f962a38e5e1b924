#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""measure_gaps.py DFDYN [FOLDER]: simulates control loops over their buses while cycles and frames are lost, ticks begin late, and a clock is set,
and prints the table "Faults" of docs/guide/loop.md: the largest change of a command in a tick, in % of its limit, and the ticks in which a joint
had no reading. The controller is the nominal rigid body with feedback. FOLDER (build/gaps) receives the scenarios and results."""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "tests" / "data"
ARMS = {"ur5": ("UR5", "ur5/ur5_robot.urdf"), "icub": ("iCub", "icub_right_arm/icub_right_arm.urdf")}
AT_S = 6  # of the faults that are events; the arms are at full speed
DURATION_S = 12


def lost(cycles):
    """Lost cycles of all devices."""
    return [{"kind": "cycles_lost", "cycles": cycles, "at_s": AT_S}]


def late(ticks):
    """Late ticks in a row; `ticks` of the loop become due while each is late."""
    return lambda period_s: [{"kind": "late_ticks", "late_s": (ticks + 0.5) * period_s, "at_s": AT_S}]


def frames(share):
    """Lost frames during the whole run."""
    return [{"kind": "frames_lost", "share": share, "from_s": 0, "for_s": DURATION_S}]


def clock(by_s):
    """The clock of the frames' stamps is set."""
    return [{"kind": "clock_jump", "by_s": by_s, "at_s": AT_S}]


FAULTS = {
    "none": [[]],
    "1 cycle lost": [lost(1)],
    "2 cycles": [lost(2)],
    "3 cycles": [lost(3)],
    "5 cycles": [lost(5)],
    "a late tick": [late(1)],
    "3 late ticks": [late(3)],
    "1 % of the frames, from the start for 12 s": [frames(0.01)],
    "5 %": [frames(0.05)],
    "the computer's clock + 4 ms": [clock(0.004)],
    "− 4 ms": [clock(-0.004)],
    "± 20 ms, ± 100 ms, ± 1 s": [clock(sign * by) for by in (0.02, 0.1, 1) for sign in (1, -1)],
}


def measured(dfdyn, folder, arm, faults):
    """Returns the largest change of a command in a tick, in % of the limit, the ticks without a reading, and whether the loop ran to the end."""
    scenario = json.loads((DATA / "scenarios" / f"{arm}_loop.json").read_text(encoding="utf-8"))
    scenario["faults"] = faults(1 / scenario["controller"]["rate_hz"]) if callable(faults) else faults
    path = folder / f"{arm}.json"
    path.write_text(json.dumps(scenario), encoding="utf-8")
    run = subprocess.run(
        [dfdyn, "loop", "--simulate", "--robot", DATA / "robots" / ARMS[arm][1], "--scenario", path, "--bus",
         DATA / "can" / f"{arm}_loop.json", "--observer-bandwidth", "0", "--duration", str(DURATION_S), "--json"],
        check=False, capture_output=True, text=True)
    if run.returncode not in (0, 1):  # 1: stopped by itself
        sys.exit(f"{arm}: {run.stderr}")
    loop = json.loads(run.stdout)["loops"][0]
    limits = scenario["actuators"]["torque_limit_nm"]
    change = max(step / limit for step, limit in zip(loop["largest_torque_step_nm"], limits))
    return 100 * change, loop["coasted"], loop["state"] == "running"


def main():
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "build" / "gaps"
    folder.mkdir(parents=True, exist_ok=True)
    titles = [title for title, _ in ARMS.values()]
    print("| fault | " + " | ".join(f"{title} | ticks" for title in titles) + " |")
    print("| --- |" + " --- | --- |" * len(titles))
    for name, variants in FAULTS.items():
        cells = []
        for arm in ARMS:
            results = [measured(sys.argv[1], folder, arm, faults) for faults in variants]
            worst = f"{max(change for change, _, _ in results):.1f}"
            stopped = "" if all(ran for _, _, ran in results) else " (stopped)"
            cells += [worst + stopped, f"{max(ticks for _, ticks, _ in results):,}"]
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
