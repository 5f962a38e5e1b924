#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""run_page.py BUILD PAGE: runs the commands of a documentation page in a new folder, in their order. The folder has links to the
repository's tests, tools and firmware_lib, and to the build as build/release.

    ```sh                     a script; it must end with status 0
    ```sh status 1            a script that must end with this status
    ```sh not run: REASON     what a test cannot run
    ```text                   lines of the output of the script above; `…` is output left out

Words of the output must be equal; numbers may differ by a twentieth, since processors round differently."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent.parent
TOLERANCE = 0.05
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def blocks_of(page):
    """Returns [(info string, lines)] of the fenced blocks."""
    return [(one[1].strip(), one[2].splitlines()) for one in re.finditer(r"^```(\w[^\n]*)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)]


def agree(expected, found):
    """Returns whether two lines have the same words and nearly the same numbers. A line may begin with `…`: its beginning is left out."""
    words, rest = NUMBER.sub("#", expected).split(), NUMBER.sub("#", found).split()
    if words[0].startswith("…"):
        rest = rest[len(rest) - len(words):]
        words[0] = words[0][1:]
        if not rest or not rest[0].endswith(words[0]):
            return False
        words, rest = words[1:], rest[1:]
    if words != rest:
        return False
    numbers = [float(one) for one in NUMBER.findall(expected)]
    others = [float(one) for one in NUMBER.findall(found)][-len(numbers):] if numbers else []
    return len(numbers) == len(others) and all(
        abs(one - other) <= TOLERANCE * max(abs(one), abs(other), 0.01) for one, other in zip(numbers, others))


def missing_line(shown, output):
    """Returns the first line of a block that the output does not have in its place; None: all are there."""
    at = 0
    for line in (one for one in shown if one.strip() not in ("", "…")):
        matches = [row for row in range(at, len(output)) if agree(line, output[row])]
        if not matches:
            return line
        at = matches[0] + 1
    return None


def make_folder(folder, build):
    """Links what the commands of a page may use into the folder."""
    for name in ("tests", "tools", "firmware_lib"):
        (folder / name).symlink_to(SOURCE / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(build)


def run_script(lines, expected, folder, build):
    """Runs a block as one script; returns the lines of its output."""
    environment = dict(os.environ, PATH=f"{build / 'tools'}:{os.environ['PATH']}")
    print("\n".join(f"$ {line}" for line in lines), flush=True)
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", "\n".join(lines)], cwd=folder, env=environment, text=True, check=False,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(done.stdout)
    assert done.returncode == expected, f"expected status {expected}, found {done.returncode}"
    return done.stdout.splitlines()


def main():
    build, page = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    scripts = compared = skipped = 0
    with tempfile.TemporaryDirectory() as scratch:
        make_folder(pathlib.Path(scratch), build)
        output = []
        for info, lines in blocks_of((SOURCE / page).read_text()):
            kind = re.fullmatch(r"sh(?: status (\d+)|( not run: \S.*))?", info)
            assert kind or not info.startswith("sh"), f"{page}: expected `sh`, `sh status N` or `sh not run: REASON`, found {info!r}"
            if kind and kind[2]:
                print(f"{info}:", *lines, sep="\n  ")
                skipped += 1
            elif kind:
                output = run_script(lines, int(kind[1] or 0), scratch, build)
                scripts += 1
            elif info == "text":
                line = missing_line(lines, output)
                assert line is None, f"{page}: expected the output to have the line {line!r}"
                compared += len(lines)
    print(f"{page}: {scripts} scripts run, {compared} lines compared, {skipped} scripts not run")
    assert scripts


if __name__ == "__main__":
    main()
