#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""arduino.py CXX SOURCE VERSION: reads library.properties, lays the library out for Arduino, and compiles against it."""

import pathlib
import subprocess
import sys
import tempfile

compiler, source, version = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
lines = (source / "library.properties").read_text().splitlines()
properties = dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))
for field in ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "architectures", "includes"):
    assert properties.get(field), f"library.properties: expected {field}, found none"
assert properties["version"] == version, f"expected version {version}, found {properties['version']}"

# Arduino's include path of a library is src/, and it compiles every source below it.
with tempfile.TemporaryDirectory() as folder:
    library = pathlib.Path(folder) / "libraries" / properties["name"]
    library.parent.mkdir()
    subprocess.run([source / "tools/arduino_library.sh", library], check=True)
    assert (library / "library.properties").is_file()
    assert not list(library.rglob("*.cpp")), "expected headers only"
    for header in properties["includes"].split(","):
        assert (library / "src" / header.strip()).is_file(), f"expected {header}, found none"
    consumer = source / "tests/packaging/consumer.cpp"
    subprocess.run([compiler, "-std=gnu++20", "-I", library / "src", "-fsyntax-only", consumer], check=True)
