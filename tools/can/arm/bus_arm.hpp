// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/sample_assembly.hpp"
#include "tools/can/description/bus_description.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A sample of an arm with any number of joints, or the reason why there is none.
struct BusSample {
    std::int64_t time_ns = 0;
    hal::Reason position_reason = hal::Reason::ok; ///< ok: `position` is valid
    int joint = hal::unused_joint;                 ///< the first joint to which `position_reason` applies
    hal::Reason output_reason = hal::Reason::ok;   ///< ok: `output` is valid
    std::vector<double> position;                  ///< rad; valid for joints with ok in `joint_reason`
    std::vector<hal::Reason> joint_reason;         ///< per joint
    std::vector<hal::ValueOrigin> position_origin; ///< per joint: see hal::SampleReport
    hal::ValueOrigin output_origin = hal::ValueOrigin::none;
    std::vector<double> output;                ///< in the order of `output_names`
    std::vector<std::int64_t> position_age_ns; ///< per joint: see hal::SampleReport

    [[nodiscard]] bool valid() const noexcept { return position_reason == hal::Reason::ok; }
    [[nodiscard]] bool output_valid() const noexcept { return valid() && output_reason == hal::Reason::ok; }
};

/// hal::SampleAssembly for the arm of a bus description: one interface to the firmware's code for any devices
/// and any number of joints. Its methods are documented there.
class BusArm {
  public:
    virtual ~BusArm() = default;

    /// Takes a frame read at `now_ns`. Returns the time of the sample that can be assembled now, if there is
    /// one.
    virtual std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) = 0;

    /// Sets the state and counters of the bus. Call it before `take` for the frames that were read together
    /// with them.
    virtual void update(hal::BusState state, const hal::BusCounters& counters) = 0;

    /// Returns true if a value for this sample time is missing that can still be interpolated.
    virtual bool pending(std::int64_t instant_ns, std::int64_t now_ns) const = 0;

    /// Assembles the sample of `instant_ns`. The result is valid until the next call.
    virtual const BusSample& assemble(std::int64_t instant_ns, std::int64_t now_ns) = 0;

    virtual const hal::AssemblyCounters& counters() const = 0;
    virtual const hal::BusWatch& bus() const = 0;

    /// The sensor with everything that it has reported; null if the joints measure the outputs.
    virtual const AnySensor* sensor() const = 0;

    /// Requests for the full scales of the sensor; empty if they are known and not in doubt.
    virtual std::vector<hal::Frame> requests() const = 0;

    /// A standard identifier that two devices would send, if there is one.
    virtual std::optional<std::uint32_t> colliding_id() const = 0;
};

/// Makes the arm of `description` and keeps no reference to it. Sample times of other triggers than the
/// description's are not reported.
std::unique_ptr<BusArm> make_bus_arm(const BusDescription& description);

} // namespace dfdyn::tools
