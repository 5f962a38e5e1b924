// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_two_joint_board.hpp"

#include "tools/can/families/family_fields.hpp"
#include "tools/can/motors/codec_fit.hpp"

namespace dfdyn::tools::families {

namespace {

class TwoJointBoard final : public BoardOf<TwoJointBoard, hal::icub::TwoJointBoard> {
  public:
    using BoardOf::BoardOf;
};

const std::vector<FamilyField> two_joint_board_fields{
    {"address", "(1 to 14)"},
    {"joints", "(two; 0: not of this arm)"},
    {"ticks_per_degree", "(two, negative for the other direction)"},
    {"zero_deg", "(two; 0): angle (deg) = ticks / ticks_per_degree − zero"},
};

BusBoard read_two_joint_board(const JsonReader& board) {
    board.allow_only(names_of(two_joint_board_fields));
    const std::vector<int> joints = board.whole_numbers("joints", 0, largest_bus_joint_count);
    if (joints.size() != 2) {
        throw board.error("joints", "2 numbers, 0 for a joint that the arm does not have",
                          std::to_string(joints.size()));
    }
    const std::vector<double> scales = board.numbers("ticks_per_degree", 2);
    const std::vector<double> zeros =
        board.has("zero_deg") ? board.numbers("zero_deg", 2) : std::vector<double>(2);
    const auto scale = [&](std::size_t i) {
        return hal::icub::EncoderScale{joints[i] - 1, read_ratio(scales[i], board, "ticks_per_degree"),
                                       zeros[i]};
    };
    static_assert(hal::unused_joint == -1);
    const hal::icub::TwoJointBoard codec(board.whole_number("address", 1, 14), scale(0), scale(1));
    return {AnyBoard(std::make_unique<TwoJointBoard>(codec)), {joints[0] - 1, joints[1] - 1}};
}

void read_two_joint_boards(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                           BusDescription& description) {
    read_each_board(joints, read_two_joint_board, description);
}

Recognition recognise_two_joint_boards(FrameSpan frames) {
    constexpr double usual_ticks = 11.375; // per degree: 12 bits per turn
    Recognition recognition;
    for (int address = 1; address <= 14; ++address) {
        const CodecFit fit =
            fit_codec(hal::icub::TwoJointBoard(address, {0, usual_ticks, 0}, {1, usual_ticks, 0}), frames);
        if (fit.fits()) {
            recognition.boards.push_back(
                {.name = "board " + std::to_string(address),
                 .entry = {{"address", address}, {"ticks_per_degree", {usual_ticks, usual_ticks}}},
                 .joints = 2,
                 .rate_hz = fit.joint[0].rate_hz()});
            recognition.identifiers.insert({false, 0x101U | static_cast<std::uint32_t>(address) << 4U});
            recognition.score += 2 * static_cast<double>(fit.values);
        }
    }
    if (!recognition.boards.empty()) {
        recognition.unsure.emplace_back("ticks_per_degree: 11.375 of encoders with 12 bits are assumed");
    }
    return recognition;
}

} // namespace

JointFamily icub_two_joint_board() {
    return {.name = "icub_two_joint_board",
            .board_fields = two_joint_board_fields,
            .fields = {},
            .dbc = "icub_two_joint_boards.dbc",
            .example = R"({"family": "icub_two_joint_board", "boards": [
                {"address": 1, "joints": [1, 2], "ticks_per_degree": [182.04, -182.04]}]})",
            .read = read_two_joint_boards,
            .devices = "iCub motor boards with two joints (MC4, BLL, DSP)",
            .recognise = recognise_two_joint_boards,
            .no_draft = no_efforts};
}

} // namespace dfdyn::tools::families
