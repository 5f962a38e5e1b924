// SPDX-License-Identifier: Apache-2.0
// An arm on a bus: the frames of its devices, and the receiver under test.
#pragma once

#include "dfdyn/hal/assembly/position_track.hpp"
#include "dfdyn/hal/assembly/sample_report.hpp"
#include "dfdyn/hal/bus.hpp"
#include "tests/hal/campaign/traffic.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace dfdyn::tests {

enum class Trigger { timer, set, sync };

/// A sample of the receiver, independent of its type there.
struct CampaignSample {
    std::int64_t time_ns = 0;
    bool valid = false, output_valid = false;
    std::array<double, 2> position{};
    std::array<double, 6> output{};
    std::size_t outputs = 0;
    hal::SampleReport<2, 6> report;
};

/// The receiver's assembly of an arm, in the form that hal::Sampler takes.
class ReceivingArm {
  public:
    explicit ReceivingArm() = default;
    ReceivingArm(const ReceivingArm&) = delete;
    ReceivingArm& operator=(const ReceivingArm&) = delete;
    virtual ~ReceivingArm() = default;
    virtual std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) = 0;
    virtual void update(hal::BusState state, const hal::BusCounters& counters) = 0;
    [[nodiscard]] virtual bool pending(std::int64_t instant_ns, std::int64_t now_ns) const = 0;
    virtual CampaignSample assemble(std::int64_t instant_ns, std::int64_t now_ns) = 0;
};

/// Mask of bits in a frame's data.
using Bits = std::array<std::uint8_t, 64>;

/// Two joints on a bus, with efforts or a wrench.
struct CampaignArm {
    std::string name;
    bool synchronous = false; ///< the joints measure at a SYNC
    std::size_t boards = 0;
    std::array<double, 2> step_rad{}; ///< one count of a joint's position
    std::array<double, 2> zero_rad{}; ///< position of a joint where its device's number is 0
    double output_step = 0;           ///< one count of an effort or of a wrench
    double output_range = 0;          ///< largest value of a wrench; 0: efforts
    std::function<wire::Frames(std::size_t board, const wire::Joints&)> frames;
    std::function<wire::Frames(const wire::SixWords&)> wrench;
    std::function<void(hal::Frame&, std::size_t half)> saturate_wrench;
    std::function<bool(const hal::Frame&)> has_values; ///< true if the receiver takes values from the frame
    std::vector<hal::Frame> status;                    ///< sent at the start and every 100 ms
    std::function<std::unique_ptr<ReceivingArm>(Trigger, const hal::MotionLimits&)> receive;

    /// Masks of the position and the effort of each joint in a board's frame; empty if the frame has none.
    struct Fields {
        std::array<Bits, 2> position{}, effort{};
    };
    std::array<std::array<Fields, 3>, 2> fields{}; ///< [board][part]

    [[nodiscard]] bool efforts() const { return output_range == 0; }

    /// Returns true if a device of the arm sends frames with this identifier, length and flags.
    [[nodiscard]] bool has_form(const hal::Frame& frame) const;

    /// Finds the fields by the bits that change between frames.
    void find_fields();

    /// Returns the frames that the devices send in this many periods, in order of true time.
    [[nodiscard]] Traffic run(const Scene& scene, int cycles) const;

  private:
    void send_joints(const Scene& scene, int cycle, Traffic& traffic) const;
    void send_wrench(const Scene& scene, int cycle, Traffic& traffic) const;
};

[[nodiscard]] bool any(const Bits& bits);
[[nodiscard]] int count(const Bits& bits);

/// Copies the masked bits.
void copy_bits(const hal::Frame& from, const Bits& bits, hal::Frame& to);

/// Returns the families of tests/hal/families, also with SYNC, wrapping integers and separate efforts if they
/// have them.
[[nodiscard]] std::vector<CampaignArm> campaign_arms();

} // namespace dfdyn::tests
