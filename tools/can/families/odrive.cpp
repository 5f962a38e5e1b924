// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/odrive.hpp"

#include "tools/can/families/family_fields.hpp"
#include "tools/can/motors/codec_fit.hpp"

#include <cmath>

namespace dfdyn::tools::families {

namespace {

class OdriveAxis final : public BoardOf<OdriveAxis, hal::OdriveAxis> {
  public:
    using BoardOf::BoardOf;
    double encoder_turn_rad() const override {
        return BoardOf::encoder_turn_rad() / std::abs(codec().config().motor_per_joint);
    }
    std::optional<hal::Frame> heartbeat() const override { return codec().encode_heartbeat(false); }
};

const std::vector<FamilyField> odrive_axis_fields{
    {"node", "(0 to 63)"},
    {"joint", ""},
    {"motor_per_joint", "(1)"},
    {"zero_rad", "(0): angle = turns · 2π / motor_per_joint + zero"}};

hal::OdriveFirmware read_firmware(const JsonReader& joints) {
    const std::string firmware = joints.has("firmware") ? joints.text("firmware") : "";
    if (firmware == "0.5") {
        return hal::OdriveFirmware::v0_5;
    }
    if (firmware == "0.6") {
        return hal::OdriveFirmware::v0_6;
    }
    if (joints.has("firmware")) {
        throw joints.error("firmware", R"("0.5" or "0.6")", in_quotes(firmware));
    }
    return hal::OdriveFirmware::any;
}

/// `config`: the properties that all axes of a bus have in common.
BusBoard read_odrive_axis(const JsonReader& board, hal::OdriveAxis::Config config) {
    board.allow_only(names_of(odrive_axis_fields));
    config.node = board.whole_number("node", 0, 63);
    config.joint = read_joint(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<OdriveAxis>(hal::OdriveAxis(config), config.joint);
}

void read_odrive_axes(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                      BusDescription& description) {
    hal::OdriveAxis::Config config;
    config.heartbeat_timeout_ns = nanoseconds_or(joints, "heartbeat_timeout_s", 0.25);
    config.firmware = read_firmware(joints);
    read_each_board(
        joints, [&](const JsonReader& board) { return read_odrive_axis(board, config); }, description);
}

/// Requires the heartbeat and possible angles, because many frames look like two floats.
Recognition recognise_odrive_axes(FrameSpan frames) {
    constexpr double implausible_rad = 1e6; // neutral commands of motors with MIT mode look like -3e29 turns
    Recognition recognition;
    for (int node = 0; node <= 63; ++node) {
        const auto heartbeat_id = static_cast<std::uint32_t>(node) << 5U | 1U;
        const auto heartbeats = std::ranges::count_if(frames, [&](const hal::Frame& frame) {
            return hal::has_id(frame, heartbeat_id) && hal::check_form(frame, 8) == hal::Reason::ok;
        });
        const CodecFit fit = fit_codec(hal::OdriveAxis({.node = node}), frames);
        const double largest_rad = std::max(-fit.joint[0].lowest_rad, fit.joint[0].highest_rad);
        if (heartbeats >= 3 && fit.fits() && largest_rad < implausible_rad) {
            recognition.boards.push_back({.name = "axis " + std::to_string(node),
                                          .entry = {{"node", node}},
                                          .rate_hz = fit.joint[0].rate_hz()});
            recognition.identifiers.insert({false, heartbeat_id});
            recognition.identifiers.insert({false, heartbeat_id + 8});
            for (std::uint32_t command = 0; command < 32; ++command) {
                recognition.reserved.insert({false, static_cast<std::uint32_t>(node) << 5U | command});
            }
            recognition.score += 2 * static_cast<double>(fit.values);
        }
    }
    if (!recognition.boards.empty()) {
        recognition.unsure.emplace_back(
            "motor_per_joint: turns of the motor are taken for those of the joint");
    }
    return recognition;
}

} // namespace

JointFamily odrive() {
    return {.name = "odrive",
            .board_fields = odrive_axis_fields,
            .fields = {{"heartbeat_timeout_s", "(0.25)"},
                       {"firmware",
                        "(`\"0.5\"` or `\"0.6\"`; without: what holds for both, so that an encoder's flag "
                        "without a bit in the error word is 0.6's finished trajectory)"}},
            .dbc = "odrive.dbc",
            .example = R"({"family": "odrive", "boards": [{"node": 1, "joint": 1, "motor_per_joint": 9},
                                                          {"node": 2, "joint": 2, "motor_per_joint": -9}]})",
            .read = read_odrive_axes,
            .devices = "ODrive axes with CANSimple, firmware 0.5 and 0.6",
            .recognise = recognise_odrive_axes,
            .no_draft = no_efforts};
}

} // namespace dfdyn::tools::families
