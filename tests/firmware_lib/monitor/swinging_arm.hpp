// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/centred_motion.hpp"
#include "dfdyn/monitor/monitor.hpp"

#include "tests/firmware_lib/support/two_link_arm.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <random>

namespace dfdyn::tests::monitored {

constexpr double period_s = 0.01;
constexpr int lags = 8;
constexpr double tip_x = 0.3; // m
using Arm = Chain<2>;

template <class Scalar>
using TestMonitor = Monitor<Scalar, Arm, lags>;

template <class Scalar>
typename TestMonitor<Scalar>::Constants constants() {
    typename TestMonitor<Scalar>::Constants result{};
    set_two_links(result.chain);
    std::array<Scalar, 3 * (lags + 1)> rows{};
    centred_motion_rows(lags, Scalar(period_s), rows.data());
    to_difference_form(rows.data(), 3, lags, result.motion.rows.data());
    std::ranges::fill(result.motion.scale, Scalar(1));
    result.output_gain = {{1, 1}};
    result.tip[0] = Scalar(tip_x);
    result.sign_velocity = Scalar(0.02);
    result.speed = {Scalar(0.03), Scalar(0.15)};
    result.block_samples = 10;
    result.blocks_between_false_alarms = 360000;
    result.report_blocks = 20;
    result.longest_blocks = 200;
    result.refresh_blocks = 30;
    return result;
}

/// The change to detect, if any.
struct Hidden {
    std::optional<Cause> cause;
    double from_s = 0, to_s = 1e9;
    bool weightless = false; ///< a payload without mass, but with a first moment
};

constexpr double payload_mass = 0.8;
constexpr double payload_x = 0.2;
constexpr double coulomb = 0.9;
constexpr double moved = 0.7;
constexpr double force_x = 12;

/// Applies a fault to the values of a sample; kind 0 has no effect.
struct Fault {
    int kind = 0;
    /// Value of a spike, for kinds 5 to 8: on output, prediction, position, or again on the output.
    double size = 0;

    template <class Scalar>
    void operator()(Scalar* position, Scalar* output, Scalar* predicted) const {
        constexpr Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
        constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
        switch (kind) {
        case 1:
            position[0] = nan;
            break;
        case 2:
            output[1] = infinity;
            break;
        case 3:
            predicted[0] = nan;
            break;
        case 4:
            output[0] = 1e30F;
            break;
        case 5:
        case 8:
            output[0] = static_cast<Scalar>(size);
            break;
        case 6:
            predicted[1] = static_cast<Scalar>(size);
            break;
        case 7:
            position[0] = static_cast<Scalar>(size);
            break;
        default:
            break;
        }
    }
};

/// A planar arm with a motion of two frequencies per joint, and torques that are missing in the prediction.
template <class Scalar>
class Swinging {
  public:
    explicit Swinging(Hidden hidden) : hidden_(hidden) { set_two_links(chain_); }

    /// Passes the next sample to the monitor; returns true if the monitor reports a change of its state.
    bool step(TestMonitor<Scalar>& monitor, std::mt19937_64& engine, const Fault& fault = {}) {
        const double t = period_s * tick_++;
        std::normal_distribution<double> normal;
        const ArmState arm = state(t);
        const std::array<double, 2> extra = extra_torques(arm, t);
        for (std::size_t i = 0; i < 2; ++i) {
            noise_[i] = 0.8 * noise_[i] + 0.6 * 0.05 * normal(engine);
            const bool frozen = hidden_.cause == Cause::frozen && t >= hidden_.from_s;
            position_[i] = static_cast<Scalar>(1e-4 * std::round(1e4 * arm.position[i]));
            predicted_[i] = static_cast<Scalar>(arm.torque(i));
            if (!frozen || i != 1) {
                output_[i] = static_cast<Scalar>(arm.torque(i) + extra[i] + noise_[i]);
            }
        }
        fault(position_.data(), output_.data(), predicted_.data());
        const auto time_ns = static_cast<std::int64_t>(std::llround(1e9 * t));
        return monitor.tick({time_ns, position_.data(), output_.data(), predicted_.data(), deviation_.data(),
                             predicted_.data()});
    }

    [[nodiscard]] double time_s() const { return period_s * tick_; }

  private:
    static ArmState state(double t) {
        ArmState arm{};
        for (std::size_t i = 0; i < 2; ++i) {
            for (const double w : {1.1 + 0.4 * static_cast<double>(i), 2.9 - 0.5 * static_cast<double>(i)}) {
                arm.position[i] += 0.5 * std::sin(w * t);
                arm.velocity[i] += 0.5 * w * std::cos(w * t);
                arm.acceleration[i] -= 0.5 * w * w * std::sin(w * t);
            }
        }
        return arm;
    }

    std::array<double, 2> extra_torques(const ArmState& arm, double t) const {
        if (!hidden_.cause || t < hidden_.from_s || t >= hidden_.to_s) {
            return {};
        }
        switch (*hidden_.cause) {
        case Cause::payload:
            return payload(arm);
        case Cause::friction:
            return {0, arm.velocity[1] > 0 ? coulomb : -coulomb};
        case Cause::bias:
            return {moved, 0};
        case Cause::contact:
            return push(arm);
        default:
            return {};
        }
    }

    /// Computed from the regressor of all bodies, independently of the monitor's columns.
    std::array<double, 2> payload(const ArmState& arm) const {
        std::array<double, 6> xi{};
        for (std::size_t i = 0; i < 2; ++i) {
            xi[3 * i] = arm.position[i];
            xi[3 * i + 1] = arm.velocity[i];
            xi[3 * i + 2] = arm.acceleration[i];
        }
        std::array<double, 40> psi{};
        rigid_body_regressor<Arm, double>(chain_, {}, xi.data(), psi.data(), 20);
        std::array<double, 2> torque{};
        for (std::size_t k = 0; k < 2; ++k) {
            torque[k] = hidden_.weightless ? 0.5 * psi[20 * k + 11]
                                           : payload_mass * (psi[20 * k + 10] + payload_x * psi[20 * k + 11] +
                                                             payload_x * payload_x * psi[20 * k + 19]);
        }
        return torque;
    }

    /// A force along the base's x axis on the tip, 0.3 m beyond the second joint; minus its lever arms.
    static std::array<double, 2> push(const ArmState& arm) {
        const double second = 0.3 * std::sin(arm.position[0] + arm.position[1]);
        const double first = first_link_length * std::sin(arm.position[0]);
        return {force_x * (first + second), force_x * second};
    }

    Hidden hidden_;
    Arm::Constants<double> chain_{};
    std::array<Scalar, 2> position_{}, output_{}, predicted_{};
    std::array<Scalar, 2> deviation_{Scalar(0.05), Scalar(0.05)};
    std::array<double, 2> noise_{};
    int tick_ = 0;
};

/// Runs until a change is over, but at most until `until_s`; returns the number of reports.
template <class Scalar>
int run(TestMonitor<Scalar>& monitor, Swinging<Scalar>& arm, double until_s, std::mt19937_64& engine) {
    int updates = 0;
    while (arm.time_s() < until_s) {
        updates += arm.step(monitor, engine) ? 1 : 0;
        if (updates > 0 && !monitor.changing()) {
            break;
        }
    }
    return updates;
}

} // namespace dfdyn::tests::monitored
