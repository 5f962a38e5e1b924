// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/mit_recognition.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/motors/motor_fields.hpp"

#include <cmath>
#include <set>

namespace dfdyn::tools {

namespace {

/// Relative distance of a measured velocity maximum from the closest one of the types.
double closest(std::span<const MotorType> types, double measured) {
    double distance = 1;
    for (const MotorType& type : types) {
        distance = std::min(
            {distance, std::abs(measured / type.maxima[1] - 1), std::abs(measured / type.others[1] - 1)});
    }
    return distance;
}

std::string numbers_text(const std::set<double>& numbers) {
    std::vector<std::string> texts;
    for (const double number : numbers) {
        texts.push_back(number_text(number));
    }
    return listed(texts);
}

} // namespace

void SteadyBytes::take(const hal::Frame& frame) {
    if (steps_ > 0 || last_.length > 0) {
        const auto jumped = [&](std::size_t i) { return std::abs(frame.data[i] - last_.data[i]) > 3; };
        ++steps_;
        jumps_ += jumped(6) || jumped(7) ? 1 : 0;
        intervals_ns_.push_back(frame.stamp_ns - last_.stamp_ns);
    }
    last_ = frame;
}

bool SteadyBytes::is_steady(bool alone) const {
    if (intervals_ns_.empty()) {
        return false;
    }
    std::vector<std::int64_t> sorted = intervals_ns_;
    std::ranges::sort(sorted);
    const std::int64_t median_ns = sorted[sorted.size() / 2];
    const auto even = std::ranges::count_if(sorted, [&](std::int64_t interval_ns) {
        return 2 * interval_ns > median_ns && 2 * interval_ns < 3 * median_ns;
    });
    constexpr double least_even = 0.45; // a random selection of frames has 0.35
    const bool is_even = static_cast<double>(even) > least_even * static_cast<double>(sorted.size());
    return 10 * jumps_ < steps_ && (alone || is_even);
}

void drop_selections(std::vector<MitCandidate>& candidates) {
    constexpr double least_coverage = 0.95; ///< fraction of the frames of an identifier
    std::map<std::uint32_t, std::pair<int, std::uint64_t>> explained;
    for (const MitCandidate& candidate : candidates) {
        ++explained[candidate.feedback_id].first;
        explained[candidate.feedback_id].second += candidate.frames;
    }
    std::erase_if(candidates, [&](const MitCandidate& candidate) {
        const auto& [motors, frames] = explained[candidate.feedback_id];
        return motors > 1 &&
               static_cast<double>(frames) < least_coverage * static_cast<double>(candidate.of_id);
    });
}

void drop_repeated_motors(std::vector<MitCandidate>& candidates) {
    constexpr double clearly = 0.2;
    constexpr double own_identifier = 0.5;
    std::map<unsigned, std::vector<std::pair<double, std::uint32_t>>> fits; // plausibility and identifier
    for (const MitCandidate& candidate : candidates) {
        const double bonus = candidate.feedback_id == candidate.motor ? own_identifier : 0;
        fits[candidate.motor].emplace_back(candidate.plausibility + bonus, candidate.feedback_id);
    }
    for (auto& [motor, of_motor] : fits) {
        std::ranges::sort(of_motor, std::ranges::greater());
    }
    std::erase_if(candidates, [&](const MitCandidate& candidate) {
        const auto& of_motor = fits.at(candidate.motor);
        const auto& [fit, identifier] = of_motor.front();
        return of_motor.size() > 1 && (of_motor.size() > 2 || identifier != candidate.feedback_id ||
                                       fit < of_motor.back().first + clearly);
    });
    for (MitCandidate& candidate : candidates) {
        if (const auto& of_motor = fits.at(candidate.motor); of_motor.size() > 1) {
            candidate.other_id = of_motor.back().second;
        }
    }
}

double explained_share(const MitCandidate& candidate, std::span<const MitCandidate> candidates) {
    if (candidate.feedback_id == candidate.motor) {
        return 1;
    }
    std::uint64_t explained = 0;
    for (const MitCandidate& other : candidates) {
        explained += other.feedback_id == candidate.feedback_id ? other.frames : 0;
    }
    return static_cast<double>(explained) / static_cast<double>(candidate.of_id);
}

namespace {

/// Maxima of the types whose velocity_max is near a listed or measured one.
struct NearTypes {
    std::vector<std::string> names;
    std::set<double> velocities, torques;
    Maxima first{}; ///< zeros: no type is near
};

/// `velocity`: 0 if unknown; then the first type is used.
NearTypes near_types(std::span<const MotorType> types, double velocity) {
    constexpr double largest_distance = 0.09; // of filters in the motor; maxima of types differ by 10 %
    constexpr double as_close = 0.01;
    const double distance = closest(types, velocity);
    NearTypes result;
    for (const MotorType& type : types) {
        for (const Maxima& maxima : {type.maxima, type.others}) {
            const bool fits = velocity > 0 && distance < largest_distance &&
                              std::abs(velocity / maxima[1] - 1) < distance + as_close;
            if (!fits && !(velocity == 0 && &type == &types.front())) {
                continue;
            }
            result.velocities.insert(maxima[1]);
            result.torques.insert(maxima[2]);
            if (result.names.empty() || result.names.back() != type.name) {
                result.names.emplace_back(type.name);
            }
            result.first = result.first[1] == 0 ? maxima : result.first;
        }
    }
    return result;
}

} // namespace

MeasuredMaxima measure_maxima(const VelocityCheck& velocity, double assumed, const MotorSearch& search,
                              const Maxima& known) {
    const std::string ask(search.ask);
    MeasuredMaxima result;
    const bool sure = velocity.is_sure();
    const double measured = sure ? std::abs(velocity.ratio()) * assumed : 0;
    const double error = velocity.ratio_error() * assumed;
    const NearTypes near = near_types(search.types, known[1] > 0 ? known[1] : measured);
    result.maxima = near.first;
    if (result.maxima[1] == 0) { // no type has this maximum
        result.maxima = search.types.front().maxima;
        result.maxima[1] = std::stod(rounded_text(measured > 0 ? measured : known[1]));
    }
    if (sure) {
        result.measured = "velocity_max " + rounded_text(measured) + " ± " + rounded_text(3 * error) +
                          " rad/s, from its positions";
    }
    if (known[1] == 0 && !sure) {
        result.unsure = "it moved too little to determine its type; " + ask;
    } else if (near.velocities.empty()) {
        result.unsure = "no known type has a velocity_max of " + rounded_text(measured) + " rad/s; " + ask;
    } else if ((known[2] == 0 && near.torques.size() > 1) || (known[1] == 0 && near.velocities.size() > 1)) {
        result.unsure = "it may be a " + listed(near.names) + ": velocity_max " +
                        numbers_text(near.velocities) + " rad/s, torque_max " + numbers_text(near.torques) +
                        " N·m; " + ask;
    }
    for (std::size_t i = 0; i < known.size(); ++i) {
        result.maxima[i] = known[i] > 0 ? known[i] : result.maxima[i];
    }
    return result;
}

void add_motor(unsigned motor, const JointFit& fit, double assumed, const MotorSearch& search,
               const Maxima& known, nlohmann::json entry, Recognition& recognition) {
    const MeasuredMaxima measured = measure_maxima(fit.velocity, assumed, search, known);
    RecognisedBoard board{
        .name = "motor " + std::to_string(motor), .entry = std::move(entry), .rate_hz = fit.rate_hz()};
    board.entry["motor_id"] = motor;
    for (std::size_t i = 0; i < measured.maxima.size(); ++i) {
        board.entry[maximum_names[i]] = measured.maxima[i];
    }
    board.measured = measured.measured;
    if (!measured.unsure.empty()) {
        recognition.unsure.push_back(board.name + ": " + measured.unsure);
    }
    recognition.boards.push_back(std::move(board));
}

} // namespace dfdyn::tools
