// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"

namespace dfdyn::tests {

/// An estimator that has learned from the moving arm for a while, and the arm.
template <class Model>
class RunningArm {
  public:
    using Sample = typename Model::Sample;
    static constexpr int ticks_before = 60;

    RunningArm(std::mt19937_64& engine, const typename Model::Constants& model_constants)
        : engine_(&engine), constants(model_constants), estimator(constants) {
        while (now < ticks_before) {
            estimator.tick(due(), Budget::unlimited());
        }
    }

    RunningArm(const RunningArm&) = delete;
    RunningArm& operator=(const RunningArm&) = delete;

    /// Returns the next sample and advances the time.
    Sample due() {
        Sample sample = moving_sample<Model>(now, *engine_);
        sample.time_ns += clock_offset_ns;
        ++now;
        return sample;
    }

    /// Performs a tick with an unlimited budget; returns its reason.
    Reason tick(const Sample& sample) { return estimator.tick(sample, Budget::unlimited()).status.reason(); }

    /// Performs a tick that must not change the learned state; returns its reason.
    Reason refused(const Sample& sample) {
        const auto before = snapshot_of(estimator);
        const Reason reason = tick(sample);
        CHECK((snapshot_of(estimator) == before)); // in parentheses, so that Catch does not print them
        return reason;
    }

    /// Counts the ticks until the estimator predicts again.
    int ticks_to_recover() {
        int ticks = 0;
        while (!estimator.tick(due(), Budget::unlimited()).status.predicted()) {
            ++ticks;
        }
        return ticks;
    }

  private:
    std::mt19937_64* engine_;

  public:
    typename Model::Constants constants;
    Estimator<Model> estimator;
    std::int64_t now = 0;             ///< number of the next sample
    std::int64_t clock_offset_ns = 0; ///< added to every stamp
};

} // namespace dfdyn::tests
