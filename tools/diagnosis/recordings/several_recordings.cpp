// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/several_recordings.hpp"

#include "tools/base/text/error.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* everything = "everything";

/// Returns the signals of a recording, or nothing if it is too short.
std::optional<DiagnosisSignals> signals_of_recording(const Robot& robot, OutputKind outputs,
                                                     const Recording& recording) {
    try {
        return diagnosis_signals(robot, outputs, measured_motion(recording));
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// Returns what a recording tells. `gains`: measured unit per N·m.
RecordingInformation information_with(const DiagnosisSignals& signals, const VectorXd& gains) {
    const MatrixXd measured = signals.measured.outputs * gains.cwiseInverse().asDiagonal();
    std::vector<MatrixXd> terms;
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        terms.push_back(
            fit_moving_rows(signals, measured.col(joint), signals.nominal.col(joint), joint, true).columns);
    }
    return information_of(signals, measured, terms);
}

/// Returns the median of each row.
VectorXd medians(MatrixXd values) {
    VectorXd result(values.rows());
    for (Index row = 0; row < values.rows(); ++row) {
        VectorXd sorted = values.row(row).transpose();
        std::ranges::sort(sorted);
        result[row] = sorted[sorted.size() / 2];
    }
    return result;
}

VectorXd pooled_gains(const std::vector<DiagnosisSignals>& signals, const DiagnosisOptions& options) {
    MatrixXd gains(signals.front().outputs(), std::ssize(signals));
    for (std::size_t r = 0; r < signals.size(); ++r) {
        gains.col(static_cast<Index>(r)) = torque_gains(signals[r], options);
    }
    return medians(std::move(gains));
}

/// Interpolates a series (T x n) of the rows of a motion at the rows of its recording.
MatrixXd at_rows(const Recording& recording, const MeasuredMotion& measured, const MatrixXd& series) {
    const std::span<const double> time(measured.time_s.data(),
                                       static_cast<std::size_t>(measured.time_s.size()));
    MatrixXd result(static_cast<Index>(recording.row_count()), series.cols());
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const auto after = std::ranges::upper_bound(time, recording.time_s[row]);
        const Index next = std::clamp<Index>(after - time.begin(), 1, std::ssize(time) - 1);
        const double step = measured.time_s[next] - measured.time_s[next - 1];
        const double at = std::clamp((recording.time_s[row] - measured.time_s[next - 1]) / step, 0.0, 1.0);
        result.row(static_cast<Index>(row)) = (1 - at) * series.row(next - 1) + at * series.row(next);
    }
    return result;
}

} // namespace

std::vector<std::string> changed_names() {
    std::vector<std::string> names{effects::payload().name, effects::actuator_gain().name};
    for (const Effect& effect : effect_catalogue()) {
        if (effect.textbook) {
            names.emplace_back(effect.name);
        }
    }
    names.emplace_back(everything);
    return names;
}

Changed parse_changed(const std::vector<std::string>& effects) {
    const std::vector<std::string> known = changed_names();
    Changed changed;
    for (const std::string& name : effects) {
        if (std::ranges::find(known, name) == known.end()) {
            throw InputError(
                "--changed: expected effects that one value per recording can describe, found \"" + name +
                "\"");
        }
        const bool all = name == everything;
        changed.payload = changed.payload || all || name == effects::payload().name;
        const Effect* const effect = find_effect(name);
        for (std::size_t term = 0; term < changed.terms.size(); ++term) {
            const bool gain = term == 0 && name == effects::actuator_gain().name;
            const bool own = effect != nullptr && effect->textbook == static_cast<TextbookTerm>(term);
            changed.terms[term] = changed.terms[term] || all || gain || own;
        }
    }
    return changed;
}

SeveralRecordings fit_recordings(const Robot& robot, const std::vector<Recording>& recordings,
                                 const DiagnosisOptions& options, const Changed& changed) {
    SeveralRecordings several;
    std::vector<DiagnosisSignals> signals;
    for (std::size_t r = 0; r < recordings.size(); ++r) {
        several.names.push_back(std::filesystem::path(recordings[r].source).filename().string());
        if (options.outputs == OutputKind::wrench || recordings.size() < 2) {
            continue;
        }
        if (std::optional<DiagnosisSignals> one =
                signals_of_recording(robot, options.outputs, recordings[r])) {
            several.pooled.push_back(r);
            several.seconds += static_cast<double>(one->rows()) / one->measured.rate_hz;
            signals.push_back(std::move(*one));
        }
    }
    if (!several.answered()) {
        return several;
    }
    several.torque_gains = pooled_gains(signals, options);
    std::vector<RecordingInformation> information;
    for (const DiagnosisSignals& one : signals) {
        information.push_back(information_with(one, several.torque_gains));
    }
    const bool gains_known =
        options.outputs != OutputKind::motor_current || !options.torque_constants.empty();
    several.answer = ask_recordings(signals.front(), information, changed, gains_known);
    return several;
}

void take_loads_off(std::vector<Recording>& recordings, const Robot& robot, const SeveralRecordings& several,
                    OutputKind outputs) {
    for (const RecordingLoad& load : several.answer.loads) {
        Recording& recording = recordings[several.pooled[load.recording]];
        const DiagnosisSignals signals = diagnosis_signals(robot, outputs, measured_motion(recording));
        const Index last = signals.regressor.cols() / 10 - 1;
        const MatrixXd torque = at_rows(recording, signals.measured, signals.of_body(last, load.of_body));
        const std::size_t count = recording.output.names.size();
        for (std::size_t value = 0; value < recording.output.values.size(); ++value) {
            const auto output = static_cast<Index>(value % count);
            recording.output.values[value] -=
                several.torque_gains[output] * torque(static_cast<Index>(value / count), output);
        }
    }
}

} // namespace dfdyn::tools
