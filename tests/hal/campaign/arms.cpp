// SPDX-License-Identifier: Apache-2.0
#include "every_family.hpp"
#include "tests/hal/campaign/arm_of_family.hpp"

namespace dfdyn::tests {

/// Drives that measure when they send.
struct FreeDrives {
    struct on_wire : families::cia402::on_wire {
        static constexpr bool synchronous = false;
        static auto boards() noexcept { return std::array{drive(1, false, 32, 0), drive(2, false, 32, 0)}; }
    };
};

/// Drives with 16 bits of position, whose encoders wrap in the middle of the motion.
struct WrappingDrives {
    struct on_wire : families::cia402::on_wire {
        static constexpr double step_rad = wire::turn / 65536;
        static constexpr double mounting_rad = 2.9;

        static auto boards() noexcept {
            return std::array{drive(1, true, 16, -mounting_rad), drive(2, true, 16, -mounting_rad)};
        }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const double position_rad = joints[board].position_rad + mounting_rad;
            const long long q = std::llround(position_rad / step_rad); // wraps
            const long long t = wire::int16(1000 * joints[board].effort);
            using wire::byte_of;
            return wire::one(wire::frame(board == 0 ? 0x281 : 0x282,
                                         {byte_of(q, 0), byte_of(q, 1), byte_of(t, 0), byte_of(t, 1)}));
        }
    };
};

template <class Family>
static void add_family(const std::string& name, std::vector<CampaignArm>& arms) {
    if constexpr (requires { Family::sensor(); }) {
        arms.push_back(
            arm_with_sensor<families::icub_two_joint_board, Family>("icub_two_joint_board, " + name));
    } else if (effort_step<Family>() > 0) {
        arms.push_back(arm_with_efforts<Family>(name + ", efforts"));
    } else {
        arms.push_back(arm_with_sensor<Family, families::icub_strain>(name + ", icub_strain"));
    }
}

template <class... Family>
struct Arms {
    static std::vector<CampaignArm> all() {
        std::vector<CampaignArm> arms;
        std::size_t i = 0;
        (add_family<Family>(every_family_name[i++], arms), ...);
        add_family<FreeDrives>("cia402 without SYNC", arms);
        add_family<WrappingDrives>("cia402 with 16 bits", arms);
        return arms;
    }
};

std::vector<CampaignArm> campaign_arms() { return EveryFamily<Arms>::all(); }

} // namespace dfdyn::tests
