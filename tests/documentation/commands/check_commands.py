#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_commands.py DFDYN: searches README.md and docs for commands that run_page.py does not see (in indented blocks), for pages with
scripts that no test runs, and for options that the named command of the program does not have."""

import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent.parent
INDENTED = re.compile(r"^ {4}(?:\$ |dfdyn |build/|tools/|cmake |ctest |[A-Z]=)")
CALL = re.compile(r"(?:^|[`$|&;(] ?)(?:build/release/tools/)?dfdyn ([a-z]+)((?: [^`\n]*)?)")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def help_of(dfdyn, command, known={}):
    """Returns the help of a command; None: there is no such command."""
    if command not in known:
        done = subprocess.run([dfdyn, command, "--help"], capture_output=True, text=True, check=False)
        known[command] = done.stdout if done.returncode == 0 else None
    return known[command]


def lines_of(page):
    """Returns [(number, text)]: lines that end with a backslash are joined with the next."""
    lines, start = [], None
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if start is not None:
            lines[-1] = (start, lines[-1][1][:-1] + line.strip())
        else:
            lines.append((number, line))
        start = (start or number) if line.endswith("\\") else None
    return lines


def wrong_options(dfdyn, text):
    """Returns the options of calls of the program that their command does not have."""
    wrong = []
    for command, words in CALL.findall(text):
        words = re.split(r" (?:\||&&|#|>)|;", words)[0]
        known = help_of(dfdyn, command)
        options = OPTION.findall(words)
        if known is None:
            wrong += [f"dfdyn {command}"] if options else []
        else:
            wrong += [f"dfdyn {command} {one}" for one in options if one not in OPTION.findall(known)]
    return wrong


def main():
    dfdyn = sys.argv[1]
    pages = [SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md"))]
    run = (SOURCE / "tests" / "documentation" / "CMakeLists.txt").read_text()
    calls, wrong = 0, []
    for page in pages:
        name = page.relative_to(SOURCE)
        lines = lines_of(page)
        if re.search(r"^```sh(?: status|$)", page.read_text(), re.MULTILINE) and str(name) not in run:
            wrong.append(f"{name}: expected a test that runs its scripts, found none in tests/documentation/CMakeLists.txt")
        for number, line in lines:
            calls += len(CALL.findall(line))
            wrong += [f"{name}:{number}: unknown: {one}" for one in wrong_options(dfdyn, line)]
            if INDENTED.match(line) and name.parts[:2] != ("docs", "results") and not line.startswith("    dfdyn::"):
                wrong.append(f"{name}:{number}: expected a block ```sh, found an indented command")
    print(*wrong, sep="\n")
    print(f"{len(pages)} pages, {calls} calls of the program, {len(wrong)} complaints")
    assert calls > 100
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
