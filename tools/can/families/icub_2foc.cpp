// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_2foc.hpp"

#include "tools/can/families/family_fields.hpp"
#include "tools/can/motors/codec_fit.hpp"

#include <cmath>

namespace dfdyn::tools::families {

namespace {

class FocBoard final : public BoardOf<FocBoard, hal::icub::FocBoard> {
  public:
    using BoardOf::BoardOf;
    bool measures_effort() const override { return true; }
    double encoder_turn_rad() const override {
        return BoardOf::encoder_turn_rad() / std::abs(codec().config().motor_per_joint);
    }
};

const std::vector<FamilyField> foc_board_fields{
    {"address", "(1 to 14)"},
    {"joint", ""},
    {"motor_per_joint", "(1)"},
    {"zero_rad", "(0): angle = turns · 2π / motor_per_joint + zero; current in mA"},
};

BusBoard read_foc_board(const JsonReader& board) {
    board.allow_only(names_of(foc_board_fields));
    hal::icub::FocBoard::Config config;
    config.address = board.whole_number("address", 1, 14);
    config.joint = read_joint(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<FocBoard>(hal::icub::FocBoard(config), config.joint);
}

void read_foc_boards(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                     BusDescription& description) {
    read_each_board(joints, read_foc_board, description);
}

Recognition recognise_foc_boards(FrameSpan frames) {
    Recognition recognition;
    recognition.quantity = "i";
    for (int address = 1; address <= 14; ++address) {
        const CodecFit fit = fit_codec(hal::icub::FocBoard({.address = address}), frames);
        if (fit.fits()) {
            recognition.boards.push_back({.name = "board " + std::to_string(address),
                                          .entry = {{"address", address}},
                                          .rate_hz = fit.joint[0].rate_hz()});
            recognition.identifiers.insert({false, 0x100U | static_cast<std::uint32_t>(address) << 4U});
            recognition.score += 2 * static_cast<double>(fit.values);
        }
    }
    if (!recognition.boards.empty()) {
        recognition.unsure.emplace_back(
            "motor_per_joint: turns of the encoder are taken for those of the joint");
    }
    return recognition;
}

} // namespace

JointFamily icub_2foc() {
    return {.name = "icub_2foc",
            .board_fields = foc_board_fields,
            .fields = {},
            .dbc = "icub_2foc.dbc",
            .example = R"({"family": "icub_2foc",
                "boards": [{"address": 1, "joint": 1}, {"address": 2, "joint": 2, "motor_per_joint": -2}]})",
            .read = read_foc_boards,
            .devices = "iCub motor boards (2FOC, AMC), one joint each",
            .recognise = recognise_foc_boards};
}

} // namespace dfdyn::tools::families
