// SPDX-License-Identifier: Apache-2.0
// Added to a copy of a page by look_at_pages.py: sends what can be seen of the page to its frame as JSON.
"use strict";

const smallestText = 8; // pixels

/** Returns [r, g, b, a] of a computed colour. */
function colourOf(text) {
  const parts = text.match(/[\d.]+/g).map(Number);
  return parts.length === 3 ? [...parts, 1] : parts;
}

/** Returns the relative luminance of a colour (WCAG 2.1). */
function luminanceOf([red, green, blue]) {
  const linear = [red, green, blue].map((value) =>
    value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}

/** Returns the colour of the nearest background that is not transparent. */
function backgroundOf(element) {
  for (let at = element; at; at = at.parentElement) {
    const colour = colourOf(getComputedStyle(at).backgroundColor);
    if (colour[3] > 0.99) {
      return colour;
    }
  }
  return [255, 255, 255, 1];
}

function contrastOf(element) {
  const style = getComputedStyle(element);
  const inSvg = element instanceof SVGElement;
  const text = colourOf(inSvg ? style.fill : style.color);
  const pair = [luminanceOf(text), luminanceOf(backgroundOf(element))].sort((a, b) => b - a);
  return (pair[0] + 0.05) / (pair[1] + 0.05);
}

function describe(element) {
  return `${element.tagName.toLowerCase()}.${element.getAttribute("class") || ""} "${element.textContent.trim().slice(0, 50)}"`;
}

/** Returns whether an ancestor shows the rest of the element when scrolled. */
function isScrolled(element) {
  for (let at = element.parentElement; at && at !== document.body; at = at.parentElement) {
    if (["auto", "scroll"].includes(getComputedStyle(at).overflowX) && at.scrollWidth > at.clientWidth) {
      return true;
    }
  }
  return false;
}

/** Returns whether the element has text of its own that is shown. */
function showsText(element) {
  const own = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
  return own && element.checkVisibility() && element.getClientRects().length > 0;
}

/** Returns the size of a text in pixels of the screen; drawings may be scaled. */
function sizeOf(element) {
  const size = parseFloat(getComputedStyle(element).fontSize);
  const scale = element instanceof SVGElement ? element.getScreenCTM() : null;
  return scale ? size * Math.hypot(scale.a, scale.b) : size;
}

/** Returns the cells of table heads with more than two lines, which leave a gap above the others. */
function tallHeads() {
  return [...document.querySelectorAll("thead th")].filter((cell) => {
    const lines = document.createRange();
    lines.selectNodeContents(cell);
    return new Set([...lines.getClientRects()].map((box) => Math.round(box.top))).size > 2;
  }).map(describe);
}

/** Returns the charts that do not take the keys that zoom and pan. */
function stuckCharts() {
  return [...document.querySelectorAll(".u-over")].filter((over) => {
    const keys = ["+", "ArrowRight", "-", "Home"].map((key) => new KeyboardEvent("keydown", { key, cancelable: true }));
    return over.tabIndex < 0 || keys.some((key) => over.dispatchEvent(key));
  }).map(describe);
}

/** Returns what a chart shows: the views of its plots, and its ticks. */
function stateOf(chart) {
  const views = [...chart.querySelectorAll(".plot")].map((plot) => plot.getAttribute("viewBox").split(" ").map(Number));
  return { views, ticks: [...chart.querySelectorAll(".tick")].map((tick) => tick.textContent) };
}

/** Sends a pointer event to a point of a chart's plot; `across` and `down` are shares of it. */
function point(chart, name, across, down) {
  const plot = chart.querySelector(".plot");
  const [x, y, width, height] = ["x", "y", "width", "height"].map((one) => plot[one].baseVal.value);
  const at = new DOMPoint(x + across * width, y + down * height).matrixTransform(chart.getScreenCTM());
  chart.dispatchEvent(new PointerEvent(name, { clientX: at.x, clientY: at.y, pointerId: 1, pointerType: "mouse",
    bubbles: true, cancelable: true }));
}

/**
 * Returns the charts of figures that do not show what the mouse selects, with ticks of that part, or do not return, and
 * those of the first that cannot be saved as a picture.
 */
async function stuckFigures() {
  const stuck = [];
  const charts = [...document.querySelectorAll(".charts .chart")];
  for (const chart of charts) {
    const before = stateOf(chart);
    if (chart.querySelector(".plot")) {
      chart.setPointerCapture = () => {}; // no real pointer is down
      const { x, y, width, height } = chart.querySelector(".plot").viewBox.baseVal;
      const expected = [x + 0.4 * width, y + 0.5 * height, 0.2 * width, 0.3 * height];
      point(chart, "pointerdown", 0.4, 0.5);
      point(chart, "pointermove", 0.5, 0.6);
      point(chart, "pointerup", 0.6, 0.8);
      const part = stateOf(chart);
      const isPart = part.views.every((view) => view.every((value, i) => Math.abs(value - expected[i]) < 0.01 * width));
      point(chart, "dblclick", 0.5, 0.5);
      const returns = JSON.stringify(stateOf(chart)) === JSON.stringify(before);
      if (!isPart || part.ticks.length < 4 || !returns) {
        stuck.push(`${describe(chart)} shows ${JSON.stringify(part)}, expected ${expected}; returns: ${returns}`);
      }
    }
  }
  for (const chart of charts.slice(0, 3)) { // each takes a while
    const png = await png_of(chart);
    if (!png || png.size < 2000) {
      stuck.push(`${describe(chart)} is a PNG of ${png && png.size} bytes`);
    }
  }
  return stuck;
}

/** Returns the tables: the text of all cells, row by row. */
function tablesOf() {
  return [...document.querySelectorAll("table")].map((table) =>
    [...table.rows].map((row) => [...row.cells].map((cell) => cell.innerText.trim())));
}

/** Returns the texts that show a value without a number. */
function unprinted(texts) {
  return texts.filter((one) => /(^|[^\w])-?(nan|inf|undefined|null)([^\w]|$)/i.test(one.textContent)).map(describe);
}

async function probe() {
  const width = document.documentElement.clientWidth;
  const elements = [...document.body.querySelectorAll("*")].filter((one) => !["SCRIPT", "STYLE"].includes(one.tagName));
  const texts = elements.filter(showsText);
  const cut = texts.filter((one) => {
    const box = one.getBoundingClientRect();
    return (box.right > width + 1 || box.left < -1) && !isScrolled(one);
  });
  const clipped = texts.filter((one) => {
    const style = getComputedStyle(one);
    return style.overflowX === "hidden" && one.scrollWidth > one.clientWidth + 1;
  });
  const controls = [...document.querySelectorAll("a[href], button, summary, input, select, [role=button]")]
    .filter((one) => one.checkVisibility());
  const scrollers = elements.filter((one) => ["auto", "scroll"].includes(getComputedStyle(one).overflowX) &&
    one.scrollWidth > one.clientWidth + 1);
  const body = getComputedStyle(document.body);
  parent.postMessage(JSON.stringify({
    width, innerWidth, pageWidth: document.documentElement.scrollWidth,
    text: document.body.innerText, tables: tablesOf(), unprinted: unprinted(texts),
    cut: cut.map(describe), clipped: clipped.map(describe),
    faint: texts.filter((one) => contrastOf(one) < 4.5).map((one) => `${describe(one)} ${contrastOf(one).toFixed(2)}`),
    small: texts.filter((one) => sizeOf(one) < smallestText).map((one) => `${describe(one)} ${sizeOf(one).toFixed(1)} px`),
    tall: tallHeads(),
    controls: controls.length,
    unreachable: controls.filter((one) => one.tabIndex < 0 && !one.disabled).map(describe)
      .concat(scrollers.filter((one) => one.tabIndex < 0 && !one.querySelector("a, button, input, [tabindex]")).map(describe)),
    background: luminanceOf(backgroundOf(document.body)), foreground: luminanceOf(colourOf(body.color)),
    stuck: stuckCharts().concat(await stuckFigures()),
    errors: window.probeErrors,
  }), "*");
}

addEventListener("load", () => setTimeout(probe, 1000));
