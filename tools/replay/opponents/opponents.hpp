// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/output_error.hpp"
#include "tools/replay/replay.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// One-step forecasts of the measured outputs for comparison with a model: ticks × m, row by row. Each uses
/// only measurements before its own tick; without any earlier measurement it is 0.
using Forecasts = std::vector<double>;

/// Persistence: the last measurement of the output.
Forecasts persistence(const ReplayedRecording& replayed, std::size_t outputs);

/// AR(2) of each output: y(t) = a y(t-1) + b y(t-2) + c. The coefficients are learned online over the
/// recording, by recursive least squares in double without forgetting (prior variance 1e6), from every
/// measurement.
Forecasts autoregression(const ReplayedRecording& replayed, std::size_t outputs);

/// The model with the firmware's residual state (dfdyn::ColouredResidual) and a memory of
/// `residual_memory_s`, learned online over the recording, in units of the model's `noise_std`.
Forecasts with_residual_state(const ReplayedRecording& replayed, const TrainedModel& model);

/// Memory of the state (s). It was chosen on UR5 No5 and No6 and XL330 00, 02, 03, 04 and 06. There all
/// memories from 0.16 s to 8 s are better than persistence and AR(2), shorter ones by a larger margin. This
/// value provides enough samples for four coefficients at 50 Hz.
inline constexpr double residual_memory_s = 0.8;

/// Errors of an alternative to a model: a label and the nRMSE of each output, over the measured ticks with a
/// model prediction; NaN if there are none.
struct OpponentErrors {
    std::string label;
    std::vector<double> normalised_error;
};

/// Returns the label of a rigid body with friction: with the robot file's inertia, or with an identified one.
const char* rigid_body_label(bool identified);

/// Returns the errors of the model with its residual state, then of each alternative: persistence, AR(2), and
/// two rigid bodies with friction. NaN for bodies that the replay does not have; ticks without their forecast
/// are ignored.
std::vector<OpponentErrors> opponent_errors(const ReplayedRecording& replayed, const TrainedModel& model);

} // namespace dfdyn::tools
