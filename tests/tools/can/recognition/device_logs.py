#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""device_logs.py FOLDER [--check]: writes, or compares with those in FOLDER, candump logs of motors as their protocols'
documents describe the frames. It shares nothing with the decoders of hal: numbers are written byte by byte here.

Every joint k, from 1, moves by q(t) = 0.3 k - 0.5 + 0.4 sin(pi t + k) rad, with the effort
(0.5 + 0.1 k) cos(pi t / 2 + k) N m or A. Frames are stamped when they are measured."""
import math
import pathlib
import struct
import sys

RATE = 200  # Hz
SECONDS = 1.5
START = 1700000000.0


def q(k, t):
    return 0.3 * k - 0.5 + 0.4 * math.sin(math.pi * t + k)


def qd(k, t):
    return 0.4 * math.pi * math.cos(math.pi * t + k)


def effort(k, t):
    return (0.5 + 0.1 * k) * math.cos(math.pi * t / 2 + k)


def code(value, maximum, bits):
    """Unsigned code of a value in +-maximum, cut off like in the makers' examples."""
    return max(0, min((1 << bits) - 1, int((value + maximum) * ((1 << bits) - 1) / (2 * maximum))))


def mit_body(position, velocity, torque):
    """Bytes 1 to 5 of a feedback in MIT mode."""
    return bytes([position >> 8, position & 255, velocity >> 4, (velocity & 15) << 4 | torque >> 8, torque & 255])


class Log:
    def __init__(self):
        self.lines = []

    def add(self, t, identifier, data, extended=False, fd=False):
        name = f"{identifier:08X}" if extended else f"{identifier:03X}"
        self.lines.append((t, f"({START + t:.6f}) can0 {name}{'##1' if fd else '#'}{data.hex().upper()}"))

    def text(self):
        return "".join(line + "\n" for _, line in sorted(self.lines, key=lambda entry: entry[0]))


def cycles(joints):
    """Yields time and joint, each joint 200 us after the one before."""
    for i in range(round(RATE * SECONDS)):
        for k in range(1, joints + 1):
            yield i, k, round(i / RATE + 200e-6 * k, 6)


def damiao():
    """DM4310, DM4340 (10 rad/s), DM8009; what hosts send: commands, a poll, register accesses."""
    maxima = {1: (12.5, 30, 10), 2: (12.5, 10, 28), 3: (12.5, 45, 54)}
    log = Log()
    for i, k, t in cycles(3):
        p, v, m = maxima[k]
        log.add(t - 100e-6, k, bytes([0x7F, 0xFF, 0x7F, 0xF0, 0, 0, 0x07, 0xFF]))
        body = mit_body(code(q(k, t), p, 16), code(qd(k, t), v, 12), code(effort(k, t), m, 12))
        log.add(t, 0x10 + k, bytes([1 << 4 | k]) + body + bytes([31 + k, 35 + k]))
        if i % 100 == 50:
            for n, register in enumerate((21, 22, 23)):
                late = t + 2e-3 + 10e-6 * n
                log.add(late, 0x7FF, bytes([k, 0, 0x33, register, 0, 0, 0, 0]))
                log.add(late + 5e-6, 0x10 + k, bytes([k, 0, 0x33, register]) + struct.pack("<f", maxima[k][n]))
    return log


def robstride():
    """RS01, CyberGear, RS05 with the private protocol, host 0xFD; reads of mechPos."""
    maxima = {1: (44, 17), 2: (30, 12), 3: (50, 5.5)}
    log = Log()
    for i, k, t in cycles(3):
        v, m = maxima[k]
        identifier = 2 << 24 | 2 << 22 | k << 8 | 0xFD
        numbers = (code(q(k, t), 4 * math.pi, 16), code(qd(k, t), v, 16), code(effort(k, t), m, 16), 285)
        log.add(t, identifier, struct.pack(">HHHH", *numbers), extended=True)
        if i % 100 == 50:
            log.add(t + 2e-3, 17 << 24 | k << 8 | 0xFD, struct.pack("<HHf", 0x7019, 0, q(k, t)), extended=True)
    return log


def robstride_mit():
    """RS01, CyberGear, RS05 in MIT mode, all on the host's identifier."""
    maxima = {1: (44, 17), 2: (30, 12), 3: (50, 5.5)}
    log = Log()
    for _, k, t in cycles(3):
        v, m = maxima[k]
        body = mit_body(code(q(k, t), 4 * math.pi, 16), code(qd(k, t), v, 12), code(effort(k, t), m, 12))
        log.add(t, 0xFD, bytes([k]) + body + struct.pack(">H", 285))
    return log


def cubemars_mit():
    """AK80-9 in MIT mode, on identifier 0; the second with old firmware of six bytes."""
    log = Log()
    for _, k, t in cycles(2):
        body = mit_body(code(q(k, t), 12.5, 16), code(qd(k, t), 50, 12), code(effort(k, t), 18, 12))
        log.add(t, 0, bytes([k]) + body + (bytes([33, 0]) if k == 1 else b""))
    return log


def cubemars_servo():
    """AK80-9 in servo mode: 21 pole pairs, gear 9; current commands."""
    log = Log()
    for _, k, t in cycles(2):
        numbers = (round(math.degrees(q(k, t)) * 10), round(qd(k, t) * 60 / (2 * math.pi) * 21 * 9 / 10),
                   round(effort(k, t) * 100), 33, 0)
        log.add(t, 0x2900 | k, struct.pack(">hhhbB", *numbers), extended=True)
        log.add(t - 50e-6, 0x100 | k, struct.pack(">i", round(effort(k, t) * 1000)), extended=True)
    return log


def rmd():
    """V3 drivers that are asked for 0x92 and 0x9C."""
    log = Log()
    for _, k, t in cycles(3):
        for command in (0x92, 0x9C):
            log.add(t - 50e-6 if command == 0x92 else t + 20e-6, 0x140 + k, bytes([command]) + bytes(7))
        log.add(t, 0x240 + k, bytes([0x92, 0, 0, 0]) + struct.pack("<i", round(math.degrees(q(k, t)) * 100)))
        t = round(t + 70e-6, 6)
        log.add(t, 0x240 + k, bytes([0x9C]) + struct.pack(
            "<bhhh", 33, round(effort(k, t) * 100), round(math.degrees(qd(k, t))), round(math.degrees(q(k, t)))))
    return log


def rmd_v2():
    """V2 drivers: requests and answers on one identifier, seven bytes of angle, 33/2048 A per count."""
    log = Log()
    for _, k, t in cycles(2):
        for command in (0x92, 0x9C):
            log.add(t - 50e-6 if command == 0x92 else t + 20e-6, 0x140 + k, bytes([command]) + bytes(7))
        angle = round(math.degrees(q(k, t)) * 100)
        log.add(t, 0x140 + k, bytes([0x92]) + struct.pack("<q", angle)[:7])
        t = round(t + 70e-6, 6)
        log.add(t, 0x140 + k, bytes([0x9C]) + struct.pack(
            "<bhhH", 33, round(effort(k, t) * 2048 / 33), round(math.degrees(qd(k, t))),
            round(q(k, t) / (2 * math.pi) * 16384) & 0x3FFF))
    return log


def padded(data):
    for length in (8, 12, 16, 20, 24, 32, 48, 64):
        if len(data) <= length and (len(data) > 8 or length == 8):
            return data + bytes([0x50] * (length - len(data))) if len(data) > 8 else data
    raise ValueError


def moteus():
    """Controllers 1, 2 and 12: float, int32 and int16, the registers in another order each; replies to a second host."""
    log = Log()
    turn = 2 * math.pi
    for i, k, t in cycles(3):
        identifier = {1: 1, 2: 2, 3: 12}[k]
        position, velocity, torque = q(k, t) / turn, qd(k, t) / turn, effort(k, t)
        if k == 1:
            data = bytes([0x21, 0x00, 10, 0x2F, 0x01]) + struct.pack("<fff", position, velocity, torque)
            data += bytes([0x23, 0x0D, 48, 30, 0])
        elif k == 2:
            data = bytes([0x29, 0x03]) + struct.pack("<i", round(torque * 1000))
            data += bytes([0x2A, 0x01]) + struct.pack("<ii", round(position * 1e5), round(velocity * 1e5))
            data += bytes([0x50, 0x30, 0x20, 0x05, 0x21, 0x00, 10])
        else:
            data = bytes([0x24, 0x04, 0x00]) + struct.pack(
                "<hhhh", 10, round(position * 1e4), round(velocity * 4000), round(torque * 100))
            data += bytes([0x23, 0x0D, 48, 30, 0])
        command = bytes([0x11, 0x00, 0x1F, 0x01, 0x13, 0x0D])
        log.add(t - 100e-6, 0x8000 | identifier, command, extended=True, fd=True)
        log.add(t, identifier << 8, padded(data), extended=identifier << 8 > 0x7FF, fd=True)
        if i % 20 == 10 and k == 1:
            log.add(t + 1e-3, identifier << 8 | 3, padded(data), fd=True)
    return log


def piper():
    """Six joints: angles, speeds and currents, states, poses."""
    log = Log()
    for i in range(round(RATE * SECONDS)):
        t = round(i / RATE, 6)
        for pair in range(3):
            at = round(t + 200e-6 * pair, 6)
            angles = [round(math.degrees(q(2 * pair + half, at)) * 1000) for half in (1, 2)]
            log.add(at, 0x2A5 + pair, struct.pack(">ii", *angles))
        for k in range(1, 7):
            at = round(t + 1e-3 + 100e-6 * k, 6)
            log.add(at, 0x250 + k, struct.pack(">hhi", round(qd(k, at) * 1000), round(effort(k, at) * 1000), 0))
            if i % 20 == 0:
                log.add(at, 0x260 + k, struct.pack(">HhbBH", 240, 30, 35, 0x40, 0))
        log.add(round(t + 3e-3, 6), 0x2A1, bytes([1, 0, 1, 0, 0, 0, 0, 0]))
        log.add(round(t + 3e-3, 6), 0x2A2, struct.pack(">ii", 100000, 200000))
    return log


LOGS = (damiao, robstride, robstride_mit, cubemars_mit, cubemars_servo, rmd, rmd_v2, moteus, piper)


def main():
    folder = pathlib.Path(sys.argv[1])
    for make in LOGS:
        path = folder / f"{make.__name__}.log"
        text = make().text()
        if "--check" not in sys.argv:
            path.write_text(text)
        elif path.read_text() != text:
            sys.exit(f"{path}: expected what {sys.argv[0]} writes, found another log")
    print(f"{len(LOGS)} logs in {folder}")


main()
