// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/opponents/opponents.hpp"

#include "dfdyn/coloured_residual.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

/// nRMSE of one output's forecasts over the measured ticks with a model prediction.
double normalised_error_of(const Forecasts& forecasts, const ReplayedRecording& replayed, std::size_t outputs,
                           std::size_t output) {
    OutputError error;
    for (std::size_t element = output; element < forecasts.size(); element += outputs) {
        if (std::isfinite(replayed.predicted[element])) {
            error.add(replayed.measured[element], forecasts[element]);
        }
    }
    return error.normalised();
}

} // namespace

Forecasts with_residual_state(const ReplayedRecording& replayed, const TrainedModel& model) {
    const std::size_t outputs = model.outputs.names.size();
    const std::vector<float> noise(model.outputs.noise_std.begin(), model.outputs.noise_std.end());
    ColouredResidual<float, dynamic> state(Extent<dynamic>{static_cast<int>(outputs)},
                                           static_cast<float>(residual_memory_s / model.sample_period_s),
                                           noise.data());
    Forecasts forecasts(replayed.measured.size());
    std::vector<float> measured(outputs);
    std::vector<float> forecast(outputs);
    for (std::size_t tick = 0; tick < replayed.status.size(); ++tick) {
        const std::size_t row = tick * outputs;
        const float* const predicted =
            replayed.status[tick].estimated() ? replayed.predicted.data() + row : nullptr;
        if (predicted != nullptr) {
            state.forecast(predicted, forecast.data());
            std::ranges::copy(forecast, forecasts.begin() + static_cast<std::ptrdiff_t>(row));
        }
        for (std::size_t k = 0; k < outputs; ++k) {
            measured[k] = static_cast<float>(replayed.measured[row + k]);
        }
        state.learn(predicted, measured.data());
    }
    return forecasts;
}

const char* rigid_body_label(bool identified) {
    return identified ? "identified rigid body" : "rigid body of the URDF";
}

std::vector<OpponentErrors> opponent_errors(const ReplayedRecording& replayed, const TrainedModel& model) {
    const std::size_t outputs = model.outputs.names.size();
    Forecasts none(replayed.measured.size(), std::numeric_limits<double>::quiet_NaN());
    const auto rigid_body = [&](std::size_t index) {
        return index < replayed.rigid_body.size() ? replayed.rigid_body[index] : none;
    };
    const std::pair<const char*, Forecasts> all[] = {
        {"with residual state", with_residual_state(replayed, model)},
        {"persistence, y(t-1)", persistence(replayed, outputs)},
        {"AR(2), learned online", autoregression(replayed, outputs)},
        {rigid_body_label(false), rigid_body(0)},
        {rigid_body_label(true), rigid_body(1)},
    };
    std::vector<OpponentErrors> errors;
    for (const auto& [label, forecasts] : all) {
        errors.push_back({label, {}});
        for (std::size_t k = 0; k < outputs; ++k) {
            errors.back().normalised_error.push_back(normalised_error_of(forecasts, replayed, outputs, k));
        }
    }
    return errors;
}

} // namespace dfdyn::tools
