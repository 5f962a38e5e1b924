// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/rmd.hpp"

#include "tools/can/motors/codec_fit.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

#include <algorithm>
#include <map>
#include <ranges>

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands, as currents, if the torque constant is configured.
class RmdMotor final : public MotorBoard<RmdMotor, hal::RmdMotor> {
  public:
    using MotorBoard::MotorBoard;
    static constexpr bool needs_polls = true; ///< the angle of 1 ° in answers to commands is too coarse
    bool takes_torque() const { return codec().config().newton_metre_per_ampere != 0; }
    static ScaleAdvice advice() {
        return {
            "turn the joint by a known angle: some drivers report angles of the motor, others of its output",
            "Correct driver, counts_per_turn or motor_per_joint in the description."};
    }
};

const std::vector<FamilyField> rmd_fields{
    {"motor_id", "(1 to 32)"},
    {"joint", ""},
    {"counts_per_turn", "(65536; with `\"encoder\"`)"},
    {"newton_metre_per_ampere",
     "(makes efforts and commands torques of the motor's output; without: efforts are "
     "currents)"},
    transmission_field(),
    zero_field(),
};

const std::vector<FamilyField> rmd_bus_fields{
    {"driver", "(`\"V2\"` or `\"V3\"`, which is also for V4; `\"V3\"`)"},
    {"position",
     "(`\"multi_turn\"`: answers to 0x92; `\"encoder\"`: to 0x60; `\"status\"`: to 0x9C, 1 ° with V3; "
     "`\"multi_turn\"`)"},
};

hal::RmdDriver read_rmd_driver(const JsonReader& joints) {
    const std::string driver = joints.has("driver") ? joints.text("driver") : "V3";
    if (driver != "V2" && driver != "V3") {
        throw joints.error("driver", R"("V2" or "V3")", in_quotes(driver));
    }
    return driver == "V2" ? hal::RmdDriver::v2 : hal::RmdDriver::v3;
}

hal::RmdPosition read_rmd_position(const JsonReader& joints) {
    const std::string position = joints.has("position") ? joints.text("position") : "multi_turn";
    if (position == "multi_turn") {
        return hal::RmdPosition::multi_turn;
    }
    if (position == "encoder") {
        return hal::RmdPosition::encoder;
    }
    if (position == "status") {
        return hal::RmdPosition::status;
    }
    throw joints.error("position", R"("multi_turn", "encoder" or "status")", in_quotes(position));
}

/// `config`: common properties of all motors.
BusBoard read_rmd_motor(const JsonReader& board, hal::RmdMotor::Config config) {
    board.allow_only(names_of(rmd_fields));
    config.motor_id = board.whole_number("motor_id", 1, 32);
    config.joint = read_joint(board);
    if (config.position != hal::RmdPosition::encoder) {
        reject_fields(board, {"counts_per_turn"}, R"(position other than "encoder")");
    }
    config.counts_per_turn = board.number_or("counts_per_turn", config.counts_per_turn, 1, 1e9);
    config.newton_metre_per_ampere = read_torque_constant(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<RmdMotor>(hal::RmdMotor(config), config.joint);
}

void read_rmd_motors(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                     BusDescription& description) {
    hal::RmdMotor::Config config;
    config.driver = read_rmd_driver(joints);
    config.position = read_rmd_position(joints);
    read_each_board(
        joints, [&](const JsonReader& board) { return read_rmd_motor(board, config); }, description);
}

/// Answers of the motors of one driver version: number of frames by motor and command.
using RmdAnswers = std::map<int, std::map<unsigned, std::uint64_t>>;

bool is_rmd_answer(unsigned command) {
    return command == 0x60 || command == 0x92 || command == 0x9A || command == 0x9C || command == 0x9D ||
           (command >= 0xA1 && command <= 0xA9);
}

RmdAnswers rmd_answers(FrameSpan frames, hal::RmdDriver driver) {
    RmdAnswers answers;
    const std::uint32_t base = driver == hal::RmdDriver::v2 ? 0x140 : 0x240;
    for (const hal::Frame& frame : frames) {
        const bool form = !frame.extended && !frame.error && hal::check_form(frame, 8) == hal::Reason::ok;
        if (!form || frame.id <= base || frame.id > base + 32 || !is_rmd_answer(frame.data[0])) {
            continue;
        }
        const int motor = static_cast<int>(frame.id - base);
        const hal::RmdMotor codec({.motor_id = motor, .driver = driver});
        if (codec.command(frame) == hal::MotorCommand::none) { // V2: not a request
            ++answers[motor][frame.data[0]];
        }
    }
    return answers;
}

/// Returns the finest position among the answers of a motor.
hal::RmdPosition finest_rmd_position(const std::map<unsigned, std::uint64_t>& commands) {
    const auto often = [&](unsigned command) {
        const auto found = commands.find(command);
        return found != commands.end() && found->second >= frames_to_recognise;
    };
    return often(0x92)   ? hal::RmdPosition::multi_turn
           : often(0x60) ? hal::RmdPosition::encoder
                         : hal::RmdPosition::status;
}

constexpr std::array<const char*, 3> rmd_position_names{"multi_turn", "encoder", "status"};

/// Adds a motor that answers, with the identifiers of its requests and answers.
void add_rmd_motor(int motor, const JointFit& fit, Recognition& recognition) {
    RecognisedBoard board{
        .name = "motor " + std::to_string(motor), .entry = {{"motor_id", motor}}, .rate_hz = fit.rate_hz()};
    if (fit.efforts == 0) {
        recognition.unsure.push_back(board.name +
                                     ": no program requests its current (0x9C), so that it has no efforts");
    }
    recognition.boards.push_back(std::move(board));
    for (const std::uint32_t base : {0x140U, 0x240U}) {
        recognition.identifiers.insert({false, base + static_cast<std::uint32_t>(motor)});
    }
}

/// Adds the silent motors. The identifier of one is explained if its frames begin with known commands.
void add_silent_rmd_motors(FrameSpan frames, hal::RmdDriver driver, const std::set<unsigned>& answering,
                           Recognition& recognition) {
    recognition.silent = silent_motors(frames, 1, 32, answering, [&](unsigned motor) {
        return hal::RmdMotor({.motor_id = static_cast<int>(motor), .driver = driver});
    });
    for (const SilentMotor& silent : recognition.silent) {
        const std::uint32_t id = 0x140 + silent.motor;
        const auto count = [&](auto matches) {
            return std::ranges::count_if(
                frames, [&](const hal::Frame& frame) { return hal::has_id(frame, id) && matches(frame); });
        };
        const auto all = count([](const hal::Frame&) { return true; });
        const auto known = count([](const hal::Frame& frame) { return is_rmd_answer(frame.data[0]); });
        if (10 * known >= 9 * all) {
            recognition.identifiers.insert({false, id});
        }
    }
}

/// Adds the properties of recognised motors that the frames do not determine.
void add_rmd_doubts(hal::RmdPosition position, const std::map<int, hal::RmdPosition>& finest_of, bool old,
                    std::vector<std::string>& unsure) {
    for (const auto& [motor, finest] : finest_of) {
        if (finest != position) {
            unsure.push_back("motor " + std::to_string(motor) + ": sends no positions of the kind " +
                             rmd_position_names.at(static_cast<std::size_t>(position)));
        }
    }
    unsure.emplace_back("torques: efforts are currents without newton_metre_per_ampere");
    if (position == hal::RmdPosition::encoder) {
        unsure.emplace_back("counts_per_turn: 65536 is assumed");
    }
    if (position == hal::RmdPosition::status && !old) {
        unsure.emplace_back("positions of 1 ° are too coarse to learn from: poll 0x92");
    }
}

Recognition recognise_rmd_driver(FrameSpan frames, hal::RmdDriver driver) {
    Recognition recognition;
    recognition.quantity = "i";
    const bool old = driver == hal::RmdDriver::v2;
    std::map<int, hal::RmdPosition> finest_of;
    std::set<unsigned> answering;
    for (const auto& [motor, commands] : rmd_answers(frames, driver)) {
        const hal::RmdPosition finest = finest_rmd_position(commands);
        const CodecFit fit =
            fit_codec(hal::RmdMotor({.motor_id = motor, .driver = driver, .position = finest}), frames);
        if (!fit.fits()) {
            continue;
        }
        finest_of[motor] = finest;
        add_rmd_motor(motor, fit.joint[0], recognition);
        answering.insert(static_cast<unsigned>(motor));
        for (const auto& [command, count] : commands) {
            recognition.score += 3 * static_cast<double>(count);
        }
    }
    if (!answering.empty()) {
        add_silent_rmd_motors(frames, driver, answering, recognition);
    }
    const hal::RmdPosition position = // of all motors of the draft
        finest_of.empty() ? hal::RmdPosition::multi_turn : std::ranges::min(finest_of | std::views::values);
    recognition.fields = {{"driver", old ? "V2" : "V3"},
                          {"position", rmd_position_names.at(static_cast<std::size_t>(position))}};
    if (!recognition.boards.empty()) {
        add_rmd_doubts(position, finest_of, old, recognition.unsure);
    }
    return recognition;
}

Recognition recognise_rmd(FrameSpan frames) {
    Recognition today = recognise_rmd_driver(frames, hal::RmdDriver::v3);
    Recognition old = recognise_rmd_driver(frames, hal::RmdDriver::v2);
    return today.score >= old.score ? today : old;
}

} // namespace

JointFamily rmd() {
    return {.name = "rmd",
            .board_fields = rmd_fields,
            .fields = rmd_bus_fields,
            .dbc = "rmd.dbc",
            .example = R"({"family": "rmd", "boards": [
                {"motor_id": 1, "joint": 1, "newton_metre_per_ampere": 2.1},
                {"motor_id": 2, "joint": 2, "newton_metre_per_ampere": 2.1, "motor_per_joint": -1}]})",
            .read = read_rmd_motors,
            .devices = "MyActuator RMD motors with V2, V3 and V4 drivers",
            .sources = {"MyActuator, Motor Motion Protocol V4.2 (2024-05), and three independent drivers"},
            .pitfalls = {"V2 drivers answer on the identifier of the requests, with 33/2048 A per count.",
                         "The angle in the answer to 0x9C has steps of 1 °: too coarse to learn from.",
                         "A request has the first byte of its answer; with V2 drivers its identifier, too.",
                         "A V2 driver's angle of exactly 0 looks like its request: it is used only at "
                         "speed 0, and only if both frames, request and answer, came.",
                         "V2 drivers: 0xA5 and 0xA6 have the direction where answers have the temperature."},
            .recognise = recognise_rmd};
}

} // namespace dfdyn::tools::families
