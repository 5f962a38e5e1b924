// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/cubemars.hpp"

#include "tools/base/text/number.hpp"
#include "tools/can/motors/mit_recognition.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands: the motor's own command with zero stiffness and damping.
class CubemarsMitMotor final : public MotorBoard<CubemarsMitMotor, hal::CubemarsMitMotor> {
  public:
    using MotorBoard::MotorBoard;
    static bool takes_torque() { return true; }
    static ScaleAdvice advice() {
        return {"read the motor's type on its label, and its ranges in its manual",
                "Correct motor, or velocity_max. Check torque_max, too."};
    }
};

/// Accepts torque commands, as currents, if the torque constant is configured.
class CubemarsServo final : public MotorBoard<CubemarsServo, hal::CubemarsServo> {
  public:
    using MotorBoard::MotorBoard;
    bool takes_torque() const { return codec().config().newton_metre_per_ampere != 0; }
    static ScaleAdvice advice() {
        return {"count the motor's turns for one of its output",
                "Correct pole_pairs or gear_ratio in the description."};
    }
};

/// TMotorCANControl (bb8d071), mit_can.py.
constexpr std::array<MotorType, 1> cubemars_types{{{"AK80-9", {12.5, 50, 18}}}};

const std::vector<FamilyField> cubemars_fields{
    {"motor_id", "(1 to 255)"},
    {"feedback_id", "(of its answers with `\"mit\"`; that of `joints`)"},
    {"joint", ""},
    {"motor", "(with `\"mit\"`: `\"AK80-9\"`; without: none)"},
    {"position_max", "(rad; with `\"mit\"`)"},
    {"velocity_max", "(rad/s; with `\"mit\"`)"},
    {"torque_max", "(N·m; with `\"mit\"`)"},
    {"pole_pairs", "(with `\"servo\"`; 21)"},
    {"gear_ratio", "(with `\"servo\"`; 9: turns of the motor for one of the angle that it reports)"},
    {"newton_metre_per_ampere",
     "(with `\"servo\"`: makes efforts and commands torques of the motor's output; "
     "without: efforts are currents)"},
    transmission_field(),
    zero_field(),
};

const std::vector<FamilyField> cubemars_bus_fields{
    {"protocol", "(`\"mit\"` or `\"servo\"`; `\"mit\"`)"},
    {"feedback_id", "(`\"0x0\"`; of the answers with `\"mit\"`)"},
    {"packet", "(of the answers with `\"servo\"`, bits 28 to 8 of their identifiers, as `\"0x29\"`; without: "
               "`\"0x29\"`, 9 or 0)"},
};

hal::CubemarsMitMotor::Config read_cubemars_mit_motor(const JsonReader& board, std::uint32_t feedback_id) {
    board.allow_only(names_of(cubemars_fields));
    reject_fields(board, {"pole_pairs", "gear_ratio", "newton_metre_per_ampere"}, R"(protocol "mit")");
    hal::CubemarsMitMotor::Config config;
    config.motor_id = board.whole_number("motor_id", 1, 255);
    config.feedback_id = identifier_or(board, "feedback_id", feedback_id);
    config.joint = read_joint(board);
    const std::string expected = "the range in the motor's manual";
    const Maxima maxima = read_maxima(board, cubemars_types, {expected, expected, expected});
    config.position_max = maxima[0];
    config.velocity_max = maxima[1];
    config.torque_max = maxima[2];
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return config;
}

BusBoard read_cubemars_servo(const JsonReader& board, int packet, std::vector<int>& motors) {
    board.allow_only(names_of(cubemars_fields));
    reject_fields(board, {"feedback_id", "motor", "position_max", "velocity_max", "torque_max"},
                  R"(protocol "servo")");
    hal::CubemarsServo::Config config;
    config.motor_id = board.whole_number("motor_id", 0, 255);
    take_own_id(board, "motor_id", config.motor_id, motors);
    config.packet = packet;
    config.joint = read_joint(board);
    config.pole_pairs = board.number_or("pole_pairs", config.pole_pairs, 1, 100);
    config.gear_ratio = board.number_or("gear_ratio", config.gear_ratio, 0.01, 1000);
    config.newton_metre_per_ampere = read_torque_constant(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<CubemarsServo>(hal::CubemarsServo(config), config.joint);
}

void read_cubemars_motors(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                          BusDescription& description) {
    const std::string protocol = joints.has("protocol") ? joints.text("protocol") : "mit";
    if (protocol == "mit") {
        reject_fields(joints, {"packet"}, R"(protocol "mit")");
        const std::uint32_t feedback_id = identifier_or(joints, "feedback_id", 0);
        add_mit_motors<CubemarsMitMotor, hal::CubemarsMitMotor>(
            joints, true,
            [&](const JsonReader& board) { return read_cubemars_mit_motor(board, feedback_id); },
            description);
    } else if (protocol == "servo") {
        reject_fields(joints, {"feedback_id"}, R"(protocol "servo")");
        const int packet = joints.has("packet") ? static_cast<int>(identifier_or(joints, "packet", 0)) : -1;
        std::vector<int> motors;
        read_each_board(
            joints, [&](const JsonReader& board) { return read_cubemars_servo(board, packet, motors); },
            description);
    } else {
        throw joints.error("protocol", R"("mit" or "servo")", in_quotes(protocol));
    }
}

/// Returns 0 if the frame cannot be a feedback of such a motor, 1 if it can be, more with evidence for it.
double cubemars_plausibility(const hal::Frame& frame) {
    const bool short_frame = frame.length == 6;
    if (!short_frame && (frame.data[6] > 150 || frame.data[7] > 6)) {
        return 0;
    }
    const bool cold = frame.data[6] > 0 && frame.data[7] == 0; // without an error
    return 1 + (short_frame || frame.data[6] >= 5 || cold ? 1 : 0) + (frame.id == 0 ? 0.75 : 0);
}

Recognition recognise_mit_cubemars(FrameSpan frames) {
    Recognition recognition = recognise_mit_motors<hal::CubemarsMitProtocol>(
        frames, {cubemars_types, "look up the type on its label", 255, true}, cubemars_plausibility,
        [](const MitCandidate&) { return Maxima{}; });
    recognition.fields = {{"protocol", "mit"}};
    return recognition;
}

/// Returns true if it may be the feedback of a motor in servo mode.
bool is_cubemars_upload(const hal::Frame& frame) {
    const unsigned packet = frame.id >> 8U;
    return frame.extended && !frame.error && !frame.remote && !frame.fd && frame.length == 8 &&
           (packet == 0 || packet > 8) && packet <= 0xFF && frame.data[7] <= 6;
}

constexpr double usual_pairs = hal::CubemarsServo::Config{}.pole_pairs;
constexpr double usual_gear = hal::CubemarsServo::Config{}.gear_ratio;

/// Adds the motor, whose feedback was decoded with the usual pole pairs and gear.
void add_cubemars_servo(unsigned motor, const JointFit& fit, Recognition& recognition) {
    RecognisedBoard board{.name = "motor " + std::to_string(motor), .entry = {}, .rate_hz = fit.rate_hz()};
    board.entry = {{"motor_id", motor}};
    if (fit.velocity.is_sure() && fit.velocity.ratio() != 0) {
        const double pairs_and_gear = usual_pairs * usual_gear / std::abs(fit.velocity.ratio());
        const double gear = pairs_and_gear / usual_pairs;
        const double whole = std::round(gear);
        board.entry["pole_pairs"] = usual_pairs;
        board.entry["gear_ratio"] = whole >= 1 && std::abs(gear / whole - 1) < 0.04 ? whole : gear;
        board.measured =
            "pole pairs times gear ratio " + rounded_text(pairs_and_gear) + ", from its positions";
    } else {
        recognition.unsure.push_back(board.name + ": it moved too little to determine its gear");
    }
    recognition.boards.push_back(std::move(board));
}

Recognition recognise_cubemars_servo(FrameSpan frames) {
    Recognition recognition;
    recognition.quantity = "i";
    std::map<std::uint32_t, std::uint64_t> uploads;
    for (const hal::Frame& frame : frames) {
        uploads[frame.id] += is_cubemars_upload(frame) ? 1 : 0;
    }
    for (const auto& [id, count] : uploads) {
        if (count < frames_to_recognise) {
            continue;
        }
        const CodecFit fit = fit_codec(hal::CubemarsServo({.motor_id = static_cast<int>(id & 0xFFU),
                                                           .packet = static_cast<int>(id >> 8U)}),
                                       frames);
        if (fit.fits()) {
            add_cubemars_servo(id & 0xFFU, fit.joint[0], recognition);
            recognition.identifiers.insert({true, id});
            recognition.score += 2 * static_cast<double>(count);
            recognition.fields = {{"protocol", "servo"}, {"packet", identifier_text(id >> 8U)}};
        }
    }
    if (!recognition.boards.empty()) {
        recognition.unsure.emplace_back("torques: efforts are currents without newton_metre_per_ampere");
    }
    return recognition;
}

Recognition recognise_cubemars(FrameSpan frames) {
    Recognition mit = recognise_mit_cubemars(frames);
    Recognition servo = recognise_cubemars_servo(frames);
    return mit.score >= servo.score ? mit : servo;
}

} // namespace

JointFamily cubemars() {
    return {
        .name = "cubemars",
        .board_fields = cubemars_fields,
        .fields = cubemars_bus_fields,
        .dbc = "cubemars.dbc",
        .example = R"({"family": "cubemars", "boards": [
                {"motor_id": 1, "joint": 1, "motor": "AK80-9"},
                {"motor_id": 2, "joint": 2, "motor": "AK80-9", "motor_per_joint": -1}]})",
        .read = read_cubemars_motors,
        .devices = "CubeMars (T-Motor) AK motors in MIT mode or servo mode",
        .sources = {"neurobionics/TMotorCANControl `mit_can.py`, `servo_can.py` (bb8d071)"},
        .pitfalls =
            {"The torque in MIT mode is a current times a constant, without friction.",
             "For the AK80-9 the maker has 0.091 N·m/A, TMotorCANControl measured 0.115: 26 % more.",
             "Speeds in servo mode are electrical: pole pairs and gear convert them to those of the joint.",
             "Old firmware sends six bytes in MIT mode, without temperature and error.",
             "Some firmware has another packet number in the identifiers of servo mode, or none."},
        .types = {cubemars_types.begin(), cubemars_types.end()},
        .recognise = recognise_cubemars};
}

} // namespace dfdyn::tools::families
