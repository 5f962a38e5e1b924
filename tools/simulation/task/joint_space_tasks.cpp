// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/joint_space_tasks.hpp"

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/random_streams.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

/// One number per joint without heap memory, because a control loop evaluates the reference in every tick.
using JointArray = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, largest_simulated_chain, 1>;

} // namespace

Multisine::Multisine(const MultisineTask& model, double period_s, std::uint64_t seed)
    : model_(model), period_s_(period_s), phase_(model.centre.size(), model.tones) {
    NormalSource source(seed, stream::task);
    for (double& phase : phase_.reshaped()) {
        const double sine = source.next();
        phase = std::atan2(sine, source.next()); // uniform on the circle
    }
}

Reference Multisine::next() {
    const double time_s = static_cast<double>(step_++) * period_s_;
    const SmoothStep size = smooth_step(time_s, model_.start_s);
    const double spacing = model_.tones > 1 ? (model_.highest_hz - model_.lowest_hz) / (model_.tones - 1) : 0;
    JointArray sum = JointArray::Zero(phase_.rows());
    JointArray rate = sum;
    JointArray acceleration = sum;
    for (Eigen::Index tone = 0; tone < phase_.cols(); ++tone) {
        const double omega = 2 * std::numbers::pi * (model_.lowest_hz + spacing * static_cast<double>(tone));
        const JointArray angle = omega * time_s + phase_.col(tone).array();
        sum += angle.sin();
        rate += omega * angle.cos();
        acceleration -= omega * omega * angle.sin();
    }
    const JointArray amplitude = model_.amplitude.array() / static_cast<double>(model_.tones);
    return {model_.centre + (amplitude * size.value * sum).matrix(),
            amplitude * (size.rate * sum + size.value * rate),
            amplitude * (size.acceleration * sum + 2 * size.rate * rate + size.value * acceleration)};
}

Reference Tones::next() {
    const double time_s = static_cast<double>(step_++) * period_s_;
    const SmoothStep size = smooth_step(time_s, model_.start_s);
    Reference result{model_.centre, JointVector::Zero(model_.centre.size()),
                     JointVector::Zero(model_.centre.size())};
    for (Eigen::Index joint = 0; joint < result.position.size(); ++joint) {
        for (const Tone& tone : model_.tones[static_cast<std::size_t>(joint)]) {
            const double omega = 2 * std::numbers::pi * tone.hz;
            const double angle = omega * time_s + tone.phase;
            const double value = tone.amplitude * std::sin(angle);
            const double rate = tone.amplitude * omega * std::cos(angle);
            result.position[joint] += size.value * value;
            result.velocity[joint] += size.rate * value + size.value * rate;
            result.acceleration[joint] +=
                size.acceleration * value + 2 * size.rate * rate - size.value * omega * omega * value;
        }
    }
    return result;
}

Reference PointToPoint::next() {
    const double time_s = static_cast<double>(step_++) * period_s_;
    const double leg_s = model_.move_s + model_.dwell_s;
    const auto leg = static_cast<std::size_t>(time_s / leg_s);
    const JointVector& from = model_.postures[leg % model_.postures.size()];
    const JointVector& to = model_.postures[(leg + 1) % model_.postures.size()];
    const SmoothStep along = smooth_step(time_s - static_cast<double>(leg) * leg_s, model_.move_s);
    return {from + along.value * (to - from), along.rate * (to - from), along.acceleration * (to - from)};
}

} // namespace dfdyn::tools
