# SPDX-License-Identifier: Apache-2.0
# Turns rows 5200 to 5499 of the UR5's recording (2.4 s in motion) into a table for the examples: with -v table=samples its
# positions and currents, with -v table=frames the same as frames of six CiA 402 drives (tests/data/can/ur5_cia402.json).
# Usage: awk -v table=samples -f ur5_tables.awk RECORDING.csv

function start(type, name, members) {
    print "// Written by ur5_tables.awk when the examples are built (provenance: tests/data/ur5_kufieta)."
    print "#pragma once\n\n#include <cstdint>\n"
    print "struct " type " {\n" members "};\n\ninline constexpr " type " " name "[] = {"
}

function sample() {
    printf "    {%d, {%sF, %sF, %sF, %sF, %sF, %sF}, {%sF, %sF, %sF, %sF, %sF, %sF}},\n",
        $1 * 1000000 + 0.5, $2, $3, $4, $5, $6, $7, $14, $15, $16, $17, $18, $19
}

function rounded(value) { return value < 0 ? -int(0.5 - value) : int(value + 0.5) }

# The lowest `count` bytes of a whole number, lowest first, two's complement.
function bytes(value, count,    text) {
    value += value < 0 ? 256 ^ count : 0
    for (; count > 0; --count) {
        text = text sprintf("%s0x%02X", text == "" ? "" : ", ", value % 256)
        value = int(value / 256)
    }
    return text
}

function frame(time_us, id, length_bytes, data) {
    printf "    {%d, 0x%03X, %d, {%s}},\n", time_us, id, length_bytes, data
}

# A SYNC, then one PDO per drive, each as late as a bus of 1 Mbit/s makes it; heartbeats after every twelfth.
function frames(    joint, time_us) {
    time_us = rounded($1 * 1000000) + sync_us
    frame(time_us, 128, 0, "")
    for (joint = 1; joint <= 6; ++joint) {
        time_us += pdo_us
        frame(time_us, 640 + joint, 6, \
            bytes(rounded($(1 + joint) / (2 * pi) * 1048576), 4) ", " bytes(rounded($(13 + joint) * 1000), 2))
    }
    for (joint = 1; NR % 12 == 0 && joint <= 6; ++joint) {
        time_us += heartbeat_us
        frame(time_us, 1792 + joint, 1, "0x05")
    }
}

BEGIN {
    FS = ","
    pi = atan2(0, -1)
    sync_us = 55
    pdo_us = 115
    heartbeat_us = 65
    if (table == "samples") {
        start("Ur5Sample", "ur5_samples", "    std::int64_t time_us;\n    float position_rad[6];\n    float current_A[6];\n")
    } else {
        start("Ur5Frame", "ur5_frames", \
            "    std::uint32_t time_us;\n    std::uint16_t id;\n    std::uint8_t length;\n    std::uint8_t data[8];\n")
    }
}
NR >= 5202 && NR < 5502 { if (table == "samples") sample(); else frames() }
END { print "};" }
