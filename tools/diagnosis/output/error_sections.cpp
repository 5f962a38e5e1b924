// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/error_sections.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/recording/csv_writer.hpp"
#include "tools/diagnosis/output/finding_words.hpp"
#include "tools/diagnosis/output/over_time.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"
#include "tools/report/xy_chart.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double shown_s = 20; ///< longer curves would be illegible
constexpr Eigen::Index most_points = 700;

/// Converts torques to the units of the outputs.
Eigen::MatrixXd in_output_units(const DiagnosisWork& work, const Eigen::MatrixXd& torques) {
    return torques * work.torque_gains.asDiagonal();
}

/// Returns the rows of the plots, from the start of the held-out time, or of the recording.
std::vector<Eigen::Index> shown_rows(const DiagnosisWork& work) {
    const Eigen::VectorXd& time = work.signals->measured.time_s;
    const double from = std::max(work.diagnosis.heldout_from_s, time[0]);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index row = 0; row < time.size(); ++row) {
        if (time[row] >= from && time[row] <= from + shown_s) {
            rows.push_back(row);
        }
    }
    const Eigen::Index step = static_cast<Eigen::Index>(rows.size()) / most_points + 1;
    std::vector<Eigen::Index> thin;
    for (std::size_t i = 0; i < rows.size(); i += static_cast<std::size_t>(step)) {
        thin.push_back(rows[i]);
    }
    return thin;
}

/// Autocorrelation at lag one: 0 for white noise, near 1 for slow signals.
double autocorrelation(const DiagnosisSignals& signals, const Eigen::VectorXd& series) {
    double product = 0;
    double square = 0;
    for (const Stretch& stretch : signals.measured.stretches) {
        const auto part = series.segment(stretch.first, stretch.count);
        product += part.head(stretch.count - 1).dot(part.tail(stretch.count - 1));
        square += part.squaredNorm();
    }
    return square > 0 ? product / square : 0;
}

/// The median over the upper half of the curve: the level of white noise, where the motion has no energy.
ChartCurve white_level(const ChartCurve& rest) {
    const auto half = static_cast<std::ptrdiff_t>(rest.y.size() / 2);
    const double level = median({rest.y.begin() + half, rest.y.end()});
    ChartCurve curve{"median of the upper half", rest.x, {}, {}, {}};
    curve.y.assign(rest.x.size(), level);
    curve.low = curve.high = curve.y;
    return curve;
}

ReportTable rest_table(const DiagnosisWork& work, const Eigen::MatrixXd& rest) {
    ReportTable table{
        "Remaining error",
        {"output", "unit", "rms", "share of the output's standard deviation", "autocorrelation, lag 1"},
        {},
        {}};
    table.note = "Over " + work.diagnosis.scope +
                 ", after an anti-aliasing filter, of the model fitted to all of it. Autocorrelation 0: "
                 "white noise; near 1: a slow error whose cause is not named.";
    const Eigen::MatrixXd measured = in_output_units(work, work.measured);
    for (Eigen::Index output = 0; output < rest.cols(); ++output) {
        const auto index = static_cast<std::size_t>(output);
        const Eigen::VectorXd centred = measured.col(output).array() - measured.col(output).mean();
        table.rows.push_back({work.diagnosis.output_names[index], work.diagnosis.output_units[index],
                              root_mean_square(rest.col(output)),
                              root_mean_square(rest.col(output)) / std::max(root_mean_square(centred), 1e-12),
                              autocorrelation(*work.signals, rest.col(output))});
    }
    return table;
}

ReportTable unexplained_table(const Diagnosis& diagnosis) {
    ReportTable table{"Predictable, but by no cause of the catalogue",
                      {"output", "share of the output's standard deviation", "depends on", "note"},
                      {},
                      {}};
    for (const Unexplained& entry : diagnosis.unexplained) {
        std::string inputs;
        for (const std::string& input : entry.depends_on) {
            inputs.append(inputs.empty() ? "" : ", ").append(input);
        }
        table.rows.push_back({diagnosis.output_names[static_cast<std::size_t>(entry.output)], entry.nrmse,
                              inputs, entry.note});
    }
    return table;
}

} // namespace

ChartCurve error_spectrum(const SpectralRows& rows, std::string name, const Eigen::VectorXd& error,
                          Eigen::Index output) {
    constexpr double least_power = 1e-300; // on a logarithmic axis
    const double frames = std::max(rows.filled(output).sum(), 1e-9);
    const Eigen::VectorXd power = rows.analyse(error, output).rowwise().squaredNorm() / frames;
    ChartCurve curve{std::move(name), {}, {}, {}, {}};
    for (Eigen::Index bin = 0; bin < rows.bins_in_bandwidth(output); ++bin) {
        curve.x.push_back(rows.frequency_hz(bin));
        curve.y.push_back(std::sqrt(std::max(power[bin], least_power)));
    }
    curve.low = curve.high = curve.y;
    return curve;
}

ComparedOutputs compared_outputs(const DiagnosisWork& work) {
    const Eigen::MatrixXd simulated = in_output_units(work, work.signals->nominal);
    return {in_output_units(work, work.measured), simulated, in_output_units(work, work.extended)};
}

void write_comparison_csv(std::ostream& out, const DiagnosisWork& work) {
    std::vector<std::string> columns{"t"};
    for (const std::string& name : work.diagnosis.output_names) {
        columns.insert(columns.end(), {name, name + "_simulated", name + "_extended"});
    }
    const ComparedOutputs outputs = compared_outputs(work);
    CsvWriter csv(out, columns);
    for (Eigen::Index row = 0; row < outputs.measured.rows(); ++row) {
        csv.field(work.signals->measured.time_s[row]);
        for (Eigen::Index output = 0; output < outputs.measured.cols(); ++output) {
            csv.field(outputs.measured(row, output))
                .field(outputs.simulated(row, output))
                .field(outputs.extended(row, output));
        }
        csv.end_row();
    }
}

PageSection comparison_section(const DiagnosisWork& work, const std::string& full_data) {
    PageSection section{"Measured, simulated, extended", {}, {}, {}};
    section.paragraphs.push_back(
        "Simulated: the rigid body of the robot's file along the measured motion. Extended: with "
        "all named effects, or plain least squares where its error is smaller, fitted to " +
        work.diagnosis.scope + ". The first 20 s of the " +
        (has_held_out(work.diagnosis) ? "held-out time" : "recording") + " are shown.");
    if (!full_data.empty()) {
        section.paragraphs.push_back(
            "Curves have at most " + std::to_string(most_points) + " points. The file " + full_data +
            " in the same folder has every row that the diagnosis used, at its own rate.");
    }
    const MeasuredMotion& motion = work.signals->measured;
    const std::string time_label = time_axis(motion).label;
    const std::vector<Eigen::Index> rows = shown_rows(work);
    const auto [measured, nominal, extended] = compared_outputs(work);
    for (Eigen::Index output = 0; output < measured.cols(); ++output) {
        const std::string& name = work.diagnosis.output_names[static_cast<std::size_t>(output)];
        const std::string& unit = work.diagnosis.output_units[static_cast<std::size_t>(output)];
        XyChart chart{name, time_label, std::string(name).append(" (").append(unit).append(")")};
        chart.height = 220;
        chart.reference = line_over_time(motion, "measured", measured.col(output), rows);
        chart.lines = {line_over_time(motion, "simulated", nominal.col(output), rows),
                       line_over_time(motion, "extended", extended.col(output), rows)};
        section.charts.push_back({"outputs_" + name, name, xy_chart(chart)});
        XyChart error{std::string("error of ").append(name), time_label,
                      std::string("error (").append(unit).append(")")};
        error.height = 220;
        error.lines = {line_over_time(motion, "simulated", measured.col(output) - nominal.col(output), rows),
                       line_over_time(motion, "extended", measured.col(output) - extended.col(output), rows)};
        section.charts.push_back({"errors_" + name, error.title, xy_chart(error)});
    }
    return section;
}

PageSection rest_section(const DiagnosisWork& work) {
    PageSection section{"Remaining error", {}, {}, {}};
    const Eigen::MatrixXd nominal = in_output_units(work, work.measured - work.signals->nominal);
    const Eigen::MatrixXd rest = in_output_units(work, work.measured - work.extended);
    section.tables.push_back(rest_table(work, rest));
    section.paragraphs.emplace_back(work.diagnosis.unexplained.empty()
                                        ? "Smooth functions of position, velocity and acceleration predict "
                                          "nothing of the remaining error."
                                        : "Part of the remaining error is predictable, but matches no cause "
                                          "of the catalogue: see the table.");
    if (!work.diagnosis.unexplained.empty()) {
        section.tables.push_back(unexplained_table(work.diagnosis));
    }
    const SpectralRows rows(work.signals->measured);
    for (Eigen::Index output = 0; output < rest.cols(); ++output) {
        const std::string& name = work.diagnosis.output_names[static_cast<std::size_t>(output)];
        const std::string& unit = work.diagnosis.output_units[static_cast<std::size_t>(output)];
        const ChartCurve left = error_spectrum(rows, "extended", rest.col(output), output);
        section.charts.push_back(
            {"spectrum_" + name, name,
             curve_chart(
                 std::string("spectrum of the error of ").append(name), "frequency (Hz)",
                 std::string("per bin (").append(unit).append(")"),
                 {white_level(left), error_spectrum(rows, "simulated", nominal.col(output), output), left})});
    }
    return section;
}

} // namespace dfdyn::tools
