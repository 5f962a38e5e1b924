// SPDX-License-Identifier: Apache-2.0

// The charts: their lines, axes and limits.

const axis_label_size = 18;
const right_margin = 24; // half the text of a tick
const half_tick_height = 8;
const narrow_page = 600;

// Colours and font as the style sheet has them now; the charts read them at each drawing.
function read_theme(theme) {
    const style = getComputedStyle(document.documentElement);
    for (const name of [
        "ink",
        "muted",
        "grid",
        "measured",
        "predicted",
        "band",
        "error",
        "innovation",
        "alarm",
        "interval",
        "interval-edge",
        "interval-text",
        "boundary",
    ]) {
        theme[name.replace("-", "_")] = style.getPropertyValue("--" + name).trim();
    }
    theme.font = getComputedStyle(document.body).fontFamily;
    return theme;
}

// The numbers among `values` in rows first..last, sorted; of a long interval a few thousand, evenly spaced.
function sorted_numbers(values, [first, last]) {
    const stride = Math.max(1, Math.floor((last - first + 1) / 4000));
    const numbers = [];
    for (let row = first; row <= last; row += stride) {
        if (values[row] !== null) {
            numbers.push(values[row]);
        }
    }
    return Float64Array.from(numbers).sort();
}

function quantile(sorted, share) {
    return sorted[Math.round(share * (sorted.length - 1))];
}

function extremes(values, [first, last]) {
    let min = Infinity;
    let max = -Infinity;
    for (let row = first; row <= last; ++row) {
        if (values[row] !== null) {
            min = Math.min(min, values[row]);
            max = Math.max(max, values[row]);
        }
    }
    return [min, max];
}

// Includes all measurements, and the predictions without the few farthest ones, so that a large error of the
// first prediction does not flatten the curves.
function signal_limits(output, rows) {
    let [min, max] = extremes(output.measured, rows);
    const predicted = sorted_numbers(output.predicted, rows);
    if (predicted.length > 0) {
        min = Math.min(min, quantile(predicted, 0.0025));
        max = Math.max(max, quantile(predicted, 0.9975));
    }
    if (!(min <= max)) {
        return [-1, 1];
    }
    const margin = 0.08 * (max - min) || Math.abs(max) || 1;
    return [min - margin, max + margin];
}

function error_limits(output, rows) {
    const errors = sorted_numbers(output.error, rows);
    const margins = sorted_numbers(output.margin, rows);
    const furthest = Math.max(
        -quantile(errors, 0.0025) || 0,
        quantile(errors, 0.9975) || 0,
        quantile(margins, 0.5) || 0,
    );
    return [-1.2 * furthest || -1, 1.2 * furthest || 1];
}

// Includes the threshold, unless it is so far above all values that they would not be seen: a threshold that was
// never calibrated is 1e30.
function innovation_limits(innovation, rows) {
    const values = sorted_numbers(innovation.values, rows);
    const largest = extremes(innovation.values, rows)[1];
    const { threshold } = innovation;
    const far = largest > 0 && threshold > 1e6 * largest;
    const max = Math.max(largest, far ? 0 : 3 * threshold);
    const min = Math.min(quantile(values, 0.005) || Infinity, far ? largest / 10 : threshold / 10);
    return uPlot.rangeLog(Math.max(min, 1e-6 * max), max, 10, false);
}

// Number of decimals for a multiple of `step`, which has at most two significant digits.
function decimals_for(step) {
    const of_first_digit = Math.max(-Math.floor(Math.log10(step) + 1e-6), 0);
    const exact = Math.abs(step * 10 ** of_first_digit - Math.round(step * 10 ** of_first_digit)) < 1e-6;
    return Math.min(of_first_digit + Number(!exact), 9);
}

// Uses the typographic minus sign, which is as wide as a digit.
function signed_text(text) {
    return text.replace("-", "\u2212");
}

function tick_texts(chart, splits, axis, space, step) {
    const short = step >= 1e-4 && Math.max(...splits.map(Math.abs)) < 1e5;
    return splits.map(v =>
        signed_text(short ? v.toFixed(decimals_for(step)) : v === 0 ? "0" : v.toExponential(1)),
    );
}

function power_of_ten_texts(chart, splits) {
    const superscript = exponent =>
        Array.from(String(exponent), c => "⁰¹²³⁴⁵⁶⁷⁸⁹"["0123456789".indexOf(c)] ?? "⁻").join("");
    return splits.map(v => {
        const exponent = Math.floor(Math.log10(v) + 1e-9);
        const digit = Math.round(v / 10 ** exponent);
        return v === null
            ? ""
            : Math.abs(exponent) < 4
              ? String(v)
              : (digit === 1 ? "10" : digit + "·10") + superscript(exponent);
    });
}

function only_powers_of_ten(chart, splits) {
    return splits.map(v => (Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9 ? v : null));
}

function axis_style(theme) {
    return {
        stroke: () => theme.muted,
        font: `12px ${theme.font}`,
        labelFont: `12px ${theme.font}`,
        grid: { stroke: () => theme.grid, width: 1 },
        ticks: { show: false },
        gap: 8,
    };
}

function time_axis(theme, labelled) {
    const hidden = { size: 0, values: (chart, splits) => splits.map(() => "") };
    const shown = { size: 26, values: tick_texts, label: "time, s", labelSize: 20, labelGap: 0 };
    return { ...axis_style(theme), space: 70, ...(labelled ? shown : hidden) };
}

// Equal for all charts, so that their time axes are aligned.
function value_axis_size(chart) {
    return chart.width < narrow_page ? 50 : 60;
}

function value_axis(theme, label) {
    return {
        ...axis_style(theme),
        space: 26,
        size: value_axis_size,
        values: tick_texts,
        label,
        labelSize: axis_label_size,
        labelGap: 0,
    };
}

function line(stroke, width) {
    return { stroke, width, points: { show: false } };
}

// A line that also shows its samples if they are far enough apart.
function sampled_line(stroke, width) {
    return { stroke, width, points: { size: 5, width: 0, fill: stroke } };
}

// Common options of all charts. `height(narrow)`: height of the plot with its axes, without the lanes of
// labels above it.
function chart_options(page, { y_label, height, lanes, with_time }) {
    const keep = (chart, min, max) => [min, max];
    const top = half_tick_height + (lanes ? lane_count(lanes) * lane_height : 0);
    return {
        width: 300,
        height: 200,
        height_for: narrow => height(narrow) + top,
        padding: [top, right_margin, with_time ? 0 : half_tick_height, 0],
        legend: { show: false },
        scales: { x: { time: false, range: keep }, y: { auto: false, range: keep, min: 0.1, max: 1 } },
        axes: [time_axis(page.theme, with_time), value_axis(page.theme, y_label)],
        cursor: {
            y: false,
            points: { show: false },
            drag: { x: true, y: false, setScale: false, dist: 4 },
            sync: { key: "time", scales: ["x", null], filters: { pub: type => type === "mousemove" } },
            bind: { dblclick: () => () => page.range.reset() },
        },
        hooks: {
            drawAxes: [chart => draw_background(chart, page.report, page.theme)],
            draw: lanes ? [chart => draw_labels(chart, page.report, page.theme, lanes)] : [],
            setSelect: [chart => show_selection(chart, page.range)],
            setCursor: [chart => page.read_out(chart.cursor.idx)],
        },
    };
}

function with_unit(text, unit) {
    return unit === "" ? text : `${text}, ${unit}`;
}

function signal_chart(page, output) {
    const { theme } = page;
    const options = chart_options(page, {
        y_label: with_unit(output.name, output.unit),
        height: narrow => (narrow ? 180 : 230),
        lanes: label_lanes(page.report),
        with_time: false,
    });
    options.series = [
        {},
        line(null, 0),
        line(null, 0),
        sampled_line(() => theme.measured, 1.5),
        line(() => theme.predicted, 1.5),
    ];
    options.bands = [{ series: [1, 2], fill: () => theme.band }];
    const data = [page.report.time, output.upper, output.lower, output.measured, output.predicted];
    return { options, data, limits: rows => signal_limits(output, rows) };
}

function error_chart(page, output) {
    const { theme } = page;
    const options = chart_options(page, {
        y_label: with_unit("error", output.unit),
        height: narrow => (narrow ? 140 : 160),
        lanes: null,
        with_time: true,
    });
    options.series = [
        {},
        line(() => theme.predicted, 1),
        line(() => theme.predicted, 1),
        sampled_line(() => theme.error, 1.25),
    ];
    options.bands = [{ series: [1, 2], fill: () => theme.band }];
    const data = [page.report.time, output.margin, output.margin_below, output.error];
    return { options, data, limits: rows => error_limits(output, rows) };
}

function innovation_chart(page, innovation) {
    const { theme } = page;
    const options = chart_options(page, {
        y_label: "NIS",
        height: narrow => (narrow ? 210 : 250),
        lanes: label_lanes(page.report),
        with_time: true,
    });
    options.scales.y.distr = 3;
    options.axes[1].values = power_of_ten_texts;
    options.axes[1].grid.filter = only_powers_of_ten;
    options.series = [{}, sampled_line(() => theme.innovation, 1)];
    options.hooks.drawSeries = [chart => draw_above_threshold(chart, innovation, theme)];
    options.hooks.draw.push(chart => draw_threshold(chart, innovation, theme));
    return {
        options,
        data: [page.report.time, innovation.values],
        limits: rows => innovation_limits(innovation, rows),
    };
}
