#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""look_at_pages.py DFDYN [FOLDER]: opens every kind of page that the program writes in headless Chromium, 390 and 1440 pixels wide, light and
dark. Nothing may be cut or faint, every control must be reachable by keyboard, and the figures must be those of the command's JSON. FOLDER
keeps the pages and their pictures. Exit status 77: there is no Chromium."""

import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
DATA = HERE.parent.parent / "data"
LEAST_CONTRAST = 4.5  # of text, WCAG 2.1 AA
UR5 = DATA / "ur5_kufieta"
TX40 = DATA / "tx40_figaroh" / "tx40_5kHz.csv"


def run(dfdyn, *words, expected=0):
    """Runs the program; returns its standard output."""
    done = subprocess.run([dfdyn, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == expected, f"{words}: status {done.returncode}: {done.stderr}"
    return done.stdout


def make_pages(dfdyn, folder):
    """Writes all pages. Returns {name: (page, figures that it must show)}."""
    pages = {}
    model = folder / "model.json"
    train = ["train", "--outputs", "i", "--lags", 10, "--features", 30, "--likelihood-rows", 100, "--starts", 1, "--quiet"]
    run(dfdyn, *train, "--log", UR5 / "Movement_No6_Acc_slow_Verify_Model.csv", "--rows", ":3421", "-o", model)
    replay = json.loads(run(dfdyn, "replay", "--model", model, "--contacts", "--json", "--report", folder / "replay.html",
                            "--log", UR5 / "Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv"))
    errors = replay["recordings"][0]["nrmse"]
    pages["replay"] = folder / "replay.html", [f"{error:.3f}" for error in errors]

    robot = ["--robot", DATA / "robots" / "tx40" / "tx40.urdf", "--tip", "link_6"]
    findings = json.loads(run(dfdyn, "diagnose", *robot, "--log", TX40, "--outputs", "tau", "--no-held-out",
                              "--quiet", "--json", "-o", folder / "diagnosis"))
    figures = [one["effect"].replace("_", " ") for one in findings["findings"] if one["confidence"] >= 0.5]
    assert figures, "expected findings on the TX40"
    pages["diagnosis"] = folder / "diagnosis" / "report.html", figures

    arm = DATA / "robots" / "small_arm" / "small_arm.urdf"
    loop = json.loads(run(dfdyn, "loop", "--simulate", "--duration", 11, "--robot", arm, "--json", "--quiet",
                          "--scenario", DATA / "scenarios" / "small_arm_loop.json", "-o", folder / "loop"))
    windows = loop["runs"][0]["windows"]
    pages["loop"] = folder / "loop" / "tracking.html", [f"{1e3 * one['rms_all_rad']:.3g}" for one in windows[:2]]
    return pages


def look(chromium, page, width, dark, picture):
    """Returns what probe.js found in the page; writes its picture."""
    probe = (HERE / "probe.js").read_text()
    text = page.read_text()
    catch = "<script>window.probeErrors = []; addEventListener('error', (one) => probeErrors.push(one.message));</script>"
    text = re.sub(r"<meta http-equiv=\"Content-Security-Policy\"[^>]*>", "", text)  # of pages without scripts, which would stop the probe
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
    for kind in ("cut", "clipped", "faint", "unreachable", "stuck", "errors"):
        wrong += [f"{kind}: {one}" for one in seen[kind]]
    if (seen["background"] < 0.18) != dark or (seen["foreground"] > 0.18) != dark:
        wrong.append(f"background of luminance {seen['background']:.2f}, text {seen['foreground']:.2f}")
    wrong += [f"shows no {figure}" for figure in figures if figure.lower() not in seen["text"].lower()]
    return wrong


def main():
    chromium = shutil.which("chromium")
    if chromium is None:
        print("not run: no chromium")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else scratch).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        failed = False
        for name, (page, figures) in make_pages(sys.argv[1], folder).items():
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
