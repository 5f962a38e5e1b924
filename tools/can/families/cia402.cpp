// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/cia402.hpp"

#include "tools/can/families/family_fields.hpp"
#include "tools/can/motors/codec_fit.hpp"

#include <numbers>

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands (RPDO 1, 0x200 + node: target torque 0x6071) if its efforts are mapped, in the
/// unit of the efforts.
class Cia402Drive final : public BoardOf<Cia402Drive, hal::Cia402Drive> {
  public:
    using BoardOf::BoardOf;
    bool measures_effort() const override { return codec().has_effort(); }
    std::optional<hal::Frame> heartbeat() const override {
        return codec().encode_heartbeat(hal::Cia402Drive::State::operational);
    }
    std::optional<hal::Frame> torque_command(int /*joint*/, double torque_Nm) const override {
        return codec().has_effort() ? std::optional(codec().encode_target_torque(torque_Nm)) : std::nullopt;
    }
    bool commands_efforts() const override { return codec().has_effort(); }
    std::optional<double> commanded_torque(int /*joint*/, const hal::Frame& frame) const override {
        return codec().has_effort() ? codec().decode_target_torque(frame) : std::nullopt;
    }
};

const std::vector<FamilyField> drive_fields{
    {"node", "(1 to 127)"},
    {"joint", ""},
    {"counts_per_turn", "(of the joint, negative for the other direction)"},
    {"zero_rad", "(0)"},
    {"effort_per_count", "(N·m or A; where `effort` is mapped)"},
};

/// Reads the position of an object in a drive's PDO: `{"pdo": "0x280", "length": 8, "start_bit": 0, "bits":
/// 32}`.
void read_drive_mapping(const JsonReader& mapping, std::uint32_t& pdo, int& length, hal::Signal& signal) {
    mapping.allow_only(std::array<std::string_view, 4>{"pdo", "length", "start_bit", "bits"});
    pdo = identifier_or(mapping, "pdo", pdo);
    length = mapping.whole_or("length", length, 1, 8);
    signal.start_bit = mapping.whole_or("start_bit", signal.start_bit, 0, 63);
    signal.length = mapping.whole_or("bits", signal.length, 1, 64);
}

/// Reads the properties that all drives of a bus have in common.
hal::Cia402Drive::Config read_drive_mappings(const JsonReader& joints, bool synchronous) {
    hal::Cia402Drive::Config config;
    config.synchronous = synchronous;
    config.heartbeat_timeout_ns = nanoseconds_or(joints, "heartbeat_timeout_s", 0);
    if (joints.has("position")) {
        read_drive_mapping(joints.object("position"), config.position_pdo, config.position_length,
                           config.position);
    }
    if (joints.has("effort")) {
        config.effort_pdo = 0x380;
        config.effort_length = 2;
        read_drive_mapping(joints.object("effort"), config.effort_pdo, config.effort_length, config.effort);
    }
    return config;
}

BusBoard read_drive(const JsonReader& board, hal::Cia402Drive::Config config) {
    const bool effort = config.effort_pdo != 0;
    std::vector<std::string_view> names = names_of(drive_fields);
    if (!effort) {
        names.pop_back();
    }
    board.allow_only(names);
    config.node = board.whole_number("node", 1, 127);
    config.joint = read_joint(board);
    config.position.factor = 2 * std::numbers::pi / read_ratio(board, "counts_per_turn");
    config.position.offset = read_zero_rad(board);
    if (effort) {
        config.effort.factor = read_ratio(board, "effort_per_count");
    }
    const hal::Cia402Drive drive(config);
    if (!drive.config_is_valid()) {
        throw board.error("node", "PDOs with identifiers that CANopen leaves to them, and signals that fit",
                          "others");
    }
    return one_joint<Cia402Drive>(drive, config.joint);
}

void read_drives(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                 BusDescription& description) {
    description.synchronous =
        joints.has("synchronous") ? joints.flag("synchronous") : description.trigger == BusTrigger::sync;
    const auto config = read_drive_mappings(joints, description.synchronous);
    read_each_board(
        joints, [&](const JsonReader& board) { return read_drive(board, config); }, description);
}

/// Identifiers without the node: of the TPDOs, of the heartbeat, and of all its frames.
constexpr std::array<std::uint32_t, 4> tpdo_identifiers{0x180, 0x280, 0x380, 0x480};
constexpr std::uint32_t heartbeat_identifier = 0x700;
constexpr std::uint32_t sync_identifier = 0x080;
constexpr std::array<std::uint32_t, 12> node_identifiers{0x080, 0x180, 0x200, 0x280, 0x300, 0x380,
                                                         0x400, 0x480, 0x500, 0x580, 0x600, 0x700};

/// Returns false for a frame on an identifier of SYNC or heartbeats that is of another protocol.
bool may_be_canopen(const hal::Frame& frame) {
    if (frame.extended || frame.error || frame.fd || frame.remote) {
        return false;
    }
    if (frame.id > heartbeat_identifier && frame.id <= heartbeat_identifier + 127) {
        const unsigned state = frame.data[0] & 0x7FU;
        return frame.length == 1 && (state == 0 || state == 4 || state == 5 || state == 127);
    }
    return frame.id != sync_identifier || frame.length <= 1;
}

/// Requires a SYNC or a heartbeat, because other devices use the identifiers of TPDOs. A heartbeat, or one
/// TPDO for each SYNC, makes sure that it is a drive, even if its TPDO could be a feedback of a motor. The
/// contents of the TPDOs are configured in each drive.
Recognition recognise_drives(FrameSpan frames) {
    constexpr double weight_of_sure = 2.5;
    std::map<std::uint32_t, std::vector<std::int64_t>> stamps;
    for (const hal::Frame& frame : frames) {
        if (may_be_canopen(frame)) {
            stamps[frame.id].push_back(frame.stamp_ns);
        }
    }
    const std::size_t syncs = stamps[sync_identifier].size();
    const bool synchronous = syncs >= frames_to_recognise;
    Recognition recognition;
    for (std::uint32_t node = 1; node <= 127; ++node) {
        RecognisedBoard board{.name = "node " + std::to_string(node), .entry = {{"node", node}}};
        const bool heartbeat = !stamps[heartbeat_identifier + node].empty();
        for (const std::uint32_t tpdo : tpdo_identifiers) {
            const std::vector<std::int64_t>& times = stamps[tpdo + node];
            if (times.size() < frames_to_recognise || (!synchronous && !heartbeat)) {
                continue;
            }
            board.rate_hz = std::max(board.rate_hz, usual_rate_hz(times));
            board.measured += (board.measured.empty() ? "sends " : ", ") + identifier_text(tpdo + node);
            recognition.identifiers.insert({false, tpdo + node});
            const bool answers_sync = 10 * times.size() >= 9 * syncs && 10 * times.size() <= 11 * syncs;
            recognition.score +=
                (heartbeat || answers_sync ? weight_of_sure : 1) * static_cast<double>(times.size());
        }
        if (board.rate_hz > 0) {
            for (const std::uint32_t identifier : node_identifiers) {
                recognition.reserved.insert({false, identifier + node});
            }
            recognition.boards.push_back(std::move(board));
        }
    }
    if (!recognition.boards.empty()) {
        recognition.unsure.emplace_back(
            "what the TPDOs contain, and its units: read the objects 0x1A00 to 0x1A03");
    }
    return recognition;
}

} // namespace

JointFamily cia402() {
    return {
        .name = "cia402",
        .board_fields = drive_fields,
        .fields = {{"position", ""},
                   {"effort", "(where the PDOs have them, each `pdo`, `length`, `start_bit`, `bits`; without "
                              "`effort` none is mapped)"},
                   {"synchronous", "(true with trigger `sync`: values belong to the SYNC before)"},
                   {"heartbeat_timeout_s", "(0: none is expected, as most EDS files have it; the values "
                                           "themselves then end a boot-up)"}},
        .dbc = "cia402.dbc",
        .example =
            R"({"family": "cia402", "position": {"pdo": "0x280", "length": 6, "start_bit": 0, "bits": 32},
                "effort": {"pdo": "0x280", "length": 6, "start_bit": 32, "bits": 16}, "boards": [
                {"node": 1, "joint": 1, "counts_per_turn": 1048576, "effort_per_count": 0.01},
                {"node": 2, "joint": 2, "counts_per_turn": -1048576, "effort_per_count": 0.01}]})",
        .read = read_drives,
        .devices = "Drives with CANopen and the profile CiA 402",
        .recognise = recognise_drives,
        .no_draft = "what its frames contain is configured in each drive",
        .sync = hal::Cia402Drive::encode_sync};
}

} // namespace dfdyn::tools::families
