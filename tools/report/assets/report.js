// SPDX-License-Identifier: Apache-2.0

// Assembles the page: a block of charts per output and one for the innovation, their read-outs, and the common
// controls.

const print_width = 680; // CSS pixels that fit on A4 and on Letter

function element(name, class_name, ...children) {
    const node = document.createElement(name);
    node.className = class_name;
    node.append(...children);
    return node;
}

// Times of recordings from here on are seconds since 1970 (this one is in 2001), and shown as dates.
const first_date_s = 1e9;
const last_date_s = 8.64e12; // of Date

// A key of the legend, followed by the value under the cursor.
function legend_key(kind, text) {
    const value = element("span", "value");
    return { node: element("span", `key ${kind}`, element("i", "swatch"), text, value), value };
}

function show_number(value, decimals) {
    return value === null || value === undefined ? "" : signed_text(value.toFixed(decimals));
}

class Page {
    constructor(report) {
        this.report = report;
        this.range = new TimeRange(report.time, report.sample_time);
        this.theme = read_theme({});
        this.charts = []; // {chart, limits, height_for, visible, stale}
        this.readers = []; // each shows the values of a row, or none for null
        this.summaries = []; // each shows figures of the rows in view
        this.row = undefined;
        this.width = undefined;
        this.printing = false;
        this.time_decimals = decimals_for(report.sample_time);
    }

    build() {
        this.report.outputs.forEach(output => this.add_output(output));
        if (this.report.innovation !== null) {
            this.add_innovation(this.report.innovation);
        }
        document.getElementById("toolbar").hidden = false;
        document.getElementById("reset").addEventListener("click", () => this.range.reset());
        this.range.listeners.push(() => this.show_range());
        this.follow_theme();
        this.follow_size();
        this.follow_print();
        this.show_range();
        this.follow_scrolling();
        this.read_out(null);
    }

    add_block(title, unit, keys) {
        const id = `chart-${document.querySelectorAll("#charts > section").length + 1}`;
        const figures = element("div", "figures");
        const heading = element("h2", "", title, " ", element("small", "", unit));
        const block = element(
            "section",
            "",
            element("div", "heading", heading, figures),
            element("div", "keys", ...keys.map(key => key.node)),
        );
        block.id = id;
        document.getElementById("charts").append(block);
        const link = element("a", "", title);
        link.href = `#${id}`;
        document.getElementById("contents").append(link);
        return { block, figures };
    }

    add_chart({ options, data, limits }, block) {
        const chart = new uPlot(options, data, block);
        add_gestures(chart, this.range);
        this.charts.push({ chart, limits, height_for: options.height_for, visible: true, stale: true });
    }

    add_output(output) {
        const measured = legend_key("measured", "measured");
        const predicted = legend_key("predicted", "predicted ±\u202f2σ");
        const error = legend_key("error", "error");
        const { block, figures } = this.add_block(output.name, output.unit, [measured, predicted, error]);
        this.add_chart(signal_chart(this, output), block);
        this.add_chart(error_chart(this, output), block);
        const [min, max] = extremes(output.measured, [0, output.measured.length - 1]);
        const decimals = max > min ? decimals_for(10 ** Math.floor(Math.log10((max - min) / 1000))) : 3;
        this.readers.push(row => {
            const margin = show_number(output.margin[row], decimals);
            measured.value.textContent = show_number(output.measured[row], decimals);
            predicted.value.textContent =
                show_number(output.predicted[row], decimals) + (margin && ` ± ${margin}`);
            error.value.textContent = show_number(output.error[row], decimals);
        });
        this.add_summary(figures, rows => error_figures(output, rows, decimals));
    }

    add_innovation(innovation) {
        const value = legend_key("innovation", "normalised innovation squared");
        const threshold = innovation.threshold.toPrecision(3);
        const limit = legend_key(
            "threshold",
            `threshold ${threshold}${innovation.threshold_label && ` (${innovation.threshold_label})`}`,
        );
        const { block, figures } = this.add_block("Innovation", "", [value, limit]);
        this.add_chart(innovation_chart(this, innovation), block);
        this.readers.push(row => (value.value.textContent = innovation.values[row]?.toPrecision(3) ?? ""));
        this.add_summary(figures, rows => innovation_figures(innovation, rows));
    }

    // Shows the figures of the rows in view. The rows of a thinned page are extreme: they have no such figures.
    add_summary(node, figures_of) {
        if (!this.report.thinned) {
            this.summaries.push(rows => show_figures(node, figures_of(rows)));
        }
    }

    // Shows the values of `row` (null: the cursor is on no chart) in all legends.
    read_out(row) {
        const shown = row ?? null;
        if (shown === this.row) {
            return;
        }
        this.row = shown;
        this.readers.forEach(reader => reader(shown));
        this.show_where();
    }

    show_where() {
        const text = this.row === null ? this.range_text() : this.place_text(this.report.time[this.row]);
        document.getElementById("where").textContent = text;
    }

    range_text() {
        const [min, max] = [this.range.min, this.range.max].map(t =>
            signed_text(t.toFixed(this.time_decimals)),
        );
        return `${min} – ${max} s`;
    }

    // Plot time, then the recording with its own time, then the intervals that contain it.
    place_text(t) {
        const seconds = value => `${signed_text(value.toFixed(this.time_decimals))} s`;
        const parts = [`t = ${seconds(t)}`];
        const recording = this.report.recordings.filter(each => each.start_s <= t).pop();
        if (recording !== undefined) {
            const own = recording.first_t_s + t - recording.start_s;
            if (own > first_date_s && own < last_date_s) {
                parts.push(`${recording.name}, ${new Date(1e3 * own).toISOString().replace("T", " ").replace("Z", " UTC")}`);
            } else if (this.report.recordings.length > 1) {
                parts.push(`${recording.name} at ${seconds(own)}`);
            }
        }
        const around = this.report.intervals.filter(each => each.start_s <= t && t <= each.end_s);
        return parts.concat(around.map(each => each.label)).join("  ·  ");
    }

    show_range() {
        const { rows } = this.range;
        this.charts.forEach(entry => (entry.stale = true));
        this.update_charts(entry => entry.visible);
        this.summaries.forEach(summary => summary(rows));
        document.getElementById("reset").disabled = this.range.is_whole;
        this.show_where();
    }

    // Drawing is slow: charts outside the view are drawn when they come into view.
    update_charts(wanted) {
        const { min, max, rows } = this.range;
        for (const entry of this.charts.filter(each => each.stale && wanted(each))) {
            const [low, high] = entry.limits(rows);
            entry.stale = false;
            entry.chart.batch(() => {
                entry.chart.setScale("x", { min, max });
                entry.chart.setScale("y", { min: low, max: high });
            });
        }
    }

    resize(width) {
        if (width === this.width) {
            return;
        }
        this.width = width;
        const narrow = width < narrow_page || this.printing;
        this.charts.forEach(({ chart, height_for }) => chart.setSize({ width, height: height_for(narrow) }));
    }

    redraw() {
        read_theme(this.theme);
        this.charts.forEach(({ chart }) => chart.redraw());
    }

    follow_theme() {
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    }

    follow_size() {
        const container = document.getElementById("charts");
        this.resize(container.clientWidth);
        new ResizeObserver(() => this.printing || this.resize(container.clientWidth)).observe(container);
    }

    follow_scrolling() {
        const entry_of = new Map(this.charts.map(entry => [entry.chart.root, entry]));
        const observer = new IntersectionObserver(
            changes => {
                changes.forEach(change => (entry_of.get(change.target).visible = change.isIntersecting));
                this.update_charts(entry => entry.visible);
            },
            { rootMargin: "200px 0px" },
        );
        entry_of.forEach((entry, root) => observer.observe(root));
    }

    // A canvas does not adapt to paper: printing uses the light colours and a fitting width.
    follow_print() {
        const print = on => {
            this.printing = on;
            this.update_charts(() => true);
            document.documentElement.classList.toggle("printing", on);
            this.resize(on ? print_width : document.getElementById("charts").clientWidth);
            this.redraw();
        };
        addEventListener("beforeprint", () => print(true));
        addEventListener("afterprint", () => print(false));
    }
}

function show_figures(node, figures) {
    node.replaceChildren(...["In view", ...figures].map(text => element("span", "", text)));
}

function with_unit_after(number, unit) {
    return unit === "" ? number : `${number} ${unit}`;
}

function error_figures(output, [first, last], decimals) {
    let count = 0;
    let squares = 0;
    let largest = 0;
    let within = 0;
    let banded = 0;
    for (let row = first; row <= last; ++row) {
        const error = output.error[row];
        const margin = output.margin[row];
        if (error !== null) {
            ++count;
            squares += error * error;
            largest = Math.max(largest, Math.abs(error));
        }
        if (error !== null && margin !== null) {
            ++banded;
            within += Math.abs(error) <= margin;
        }
    }
    const shown = value => with_unit_after(value.toFixed(decimals), output.unit);
    const sizes = [`RMS error ${shown(Math.sqrt(squares / count))}`, `largest ${shown(largest)}`];
    const share = `${((100 * within) / banded).toFixed(1)} % within ±\u202f2σ`;
    return (count > 0 ? sizes : ["no prediction"]).concat(banded > 0 ? share : []);
}

function innovation_figures(innovation, [first, last]) {
    const values = innovation.values.slice(first, last + 1).filter(value => value !== null);
    const above = values.filter(value => value > innovation.threshold).length;
    return values.length > 0
        ? [`${((100 * above) / values.length).toFixed(1)} % above the threshold`]
        : ["no prediction"];
}

const report = decode_report(document.getElementById("report-data").textContent);
if (report.time.length > 0 && report.outputs.length + Number(report.innovation !== null) > 0) {
    new Page(report).build();
}
