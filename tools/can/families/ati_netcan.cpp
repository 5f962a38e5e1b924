// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/ati_netcan.hpp"

#include "tools/can/families/family_fields.hpp"

namespace dfdyn::tools::families {

namespace {

class AtiNetcan final : public SensorOf<AtiNetcan, hal::AtiNetcan> {
  public:
    using SensorOf::SensorOf;
    hal::Reason calibration() const override { return codec().calibration(); }
    bool carries_no_values(const hal::Frame& frame) const override {
        return hal::has_id(frame, codec().poll().id) && frame.length == 0;
    }
};

DescribedWrenchSensor read_ati(const JsonReader& output, const std::filesystem::path& /*folder*/) {
    hal::AtiNetcan::Config config;
    config.base = static_cast<std::uint32_t>(output.whole_or("base", 0x20, 0, 0x7E));
    const std::vector<double> matrix = output.numbers("matrix", 36);
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        config.matrix[i / 6][i % 6] = matrix[i];
    }
    config.counts_per_newton = output.positive_number("counts_per_newton");
    config.counts_per_newton_metre = output.positive_number("counts_per_newton_metre");
    const hal::AtiNetcan sensor(config);
    if (sensor.calibration() != hal::Reason::ok) {
        throw output.error("matrix", "an invertible matrix", "one that is not");
    }
    return {AnySensor(std::make_unique<AtiNetcan>(sensor)), read_limit(output)};
}

} // namespace

SensorFamily ati_netcan() {
    return {.name = "ati_netcan",
            .fields = {{"base", "(32: identifiers 16 · base and the next)"},
                       {"matrix", "(36, row by row)"},
                       {"counts_per_newton", ""},
                       {"counts_per_newton_metre", ""}},
            .dbc = "ati_netcan.dbc",
            .example = R"({"family": "ati_netcan", "base": 32, "counts_per_newton": 100,
                "counts_per_newton_metre": 5000, "limit": [200, 200, 200, 6, 6, 6],
                "matrix": [1,0,0,0,0,0, 0,1,0,0,0,0, 0,0,1,0,0,0, 0,0,0,1,0,0, 0,0,0,0,1,0, 0,0,0,0,0,1]})",
            .devices = "ATI force/torque sensors with NETCANOEM",
            .read = read_ati};
}

} // namespace dfdyn::tools::families
