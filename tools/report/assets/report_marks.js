// SPDX-License-Identifier: Apache-2.0

// Drawings on the charts in addition to their lines: recordings, intervals, the threshold. Positions are in pixels
// of the canvas.

const lane_height = 20; // of one row of labels above a plot, in CSS pixels
const label_gap = 10;

// The rows of labels that this report needs above a plot.
function label_lanes(report) {
    return {
        recordings: report.recordings.length > 1,
        annotations: report.intervals.length > 0,
    };
}

function lane_count(lanes) {
    return Number(lanes.recordings) + Number(lanes.annotations);
}

function recording_end(report, index) {
    return index + 1 < report.recordings.length ? report.recordings[index + 1].start_s : Infinity;
}

// Position of time t, clamped to the plot's edges.
function clamped_position(chart, t) {
    const { left, width } = chart.bbox;
    return Math.min(Math.max(chart.valToPos(t, "x", true), left), left + width);
}

function in_view(chart, start, end) {
    return start <= chart.scales.x.max && end >= chart.scales.x.min;
}

function vertical_line(chart, t, colour) {
    if (!in_view(chart, t, t)) {
        return;
    }
    const { ctx, bbox } = chart;
    const x = Math.round(clamped_position(chart, t)) + 0.5;
    ctx.strokeStyle = colour;
    ctx.lineWidth = uPlot.pxRatio;
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
}

function draw_intervals(chart, report, theme) {
    const { ctx, bbox } = chart;
    for (const { start_s, end_s } of report.intervals) {
        if (in_view(chart, start_s, end_s)) {
            const left = clamped_position(chart, start_s);
            const width = Math.max(clamped_position(chart, end_s) - left, uPlot.pxRatio);
            ctx.fillStyle = theme.interval;
            ctx.fillRect(left, bbox.top, width, bbox.height);
        }
    }
}

// Below the chart's lines: shaded intervals, and where recordings begin.
function draw_background(chart, report, theme) {
    chart.ctx.save();
    draw_intervals(chart, report, theme);
    report.recordings
        .slice(1)
        .forEach(recording => vertical_line(chart, recording.start_s, theme.boundary));
    chart.ctx.restore();
}

// `text`, shortened to `width`; "" if fewer than three characters fit.
function fit_text(ctx, text, width) {
    if (ctx.measureText(text).width <= width) {
        return text;
    }
    const characters = Array.from(text);
    let count = characters.length;
    while (count >= 3 && ctx.measureText(characters.slice(0, count).join("") + "…").width > width) {
        --count;
    }
    return count >= 3 ? characters.slice(0, count).join("") + "…" : "";
}

function draw_recording_names(chart, report, theme, y) {
    const { ctx } = chart;
    ctx.fillStyle = theme.muted;
    report.recordings.forEach((recording, i) => {
        const end = recording_end(report, i);
        if (in_view(chart, recording.start_s, end)) {
            const left = clamped_position(chart, recording.start_s);
            const room = clamped_position(chart, end) - left - label_gap * uPlot.pxRatio;
            ctx.fillText(fit_text(ctx, recording.name, room), left, y);
        }
    });
}

// Draws `text` so that it starts between `from` and `to`, or ends at the plot's right edge, unless it would
// touch one of the labels in `taken`.
function place_label(chart, text, from, to, y, taken) {
    const { ctx, bbox } = chart;
    const width = ctx.measureText(text).width;
    const start = Math.max(from, ...taken.filter(other => other.left <= from).map(other => other.right));
    const left = Math.max(Math.min(start, bbox.left + bbox.width - width), bbox.left);
    const right = left + width + label_gap * uPlot.pxRatio;
    if (start <= to && taken.every(other => right <= other.left || left >= other.right)) {
        ctx.fillText(text, left, y);
        taken.push({ left, right });
    }
}

function draw_interval_bar(chart, interval, theme) {
    const left = clamped_position(chart, interval.start_s);
    const width = Math.max(clamped_position(chart, interval.end_s) - left, 2 * uPlot.pxRatio);
    chart.ctx.fillStyle = theme.interval_edge;
    chart.ctx.fillRect(left, chart.bbox.top - 3 * uPlot.pxRatio, width, 3 * uPlot.pxRatio);
}

function draw_annotation_labels(chart, report, theme, y) {
    const taken = [];
    for (const interval of report.intervals.filter(each => in_view(chart, each.start_s, each.end_s))) {
        draw_interval_bar(chart, interval, theme);
        chart.ctx.fillStyle = theme.interval_text;
        const [from, to] = [interval.start_s, interval.end_s].map(t => clamped_position(chart, t));
        place_label(chart, interval.label, from, to, y, taken);
    }
}

// The lanes of labels above the plot.
function draw_labels(chart, report, theme, lanes) {
    const { ctx, bbox } = chart;
    ctx.save();
    ctx.font = `${12 * uPlot.pxRatio}px ${theme.font}`;
    ctx.textAlign = "left";
    ctx.textBaseline = "alphabetic";
    const lane = index => bbox.top - (index * lane_height + 7) * uPlot.pxRatio;
    if (lanes.annotations) {
        draw_annotation_labels(chart, report, theme, lane(0));
    }
    if (lanes.recordings) {
        draw_recording_names(chart, report, theme, lane(Number(lanes.annotations)));
    }
    ctx.restore();
}

// Draws the line, which uPlot has just drawn, again in the alarm's colour where it is above the threshold.
function draw_above_threshold(chart, innovation, theme) {
    const { ctx, bbox } = chart;
    const { stroke, clip } = chart.series[1]._paths;
    const above = new Path2D();
    above.rect(bbox.left, bbox.top, bbox.width, chart.valToPos(innovation.threshold, "y", true) - bbox.top);
    ctx.save();
    ctx.clip(above);
    if (clip !== null) {
        ctx.clip(clip);
    }
    ctx.strokeStyle = theme.alarm;
    ctx.lineWidth = uPlot.pxRatio;
    ctx.stroke(stroke);
    ctx.restore();
}

function draw_threshold(chart, innovation, theme) {
    const { ctx, bbox } = chart;
    const y = Math.round(chart.valToPos(innovation.threshold, "y", true)) + 0.5;
    ctx.save();
    ctx.strokeStyle = theme.ink;
    ctx.lineWidth = uPlot.pxRatio;
    ctx.setLineDash([6 * uPlot.pxRatio, 3 * uPlot.pxRatio]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
}
