// SPDX-License-Identifier: Apache-2.0
"use strict";

// Charts of a page of figures. A dragged rectangle becomes the view, also of charts over the same x. A double click
// shows all. A button saves the chart as a picture.

const largest_zoom = 20; // the paths have a resolution of a hundredth of a pixel
const shortest_drag = 8; // pixels
const svg_namespace = "http://www.w3.org/2000/svg";

// An axis with values `ends` at the pixels `pixels` of the whole plot.
class ChartAxis {
    constructor(ends, pixels, is_log) {
        this.is_log = is_log;
        this.ends = ends.map(value => this.scaled(value));
        this.pixels = pixels;
    }

    scaled(value) {
        return this.is_log ? Math.log10(value) : value;
    }

    value(pixel) {
        const share = (pixel - this.pixels[0]) / (this.pixels[1] - this.pixels[0]);
        const scaled = this.ends[0] + share * (this.ends[1] - this.ends[0]);
        return this.is_log ? 10 ** scaled : scaled;
    }

    pixel(value) {
        const share = (this.scaled(value) - this.ends[0]) / (this.ends[1] - this.ends[0]);
        return this.pixels[0] + share * (this.pixels[1] - this.pixels[0]);
    }

    // Values and labels of the grid lines between two pixels.
    ticks(from, to) {
        const [low, high] = [this.value(from), this.value(to)].sort((a, b) => a - b);
        return this.is_log && high > 20 * low ? decade_ticks(low, high) : even_ticks(low, high);
    }
}

// Four to ten multiples of 1, 2 or 5 times a power of ten.
function even_ticks(low, high) {
    const power = 10 ** Math.floor(Math.log10((high - low) / 4));
    const step = power * [5, 2, 1].find(multiple => multiple * power <= (high - low) / 4);
    const digits = Math.min(Math.max(-Math.floor(Math.log10(step) + 1e-9), 0), 12);
    const ticks = [];
    for (let i = Math.ceil(low / step); i * step <= high; ++i) {
        ticks.push([i * step, (i * step).toFixed(digits).replace(/^-(?=0\.?0*$)/, "")]);
    }
    return ticks;
}

function decade_ticks(low, high) {
    const ticks = [];
    for (let power = 10 ** Math.floor(Math.log10(low)); power <= high; power *= 10) {
        for (const value of [power, 2 * power, 5 * power]) {
            if (value >= low && value <= high) {
                ticks.push([value, String(Number(value.toPrecision(3)))]);
            }
        }
    }
    return ticks;
}

function element(name, attributes, text = "") {
    const made = document.createElementNS(svg_namespace, name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    made.textContent = text;
    return made;
}

class ZoomableChart {
    constructor(chart) {
        this.chart = chart;
        this.plots = [...chart.querySelectorAll(".plot")];
        const { x, y, width, height } = this.plots[0].viewBox.baseVal;
        this.whole = { x, y, width, height };
        this.view = this.whole;
        this.axes = chart.querySelector(".axes");
        this.all_of_axes = [...this.axes.children];
        const is_log = this.axes.dataset.scale === "log";
        const ends = name => this.axes.dataset[name].split(" ").map(Number);
        this.x = new ChartAxis(ends("x"), [x, x + width], is_log);
        this.y = new ChartAxis(ends("y"), [y + height, y], is_log);
        // charts with the same key have the same x
        this.key = `${this.axes.dataset.x} ${chart.querySelector(".label").textContent}`;
        this.listeners = [];
    }

    get is_whole() {
        return this.view === this.whole;
    }

    // Shows a part of the plot, in its pixels, at most `largest_zoom` times as large.
    show(part) {
        const view = {};
        for (const [start, length] of [["x", "width"], ["y", "height"]]) {
            view[length] = Math.min(Math.max(part[length], this.whole[length] / largest_zoom), this.whole[length]);
            const wanted = part[start] + (part[length] - view[length]) / 2;
            const last = this.whole[start] + this.whole[length] - view[length];
            view[start] = Math.min(Math.max(wanted, this.whole[start]), last);
        }
        const is_whole = view.width > 0.999 * this.whole.width && view.height > 0.999 * this.whole.height;
        this.view = is_whole ? this.whole : view;
        this.draw();
        this.listeners.forEach(listener => listener());
    }

    draw() {
        const { x, y, width, height } = this.view;
        this.plots.forEach(plot => plot.setAttribute("viewBox", `${x} ${y} ${width} ${height}`));
        this.chart.classList.toggle("zoomed", !this.is_whole);
        const labels = this.all_of_axes.filter(one => one.classList.contains("label"));
        this.axes.replaceChildren(...(this.is_whole ? this.all_of_axes : [...this.grid_of_x(), ...this.grid_of_y(), ...labels]));
    }

    grid_of_x() {
        const { x, y, width, height } = this.whole;
        return this.x.ticks(this.view.x, this.view.x + this.view.width).flatMap(([value, label]) => {
            const at = x + ((this.x.pixel(value) - this.view.x) / this.view.width) * width;
            return [element("line", { class: "grid", x1: at, x2: at, y1: y, y2: y + height }),
                element("text", { class: "tick", x: at, y: y + height + 17 }, label)];
        });
    }

    grid_of_y() {
        const { x, y, width, height } = this.whole;
        return this.y.ticks(this.view.y, this.view.y + this.view.height).flatMap(([value, label]) => {
            const at = y + ((this.y.pixel(value) - this.view.y) / this.view.height) * height;
            return [element("line", { class: "grid", x1: x, x2: x + width, y1: at, y2: at }),
                element("text", { class: "tick y", x: x - 7, y: at + 4 }, label)];
        });
    }

    // Returns the point of the plot under the pointer, in the plot's pixels; within the plot if `inside`.
    point(event) {
        const on_chart = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.chart.getScreenCTM().inverse());
        const share = (value, start, length) => Math.min(Math.max((value - start) / length, 0), 1);
        const across = share(on_chart.x, this.whole.x, this.whole.width);
        const down = share(on_chart.y, this.whole.y, this.whole.height);
        return { x: this.view.x + across * this.view.width, y: this.view.y + down * this.view.height };
    }

    covers(event) {
        const on_chart = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.chart.getScreenCTM().inverse());
        const { x, y, width, height } = this.whole;
        return on_chart.x >= x && on_chart.x <= x + width && on_chart.y >= y && on_chart.y <= y + height;
    }
}

// A rectangle that the mouse drags becomes the view; a flat rectangle changes one axis only.
function add_dragging(chart) {
    let start = null;
    const frame = element("rect", { class: "selection" });
    const part_to = event => {
        const end = chart.point(event);
        const part = { x: Math.min(start.x, end.x), y: Math.min(start.y, end.y),
            width: Math.abs(end.x - start.x), height: Math.abs(end.y - start.y) };
        const is_short = length => part[length] * chart.whole[length] < shortest_drag * chart.view[length];
        const flat = { x: is_short("width"), y: is_short("height") };
        return { part: { ...part, ...(flat.y && { y: chart.view.y, height: chart.view.height }),
            ...(flat.x && { x: chart.view.x, width: chart.view.width }) }, is_click: flat.x && flat.y };
    };
    chart.chart.addEventListener("pointerdown", event => {
        if (event.pointerType !== "touch" && event.button === 0 && chart.covers(event)) {
            start = chart.point(event);
            chart.chart.setPointerCapture(event.pointerId);
            event.preventDefault();
        }
    });
    chart.chart.addEventListener("pointermove", event => {
        if (start !== null) {
            const { part, is_click } = part_to(event);
            Object.entries(part).forEach(([name, value]) => frame.setAttribute(name, value));
            is_click ? frame.remove() : chart.plots[0].append(frame);
        }
    });
    chart.chart.addEventListener("pointerup", event => {
        if (start !== null) {
            const { part, is_click } = part_to(event);
            start = null;
            frame.remove();
            is_click || chart.show(part);
        }
    });
    chart.chart.addEventListener("pointercancel", () => {
        start = null;
        frame.remove();
    });
    chart.chart.addEventListener("dblclick", () => chart.show(chart.whole));
}

// Ctrl + wheel, which a pinch on a touchpad also sends, zooms around the pointer.
function add_wheel(chart) {
    chart.chart.addEventListener("wheel", event => {
        if ((event.ctrlKey || event.metaKey) && chart.covers(event)) {
            const by = Math.exp(0.008 * Math.min(Math.max(event.deltaY, -30), 30));
            const centre = chart.point(event);
            const { x, y, width, height } = chart.view;
            chart.show({ x: centre.x - by * (centre.x - x), y: centre.y - by * (centre.y - y), width: by * width, height: by * height });
            event.preventDefault();
        }
    }, { passive: false });
}

// Keys of a chart with the focus: + and - zoom, the arrows pan, Home shows all.
function add_keys(chart) {
    chart.chart.parentElement.addEventListener("keydown", event => {
        const { x, y, width, height } = chart.view;
        const zoomed = by => ({ x: x + (width - by * width) / 2, y: y + (height - by * height) / 2, width: by * width, height: by * height });
        const views = {
            "+": zoomed(0.5), "-": zoomed(2), Home: chart.whole,
            ...(!chart.is_whole && {
                ArrowLeft: { ...chart.view, x: x - 0.2 * width }, ArrowRight: { ...chart.view, x: x + 0.2 * width },
                ArrowUp: { ...chart.view, y: y - 0.2 * height }, ArrowDown: { ...chart.view, y: y + 0.2 * height } }),
        };
        if (views[event.key] !== undefined && !event.ctrlKey && !event.altKey && !event.metaKey) {
            chart.show(views[event.key]);
            event.preventDefault();
        }
    });
}

// Returns a promise of the displayed chart as PNG at twice its size.
async function png_of(chart) {
    const copy = chart.cloneNode(true);
    const style = element("style", {}, [...document.querySelectorAll("style")].map(one => one.textContent).join("\n"));
    copy.prepend(style, element("rect", { class: "paper", width: "100%", height: "100%" }));
    const picture = new Image();
    picture.src = `data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
    await picture.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [2 * chart.width.baseVal.value, 2 * chart.height.baseVal.value];
    canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
    return new Promise(done => canvas.toBlob(done, "image/png"));
}

async function save_png(chart) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await png_of(chart));
    link.download = `${chart.getAttribute("aria-label").replace(/[^\p{L}\p{N}]+/gu, "-")}.png`;
    link.click();
    URL.revokeObjectURL(link.href);
}

function button(text, label, action) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", action);
    return made;
}

function add_buttons(svg, chart) {
    const title = svg.getAttribute("aria-label");
    const tools = document.createElement("div");
    tools.className = "chart-tools";
    tools.append(button("PNG", `save “${title}” as PNG`, () => save_png(svg)));
    if (chart !== null) {
        const all = button("Show all", `show all of “${title}”`, () => chart.show(chart.whole));
        all.hidden = true;
        chart.listeners.push(() => (all.hidden = chart.is_whole));
        tools.append(all);
    }
    svg.parentElement.after(tools);
}

// Charts over the same x show the same part of it.
function couple(charts) {
    for (const chart of charts) {
        const others = charts.filter(one => one !== chart && one.key === chart.key);
        chart.listeners.push(() => {
            for (const other of others) {
                if (other.view.x !== chart.view.x || other.view.width !== chart.view.width) {
                    other.show({ ...other.view, x: chart.view.x, width: chart.view.width });
                }
            }
        });
    }
}

const zoomable = [];
for (const svg of document.querySelectorAll(".charts .chart")) {
    const chart = svg.querySelector(".axes") === null ? null : new ZoomableChart(svg);
    add_buttons(svg, chart);
    if (chart !== null) {
        add_dragging(chart);
        add_wheel(chart);
        add_keys(chart);
        zoomable.push(chart);
    }
}
couple(zoomable);
