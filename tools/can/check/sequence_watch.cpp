// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/sequence_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double least_step = 0.2;    ///< share of the period; more than usual jitter
constexpr double same_step = 0.2;     ///< share of the period
constexpr int lasting_frames = 8;     ///< consecutive
constexpr int frames_to_settle = 40;  ///< until a sequence has adopted its new phase
constexpr std::size_t most_steps = 8; ///< more are not a clock step
constexpr int answers_to_learn = 20;
constexpr double late_answer = 0.25; ///< share of the period
constexpr std::uint64_t late_in_a_row = 5;

} // namespace

void PhaseSteps::take(std::int64_t stamp_ns, double due_ns, double period_ns) {
    const auto now_ns = static_cast<double>(stamp_ns);
    settling_ -= settling_ > 0 ? 1 : 0;
    if (frames_ > 0) {
        const double off_ns = std::remainder(now_ns - next_ns_, period_ns);
        next_ns_ = now_ns - off_ns + period_ns;
        frames_ = std::abs(off_ns) <= same_step * period_ns ? frames_ + 1 : 0;
        if (frames_ == lasting_frames && steps_.size() < most_steps) {
            steps_.push_back({begin_ns_, step_ns_});
            frames_ = 0;
            settling_ = frames_to_settle;
        }
        return;
    }
    const double off_ns = std::remainder(now_ns - due_ns, period_ns);
    if (settling_ == 0 && std::abs(off_ns) > least_step * period_ns) {
        begin_ns_ = stamp_ns;
        step_ns_ = off_ns;
        next_ns_ = now_ns + period_ns;
        frames_ = 1;
    }
}

void SyncAnswers::take(std::int64_t after_ns, double period_ns) {
    const auto now_ns = static_cast<double>(after_ns);
    if (learned_ < answers_to_learn) {
        const double phase_rad = 2 * std::numbers::pi * now_ns / period_ns;
        cosine_sum_ += std::cos(phase_rad);
        sine_sum_ += std::sin(phase_rad);
        usual_ns_ = std::atan2(sine_sum_, cosine_sum_) / (2 * std::numbers::pi) * period_ns;
        ++learned_;
        return;
    }
    const bool off = std::abs(std::remainder(now_ns - usual_ns_, period_ns)) > late_answer * period_ns;
    run_ = off ? run_ + 1 : 0;
    late_ += run_ == late_in_a_row ? run_ : run_ > late_in_a_row ? 1 : 0;
}

void ReadingOrder::take(std::int64_t stamp_ns) noexcept {
    constexpr std::int64_t once_ns = 10'000'000; // one step of the clock affects all sources within this time
    if (stamp_ns < latest_ns_ && stamp_ns - overtaken_ns_ > once_ns) {
        ++overtaken_;
        overtaken_ns_ = stamp_ns;
    }
    latest_ns_ = std::max(latest_ns_, stamp_ns);
}

bool ReadingOrder::differs() const noexcept {
    constexpr std::uint64_t least_times = 3;
    return overtaken_ >= least_times;
}

} // namespace dfdyn::tools
