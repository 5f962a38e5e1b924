// SPDX-License-Identifier: Apache-2.0
// Detects a push during the recorded motion, from positions and motor currents. The current of a push is
// added to the current of one joint.
#include "instruction_counter.hpp"
#include "report.hpp"
#include "ur5_model.hpp" // constants and limits, in flash
#include "ur5_ticks.hpp"

#include <algorithm>
#include <array>

namespace {

using Estimator = dfdyn::Estimator<ur5_model::Model>;

constexpr int joints = 6;
constexpr int pushed_joint = 1;
constexpr float push_A = 2;
constexpr int first_pushed = 150; // ticks of 8 ms
constexpr int last_pushed = 180;

Estimator estimator(ur5_model::constants);
dfdyn::ContactDetector<float, joints> detector({}, ur5_model::contact_limits);

/// The detector's cost in instructions.
std::uint32_t largest = 0;
std::uint32_t sum = 0;

/// Returns true during a contact. A push is no property of the arm, and at rest friction bears a part of the
/// weight: neither is learned.
bool contact(const Estimator::Sample& sample) {
    const dfdyn::Budget budget{detector.informative() ? Estimator::cost().learn : 0};
    const auto estimate = estimator.tick(sample, budget);
    const std::uint32_t begin = instruction_counter();
    if (estimate.status.estimated() && sample.output_valid) {
        // Not the innovation: it is 0 beyond the model's limit, as in a hard collision.
        std::array<float, joints> error{};
        for (int k = 0; k < joints; ++k) {
            error[k] = sample.output[k] - estimate.prediction[k];
        }
        detector.tick(sample.time_ns, sample.position.data(), error.data(), estimate.prediction.data(),
                      estimate.standard_deviation.data());
    } else {
        detector.skip(sample.time_ns);
    }
    const std::uint32_t spent = instruction_counter() - begin;
    largest = std::max(largest, spent);
    sum += spent;
    return detector.contact();
}

} // namespace

int application() {
    start_instruction_counter();
    int tick = 0;
    int contacts = 0;
    int found_after = 0; // ticks
    bool before = false;
    for (const Ur5Sample& recorded : ur5_samples) {
        auto sample = read_sensors<Estimator::Sample>(recorded);
        sample.output[pushed_joint] += tick >= first_pushed && tick < last_pushed ? push_A : 0.0F;
        const bool now = contact(sample);
        if (now && !before) {
            ++contacts;
            found_after = tick - first_pushed;
        }
        before = now;
        ++tick;
    }
    report(DFDYN_CORE ": contacts found ", static_cast<std::uint32_t>(contacts), "");
    report(", at joint ", static_cast<std::uint32_t>(detector.joint() + 1), "");
    report(", ticks of 8 ms after the push began ", static_cast<std::uint32_t>(std::max(found_after, 0)), "");
    report("; instructions of the detector per tick: mean ", sum / static_cast<std::uint32_t>(tick), "");
    report(", most ", largest, "");
    report("; its state ", sizeof(detector), " bytes\n");
    const bool in_time = found_after > 0 && found_after <= 12;
    return contacts == 1 && detector.joint() == pushed_joint && in_time ? 0 : 1;
}
