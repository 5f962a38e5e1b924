// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/damiao.hpp"

#include "tools/can/motors/mit_recognition.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands: the motor's own command (identifier: the motor id) with zero stiffness and
/// damping.
class DamiaoMotor final : public MotorBoard<DamiaoMotor, hal::DamiaoMotor> {
  public:
    using MotorBoard::MotorBoard;
    static bool takes_torque() { return true; }
    static ScaleAdvice advice() {
        return {"read the motor's register 22 (VMAX)",
                "Correct velocity_max. Check torque_max and position_max: registers 23 and 21."};
    }
};

/// Factory settings by LeRobot (06f4bd2, motors/damiao/tables.py), and by openarm_can (98666042) if they
/// disagree.
constexpr std::array<MotorType, 13> damiao_types{{{"DM3507", {12.5, 30, 10}, {12.5, 50, 5}},
                                                  {"DM4310", {12.5, 30, 10}},
                                                  {"DM4310_48V", {12.5, 50, 10}},
                                                  {"DM4340", {12.5, 8, 28}, {12.5, 10, 28}},
                                                  {"DM4340_48V", {12.5, 10, 28}},
                                                  {"DM6006", {12.5, 45, 20}},
                                                  {"DM8006", {12.5, 45, 40}},
                                                  {"DM8009", {12.5, 45, 54}},
                                                  {"DM10010L", {12.5, 25, 200}},
                                                  {"DM10010", {12.5, 20, 200}},
                                                  {"DMH3510", {12.5, 280, 1}},
                                                  {"DMH6215", {12.5, 45, 10}},
                                                  {"DMG6220", {12.5, 45, 10}}}};

const std::vector<FamilyField> damiao_fields{
    {"motor_id", "(1 to 15; register ESC_ID)"},
    {"feedback_id", "(of its answers; register MST_ID)"},
    {"joint", ""},
    {"motor",
     "(`\"DM4310\"`: the maxima of that type as delivered, where libraries agree on them; without: none)"},
    {"position_max", "(rad; register 21, PMAX)"},
    {"velocity_max", "(rad/s; register 22, VMAX; required of DM3507 and DM4340)"},
    {"torque_max", "(N·m; register 23, TMAX; required of DM3507)"},
    transmission_field(),
    zero_field(),
};

hal::DamiaoMotor::Config read_damiao_motor(const JsonReader& board, bool fd) {
    board.allow_only(names_of(damiao_fields));
    hal::DamiaoMotor::Config config;
    config.motor_id = board.whole_number("motor_id", 1, 15);
    board.text("feedback_id"); // a required field
    config.feedback_id = identifier_or(board, "feedback_id", 0);
    config.joint = read_joint(board);
    const Maxima maxima = read_maxima(board, damiao_types,
                                      {"the motor's register 21 (PMAX)", "the motor's register 22 (VMAX)",
                                       "the motor's register 23 (TMAX)"});
    config.position_max = maxima[0];
    config.velocity_max = maxima[1];
    config.torque_max = maxima[2];
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    config.fd = fd;
    return config;
}

void read_damiao_motors(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                        BusDescription& description) {
    const bool fd = joints.has("fd") && joints.flag("fd");
    add_mit_motors<DamiaoMotor, hal::DamiaoMotor>(
        joints, false, [&](const JsonReader& board) { return read_damiao_motor(board, fd); }, description);
}

/// Returns 0 if the frame cannot be a feedback of such a motor, 1 if it can be, more with evidence for it.
double damiao_plausibility(const hal::Frame& frame) {
    const unsigned state = frame.data[0] >> 4U;
    if (state != 0 && state != 1 && (state < 8 || state > 14)) {
        return 0;
    }
    const auto warm = [](std::uint8_t celsius) { return celsius >= 5 && celsius <= 130; };
    const bool usual_id = frame.id == 0x10U + (frame.data[0] & 0xFU);
    return 1 + (warm(frame.data[6]) && warm(frame.data[7]) ? 1 : 0) + (usual_id ? 0.5 : 0) +
           (state == 1 ? 0.5 : 0);
}

/// Returns the maxima that the motor reported.
Maxima reported_damiao_maxima(const MitCandidate& candidate, FrameSpan frames) {
    Maxima known{};
    for (const hal::Frame& frame : frames) {
        const bool answer = hal::has_id(frame, candidate.feedback_id) && frame.length == 8 &&
                            !hal::DamiaoProtocol::is_feedback(frame, candidate.motor);
        const auto reported = answer ? hal::DamiaoProtocol::reported(frame) : std::nullopt;
        if (reported && reported->value > 0 && reported->value < 1e6) {
            known.at(static_cast<std::size_t>(reported->maximum)) = reported->value;
        }
    }
    return known;
}

Recognition recognise_damiao_motors(FrameSpan frames) {
    Recognition recognition = recognise_mit_motors<hal::DamiaoProtocol>(
        frames, {damiao_types, "read its registers 21, 22 and 23", 15}, damiao_plausibility,
        [&](const MitCandidate& candidate) { return reported_damiao_maxima(candidate, frames); });
    if (std::ranges::any_of(frames, [&](const hal::Frame& frame) {
            return frame.fd && recognition.identifiers.contains({frame.extended, frame.id});
        })) {
        recognition.fields["fd"] = true;
        recognition.unsure.emplace_back("fd: some frames are CAN FD, so that all commands are assumed to be");
    }
    return recognition;
}

} // namespace

JointFamily damiao() {
    return {
        .name = "damiao",
        .board_fields = damiao_fields,
        .fields = {{"fd", "(false; true: the motors are set to CAN FD, for simulated and commanded ones)"}},
        .example = R"({"family": "damiao", "boards": [
                {"motor_id": 1, "feedback_id": "0x11", "joint": 1, "motor": "DM8009"},
                {"motor_id": 2, "feedback_id": "0x12", "joint": 2, "motor": "DM4310", "motor_per_joint": -1}]})",
        .read = read_damiao_motors,
        .devices = "Damiao DM motors with their own protocol: OpenArm, I2RT YAM, LeRobot's `damiao` bus",
        .sources = {"huggingface/lerobot `motors/damiao/` (049856c, 06f4bd2)",
                    "enactic/openarm_can `dm_motor_control.cpp` (98666042)",
                    "otegami/openarm `motor-can.md`"},
        .pitfalls =
            {"The maxima are registers 21, 22 and 23, which any program can change; they are not in the "
             "frames.",
             "Libraries disagree on the defaults: velocities of one DM4340 differ by 25 %.",
             "An answer about a register, or a poll, if decoded as feedback, gives a position near -PMAX.",
             "The high nibble of byte 0 is the state; an undocumented state is a fault.",
             "A motor that does not answer is not a joint at 0."},
        .types = {damiao_types.begin(), damiao_types.end()},
        .recognise = recognise_damiao_motors,
        .not_operational = {"read the upper half of byte 0 of its feedback: 0 is disabled, 1 enabled",
                            "Enable the motor: FF FF FF FF FF FF FF FC on its motor_id."}};
}

} // namespace dfdyn::tools::families
