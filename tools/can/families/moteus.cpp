// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/moteus.hpp"

#include "tools/can/motors/codec_fit.hpp"
#include "tools/can/motors/motor_board.hpp"
#include "tools/can/motors/motor_fields.hpp"

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands: mode position with zero stiffness and damping.
class MoteusController final : public MotorBoard<MoteusController, hal::MoteusController> {
  public:
    using MotorBoard::MotorBoard;
    static bool takes_torque() { return true; }
    static ScaleAdvice advice() {
        return {"turn the joint by a known angle", "Correct rotor_to_output_ratio in the controller."};
    }

    hal::Decoded decode(const hal::Frame& frame) noexcept override {
        if (hal::MoteusController::is_reply_to_other(codec().config(), frame)) {
            host().answered_other_host();
        }
        return MotorBoard::decode(frame);
    }
};

const std::vector<FamilyField> moteus_fields{
    {"id", "(1 to 127)"},
    {"joint", ""},
    transmission_field(),
    zero_field(),
};

const std::vector<FamilyField> moteus_bus_fields{
    {"host", "(0; 0 to 127: destination of the replies)"},
    {"prefix", "(0; `can.prefix`: bits 28 to 16 of the identifiers)"},
};

/// `config`: common properties of all controllers.
BusBoard read_moteus_controller(const JsonReader& board, hal::MoteusController::Config config,
                                std::vector<int>& ids) {
    board.allow_only(names_of(moteus_fields));
    config.id = board.whole_number("id", 1, 127);
    take_own_id(board, "id", config.id, ids);
    config.joint = read_joint(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<MoteusController>(hal::MoteusController(config), config.joint);
}

void read_moteus_controllers(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                             BusDescription& description) {
    hal::MoteusController::Config config;
    config.host = joints.whole_or("host", 0, 0, 127);
    config.prefix = joints.whole_or("prefix", 0, 0, 0x1FFF);
    std::vector<int> ids;
    read_each_board(
        joints, [&](const JsonReader& board) { return read_moteus_controller(board, config, ids); },
        description);
}

/// Number of replies by prefix and host, and then by controller.
using MoteusReplies = std::map<std::pair<unsigned, unsigned>, std::map<unsigned, std::uint64_t>>;

MoteusReplies moteus_replies(FrameSpan frames) {
    MoteusReplies replies;
    for (const hal::Frame& frame : frames) {
        if (frame.fd && !frame.error && (frame.id & 0x8080U) == 0 && (frame.id & 0xFF00U) != 0) {
            ++replies[{frame.id >> 16U, frame.id & 0x7FU}][frame.id >> 8U & 0x7FU];
        }
    }
    return replies;
}

/// Adds a controller that answers to `host`, with the identifiers of its replies.
void add_moteus_controller(unsigned id, std::uint32_t prefix, std::uint32_t host, const JointFit& fit,
                           Recognition& recognition) {
    RecognisedBoard board{
        .name = "controller " + std::to_string(id), .entry = {{"id", id}}, .rate_hz = fit.rate_hz()};
    if (fit.efforts == 0) {
        recognition.unsure.push_back(
            board.name + ": no program requests its torque (register 3), so that it has no efforts");
    }
    recognition.boards.push_back(std::move(board));
    const std::uint32_t reply = prefix << 16U | id << 8U | host;
    recognition.identifiers.insert({reply > 0x7FF, reply});
    recognition.identifiers.insert({true, reply});
}

/// Recognises the controllers that answer to one host. `replies`: their number by controller.
Recognition recognise_moteus_host(FrameSpan frames, std::uint32_t prefix, std::uint32_t host,
                                  const std::map<unsigned, std::uint64_t>& replies) {
    Recognition recognition;
    recognition.quantity = "tau";
    recognition.fields = {{"host", host}, {"prefix", prefix}};
    std::set<unsigned> answering;
    for (const auto& [id, count] : replies) {
        const CodecFit fit = fit_codec(hal::MoteusController({.id = static_cast<int>(id),
                                                              .host = static_cast<int>(host),
                                                              .prefix = static_cast<int>(prefix)}),
                                       frames);
        if (fit.fits()) {
            add_moteus_controller(id, prefix, host, fit.joint[0], recognition);
            answering.insert(id);
            recognition.score += 3 * static_cast<double>(count);
        }
    }
    if (!answering.empty()) {
        recognition.silent = silent_motors(frames, 1, 127, answering, [prefix](unsigned id) {
            return hal::MoteusController({.id = static_cast<int>(id), .prefix = static_cast<int>(prefix)});
        });
    }
    return recognition;
}

Recognition recognise_moteus(FrameSpan frames) {
    Recognition best;
    const MoteusReplies replies = moteus_replies(frames);
    for (const auto& [address, controllers] : replies) {
        Recognition recognition = recognise_moteus_host(frames, address.first, address.second, controllers);
        if (recognition.score > best.score) {
            best = std::move(recognition);
        }
    }
    if (replies.size() > 1 && !best.boards.empty()) {
        best.unsure.push_back(std::to_string(replies.size()) +
                              " hosts get replies; the draft has the one with the most");
    }
    return best;
}

} // namespace

JointFamily moteus() {
    return {.name = "moteus",
            .board_fields = moteus_fields,
            .fields = moteus_bus_fields,
            .example = R"({"family": "moteus", "boards": [{"id": 1, "joint": 1},
                                                          {"id": 12, "joint": 2, "motor_per_joint": -1}]})",
            .read = read_moteus_controllers,
            .devices = "mjbots moteus controllers, on CAN FD",
            .sources = {"mjbots/moteus `docs/protocol/can.md` (db1a762), `registers.md` (17fbf26)"},
            .pitfalls =
                {"A controller only answers, and answers what was asked: registers in any order and type.",
                 "The most negative integer, or a float that is no number, means that there is no value.",
                 "Positions as int8 have steps of 3.6 °.",
                 "Frames are padded with 0x50; error sub-frames may come between replies.",
                 "A fault code of 96 or more is a limit that is active, no fault."},
            .recognise = recognise_moteus,
            .not_operational = {"read its mode, register 0: 0 is stopped, 11 a timeout",
                                "Command a mode that operates, such as 10 (position). After a timeout, stop "
                                "the controller first."}};
}

} // namespace dfdyn::tools::families
