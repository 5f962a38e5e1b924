#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_dbc_log.py DFDYN RECORDING.csv BUS.json: converts the recording with DFDYN and decodes the frames without it:
the log with python-can, the DBC file, the bits and the mapping with this script. Every value of the recording must be in
the log, to half a step of its signal."""
import csv
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import can

SIGNAL = re.compile(r" SG_ (\w+) (?:(M|m\d+) )?: (\d+)\|(\d+)@([01])([+-]) \(([^,]+),([^)]+)\)")
UNITS = {"rad": 1.0, "deg": math.pi / 180, "turn": 2 * math.pi}


def read_dbc(path):
    """Returns the messages by name: (id, extended, signals by name), and the float signals."""
    messages = {}
    floats = {}
    for line in path.read_text().splitlines():
        if match := re.match(r"BO_ (\d+) (\w+): (\d+)", line):
            number = int(match[1])
            signals = {}
            messages[match[2]] = (number & 0x7FFFFFFF, number >= 1 << 31, signals)
        elif match := SIGNAL.match(line):
            signals[match[1]] = match.groups()[1:]
        elif match := re.match(r"SIG_VALTYPE_ \d+ (\w+) : ([12]);", line):
            floats[match[1]] = int(match[2])
    return messages, floats


def extract(data, signal, kind):
    """Returns the physical value of a string of bits."""
    _, start, length, intel, sign, factor, offset = signal
    start, length = int(start), int(length)
    if intel == "1":
        bits = "".join(f"{byte:08b}" for byte in reversed(data))
        end = len(bits) - start
        text = bits[end - length:end]
    else:
        bits = "".join(f"{byte:08b}" for byte in data)
        begin = start // 8 * 8 + 7 - start % 8
        text = bits[begin:begin + length]
    raw = int(text, 2)
    if kind == 1:
        number = struct.unpack("<f", struct.pack("<I", raw))[0]
    elif kind == 2:
        number = struct.unpack("<d", struct.pack("<Q", raw))[0]
    else:
        number = raw - (1 << length) if sign == "-" and text[0] == "1" else raw
    return number * float(factor) + float(offset)


def step_of(signal, kind, value):
    """Returns half a step of the signal at this value, with a small tolerance."""
    return abs(value) * 2.0**-23 + 1e-12 if kind else 0.5001 * abs(float(signal[5]))


def main():
    program, recording, bus = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    joints = json.loads(bus.read_text())["joints"]
    messages, floats = read_dbc(bus.parent / joints["file"])
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "run.log"
        subprocess.run([program, "convert", "--log", recording, "--bus", bus, "-o", log], check=True,
                       stdout=subprocess.DEVNULL)
        frames = list(can.CanutilsLogReader(str(log)))
    with recording.open() as file:
        rows = [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]
    by_row = {}
    for frame in frames:
        by_row.setdefault(round((frame.timestamp - 0.01 - 0.002) / 0.008), []).append(frame)

    checked = 0
    for number, row in enumerate(rows):
        for board in joints["boards"]:
            for quantity, column in (("position", "q"), ("effort", "i")):
                field = board[quantity]
                identifier, extended, signals = messages[field["message"]]
                signal = signals[field["signal"]]
                kind = floats.get(field["signal"])
                multiplexor = next((s for s in signals.values() if s[0] == "M"), None)
                found = [frame for frame in by_row[number]
                         if frame.arbitration_id == identifier and frame.is_extended_id == extended
                         and (signal[0] is None or extract(frame.data, multiplexor, None) == int(signal[0][1:]))]
                assert len(found) == 1, f"row {number}: {len(found)} frames of {field}"
                scale = UNITS[field.get("unit", "rad")]
                value = scale * (field.get("scale", 1) * extract(found[0].data, signal, kind) + field.get("offset", 0))
                wanted = row[column + str(board["joint"])]
                limit = abs(scale * field.get("scale", 1)) * step_of(signal, kind, wanted / scale)
                assert abs(value - wanted) <= limit, f"row {number}: {field}: {value}, in the recording {wanted}"
                checked += 1
    assert checked == 12 * len(rows) > 0
    print(f"{checked} values of {len(rows)} rows, {len(frames)} frames")


main()
