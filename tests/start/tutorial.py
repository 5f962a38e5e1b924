#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tutorial.py DFDYN PAGE: runs every command of a documentation page in an empty folder, in their order. A block `text` after a block `sh` has
lines of that output, `…` what was left out: words must be equal; numbers may differ by a twentieth, since processors round differently."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
TOLERANCE = 0.05
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def blocks_of(page):
    """Returns [(language, lines)] of the fenced blocks."""
    return [(one[1], one[2].splitlines()) for one in re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)]


def agree(expected, found):
    """Returns whether two lines have the same words and nearly the same numbers."""
    if NUMBER.sub("#", expected).split() != NUMBER.sub("#", found).split():
        return False
    pairs = zip(map(float, NUMBER.findall(expected)), map(float, NUMBER.findall(found)))
    return all(abs(one - other) <= TOLERANCE * max(abs(one), abs(other), 0.01) for one, other in pairs)


def missing_line(shown, output):
    """Returns the first line of a block that the output does not have in its place; None: all are there."""
    at = 0
    for line in (one for one in shown if one.strip() not in ("", "…")):
        matches = [row for row in range(at, len(output)) if agree(line, output[row])]
        if not matches:
            return line
        at = matches[0] + 1
    return None


def main():
    dfdyn, page = sys.argv[1:]
    environment = dict(os.environ, PATH=f"{pathlib.Path(dfdyn).resolve().parent}:{os.environ['PATH']}")
    commands = compared = 0
    with tempfile.TemporaryDirectory() as scratch:
        os.symlink(SOURCE / "tests", f"{scratch}/tests")
        output = []
        for language, lines in blocks_of((SOURCE / page).read_text()):
            if language == "sh":
                output = []
                for command in lines:
                    print(f"$ {command}", flush=True)
                    done = subprocess.run(["bash", "-c", command], cwd=scratch, env=environment, text=True, check=False,
                                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                    print(done.stdout)
                    assert done.returncode == 0, f"{command}: status {done.returncode}"
                    output += done.stdout.splitlines()
                    commands += 1
            elif language == "text":
                line = missing_line(lines, output)
                assert line is None, f"{page}: expected the output to have the line {line!r}"
                compared += len(lines)
    print(f"{page}: {commands} commands, {compared} lines compared")
    assert commands and compared


if __name__ == "__main__":
    main()
