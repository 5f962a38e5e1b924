// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/sample_assembly.hpp"
#include "tools/can/description/bus_description.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace dfdyn::tools {

/// Number of measurements stored per source; sufficient for the delay of any timer.
inline constexpr int bus_history = 64;

/// A sample of an arm with any number of joints, or the reason why there is none.
using BusSample = hal::AssembledSample<double, dynamic, dynamic>;

/// The output of an arm of a bus description, as `Output` of hal::SampleAssembly: the wrench of a sensor, or
/// the efforts of the joints. The methods are documented there.
class BusOutput {
  public:
    static constexpr int outputs = dynamic;

    explicit BusOutput(const BusDescription& description);

    Extent<outputs> size() const noexcept;
    hal::Decoded take(const hal::Frame& frame) noexcept;
    void take(const hal::JointValue& value, std::optional<double> position_rad) noexcept;
    bool claims(std::uint32_t id) const noexcept;
    /// The values after those of the outputs are 0.
    hal::Measurement<hal::places(outputs)> at(std::int64_t instant_ns, std::int64_t now_ns) noexcept;
    hal::ValueOrigin origin(std::int64_t instant_ns) const noexcept;
    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept;
    bool heard() const noexcept;
    std::int64_t newest_ns() const noexcept;
    std::int64_t period_ns() const noexcept;
    void lost() noexcept;

    /// The sensor with everything that it has reported; null if the joints measure the outputs.
    const AnySensor* sensor() const noexcept;

  private:
    using Wrench = hal::WrenchOutput<AnySensor, bus_history>;
    using Efforts = hal::EffortOutput<dynamic, bus_history>;

    std::variant<Wrench, Efforts> output_;
};

/// hal::SampleAssembly for the arm of a bus description: the firmware's code for any devices and any number
/// of joints. Its methods are documented there.
class BusArm {
  public:
    /// Keeps no reference to `description`.
    explicit BusArm(const BusDescription& description);

    /// Takes a frame read at `now_ns`. Returns the time of the sample that can be assembled now, if there is
    /// one. Sample times of other triggers than the description's are not reported.
    std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns);

    /// Sets the state and counters of the bus. Call it before `take` for the frames that were read together
    /// with them.
    void update(hal::BusState state, const hal::BusCounters& counters) { assembly_.update(state, counters); }

    /// Drops a set that is not complete at `now_ns`. The next set contains later measurements only. Returns
    /// true if the dropped set contained a joint.
    bool drop_set(std::int64_t now_ns) { return assembly_.drop_set(now_ns); }

    /// Returns true if a value for this sample time is missing that can still be interpolated.
    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const {
        return assembly_.pending(instant_ns, now_ns);
    }

    /// Assembles the sample of `instant_ns`.
    BusSample assemble(std::int64_t instant_ns, std::int64_t now_ns) {
        return assembly_.assemble(instant_ns, now_ns);
    }

    const hal::AssemblyCounters& counters() const { return assembly_.counters(); }
    const hal::BusWatch& bus() const { return assembly_.bus(); }

    /// The sensor with everything that it has reported; null if the joints measure the outputs.
    const AnySensor* sensor() const { return assembly_.output().sensor(); }

    /// Requests for the full scales of the sensor; empty if they are known and not in doubt.
    std::vector<hal::Frame> requests() const;

    /// A standard identifier that two devices would send, if there is one.
    std::optional<std::uint32_t> colliding_id() const { return assembly_.colliding_id(); }

  private:
    /// An arm has no more boards than joints; the remaining places are empty.
    using Assembly =
        hal::SampleAssembly<double, dynamic, AnyBoard, hal::largest_joint_count, BusOutput, bus_history>;

    static Assembly::Config config_of(const BusDescription& description);

    BusTrigger trigger_;
    Assembly assembly_;
};

} // namespace dfdyn::tools
