#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_code.py COMPILER: compiles every block of C++ on the documentation's pages.

Each block is compiled by itself, with surroundings.hpp for what it takes for granted. Lines that are indented outside
of braces are statements of a function."""
import pathlib
import re
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
root = here.parents[2]
pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
# The user's headers that pages include.
user_headers = ("robot_model.hpp", "ur5_model.hpp")


def blocks(page):
    """Yields the line and the text of each block of C++."""
    text = page.read_text()
    for match in re.finditer(r"^```cpp\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        yield text.count("\n", 0, match.start(1)) + 1, match.group(1)


def as_source(block):
    """Returns a source file: includes, surroundings, declarations, and statements in a function."""
    includes, declarations, statements = [], [], []
    depth = 0
    complete = True
    for line in block.splitlines():
        code = line.split("//")[0].rstrip()
        if line.startswith("#"):
            includes.append(line)
        elif statements or (line.startswith("    ") and depth == 0 and complete):
            statements.append(line)
        else:
            declarations.append(line)
            depth += code.count("{") - code.count("}")
            complete = code.endswith((";", "}")) if code else complete
    surroundings = ['#include "tests/documentation/code/surroundings.hpp"']
    return "\n".join([*includes, *surroundings, *declarations, "void statements() {", *statements, "}"]) + "\n"


def main():
    compiler = sys.argv[1]
    failed = count = 0
    with tempfile.TemporaryDirectory() as folder:
        for header in user_headers:
            (pathlib.Path(folder) / header).write_text('#include "examples/ur5/ur5_model.hpp"\n')
        for page in pages:
            for line, block in blocks(page):
                source = pathlib.Path(folder) / "block.cpp"
                source.write_text(as_source(block))
                command = [compiler, "-std=c++20", "-fsyntax-only", "-fno-exceptions", "-fno-rtti", "-I", folder,
                           "-I", str(root), "-I", str(root / "firmware_lib/include"), str(source)]
                outcome = subprocess.run(command, capture_output=True, text=True, check=False)
                count += 1
                if outcome.returncode != 0:
                    failed += 1
                    print(f"{page.relative_to(root)}:{line}: expected C++ that compiles, found\n{outcome.stderr}")
    print(f"{count} blocks of C++, {failed} do not compile")
    return 1 if failed or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
