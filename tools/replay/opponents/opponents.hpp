// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/replay.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// One-step forecasts of the measured outputs that a model is compared with: ticks × m, row by row. Each uses
/// measurements before its own tick only; where nothing was measured before, it is 0.
using Forecasts = std::vector<double>;

/// Persistence: the last measurement of the output.
Forecasts persistence(const ReplayedRecording& replayed, std::size_t outputs);

/// AR(2) of each output: y(t) = a y(t-1) + b y(t-2) + c. The coefficients are learned online over the
/// recording, by recursive least squares in double without forgetting (prior variance 1e6), from every
/// measurement.
Forecasts autoregression(const ReplayedRecording& replayed, std::size_t outputs);

/// The model itself with the firmware's residual state (dfdyn::ColouredResidual) of a memory of
/// `residual_memory_s`, learned online over the recording. `noise_std`: m values of the model.
Forecasts with_residual_state(const ReplayedRecording& replayed, const TrainedModel& model);

/// The state's memory (s). On UR5 No5 and No6 and XL330 00, 02, 03, 04 and 06, whose figures were seen when
/// it was chosen, memories of 0.16 s to 8 s all beat persistence and AR(2), shorter ones by more. This one
/// keeps enough samples for four coefficients at 50 Hz.
inline constexpr double residual_memory_s = 0.8;

/// The errors of one output's forecasts, gathered value by value.
class OutputError {
  public:
    /// Pairs with a value that is not finite do not count.
    void add(double measured, double forecast);
    /// rms(measured - forecast) / std(measured); NaN without values.
    double normalised() const;

  private:
    double count_ = 0;
    double mean_ = 0;         ///< of the measured values
    double variation_ = 0;    ///< sum of their squared differences from the mean
    double error_square_ = 0; ///< sum
};

/// What stands beside a model's own one-step errors: a label and the nRMSE of each output, over exactly the
/// ticks that the model predicted and that were measured; NaN if there are none.
struct OpponentErrors {
    std::string label;
    std::vector<double> normalised_error;
};

/// What the two rigid bodies with friction are called: with the robot file's inertia, or an identified one.
const char* rigid_body_label(bool identified);

/// The errors of the model with its residual state, then of each opponent: persistence, AR(2), and two rigid
/// bodies with friction (NaN where the replay has none; where they have no forecast a tick does not count).
std::vector<OpponentErrors> opponent_errors(const ReplayedRecording& replayed, const TrainedModel& model);

} // namespace dfdyn::tools
