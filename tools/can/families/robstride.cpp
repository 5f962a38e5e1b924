// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/robstride.hpp"

#include "tools/can/motors/mit_recognition.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

namespace dfdyn::tools::families {

namespace {

constexpr ScaleAdvice robstride_advice{"read the motor's type on its label, and its ranges in its manual",
                                       "Correct motor, or velocity_max. Check torque_max, too."};

/// Accepts torque commands: the motor's own command with zero stiffness and damping.
class RobstrideMotor final : public MotorBoard<RobstrideMotor, hal::RobstrideMotor> {
  public:
    using MotorBoard::MotorBoard;
    static bool takes_torque() { return true; }
    static ScaleAdvice advice() { return robstride_advice; }

    hal::Decoded decode(const hal::Frame& frame) noexcept override {
        if (hal::RobstrideMotor::is_feedback_to_other(codec().config(), frame)) {
            host().answered_other_host();
        }
        return MotorBoard::decode(frame);
    }
};

class RobstrideMitMotor final : public MotorBoard<RobstrideMitMotor, hal::RobstrideMitMotor> {
  public:
    using MotorBoard::MotorBoard;
    static bool takes_torque() { return true; }
    static ScaleAdvice advice() { return robstride_advice; }
};

/// LeRobot (1b8c2b6, motors/robstride/tables.py), and the maker's data sheets if they disagree. LeRobot's
/// position of the RS06, 112.5, is assumed to be a typing error. CyberGear: cybergear-docs (17e371b).
constexpr double robstride_position_max = 4 * std::numbers::pi;
constexpr std::array<MotorType, 9> robstride_types{
    {{"RS00", {robstride_position_max, 33, 14}},
     {"RS01", {robstride_position_max, 44, 17}},
     {"RS02", {robstride_position_max, 33, 20}, {robstride_position_max, 33, 17}},
     {"RS03", {robstride_position_max, 33, 60}},
     {"RS04", {robstride_position_max, 33, 120}, {robstride_position_max, 15, 120}},
     {"RS05", {robstride_position_max, 50, 5.5}},
     {"RS06", {robstride_position_max, 50, 36}},
     {"EL05", {robstride_position_max, 50, 6}},
     {"CyberGear", {robstride_position_max, 30, 12}}}};

const std::vector<FamilyField> robstride_fields{
    {"motor_id", "(1 to 254)"},
    {"feedback_id", "(of its answers with `\"mit\"`; `host_id`)"},
    {"joint", ""},
    {"motor",
     "(`\"RS00\"` to `\"RS06\"`, `\"EL05\"`, `\"CyberGear\"`: the ranges of that type, where documents "
     "agree on them; without: none)"},
    {"position_max", "(rad; 4π of every `motor`)"},
    {"velocity_max", "(rad/s; required of RS04)"},
    {"torque_max", "(N·m; required of RS02)"},
    transmission_field(),
    zero_field(),
};

const std::vector<FamilyField> robstride_bus_fields{
    {"protocol", "(`\"private\"`, or `\"mit\"`: standard identifiers; `\"private\"`)"},
    {"host_id", "(`\"0xFD\"`; the program that the motors answer: bits 7 to 0 of their identifiers, or their "
                "identifier with `\"mit\"`)"},
};

/// Reads the common fields of both protocols.
template <class Config>
Config read_robstride_motor(const JsonReader& board) {
    board.allow_only(names_of(robstride_fields));
    Config config;
    config.motor_id = board.whole_number("motor_id", 1, 254);
    config.joint = read_joint(board);
    const std::string expected = "the range in the motor's manual";
    const Maxima maxima = read_maxima(board, robstride_types, {expected, expected, expected});
    config.position_max = maxima[0];
    config.velocity_max = maxima[1];
    config.torque_max = maxima[2];
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return config;
}

void read_private_robstride(const JsonReader& joints, std::uint32_t host, BusDescription& description) {
    std::vector<int> motors;
    read_each_board(
        joints,
        [&](const JsonReader& board) {
            reject_fields(board, {"feedback_id"}, R"(protocol "private")");
            auto config = read_robstride_motor<hal::RobstrideMotor::Config>(board);
            take_own_id(board, "motor_id", config.motor_id, motors);
            config.host_id = static_cast<int>(host);
            return one_joint<RobstrideMotor>(hal::RobstrideMotor(config), config.joint);
        },
        description);
}

void read_robstride_motors(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                           BusDescription& description) {
    const std::string protocol = joints.has("protocol") ? joints.text("protocol") : "private";
    const std::uint32_t host = identifier_or(joints, "host_id", 0xFD);
    if (protocol == "private" && host <= 0xFF) {
        read_private_robstride(joints, host, description);
    } else if (protocol == "private") {
        throw joints.error("host_id", R"("0x0" to "0xFF")", in_quotes(identifier_text(host)));
    } else if (protocol == "mit") {
        add_mit_motors<RobstrideMitMotor, hal::RobstrideMitMotor>(
            joints, true,
            [&](const JsonReader& board) {
                auto config = read_robstride_motor<hal::RobstrideMitMotor::Config>(board);
                config.feedback_id = identifier_or(board, "feedback_id", host);
                return config;
            },
            description);
    } else {
        throw joints.error("protocol", R"("private" or "mit")", in_quotes(protocol));
    }
}

const MotorSearch robstride_search{robstride_types, "look up the type on its label", 254, true};

/// Number of feedback frames by host and motor.
using RobstrideAnswers = std::map<unsigned, std::map<unsigned, std::uint64_t>>;

RobstrideAnswers robstride_answers(FrameSpan frames) {
    RobstrideAnswers answers;
    for (const hal::Frame& frame : frames) {
        if (frame.extended && !frame.error && !frame.remote && !frame.fd && frame.length == 8 &&
            frame.id >> 24U == 2) {
            ++answers[frame.id & 0xFFU][frame.id >> 8U & 0xFFU];
        }
    }
    return answers;
}

/// Returns the host with the most answers.
RobstrideAnswers::const_iterator main_robstride_host(const RobstrideAnswers& answers) {
    return std::ranges::max_element(answers, {}, [](const auto& host) {
        std::uint64_t sum = 0;
        for (const auto& [motor, count] : host.second) {
            sum += count;
        }
        return sum;
    });
}

/// Adds the identifiers of all feedback, and of the commands to the answering motors.
void add_robstride_identifiers(FrameSpan frames, const std::set<unsigned>& answering,
                               std::set<BusStreamKey>& identifiers) {
    for (const hal::Frame& frame : frames) {
        if (frame.extended && frame.id >> 24U == 2) {
            identifiers.insert({true, frame.id});
        }
    }
    for (const unsigned motor : answering) {
        add_commands(frames, hal::RobstrideMotor({.motor_id = static_cast<int>(motor)}), identifiers);
    }
}

/// Returns the frames that none of the `answering` motors sent: answers look like commands to a motor with
/// the number of the host.
std::vector<hal::Frame> without_answers(FrameSpan frames, const std::set<unsigned>& answering) {
    std::vector<hal::Frame> others(frames.begin(), frames.end());
    std::erase_if(others, [&](const hal::Frame& frame) {
        const std::optional<unsigned> sender = hal::RobstrideMotor::answering_motor(frame);
        return sender && answering.contains(*sender);
    });
    return others;
}

Recognition recognise_private_robstride(FrameSpan frames) {
    Recognition recognition;
    recognition.quantity = "tau";
    const RobstrideAnswers answers = robstride_answers(frames);
    const auto main_host = main_robstride_host(answers);
    if (main_host == answers.end()) {
        return recognition;
    }
    constexpr double assumed = 33;
    std::set<unsigned> answering;
    for (const auto& [motor, count] : main_host->second) {
        const CodecFit fit = fit_codec(hal::RobstrideMotor({.motor_id = static_cast<int>(motor),
                                                            .host_id = static_cast<int>(main_host->first),
                                                            .velocity_max = assumed,
                                                            .torque_max = 1}),
                                       frames);
        if (fit.fits()) {
            add_motor(motor, fit.joint[0], assumed, robstride_search, {}, nlohmann::json::object(),
                      recognition);
            answering.insert(motor);
            recognition.score += 3 * static_cast<double>(count);
        }
    }
    if (!answering.empty()) {
        recognition.silent =
            silent_motors(without_answers(frames, answering), 1, 254, answering, [](unsigned motor) {
                return hal::RobstrideMotor({.motor_id = static_cast<int>(motor)});
            });
    }
    add_robstride_identifiers(frames, answering, recognition.identifiers);
    recognition.fields = {{"protocol", "private"}, {"host_id", identifier_text(main_host->first)}};
    if (answers.size() > 1) {
        recognition.unsure.push_back(std::to_string(answers.size()) +
                                     " hosts get answers; the draft has the one with the most");
    }
    return recognition;
}

/// Returns 0 if the frame cannot be a feedback of such a motor, 1 if it can be, more with evidence for it.
double robstride_plausibility(const hal::Frame& frame) {
    const double celsius = hal::RobstrideMitProtocol::temperature(frame);
    const bool warm = celsius >= 5 && celsius <= 130;
    const bool cubemars_error = frame.data[7] <= 6; // then byte 6 may be the temperature of a CubeMars motor
    return celsius > 150 ? 0 : 1 + (warm ? (cubemars_error ? 0.5 : 1) : 0) + (frame.id == 0xFD ? 0.5 : 0);
}

Recognition recognise_mit_robstride(FrameSpan frames) {
    Recognition recognition = recognise_mit_motors<hal::RobstrideMitProtocol>(
        frames, robstride_search, robstride_plausibility, [](const MitCandidate&) { return Maxima{}; });
    recognition.fields = {{"protocol", "mit"}};
    return recognition;
}

Recognition recognise_robstride(FrameSpan frames) {
    Recognition own = recognise_private_robstride(frames);
    Recognition mit = recognise_mit_robstride(frames);
    return own.score >= mit.score ? own : mit;
}

} // namespace

JointFamily robstride() {
    return {
        .name = "robstride",
        .board_fields = robstride_fields,
        .fields = robstride_bus_fields,
        .example = R"({"family": "robstride", "boards": [
                {"motor_id": 1, "joint": 1, "motor": "RS03"},
                {"motor_id": 2, "joint": 2, "motor": "CyberGear", "motor_per_joint": -1}]})",
        .read = read_robstride_motors,
        .devices =
            "Robstride motors and the Xiaomi CyberGear, with their own protocol or in MIT mode: K-Scale, "
            "LeRobot's `robstride` bus, OpenArmX",
        .sources = {"belovictor/cybergear-docs `instructionmanual.md` (17e371b)",
                    "huggingface/lerobot `motors/robstride/` (024196a, 1b8c2b6)"},
        .pitfalls = {"Signals are big-endian, parameters little-endian.", "The angle saturates at ±4π.",
                     "Two programs that poll get answers with two hosts in bits 7 to 0.",
                     "In MIT mode all motors answer on one identifier; byte 0 distinguishes them.",
                     "Bytes 6 and 7 are one temperature in 0.1 °C; Damiao has two.",
                     "LeRobot's `sync_read` polls by clearing faults (FF … FB).",
                     "Manuals disagree on the order of host and motor in a fault frame; both are accepted.",
                     "LeRobot's position_max of the RS06, 112.5, is assumed to be a typing error."},
        .types = {robstride_types.begin(), robstride_types.end()},
        .recognise = recognise_robstride,
        .stream_id = hal::RobstrideMotor::stream_id,
        .not_operational = {"read bits 23 and 22 of the identifier of its feedback: 2 is the mode run",
                            "Enable the motor (type 3)."}};
}

} // namespace dfdyn::tools::families
