// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/robotous_rft.hpp"

#include "tools/can/families/family_fields.hpp"

namespace dfdyn::tools::families {

namespace {

class RobotousRft final : public SensorOf<RobotousRft, hal::RobotousRft> {
  public:
    using SensorOf::SensorOf;
};

DescribedWrenchSensor read_robotous(const JsonReader& output, const std::filesystem::path& /*folder*/) {
    hal::RobotousRft::Config config;
    config.first_id = identifier_or(output, "first_id", config.first_id);
    config.second_id = identifier_or(output, "second_id", config.second_id);
    if (config.first_id == config.second_id) {
        throw output.error("second_id", "another identifier than the first",
                           identifier_text(config.second_id));
    }
    config.counts_per_newton = output.number_or("counts_per_newton", config.counts_per_newton, 1e-3, 1e6);
    config.counts_per_newton_metre =
        output.number_or("counts_per_newton_metre", config.counts_per_newton_metre, 1e-3, 1e6);
    return {AnySensor(std::make_unique<RobotousRft>(hal::RobotousRft(config))),
            limit_or(output, 32768 / config.counts_per_newton, 32768 / config.counts_per_newton_metre)};
}

} // namespace

SensorFamily robotous_rft() {
    return {.name = "robotous_rft",
            .fields = {{"first_id", "(`\"0xF9\"`)"},
                       {"second_id", "(`\"0xFA\"`)"},
                       {"counts_per_newton", "(50)"},
                       {"counts_per_newton_metre", "(2000)"}},
            .dbc = "robotous_rft.dbc",
            .example = R"({"family": "robotous_rft"})",
            .devices = "Robotous RFT force/torque sensors",
            .read = read_robotous};
}

} // namespace dfdyn::tools::families
