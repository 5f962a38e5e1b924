// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/piper.hpp"

#include "tools/base/text/number.hpp"
#include "tools/can/motors/codec_fit.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

namespace dfdyn::tools::families {

namespace {

/// Two joints. Accepts torque commands: those of the MIT mode with zero stiffness and damping.
class PiperPair final : public BoardOf<PiperPair, hal::PiperPair> {
  public:
    using BoardOf::BoardOf;

    hal::Decoded decode(const hal::Frame& frame) noexcept override {
        if (codec().config().pair == 0) { // commands concern the arm
            host_.take(codec().command(frame), false, frame.stamp_ns);
        }
        const hal::Decoded decoded = BoardOf::decode(frame);
        for (int i = 0; i < decoded.joints; ++i) {
            const hal::JointValue& value = decoded.joint.at(static_cast<std::size_t>(i));
            velocity_.at(value.joint == codec().config().joint[0] ? 0 : 1).take(value);
        }
        return decoded;
    }
    bool measures_effort() const override { return true; }
    /// Its angles do not wrap.
    double encoder_turn_rad() const override { return 0; }

    std::optional<hal::Frame> torque_command(int joint, double torque_Nm) const override {
        return codec().encode_torque(joint, torque_Nm);
    }
    std::optional<double> commanded_torque(int joint, const hal::Frame& frame) const override {
        return codec().decode_torque(joint, frame);
    }

    std::vector<BusFinding> findings() const override {
        std::vector<BusFinding> all = host_.findings("the arm");
        for (std::size_t i = 0; i < velocity_.size(); ++i) {
            const int joint = codec().config().joint.at(i);
            for (
                BusFinding& finding : velocity_findings(
                    velocity_.at(i), joint,
                    {"read the firmware's version (0x4AF)",
                     R"(Correct firmware in the description: "rpm" for speeds in revolutions per minute.)"})) {
                if (joint != hal::unused_joint) {
                    all.push_back(std::move(finding));
                }
            }
        }
        return all;
    }
    std::string host_summary() const override { return host_.summary(); }

  private:
    std::array<VelocityCheck, 2> velocity_;
    HostWatch host_;
};

const std::vector<FamilyField> piper_fields{
    {"pair", "(1 to 3: joints 1 and 2, 3 and 4, or 5 and 6 of the Piper)"},
    {"joints", "(two; 0: not of this arm)"},
    {"sign", "(two; 1, or -1 for the other direction)"},
    {"zero_rad", "(two; 0): angle = sign · Piper's angle + zero"},
};

const std::vector<FamilyField> piper_bus_fields{
    {"feedback_id",
     "(`\"0x2A1\"`: the first of the arm's eight identifiers; `\"0x2B1\"` or `\"0x2C1\"` where they "
     "were moved)"},
    {"driver_id", "(`\"0x251\"`: of the speed and current of joint 1)"},
    {"firmware",
     "(`\"rpm\"`: old, speeds in revolutions per minute and currents in 0.1 A; `\"2024-07\"`: since "
     "2024-07-25, status bits 4 and 7 are collision and stall; without: units of today, these bits are "
     "ignored)"},
    {"effort", "(`\"current\"`: A; `\"torque\"`: N·m, by the factors of piper_sdk; `\"current\"`)"},
};

hal::PiperFirmware read_piper_firmware(const JsonReader& joints) {
    const std::string firmware = joints.has("firmware") ? joints.text("firmware") : "";
    if (joints.has("firmware") && firmware != "rpm" && firmware != "2024-07") {
        throw joints.error("firmware", R"("rpm" or "2024-07")", in_quotes(firmware));
    }
    return firmware == "rpm"  ? hal::PiperFirmware::rpm
           : firmware.empty() ? hal::PiperFirmware::any
                              : hal::PiperFirmware::current;
}

bool reads_piper_torque(const JsonReader& joints) {
    const std::string effort = joints.has("effort") ? joints.text("effort") : "current";
    if (effort != "current" && effort != "torque") {
        throw joints.error("effort", R"("current" or "torque")", in_quotes(effort));
    }
    return effort == "torque";
}

/// `config`: common properties of the pairs of an arm.
BusBoard read_piper_pair(const JsonReader& board, hal::PiperPair::Config config) {
    board.allow_only(names_of(piper_fields));
    config.pair = board.whole_number("pair", 1, 3) - 1;
    const std::vector<int> joints = board.whole_numbers("joints", 0, largest_bus_joint_count);
    if (joints.size() != 2) {
        throw board.error("joints", "2 numbers", std::to_string(joints.size()));
    }
    for (std::size_t i = 0; i < 2; ++i) {
        config.joint[i] = joints[i] == 0 ? hal::unused_joint : joints[i] - 1;
    }
    if (board.has("sign")) {
        const std::vector<int> signs = board.whole_numbers("sign", -1, 1);
        if (signs.size() != 2 || signs[0] == 0 || signs[1] == 0) {
            throw board.error("sign", "two numbers, 1 or -1", "others");
        }
        config.sign = {static_cast<double>(signs[0]), static_cast<double>(signs[1])};
    }
    if (board.has("zero_rad")) {
        std::ranges::copy(board.numbers("zero_rad", 2), config.zero_rad.begin());
    }
    return {AnyBoard(std::make_unique<PiperPair>(hal::PiperPair(config))), config.joint};
}

void read_piper(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                BusDescription& description) {
    hal::PiperPair::Config config;
    config.feedback_id = identifier_or(joints, "feedback_id", config.feedback_id);
    config.driver_id = identifier_or(joints, "driver_id", config.driver_id);
    config.firmware = read_piper_firmware(joints);
    config.torque = reads_piper_torque(joints);
    read_each_board(
        joints, [&](const JsonReader& board) { return read_piper_pair(board, config); }, description);
}

constexpr std::array<std::uint32_t, 3> piper_first_identifiers{0x2A1, 0x2B1, 0x2C1};

/// Returns how many of these joints have speeds of `factor` times the change of their positions.
bool piper_speeds_are(double factor, const std::vector<CodecFit>& fits) {
    int agree = 0;
    int sure = 0;
    for (const CodecFit& fit : fits) {
        for (const JointFit& joint : fit.joint) {
            const double ratio = std::abs(joint.velocity.ratio());
            sure += joint.velocity.is_sure() ? 1 : 0;
            agree += joint.velocity.is_sure() && std::abs(ratio / factor - 1) < 0.3 ? 1 : 0;
        }
    }
    return sure > 0 && 2 * agree > sure;
}

Recognition recognise_piper_arm(FrameSpan frames, std::uint32_t feedback_id) {
    Recognition recognition;
    recognition.quantity = "i";
    std::vector<CodecFit> fits;
    for (int pair = 0; pair < 3; ++pair) {
        const std::uint32_t angles = feedback_id + 4 + static_cast<std::uint32_t>(pair);
        const CodecFit fit = fit_codec(hal::PiperPair({.pair = pair, .feedback_id = feedback_id}), frames);
        if (!fit.fits() || std::max(fit.joint[0].highest_rad, fit.joint[1].highest_rad) > 7) {
            continue;
        }
        RecognisedBoard board{.name = "joints " + std::to_string(2 * pair + 1) + " and " +
                                      std::to_string(2 * pair + 2),
                              .entry = {},
                              .joints = 2,
                              .rate_hz = fit.joint[0].rate_hz()};
        board.entry = {{"pair", pair + 1}};
        recognition.boards.push_back(std::move(board));
        recognition.identifiers.insert({false, angles});
        recognition.score += 3 * static_cast<double>(fit.values);
        fits.push_back(fit);
    }
    for (std::uint32_t id = feedback_id; id < feedback_id + 8 && !fits.empty(); ++id) {
        recognition.identifiers.insert({false, id});
    }
    recognition.fields = {{"feedback_id", identifier_text(feedback_id)}};
    constexpr double rpm = std::numbers::pi / 30 / 0.001; // new speed counts per old one
    if (piper_speeds_are(rpm, fits)) {
        recognition.fields["firmware"] = "rpm";
        recognition.unsure.emplace_back(
            "currents: its speeds are revolutions per minute, so that old firmware with "
            "currents in 0.1 A is assumed");
    } else if (!piper_speeds_are(1, fits) && !fits.empty()) {
        recognition.unsure.emplace_back(
            "the unit of speeds and currents: no joint moved enough to compare them");
    }
    return recognition;
}

Recognition recognise_piper(FrameSpan frames) {
    Recognition best;
    int arms = 0;
    for (const std::uint32_t feedback_id : piper_first_identifiers) {
        Recognition recognition = recognise_piper_arm(frames, feedback_id);
        arms += recognition.boards.empty() ? 0 : 1;
        if (recognition.boards.size() > best.boards.size()) {
            best = std::move(recognition);
        }
    }
    if (arms > 1) {
        best.unsure.push_back(
            std::to_string(arms) +
            " arms are on this bus, and their drives share identifiers: the draft has the positions "
            "of the first; its efforts may be those of another");
    }
    return best;
}

} // namespace

JointFamily piper() {
    return {
        .name = "piper",
        .board_fields = piper_fields,
        .fields = piper_bus_fields,
        .dbc = "piper.dbc",
        .example = R"({"family": "piper", "boards": [{"pair": 1, "joints": [1, 2]}]})",
        .read = read_piper,
        .devices = "AgileX Piper arms",
        .sources = {"agilexrobotics/piper_sdk `protocol_v2`, `msg_v2` (1dadd60)"},
        .pitfalls = {"Old firmware has speeds in revolutions per minute and currents in 0.1 A on the same "
                     "identifiers.",
                     "A second arm's angles are on 0x2B5 or 0x2C5; its drives keep their identifiers.",
                     "Bits 4 and 7 of a drive's status changed their meaning on 2024-07-25.",
                     "The document has unsigned currents, the SDK decodes signed ones.",
                     "The current on the supply is always 0 for the small motors.",
                     "The six angles are in three frames that are measured at different times.",
                     "The SDK's effort is a current times a factor, not from a torque sensor.",
                     "The SDK scales a commanded torque to ±8 N·m; its documentation has ±18."},
        .recognise = recognise_piper,
        .not_operational = {"read byte 5 of 0x261 to 0x266: bit 6 is set if the drive is enabled",
                            "Enable the drives (0x471)."}};
}

} // namespace dfdyn::tools::families
