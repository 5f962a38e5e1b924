// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_strain.hpp"

#include "tools/can/families/family_fields.hpp"

namespace dfdyn::tools::families {

namespace {

constexpr int strain_channels = 6;

bool same_message(const hal::Frame& one, const hal::Frame& other) {
    return one.id == other.id && !one.extended && one.length == other.length && one.data == other.data;
}

class StrainBoard final : public SensorOf<StrainBoard, hal::icub::StrainBoard> {
  public:
    using SensorOf::SensorOf;

    hal::Reason calibration() const override { return codec().full_scale().reason(); }

    std::vector<hal::Frame> requests() const override {
        std::vector<hal::Frame> frames;
        const bool ask = calibration() != hal::Reason::ok;
        for (int channel = 0; ask && channel < strain_channels; ++channel) {
            frames.push_back(codec().request_full_scale(channel));
        }
        return frames;
    }

    std::optional<hal::Frame> answer(const hal::Frame& request) const override {
        for (int channel = 0; channel < strain_channels; ++channel) {
            if (same_message(request, codec().request_full_scale(channel))) {
                return full_scale(channel);
            }
        }
        return std::nullopt;
    }

    std::vector<hal::Frame> answers() const override {
        std::vector<hal::Frame> frames;
        for (int channel = 0; channel < strain_channels; ++channel) {
            frames.push_back(full_scale(channel));
        }
        return frames;
    }

    std::vector<BusFinding> findings() const override {
        if (codec().other_sets() == 0) {
            return {};
        }
        return {{"full_scale_other_set",
                 "the sensor reported full scales of a set of its calibration that is not in use",
                 std::to_string(codec().other_sets()) + " replies that differ, of set " +
                     std::to_string(codec().last_other_set()),
                 "ask for the set in use: cansend IFACE ID#1800, and 01 to 05",
                 "Let no other program request it. If it is in use, set output.calibration_set."}};
    }

  private:
    hal::Frame full_scale(int channel) const {
        return codec().encode_full_scale(channel, codec().full_scale()[static_cast<std::size_t>(channel)]);
    }
};

DescribedWrenchSensor read_strain_board(const JsonReader& output, const std::filesystem::path& /*folder*/) {
    hal::icub::StrainBoard board(output.whole_number("address", 1, 14));
    board.use_calibration_set(output.whole_or("calibration_set", 0, 0, 15));
    std::array<double, 6> limit = limit_or(output, 10'000, 1'000); // range of any board of this type
    if (output.has("full_scale")) {
        const std::vector<int> full_scales = output.whole_numbers("full_scale", 1, 0xFFFF);
        if (full_scales.size() != strain_channels) {
            throw output.error("full_scale", "6 numbers", std::to_string(full_scales.size()));
        }
        for (int channel = 0; channel < strain_channels; ++channel) {
            const double full_scale = full_scales[static_cast<std::size_t>(channel)];
            board.describe_full_scale(channel, full_scale);
            limit[static_cast<std::size_t>(channel)] = full_scale;
        }
        if (board.full_scale().reason() != hal::Reason::ok) {
            throw output.error("full_scale", "full scales that a sensor of an arm can have, N and N·m",
                               "others");
        }
        limit = output.has("limit") ? read_limit(output) : limit;
    }
    return {AnySensor(std::make_unique<StrainBoard>(board)), limit};
}

} // namespace

SensorFamily icub_strain() {
    return {
        .name = "icub_strain",
        .fields = {{"address", "(1 to 14)"},
                   {"full_scale", "(six, N and N·m; without it the sensor has to report them on the bus)"},
                   {"calibration_set", "(0: replies about the set in use are numbered 0, as the firmware "
                                       "does; else the number of the set in use)"}},
        .dbc = "icub_strain.dbc",
        .example =
            R"({"family": "icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25]})",
        .devices = "iCub force/torque sensors (strain, strain2)",
        .read = read_strain_board};
}

} // namespace dfdyn::tools::families
