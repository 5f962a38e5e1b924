// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/bus_arm.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Measurements stored per source; sufficient for the delay of any timer.
constexpr int capacity = 64;

using Wrenches = hal::WrenchOutput<AnySensor, capacity>;
template <int n>
using Efforts = hal::EffortOutput<n, capacity>;

hal::TrackConfig track_config(const BusSource& source) {
    return {.max_age_ns = source.max_age_ns,
            .latency_ns = source.latency_ns,
            .qualification = {},
            .period_ns = std::llround(1e9 / source.rate_hz),
            .jitter_ns = source.jitter_ns};
}

template <std::size_t n>
std::array<hal::Range, n> ranges_of(const BusDescription& description) {
    std::array<hal::Range, n> ranges{};
    std::copy_n(description.output_range.begin(), n, ranges.begin());
    return ranges;
}

template <class Output>
Output make_output(const BusDescription& description) {
    const hal::TrackConfig track = track_config(description.output);
    const auto ranges = ranges_of<static_cast<std::size_t>(Output::outputs)>(description);
    if constexpr (std::is_same_v<Output, Wrenches>) {
        return Wrenches(*description.sensor, {.track = track,
                                              .range = ranges,
                                              .pairing = description.pairing,
                                              .frozen_limit = description.frozen_after});
    } else {
        return Output({.track = track, .range = ranges, .frozen_limit = description.frozen_after});
    }
}

hal::ClockGate::Config clock_config(const BusDescription& description) {
    hal::ClockGate::Config config;
    const double slowest_hz = std::min(description.joints.rate_hz, description.output.rate_hz);
    config.max_step_ns = std::max(config.max_step_ns, static_cast<std::int64_t>(3e9 / slowest_hz));
    return config;
}

template <int n, class Output>
class BusArmOf final : public BusArm {
  public:
    explicit BusArmOf(const BusDescription& description)
        : trigger_(description.trigger), assembly_(config_of(description), make_output<Output>(description)) {
    }

    std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) override {
        using Kind = typename Assembly::Moment::Kind;
        const typename Assembly::Moment moment = assembly_.take(frame, now_ns);
        const bool sync = moment.kind == Kind::sync && trigger_ == BusTrigger::sync;
        const bool set = moment.kind == Kind::set && trigger_ == BusTrigger::set;
        return sync || set ? std::optional(moment.instant_ns) : std::nullopt;
    }

    void update(hal::BusState state, const hal::BusCounters& counters) override {
        assembly_.update(state, counters);
    }

    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const override {
        return assembly_.pending(instant_ns, now_ns);
    }

    const BusSample& assemble(std::int64_t instant_ns, std::int64_t now_ns) override {
        const typename Assembly::Assembled assembled = assembly_.assemble(instant_ns, now_ns);
        const auto& [sample, report] = assembled;
        sample_.time_ns = sample.time_ns;
        sample_.position_reason = report.position;
        sample_.joint = report.joint;
        sample_.output_reason = report.output;
        sample_.position.assign(sample.position.begin(), sample.position.end());
        sample_.joint_reason.assign(report.joint_reason.begin(), report.joint_reason.end());
        sample_.position_origin.assign(report.position_origin.begin(), report.position_origin.end());
        sample_.output_origin = report.output_origin;
        sample_.output.assign(sample.output.begin(), sample.output.end());
        sample_.position_age_ns.assign(report.position_age_ns.begin(), report.position_age_ns.end());
        return sample_;
    }

    const hal::AssemblyCounters& counters() const override { return assembly_.counters(); }
    const hal::BusWatch& bus() const override { return assembly_.bus(0); }

    const AnySensor* sensor() const override {
        if constexpr (std::is_same_v<Output, Wrenches>) {
            return &assembly_.output().source();
        } else {
            return nullptr;
        }
    }

    std::vector<hal::Frame> requests() const override {
        return sensor() != nullptr ? (*sensor())->requests() : std::vector<hal::Frame>();
    }

    std::optional<std::uint32_t> colliding_id() const override { return assembly_.colliding_id(); }

  private:
    /// An arm has no more boards than joints; the remaining places are empty.
    using Assembly = hal::SampleAssembly<double, n, AnyBoard, n, Output, capacity>;

    static typename Assembly::Config config_of(const BusDescription& description) {
        typename Assembly::Config config{.board = {},
                                         .position = track_config(description.joints),
                                         .position_range = {},
                                         .clock = clock_config(description),
                                         .output_bus = 0};
        std::ranges::transform(description.boards, config.board.begin(), &BusBoard::board);
        std::ranges::copy(description.joint_limits, config.limits.begin());
        config.position_range.fill({-description.position_limit_rad, description.position_limit_rad});
        return config;
    }

    BusTrigger trigger_;
    Assembly assembly_;
    BusSample sample_;
};

template <int n>
std::unique_ptr<BusArm> make_of_size(const BusDescription& description) {
    if (description.sensor) {
        return std::make_unique<BusArmOf<n, Wrenches>>(description);
    }
    return std::make_unique<BusArmOf<n, Efforts<n>>>(description);
}

template <int... index>
std::unique_ptr<BusArm> make(const BusDescription& description, std::integer_sequence<int, index...> /*n*/) {
    std::unique_ptr<BusArm> arm;
    ((description.joint_count == index + 1 ? void(arm = make_of_size<index + 1>(description)) : void()), ...);
    return arm;
}

} // namespace

std::unique_ptr<BusArm> make_bus_arm(const BusDescription& description) {
    std::unique_ptr<BusArm> arm =
        make(description, std::make_integer_sequence<int, largest_bus_joint_count>{});
    if (arm == nullptr) {
        throw std::logic_error("a bus description with too many joints");
    }
    return arm;
}

} // namespace dfdyn::tools
