// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/bus_fields.hpp"

#include "tools/can/description/dbc_fields.hpp"

#include <charconv>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string_view>;

/// The fields of `joints`, or `output`, of any family, and those of one.
void allow_only(const JsonReader& reader, Names names, const Names& own) {
    names.insert(names.end(), own.begin(), own.end());
    reader.allow_only(names);
}

const Names joint_fields{"family",   "boards",    "rate_hz",        "max_age_s",          "latency_s",
                         "jitter_s", "limit_rad", "velocity_limit", "acceleration_limit", "robot"};
const Names sensor_fields{"family",   "rate_hz", "max_age_s",     "latency_s",
                          "jitter_s", "limit",   "pair_window_s", "frozen_after"};

/// From 0, of a board with one.
int joint_of(const JsonReader& board) { return board.whole_number("joint", 1, largest_bus_joint_count) - 1; }

/// Counts, ticks or turns per something: negative for the other direction, never 0.
double ratio(double value, const JsonReader& reader, const std::string& name) {
    if (!(std::abs(value) > 1e-9)) {
        throw reader.error(name, "a number that is not 0", std::to_string(value));
    }
    return value;
}
double ratio(const JsonReader& reader, const std::string& name) {
    return ratio(reader.number(name), reader, name);
}
double ratio_or(const JsonReader& reader, const std::string& name, double absent) {
    return reader.has(name) ? ratio(reader, name) : absent;
}

double zero_rad(const JsonReader& board) { return board.number_or("zero_rad", 0, -1000, 1000); }

BusBoard one_joint(AnyBoard::Device device, int joint) {
    return {AnyBoard(device), {joint, hal::unused_joint}};
}

BusBoard read_two_joint_board(const JsonReader& board) {
    board.allow_only(Names{"address", "joints", "ticks_per_degree", "zero_deg"});
    const std::vector<int> joints = board.whole_numbers("joints", 0, largest_bus_joint_count);
    if (joints.size() != 2) {
        throw board.error("joints", "2 numbers, 0 for a joint that the arm does not have",
                          std::to_string(joints.size()));
    }
    const std::vector<double> scales = board.numbers("ticks_per_degree", 2);
    const std::vector<double> zeros =
        board.has("zero_deg") ? board.numbers("zero_deg", 2) : std::vector<double>(2);
    const auto scale = [&](std::size_t i) {
        return hal::icub::EncoderScale{joints[i] - 1, ratio(scales[i], board, "ticks_per_degree"), zeros[i]};
    };
    static_assert(hal::unused_joint == -1);
    return {AnyBoard(hal::icub::TwoJointBoard(board.whole_number("address", 1, 14), scale(0), scale(1))),
            {joints[0] - 1, joints[1] - 1}};
}

BusBoard read_foc_board(const JsonReader& board) {
    board.allow_only(Names{"address", "joint", "motor_per_joint", "zero_rad"});
    hal::icub::FocBoard::Config config;
    config.address = board.whole_number("address", 1, 14);
    config.joint = joint_of(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = zero_rad(board);
    return one_joint(hal::icub::FocBoard(config), config.joint);
}

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

/// `config`: what is the same for all axes of a bus.
BusBoard read_odrive(const JsonReader& board, hal::OdriveAxis::Config config) {
    board.allow_only(Names{"node", "joint", "motor_per_joint", "zero_rad"});
    config.node = board.whole_number("node", 0, 63);
    config.joint = joint_of(board);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = zero_rad(board);
    return one_joint(hal::OdriveAxis(config), config.joint);
}

/// Where a drive's PDO has an object: `{"pdo": "0x280", "length": 8, "start_bit": 0, "bits": 32}`.
void read_mapping(const JsonReader& mapping, std::uint32_t& pdo, int& length, hal::Signal& signal) {
    mapping.allow_only(Names{"pdo", "length", "start_bit", "bits"});
    pdo = identifier_or(mapping, "pdo", pdo);
    length = mapping.whole_or("length", length, 1, 8);
    signal.start_bit = mapping.whole_or("start_bit", signal.start_bit, 0, 63);
    signal.length = mapping.whole_or("bits", signal.length, 1, 64);
}

/// What is the same for all drives of a bus.
hal::Cia402Drive::Config read_drive_mappings(const JsonReader& joints, bool synchronous) {
    hal::Cia402Drive::Config config;
    config.synchronous = synchronous;
    config.heartbeat_timeout_ns = nanoseconds_or(joints, "heartbeat_timeout_s", 0);
    if (joints.has("position")) {
        read_mapping(joints.object("position"), config.position_pdo, config.position_length, config.position);
    }
    if (joints.has("effort")) {
        config.effort_pdo = 0x380;
        config.effort_length = 2;
        read_mapping(joints.object("effort"), config.effort_pdo, config.effort_length, config.effort);
    }
    return config;
}

BusBoard read_drive(const JsonReader& board, hal::Cia402Drive::Config config) {
    const bool effort = config.effort_pdo != 0;
    effort ? board.allow_only(Names{"node", "joint", "counts_per_turn", "zero_rad", "effort_per_count"})
           : board.allow_only(Names{"node", "joint", "counts_per_turn", "zero_rad"});
    config.node = board.whole_number("node", 1, 127);
    config.joint = joint_of(board);
    config.position.factor = 2 * std::numbers::pi / ratio(board, "counts_per_turn");
    config.position.offset = zero_rad(board);
    if (effort) {
        config.effort.factor = ratio(board, "effort_per_count");
    }
    const hal::Cia402Drive drive(config);
    if (!drive.config_is_valid()) {
        throw board.error("node", "PDOs with identifiers that CANopen leaves to them, and signals that fit",
                          "others");
    }
    return one_joint(drive, config.joint);
}

std::array<double, 6> six(const std::vector<double>& values) {
    std::array<double, 6> result{};
    std::copy_n(values.begin(), result.size(), result.begin());
    return result;
}

/// ± per axis; the two are for an axis of force and of torque.
std::array<double, 6> limit_or(const JsonReader& reader, double force, double torque) {
    return reader.has("limit") ? six(reader.positive_numbers("limit", 6))
                               : std::array<double, 6>{force, force, force, torque, torque, torque};
}

DescribedWrenchSensor read_strain(const JsonReader& output) {
    allow_only(output, sensor_fields, {"address", "full_scale", "calibration_set"});
    hal::icub::StrainBoard board(output.whole_number("address", 1, 14));
    board.use_calibration_set(output.whole_or("calibration_set", 0, 0, 15));
    std::array<double, 6> limit = limit_or(output, 10'000, 1'000); // of any board of this kind
    if (output.has("full_scale")) {
        const std::vector<int> full_scales = output.whole_numbers("full_scale", 1, 0xFFFF);
        if (full_scales.size() != 6) {
            throw output.error("full_scale", "6 numbers", std::to_string(full_scales.size()));
        }
        for (int channel = 0; channel < 6; ++channel) {
            const double full_scale = full_scales[static_cast<std::size_t>(channel)];
            board.describe_full_scale(channel, full_scale);
            limit[static_cast<std::size_t>(channel)] = full_scale;
        }
        if (board.full_scale().reason() != hal::Reason::ok) {
            throw output.error("full_scale", "full scales that a sensor of an arm can have, N and N·m",
                               "others");
        }
        limit = output.has("limit") ? six(output.positive_numbers("limit", 6)) : limit;
    }
    return {AnySensor(board), limit};
}

DescribedWrenchSensor read_robotous(const JsonReader& output) {
    allow_only(output, sensor_fields,
               {"first_id", "second_id", "counts_per_newton", "counts_per_newton_metre"});
    hal::RobotousRft::Config config;
    config.first_id = identifier_or(output, "first_id", config.first_id);
    config.second_id = identifier_or(output, "second_id", config.second_id);
    if (config.first_id == config.second_id) {
        throw output.error("second_id", "another identifier than the first",
                           identifier_text(config.second_id));
    }
    config.counts_per_newton = output.number_or("counts_per_newton", config.counts_per_newton, 1e-3, 1e6);
    config.counts_per_newton_metre =
        output.number_or("counts_per_newton_metre", config.counts_per_newton_metre, 1e-3, 1e6);
    return {AnySensor(hal::RobotousRft(config)),
            limit_or(output, 32768 / config.counts_per_newton, 32768 / config.counts_per_newton_metre)};
}

DescribedWrenchSensor read_ati(const JsonReader& output) {
    allow_only(output, sensor_fields, {"base", "matrix", "counts_per_newton", "counts_per_newton_metre"});
    hal::AtiNetcan::Config config;
    config.base = static_cast<std::uint32_t>(output.whole_or("base", 0x20, 0, 0x7E));
    const std::vector<double> matrix = output.numbers("matrix", 36);
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        config.matrix[i / 6][i % 6] = matrix[i];
    }
    config.counts_per_newton = output.positive_number("counts_per_newton");
    config.counts_per_newton_metre = output.positive_number("counts_per_newton_metre");
    const hal::AtiNetcan sensor(config);
    if (sensor.calibration() != hal::Reason::ok) {
        throw output.error("matrix", "an invertible matrix", "one that is not");
    }
    return {AnySensor(sensor), six(output.positive_numbers("limit", 6))};
}

template <class Read>
void for_each_board(const JsonReader& joints, Read read, std::vector<BusBoard>& boards) {
    for (const JsonReader& board : joints.objects("boards", 1, largest_bus_joint_count)) {
        boards.push_back(read(board));
    }
}

} // namespace

std::int64_t nanoseconds_or(const JsonReader& reader, const std::string& name, double absent_s) {
    return std::llround(1e9 * reader.number_or(name, absent_s, 0, 60));
}

std::uint32_t identifier_or(const JsonReader& reader, const std::string& name, std::uint32_t absent) {
    if (!reader.has(name)) {
        return absent;
    }
    const std::string text = reader.text(name);
    std::uint32_t id = 0;
    const char* const begin = text.data() + (text.starts_with("0x") ? 2 : 0);
    const char* const end = text.data() + text.size();
    const auto [rest, fault] = std::from_chars(begin, end, id, 16);
    if (fault != std::errc() || rest != end || !text.starts_with("0x") || id > 0x7FF) {
        throw reader.error(name, R"(an identifier from "0x0" to "0x7FF")", in_quotes(text));
    }
    return id;
}

std::string identifier_text(std::uint32_t id) {
    std::array<char, 8> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), id, 16).ptr;
    return "0x" + std::string(digits.data(), end);
}

void read_boards(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description) {
    const std::string family = joints.text("family");
    if (family == "icub_two_joint_board") {
        allow_only(joints, joint_fields, {});
        for_each_board(joints, read_two_joint_board, description.boards);
    } else if (family == "icub_2foc") {
        allow_only(joints, joint_fields, {});
        for_each_board(joints, read_foc_board, description.boards);
    } else if (family == "cia402") {
        allow_only(joints, joint_fields, {"position", "effort", "synchronous", "heartbeat_timeout_s"});
        description.synchronous =
            joints.has("synchronous") ? joints.flag("synchronous") : description.synchronous;
        const auto config = read_drive_mappings(joints, description.synchronous);
        for_each_board(
            joints, [&](const JsonReader& board) { return read_drive(board, config); }, description.boards);
    } else if (family == "odrive") {
        allow_only(joints, joint_fields, {"heartbeat_timeout_s", "firmware"});
        hal::OdriveAxis::Config config;
        config.heartbeat_timeout_ns = nanoseconds_or(joints, "heartbeat_timeout_s", 0.25);
        config.firmware = read_firmware(joints);
        for_each_board(
            joints, [&](const JsonReader& board) { return read_odrive(board, config); }, description.boards);
    } else if (family == "dbc") {
        allow_only(joints, joint_fields, {"file"});
        const Dbc dbc = read_dbc(folder / joints.text("file"));
        for_each_board(
            joints, [&](const JsonReader& board) { return read_dbc_joint(board, dbc, description.boards); },
            description.boards);
    } else {
        throw joints.error("family", "icub_two_joint_board, icub_2foc, cia402, odrive or dbc",
                           in_quotes(family));
    }
}

bool measures_efforts(const std::vector<BusBoard>& boards) {
    const auto measures = [](const BusBoard& board) {
        const AnyBoard::Device& device = board.board.device();
        const auto* drive = std::get_if<hal::Cia402Drive>(&device);
        const auto* mapped = std::get_if<DbcJoint>(&device);
        return std::holds_alternative<hal::icub::FocBoard>(device) ||
               (drive != nullptr && drive->has_effort()) ||
               (mapped != nullptr && mapped->config().effort.has_value());
    };
    return std::ranges::all_of(boards, measures);
}

DescribedWrenchSensor read_wrench_sensor(const JsonReader& output, const std::filesystem::path& folder) {
    const std::string family = output.text("family");
    if (family == "icub_strain") {
        return read_strain(output);
    }
    if (family == "robotous_rft") {
        return read_robotous(output);
    }
    if (family == "ati_netcan") {
        return read_ati(output);
    }
    if (family == "dbc") {
        allow_only(output, sensor_fields, {"file", "wrench"});
        const DbcSensor sensor = read_dbc_sensor(output, read_dbc(folder / output.text("file")));
        return {AnySensor(sensor), six(output.positive_numbers("limit", 6))};
    }
    throw output.error("family", "efforts, icub_strain, robotous_rft, ati_netcan or dbc", in_quotes(family));
}

} // namespace dfdyn::tools
