#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""platformio.py CXX SOURCE VERSION: reads library.json, exports the files that it names, and compiles against them."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

compiler, source, version = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
manifest = json.loads((source / "library.json").read_text())
assert manifest["version"] == version, f"expected version {version}, found {manifest['version']}"

with tempfile.TemporaryDirectory() as folder:
    library = pathlib.Path(folder) / manifest["name"]
    for entry in manifest["export"]["include"]:
        place = source / entry
        copy = library / entry
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(place, copy) if place.is_dir() else shutil.copy(place, copy)
    build = manifest["build"]
    assert (library / build["includeDir"] / manifest["headers"]).is_file()
    flags = [word for flag in build["flags"] for word in flag.split()]
    consumer = source / "tests/packaging/consumer.cpp"
    subprocess.run([compiler, *flags, "-I", build["includeDir"], "-fsyntax-only", consumer], cwd=library, check=True)
