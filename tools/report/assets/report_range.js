// SPDX-License-Identifier: Apache-2.0

// The time range that all charts show, and the gestures that change it.

const shortest_range_in_samples = 8;

class TimeRange {
    constructor(time, sample_time) {
        const margin = time.length > 1 ? 0 : sample_time;
        this.time = time;
        this.shortest = shortest_range_in_samples * sample_time;
        this.whole = [time[0] - margin, time[time.length - 1] + margin];
        [this.min, this.max] = this.whole;
        this.listeners = [];
        this.pending = false;
    }

    get is_whole() {
        return this.min === this.whole[0] && this.max === this.whole[1];
    }

    // First and last row in view.
    get rows() {
        return [first_row_at(this.time, this.min), Math.max(first_row_after(this.time, this.max) - 1, 0)];
    }

    reset() {
        this.show(...this.whole);
    }

    // Shows min..max, no shorter than a few samples and within the data; the charts follow in the next frame.
    show(min, max) {
        const length = Math.min(Math.max(max - min, this.shortest), this.whole[1] - this.whole[0]);
        const start = Math.min(Math.max((min + max - length) / 2, this.whole[0]), this.whole[1] - length);
        const is_whole = length > 0.999 * (this.whole[1] - this.whole[0]);
        [this.min, this.max] = is_whole ? this.whole : [start, start + length];
        if (!this.pending) {
            this.pending = true;
            requestAnimationFrame(() => this.notify());
        }
    }

    notify() {
        this.pending = false;
        this.listeners.forEach(listener => listener());
    }
}

function first_row_at(time, t) {
    return first_row(time, value => value >= t);
}

function first_row_after(time, t) {
    return first_row(time, value => value > t);
}

// The first row whose time satisfies `holds`, which is false up to some row and true from there.
function first_row(time, holds) {
    let low = 0;
    let high = time.length;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (holds(time[middle])) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

// The selection that the mouse dragged becomes the range.
function show_selection(chart, range) {
    const { left, width } = chart.select;
    if (width > 0) {
        range.show(chart.posToVal(left, "x"), chart.posToVal(left + width, "x"));
        chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    }
}

// Ctrl + wheel, which a pinch on a touchpad also sends, zooms around the pointer; a sideways wheel pans.
// The plain wheel scrolls the page.
function handle_wheel(event, chart, range) {
    if (event.ctrlKey || event.metaKey) {
        const centre = chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, "x");
        const factor = Math.exp(0.008 * Math.min(Math.max(event.deltaY, -30), 30));
        range.show(centre - (centre - range.min) * factor, centre + (range.max - centre) * factor);
    } else if (!range.is_whole && Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        const shift = (event.deltaX / chart.over.clientWidth) * (range.max - range.min);
        range.show(range.min + shift, range.max + shift);
    } else {
        return;
    }
    event.preventDefault();
}

// A chart with the focus: + and - zoom, the arrows pan, Home shows all.
function handle_key(event, range) {
    const length = range.max - range.min;
    const changes = {
        "+": [0.25 * length, -0.25 * length],
        "-": [-0.5 * length, 0.5 * length],
        ArrowLeft: [-0.2 * length, -0.2 * length],
        ArrowRight: [0.2 * length, 0.2 * length],
        Home: [range.whole[0] - range.min, range.whole[1] - range.max],
    };
    const change = changes[event.key];
    if (change === undefined || event.ctrlKey || event.altKey || event.metaKey) {
        return;
    }
    range.show(range.min + change[0], range.max + change[1]);
    event.preventDefault();
}

// Touch: one finger moves the cursor, two fingers zoom and pan; a vertical swipe still scrolls the page.
class TouchGestures {
    constructor(chart, range) {
        this.chart = chart;
        this.range = range;
        // pointer id -> {x, y} in the plot, and the time t under the finger when the last one came down
        this.fingers = new Map();
        const over = chart.over;
        over.style.touchAction = "pan-y";
        over.addEventListener("pointerdown", event => this.on_touch(event, () => this.down(event)));
        over.addEventListener("pointermove", event => this.on_touch(event, () => this.move(event)));
        for (const name of ["pointerup", "pointercancel", "pointerleave"]) {
            over.addEventListener(name, event => this.fingers.delete(event.pointerId));
        }
    }

    on_touch(event, action) {
        if (event.pointerType === "touch") {
            action();
        }
    }

    down(event) {
        const box = this.chart.over.getBoundingClientRect();
        const finger = { x: event.clientX - box.left, y: event.clientY - box.top };
        this.fingers.set(event.pointerId, finger);
        this.fingers.forEach(f => (f.t = this.chart.posToVal(f.x, "x")));
    }

    move(event) {
        const finger = this.fingers.get(event.pointerId);
        if (finger === undefined) {
            return;
        }
        const box = this.chart.over.getBoundingClientRect();
        finger.x = event.clientX - box.left;
        finger.y = event.clientY - box.top;
        if (this.fingers.size === 2) {
            this.pinch(...this.fingers.values());
        } else {
            this.chart.setCursor({ left: finger.x, top: finger.y }, true, true);
        }
    }

    // The range in which both fingers remain at the times at which they touched the plot.
    pinch(a, b) {
        const time_per_pixel = (b.t - a.t) / (b.x - a.x);
        if (time_per_pixel > 0 && Number.isFinite(time_per_pixel)) {
            const min = a.t - a.x * time_per_pixel;
            this.range.show(min, min + this.chart.over.clientWidth * time_per_pixel);
        }
    }
}

function add_gestures(chart, range) {
    chart.over.addEventListener("wheel", event => handle_wheel(event, chart, range), { passive: false });
    new TouchGestures(chart, range);
    chart.over.tabIndex = 0;
    chart.over.setAttribute("role", "application");
    chart.over.setAttribute("aria-label", "chart: plus and minus zoom, arrows pan, Home shows all");
    chart.over.addEventListener("keydown", event => handle_key(event, range));
}
