#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""look_at_pages.py DFDYN [FOLDER]: opens every kind of page that the program writes in headless Chromium, 390 and 1440 pixels wide, light and
dark. Nothing may be cut, faint or tiny, every control must be reachable by keyboard, and the numbers of the tables must be those of the command's
JSON. FOLDER keeps the pages and their pictures. Exit status 77: there is no Chromium."""

import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from make_pages import make_pages

HERE = pathlib.Path(__file__).resolve().parent


NUMBER = re.compile(r"-?\d+(?:\.(\d+))?(?:e([+-]?\d+))?")


def shows(cell, value):
    """Returns whether a cell's first number is `value`, rounded to the digits that the cell has, or a bound of it; a share may be in %."""
    found = NUMBER.search(cell.replace("\u2212", "-"))
    if not found:
        return False
    if cell.startswith(">"):
        return value > float(found[0])
    scale = 100 if "%" in cell else 1
    last_digit = 10.0 ** (int(found[2] or 0) - len(found[1] or ""))
    return abs(float(found[0]) - scale * value) <= 0.501 * last_digit


def missing_figures(seen, figures):
    """Returns what the tables of a page do not have: (row, column, value); without a row the page has the text."""
    missing = []
    for row, column, value in figures:
        if row is None:
            missing += [] if value.lower() in " ".join(seen["text"].lower().split()) else [f"no text {value!r}"]
            continue
        cells = [line[place] for table in seen["tables"] for line in table[1:] for place, title in enumerate(table[0])
                 if line[0].lower() == row.lower() and title == column and place < len(line)]
        if not any(shows(cell, value) for cell in cells):
            missing.append(f"{row}, {column}: expected {value:.4g}, found {cells or 'no such cell'}")
    return missing


def look(chromium, page, width, dark, picture):
    """Returns what probe.js found in the page; writes its picture."""
    probe = (HERE / "probe.js").read_text()
    text = page.read_text()
    catch = "<script>window.probeErrors = []; addEventListener('error', (one) => probeErrors.push(one.message));</script>"
    text = re.sub(r"<head>", "<head>" + catch, text, count=1) + f"<script>{probe}</script>"
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch) / "page.html"
        copy.write_text(text)
        words = [chromium, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
                 f"--user-data-dir={scratch}/profile", f"--blink-settings=preferredColorScheme={0 if dark else 1}",
                 "--virtual-time-budget=8000"]
        # The window of a headless Chromium is at least 500 wide: the page is in a frame of the width.
        frame = pathlib.Path(scratch) / "frame.html"
        frame.write_text("<script>addEventListener('message', (one) => { document.body.dataset.probe = one.data; });</script>"
                         f"<body style='margin:0'><iframe src='page.html' style='border:0;width:{width}px;height:6000px'></iframe>")
        dom = subprocess.run([*words, f"--window-size={max(width, 500)},6000", f"--screenshot={picture}", "--dump-dom", frame.as_uri()],
                             capture_output=True, text=True, check=True, timeout=120).stdout
        if not picture.exists():  # one of both is written, by some versions
            subprocess.run([*words, f"--window-size={max(width, 500)},6000", f"--screenshot={picture}", frame.as_uri()],
                           capture_output=True, check=True, timeout=120)
    found = re.search(r'data-probe="([^"]*)"', dom)
    assert found, f"{page}: expected the probe's result, found none"
    return json.loads(html.unescape(found.group(1)))


def complaints(seen, figures, width, dark):
    """Returns what is wrong with a page."""
    wrong = []
    if seen["width"] != width:
        wrong.append(f"shown {seen['width']} px wide")
    if seen["pageWidth"] > seen["width"]:
        wrong.append(f"is {seen['pageWidth']} px wide")
    for kind in ("cut", "clipped", "faint", "unreachable", "stuck", "errors", "unprinted", "small", "tall"):
        wrong += [f"{kind}: {one}" for one in seen[kind]]
    if (seen["background"] < 0.18) != dark or (seen["foreground"] > 0.18) != dark:
        wrong.append(f"background of luminance {seen['background']:.2f}, text {seen['foreground']:.2f}")
    return wrong + missing_figures(seen, figures)


def main():
    chromium = shutil.which("chromium")
    if chromium is None:
        print("not run: no chromium")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else scratch).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        failed = False
        for name, (page, figures) in make_pages(str(pathlib.Path(sys.argv[1]).resolve()), folder).items():
            for width in (390, 1440):
                for dark in (False, True):
                    shade = "dark" if dark else "light"
                    seen = look(chromium, page, width, dark, folder / f"{name}_{width}_{shade}.png")
                    wrong = complaints(seen, figures, width, dark)
                    print(f"{name}, {width} px, {shade}: {len(figures)} figures, {seen['controls']} controls, {len(wrong)} complaints")
                    for one in wrong[:12]:
                        print(f"  {one}")
                    failed = failed or bool(wrong)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
