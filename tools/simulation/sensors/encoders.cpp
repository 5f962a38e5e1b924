// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/encoders.hpp"

#include "tools/simulation/random_streams.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

Encoders::Encoders(EncoderModel model, std::vector<bool> prismatic, std::uint64_t seed)
    : model_(std::move(model)), prismatic_(std::move(prismatic)), noise_(seed, stream::encoder_noise) {}

double Encoders::count(std::size_t joint) const {
    if (model_.bits_per_turn == 0) {
        return 0;
    }
    return std::ldexp(prismatic_[joint] ? 1 : 2 * std::numbers::pi, -model_.bits_per_turn);
}

void Encoders::add_faults(const JointVector& last) {
    reading_ += faults_->jump;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
        reading_[i] = faults_->frozen[static_cast<std::size_t>(i)] ? last[i] : reading_[i];
    }
}

void Encoders::observe(const JointVector& position) {
    const JointVector last = reading_;
    reading_ = position;
    if (model_.offset) {
        reading_ += *model_.offset;
    }
    for (Eigen::Index i = 0; i < position.size(); ++i) {
        reading_[i] += model_.eccentricity[i] * std::sin(position[i] + model_.eccentricity_phase[i]) +
                       model_.noise * noise_.next();
        const double size = count(static_cast<std::size_t>(i));
        if (size > 0) {
            reading_[i] = size * std::round(reading_[i] / size);
        }
    }
    if (faults_) {
        add_faults(last);
    }
}

} // namespace dfdyn::tools
