#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""measure_recordings.py DFDYN [FOLDER] [SPLITS]: diagnoses several recordings of one UR5 together, and prints the agreement of two disjoint
halves of its thirteen recordings: values, intervals and names, for SPLITS (1) random splits. FOLDER (build/recordings) receives the
diagnoses. Prints the tables of docs/results/diagnosis-cases.md."""

import pathlib
import random
import statistics
import sys

from measure_repeats import JOINTS, NAMED, diagnosed, jaccard, logs_of_arm, named_causes, short_name

EFFECTS = ["coulomb_friction", "viscous_friction", "rotor_inertia", "torque_offset"]


def values_of(diagnosis, effect):
    """Returns value and interval of an effect's main parameter by joint, of all findings."""
    found = {}
    for one in diagnosis["findings"]:
        if one["effect"] == effect and one.get("by_recording"):
            main = one["parameters"][0]
            found[int(one["where"][len("joint"):])] = (main["value"], *main["ci95"], one["confidence"])
    return found


def compare(first, second, effect):
    """Returns the differences relative to the mean, and the number of intervals that contain the other half's value, and their number."""
    a, b = values_of(first, effect), values_of(second, effect)
    both = [joint for joint in JOINTS if joint in a and joint in b]
    apart = [abs(a[joint][0] - b[joint][0]) / abs(a[joint][0] + b[joint][0]) * 200 for joint in both]
    held = sum((a[joint][1] <= b[joint][0] <= a[joint][2]) + (b[joint][1] <= a[joint][0] <= b[joint][2]) for joint in both)
    return apart, held, 2 * len(both)


def causes_of_arm(diagnosis):
    """Returns the named causes without contacts, which are events of one recording."""
    return {one for one in named_causes(diagnosis) if one[0] != "external_contact"}


def values_table(diagnosis):
    """Prints the values of all recordings, by joint."""
    print("| joint | " + " | ".join(effect.replace("_", " ") for effect in EFFECTS) + " |\n| --- |" + " --- |" * len(EFFECTS))
    for joint in JOINTS:
        cells = []
        for effect in EFFECTS:
            one = values_of(diagnosis, effect).get(joint)
            cells.append(f"{one[0]:.3g} ({one[1]:.3g} … {one[2]:.3g}), {one[3]:.2f}" if one else "–")
        print(f"| {joint} | {' | '.join(cells)} |")


def main():
    """Diagnoses all recordings, then halves of them, and prints the tables."""
    dfdyn = sys.argv[1]
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "build/recordings")
    splits = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    logs = logs_of_arm()
    whole = diagnosed(dfdyn, logs, folder / "all", "--changed", "payload")
    values_table(whole)
    print("\nloads: " + (", ".join(one["only_in"] for one in whole["findings"] if "only_in" in one) or "none"))
    order = random.Random(1)
    names, loads, rows = [], 0, {effect: [[], 0, 0] for effect in EFFECTS}
    for split in range(splits):
        mixed = order.sample(logs, len(logs))
        halves = [diagnosed(dfdyn, sorted(part), folder / f"split{split}_{side}", "--changed", "payload")
                  for side, part in enumerate((mixed[: len(mixed) // 2], mixed[len(mixed) // 2:]))]
        names.append(jaccard([causes_of_arm(half) for half in halves]))
        print(f"split {split}: {', '.join(short_name(log) for log in sorted(mixed[: len(mixed) // 2]))} | names agree by {names[-1]:.2f}; in one half only:",
              "; ".join(sorted(" ".join(one) for one in causes_of_arm(halves[0]) ^ causes_of_arm(halves[1]))) or "none", flush=True)
        loads += sum("only_in" in one and one["confidence"] >= NAMED for half in halves for one in half["findings"])
        for effect, row in rows.items():
            for place, more in enumerate(compare(*halves, effect)):
                row[place] = row[place] + more
    print("\n| | median difference of two halves (%) | intervals that contain the other half's value |\n| --- | ---: | ---: |")
    for effect, (apart, held, count) in rows.items():
        print(f"| {effect.replace('_', ' ')} | {statistics.median(apart):.0f} | {held} of {count} |")
    print(f"\nnamed causes of two halves, without contacts, agree by a Jaccard index of {statistics.mean(names):.2f}; loads named in {2 * splits} halves: {loads}")


main()
