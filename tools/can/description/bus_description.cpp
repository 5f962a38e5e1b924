// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/bus_description.hpp"

#include "tools/base/system/read_file.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/arm/bus_arm.hpp"
#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/description/bus_fields.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr const char* schema = "dfdyn.bus/1";

BusTrigger read_trigger(const JsonReader& reader) {
    const std::string kind = reader.text("on");
    if (kind == "sync") {
        return BusTrigger::sync;
    }
    if (kind == "timer") {
        return BusTrigger::timer;
    }
    if (kind == "set") {
        return BusTrigger::set;
    }
    throw reader.error("on", "sync, timer or set", in_quotes(kind));
}

constexpr double usual_jitter = 0.25; ///< share of the period

/// Reads the timing of a source. By default its values expire after three periods.
BusSource read_source(const JsonReader& reader, double default_rate_hz) {
    BusSource source;
    source.rate_hz = reader.number_or("rate_hz", default_rate_hz, 0.1, 100'000);
    source.max_age_ns = nanoseconds_or(reader, "max_age_s", 3 / source.rate_hz);
    source.latency_ns = nanoseconds_or(reader, "latency_s", 0);
    source.jitter_ns = nanoseconds_or(reader, "jitter_s", usual_jitter / source.rate_hz);
    return source;
}

/// Returns the number of joints of all boards. Each of 0 … joint_count - 1 must exist exactly once.
int count_joints(const JsonReader& reader, const std::vector<BusBoard>& boards) {
    std::vector<int> joints;
    for (const BusBoard& board : boards) {
        std::ranges::copy_if(board.joint, std::back_inserter(joints),
                             [](int joint) { return joint != hal::unused_joint; });
    }
    std::ranges::sort(joints);
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i] != static_cast<int>(i)) {
            throw reader.error(
                "boards", "joints 1 to N, each once",
                "joint " + std::to_string(i + 1) +
                    (joints[i] < static_cast<int>(i) ? " after another one of that number" : " missing"));
        }
    }
    return static_cast<int>(joints.size());
}

/// Velocity limits (rad/s) from a robot file next to the description; none for joints without a limit.
std::vector<std::optional<double>> robot_velocities(const JsonReader& joints,
                                                    const std::filesystem::path& folder, int joint_count) {
    std::vector<std::optional<double>> velocities(static_cast<std::size_t>(joint_count));
    if (!joints.has("robot")) {
        return velocities;
    }
    const JsonReader reader = joints.object("robot");
    reader.allow_only(std::array<std::string_view, 3>{"urdf", "tip", "base"});
    const Robot robot =
        read_robot(folder / reader.text("urdf"), {.tip = reader.text("tip"),
                                                  .base = reader.has("base") ? reader.text("base") : "",
                                                  .ft_joint = {},
                                                  .parent_to_child = {}});
    if (robot.joints.size() != velocities.size()) {
        throw joints.error("robot", "the arm's " + std::to_string(joint_count) + " joints",
                           std::to_string(robot.joints.size()) + " between base and tip");
    }
    std::ranges::transform(robot.joints, velocities.begin(), &RobotJoint::velocity);
    return velocities;
}

/// Reads the field `name`: one number for all joints or one per joint; none if the field is absent.
std::vector<std::optional<double>> per_joint(const JsonReader& reader, const std::string& name,
                                             int joint_count) {
    std::vector<std::optional<double>> values(static_cast<std::size_t>(joint_count));
    if (reader.has(name) && reader.is_array(name)) {
        std::ranges::copy(reader.positive_numbers(name, joint_count), values.begin());
    } else if (reader.has(name)) {
        std::ranges::fill(values, reader.positive_number(name));
    }
    return values;
}

hal::Encoder parse_encoder(const JsonReader& reader, const std::string& name) {
    if (name == "absolute") {
        return hal::Encoder::absolute;
    }
    if (name == "incremental") {
        return hal::Encoder::incremental;
    }
    if (name != "unknown") {
        throw reader.error("encoder", R"("absolute", "incremental" or "unknown")", in_quotes(name));
    }
    return hal::Encoder::unknown;
}

/// Reads what the joints' encoders show after a restart: one text for all joints or one per joint.
void read_encoders(const JsonReader& reader, std::vector<hal::MotionLimits>& limits) {
    if (!reader.has("encoder")) {
        return;
    }
    const int joints = static_cast<int>(limits.size());
    const std::vector<std::string> names = reader.is_array("encoder")
                                               ? reader.texts("encoder", joints)
                                               : std::vector(limits.size(), reader.text("encoder"));
    if (names.size() != limits.size()) {
        throw reader.error("encoder", std::to_string(joints) + " texts", std::to_string(names.size()));
    }
    for (std::size_t i = 0; i < limits.size(); ++i) {
        limits[i].encoder = parse_encoder(reader, names[i]);
    }
}

/// Motion limits from the description, otherwise from the robot file, otherwise beyond any joint's motion.
std::vector<hal::MotionLimits> read_limits(const JsonReader& reader, const std::filesystem::path& folder,
                                           int joint_count) {
    const auto velocity = per_joint(reader, "velocity_limit", joint_count);
    const auto acceleration = per_joint(reader, "acceleration_limit", joint_count);
    const auto robot_velocity = robot_velocities(reader, folder, joint_count);
    std::vector<hal::MotionLimits> limits(velocity.size());
    for (std::size_t i = 0; i < limits.size(); ++i) {
        limits[i].velocity = velocity[i].value_or(robot_velocity[i].value_or(limits[i].velocity));
        limits[i].acceleration = acceleration[i].value_or(limits[i].acceleration);
    }
    return limits;
}

void read_joints(const JsonReader& reader, const std::filesystem::path& folder, BusDescription& description) {
    description.joints = read_source(reader, description.sample_rate_hz);
    description.position_limit_rad = reader.number_or("limit_rad", 7, 1e-3, 1e6);
    read_boards(reader, folder, description);
    description.joint_count = count_joints(reader, description.boards);
    description.joint_limits = read_limits(reader, folder, description.joint_count);
    read_encoders(reader, description.joint_limits);
}

/// Reads the efforts that the joints' own boards measure as outputs.
void read_efforts(const JsonReader& reader, bool measured, BusDescription& description) {
    reader.allow_only(std::array<std::string_view, 7>{"family", "quantity", "limit", "max_age_s", "latency_s",
                                                      "jitter_s", "frozen_after"});
    if (!measured) {
        throw reader.error("family", "a sensor, because the joints' boards send no efforts", "\"efforts\"");
    }
    const std::string quantity = reader.text("quantity");
    description.outputs = parse_output_kind(quantity);
    if (description.outputs == OutputKind::wrench) {
        throw reader.error("quantity", "tau or i", in_quotes(quantity));
    }
    const double limit =
        reader.number_or("limit", std::numeric_limits<float>::max(), 0, std::numeric_limits<float>::max());
    description.output_range.assign(static_cast<std::size_t>(description.joint_count), {-limit, limit});
    description.frozen_after = reader.whole_or("frozen_after", 100, 2, 1'000'000);
}

double seconds_on_wire(std::span<const hal::Frame> frames, const BusDescription& description) {
    double bits = 0;
    for (const hal::Frame& frame : frames) {
        bits += frame_bits(frame, description.data_rate_ratio());
    }
    return bits / description.bit_rate;
}

/// Time (s) that the frames of all joints take on the bus.
double joints_on_wire_s(const BusDescription& description) {
    BusDescription joints = description;
    joints.sensor.reset(); // the sensor may be unable to send
    const std::vector<double> zeros(static_cast<std::size_t>(description.joint_count));
    return seconds_on_wire(DeviceFrames(joints).joints(zeros, {}), description);
}

/// Time (s) that the frames of a wrench take on the bus; 0 without a sensor.
double wrench_on_wire_s(const BusDescription& description) {
    if (!description.sensor) {
        return 0;
    }
    const hal::FrameList wrench = description.sensor->encode(hal::Wrench{});
    return seconds_on_wire(std::span(wrench.frame).first(static_cast<std::size_t>(wrench.count)),
                           description);
}

/// Worst-case time (s) of a wrench on the bus, including the frames of the joints that are sent meanwhile.
double waiting_s(const BusDescription& description) {
    const double joints_s = joints_on_wire_s(description);
    const double wrench_s = wrench_on_wire_s(description);
    const double period_s = 1 / description.output.rate_hz;
    double wait_s = wrench_s;
    for (double before_s = 0; wait_s > before_s && wait_s < period_s;) {
        before_s = wait_s;
        wait_s = wrench_s + joints_s * std::ceil(before_s * description.joints.rate_hz);
    }
    return wait_s;
}

/// Reads the pairing window. Default: half a period, to allow for other traffic; longer if the arm's own
/// frames take longer.
void read_pairing(const JsonReader& reader, BusDescription& description) {
    const double period_s = 1 / description.output.rate_hz;
    const double absent_s = std::clamp(waiting_s(description), 0.5 * period_s, 0.9 * period_s);
    description.pairing = {.period_ns = std::llround(1e9 * period_s),
                           .delay_ns = nanoseconds_or(reader, "pair_window_s", absent_s)};
    if (description.pairing.delay_ns >= description.pairing.period_ns) {
        throw reader.error("pair_window_s", "less than a period of the sensor, " + number_text(period_s),
                           number_text(reader.number("pair_window_s")));
    }
}

void read_sensor(const JsonReader& reader, const std::filesystem::path& folder, BusDescription& description) {
    description.outputs = OutputKind::wrench;
    const DescribedWrenchSensor sensor = read_wrench_sensor(reader, folder);
    description.sensor = sensor.device;
    for (const double limit : sensor.limit) {
        description.output_range.push_back({-limit, limit});
    }
    read_pairing(reader, description);
    description.frozen_after = reader.whole_or("frozen_after", 100, 2, 1'000'000);
}

void read_output(const JsonReader& reader, const std::filesystem::path& folder, BusDescription& description) {
    const bool efforts = reader.text("family") == "efforts";
    const bool measured = measures_efforts(description.boards);
    description.output =
        read_source(reader, efforts ? description.joints.rate_hz : description.sample_rate_hz);
    efforts ? read_efforts(reader, measured, description) : read_sensor(reader, folder, description);
}

/// Increases the default jitter by the time that all other frames of the arm take on the bus. Values that are
/// stamped by a SYNC do not need this.
void allow_waiting(const JsonReader& reader, const BusDescription& description, BusSource& source) {
    if (!reader.has("jitter_s") && !description.synchronous) {
        const double all_s = joints_on_wire_s(description) + wrench_on_wire_s(description);
        const double most_s = 0.9 / source.rate_hz;
        source.jitter_ns =
            std::max<std::int64_t>(source.jitter_ns, std::llround(1e9 * std::min(all_s, most_s)));
    }
}

/// Default delay: long enough that every source has sent a value after the sample time.
double default_delay_s(const BusDescription& description) {
    const auto latency_ns = std::max(description.joints.latency_ns, description.output.latency_ns);
    const double slowest_hz = std::min(description.joints.rate_hz, description.output.rate_hz);
    return 1e-9 * static_cast<double>(latency_ns) + 1.5 / slowest_hz;
}

void check_identifiers(const JsonReader& reader, const BusDescription& description) {
    if (const auto id = BusArm(description).colliding_id()) {
        throw reader.error("boards", "devices that do not share identifiers",
                           "two that send " + identifier_text(*id));
    }
}

BusDescription parse(const JsonReader& reader, const std::filesystem::path& path) {
    const std::filesystem::path folder = path.parent_path();
    if (reader.text("schema") != schema) {
        throw reader.error("schema", in_quotes(schema), in_quotes(reader.text("schema")));
    }
    reader.allow_only(std::array<std::string_view, 7>{"schema", "bit_rate", "data_bit_rate", "sample_rate_hz",
                                                      "trigger", "joints", "output"});
    BusDescription description;
    description.source = shown(path);
    description.bit_rate = reader.number_within("bit_rate", 1e4, 1e7);
    description.data_bit_rate =
        reader.number_or("data_bit_rate", description.bit_rate, description.bit_rate, 1e8);
    description.sample_rate_hz = reader.number_within("sample_rate_hz", 0.1, 100'000);
    const JsonReader trigger = reader.object("trigger");
    trigger.allow_only(std::array<std::string_view, 2>{"on", "delay_s"});
    description.trigger = read_trigger(trigger);
    const JsonReader joints = reader.object("joints");
    read_joints(joints, folder, description);
    if (description.trigger == BusTrigger::sync && !description.synchronous) {
        throw trigger.error("on", "timer or set, because no joint measures at a SYNC", "\"sync\"");
    }
    const JsonReader output = reader.object("output");
    read_output(output, folder, description);
    allow_waiting(joints, description, description.joints);
    allow_waiting(output, description, description.output);
    description.delay_ns = nanoseconds_or(trigger, "delay_s", default_delay_s(description));
    check_identifiers(joints, description);
    return description;
}

} // namespace

BusDescription read_bus_description(const std::filesystem::path& path) {
    const nlohmann::json json =
        parse_json(read_file(path, "cannot be read as a bus description"), shown(path));
    return parse(JsonReader(json, shown(path)), path);
}

BusDescription parse_bus_description(const nlohmann::json& json, const std::string& source) {
    return parse(JsonReader(json, source), source);
}

} // namespace dfdyn::tools
