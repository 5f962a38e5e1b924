// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/several_recordings.hpp"

#include "tools/base/text/error.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/verdict/plausibility.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the signals of a recording, or nothing if it is too short or its rows are too far apart.
std::optional<DiagnosisSignals> signals_of_recording(const Robot& robot, OutputKind outputs,
                                                     const Recording& recording) {
    if (!usable_rate(recording)) {
        return std::nullopt;
    }
    try {
        return diagnosis_signals(robot, outputs, measured_motion(recording));
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// Returns the normal equations of a recording. `gains`: measured unit per N·m.
RecordingInformation information_with(const DiagnosisSignals& signals, const VectorXd& gains) {
    const MatrixXd measured = signals.measured.outputs * gains.cwiseInverse().asDiagonal();
    std::vector<MatrixXd> terms;
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        terms.push_back(textbook_columns(signals, signals.nominal.col(joint), joint));
    }
    return information_of(signals, measured, terms);
}

/// Returns the gains estimated from the joined recording, which the diagnosis uses.
VectorXd estimated_gains(const Robot& robot, const std::vector<Recording>& recordings,
                         const DiagnosisOptions& options) {
    return torque_gains(
        diagnosis_signals(robot, options.outputs, measured_motion(joined_recording(recordings))), options);
}

/// Returns the files' names, or their paths where names are equal.
std::vector<std::string> names_of(const std::vector<Recording>& recordings) {
    const std::vector<std::string> short_names = file_names(recordings);
    std::vector<std::string> names = short_names;
    for (std::size_t r = 0; r < names.size(); ++r) {
        names[r] = std::ranges::count(short_names, names[r]) > 1 ? recordings[r].source : names[r];
    }
    return names;
}

/// Interpolates `series` (T x n, on the motion's rows) at the rows of the recording.
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

SeveralRecordings fit_recordings(const Robot& robot, const std::vector<Recording>& recordings,
                                 const DiagnosisOptions& options, bool loads_differ) {
    SeveralRecordings several;
    several.names = names_of(recordings);
    several.loads_differ = loads_differ;
    std::vector<DiagnosisSignals> signals;
    for (std::size_t r = 0; r < recordings.size(); ++r) {
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
    if (!several.fitted()) {
        return several;
    }
    const bool gains_known =
        options.outputs != OutputKind::motor_current || !options.torque_constants.empty();
    several.torque_gains =
        gains_known ? torque_gains(signals.front(), options) : estimated_gains(robot, recordings, options);
    std::vector<RecordingInformation> information;
    for (const DiagnosisSignals& one : signals) {
        information.push_back(information_with(one, several.torque_gains));
    }
    several.answer = ask_recordings(signals.front(), information, loads_differ, gains_known);
    return several;
}

void take_loads_off(std::vector<Recording>& recordings, const Robot& robot, const SeveralRecordings& several,
                    OutputKind outputs) {
    for (const RecordingLoad& load : several.answer.loads) {
        if (!load.recording) {
            continue; // all recordings have this load
        }
        Recording& recording = recordings[several.pooled[*load.recording]];
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
