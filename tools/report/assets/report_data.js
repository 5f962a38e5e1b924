// SPDX-License-Identifier: Apache-2.0
"use strict";

// Converts the page's data (base64 of little-endian numbers) to the arrays that the charts draw. Values that are
// not finite become null, which the charts show as a gap.

function decode_bytes(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) {
        bytes[i] = text.charCodeAt(i);
    }
    return bytes.buffer;
}

// `values` with `filler(row)` inserted before each of the rows `breaks`.
function insert_at_breaks(values, breaks, filler) {
    const result = [];
    let next = 0;
    for (let row = 0; row < values.length; ++row) {
        if (row === breaks[next]) {
            result.push(filler(row));
            ++next;
        }
        result.push(values[row]);
    }
    return result;
}

function finite_or_null(value) {
    return Number.isFinite(value) ? value : null;
}

function combine(a, b, operation) {
    return a.map((value, i) => (value === null || b[i] === null ? null : operation(value, b[i])));
}

function decode_output(series, decode) {
    const measured = decode(series.measured);
    const predicted = decode(series.predicted);
    const margin = decode(series.standard_deviation).map(deviation =>
        deviation === null ? null : 2 * deviation,
    );
    return {
        name: series.name,
        unit: series.unit,
        measured,
        predicted,
        margin,
        upper: combine(predicted, margin, (value, m) => value + m),
        lower: combine(predicted, margin, (value, m) => value - m),
        error: combine(measured, predicted, (m, p) => m - p),
        margin_below: margin.map(m => (m === null ? null : -m)),
    };
}

function decode_innovation(innovation, decode) {
    const values = decode(innovation.normalised_squared);
    return {
        // only positive values have a place on a logarithmic axis
        values: values.map(value => (value !== null && value > 0 ? value : null)),
        threshold: innovation.threshold,
        threshold_label: innovation.threshold_label,
    };
}

function decode_report(text) {
    const packed = JSON.parse(text);
    const time = new Float64Array(decode_bytes(packed.time_s));
    const breaks = packed.breaks; // rows before which every line is interrupted
    const decode = base64 =>
        insert_at_breaks(new Float32Array(decode_bytes(base64)), breaks, () => null).map(finite_or_null);
    return {
        time: insert_at_breaks(time, breaks, row => (time[row - 1] + time[row]) / 2),
        sample_time: packed.sample_time_s,
        thinned: packed.thinned, // the rows are chosen for their extremes
        outputs: packed.series.map(series => decode_output(series, decode)),
        innovation: packed.innovation === null ? null : decode_innovation(packed.innovation, decode),
        intervals: packed.intervals,
        recordings: packed.recordings,
    };
}
