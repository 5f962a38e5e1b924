// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/sample_assembly.hpp"
#include "tools/can/description/bus_description.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A sample of an arm of any size, or why there is none.
struct BusSample {
    std::int64_t time_ns = 0;
    hal::Reason position_reason = hal::Reason::ok; ///< ok: `position` is valid
    int joint = hal::unused_joint;                 ///< the first that `position_reason` is about
    hal::Reason output_reason = hal::Reason::ok;   ///< ok: `output` is valid
    std::vector<double> position;                  ///< rad; of the joints with ok in `joint_reason`
    std::vector<hal::Reason> joint_reason;         ///< per joint
    std::vector<hal::ValueOrigin> position_origin; ///< per joint: see hal::SampleReport
    hal::ValueOrigin output_origin = hal::ValueOrigin::none;
    std::vector<double> output;                ///< in the order of `output_names`
    std::vector<std::int64_t> position_age_ns; ///< per joint: see hal::SampleReport

    [[nodiscard]] bool valid() const noexcept { return position_reason == hal::Reason::ok; }
    [[nodiscard]] bool output_valid() const noexcept { return valid() && output_reason == hal::Reason::ok; }
};

/// hal::SampleAssembly for the arm of a bus description, whatever its devices and size: the firmware's code
/// behind one interface. Its methods are those of the assembly; see there.
class BusArm {
  public:
    virtual ~BusArm() = default;

    /// Takes a frame read at `now_ns`; the instant of the sample that can be assembled now, if there is one.
    virtual std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) = 0;

    /// State and counters of the bus, before the frames that were read with them are taken.
    virtual void update(hal::BusState state, const hal::BusCounters& counters) = 0;

    /// Whether a value of this instant is missing that may yet be interpolated.
    virtual bool pending(std::int64_t instant_ns, std::int64_t now_ns) const = 0;

    /// The result lives until the next call.
    virtual const BusSample& assemble(std::int64_t instant_ns, std::int64_t now_ns) = 0;

    virtual const hal::AssemblyCounters& counters() const = 0;
    virtual const hal::BusWatch& bus() const = 0;

    /// The sensor, with what it has reported; null where the joints measure the outputs.
    virtual const AnySensor* sensor() const = 0;

    /// What to send so that the sensor reports its full scales; none when they are known and not in doubt.
    virtual std::vector<hal::Frame> requests() const = 0;

    /// A standard identifier that two devices would send.
    virtual std::optional<std::uint32_t> colliding_id() const = 0;
};

/// The arm of `description`, to which it keeps no reference. Moments of another kind than its trigger are not
/// reported.
std::unique_ptr<BusArm> make_bus_arm(const BusDescription& description);

} // namespace dfdyn::tools
