// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/damiao.hpp"

#include "tools/base/text/number.hpp"
#include "tools/can/families/family_fields.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools::families {

namespace {

/// Accepts torque commands: the motor's own command (identifier: the motor id) with zero stiffness and
/// damping.
class DamiaoMotor final : public BoardOf<DamiaoMotor, hal::DamiaoMotor> {
  public:
    using BoardOf::BoardOf;

    hal::Decoded decode(const hal::Frame& frame) noexcept override {
        const hal::Decoded decoded = BoardOf::decode(frame);
        if (decoded.kind == hal::Decoded::Kind::values) {
            compare(decoded.joint[0], codec().velocity(frame));
        }
        return decoded;
    }
    bool measures_effort() const override { return true; }
    double encoder_turn_rad() const override {
        return BoardOf::encoder_turn_rad() / std::abs(codec().config().motor_per_joint);
    }
    std::optional<hal::Frame> torque_command(double torque_Nm) const override {
        return codec().encode_torque(torque_Nm);
    }
    std::optional<double> commanded_torque(const hal::Frame& frame) const override {
        return codec().decode_torque(frame);
    }

    /// If the configured VMAX differs from the motor's, the velocities contradict the positions.
    std::vector<BusFinding> findings() const override {
        const double ratio = squares_ > 0 ? products_ / squares_ : 1;
        if (distance_rad_ < least_distance_rad || std::abs(ratio - 1) < largest_deviation) {
            return {};
        }
        const auto& config = codec().config();
        return {{"velocity_scale",
                 "joint " + std::to_string(config.joint + 1) +
                     " moves at another speed than its motor's velocity",
                 "its positions change " + rounded_text(ratio) + " times as fast, over " +
                     rounded_text(distance_rad_) + " rad",
                 "read the motor's register 22 (VMAX)",
                 "velocity_max, and check torque_max and position_max: registers 23 and 21"}};
    }

  private:
    static constexpr double least_speed = 0.1; ///< rad/s; below it the resolution is too coarse
    static constexpr double longest_step_s = 0.02;
    static constexpr double least_distance_rad = 1;
    static constexpr double largest_deviation = 0.1;

    /// Compares positions with the mean velocity between them by least squares.
    void compare(const hal::JointValue& value, double velocity) noexcept {
        const double step_s = 1e-9 * static_cast<double>(value.stamp_ns - last_.stamp_ns);
        const bool sound = value.position_reason == hal::Reason::ok;
        const bool fast = std::abs(velocity) > least_speed && std::abs(last_velocity_) > least_speed;
        if (sound && last_.position_reason == hal::Reason::ok && fast && step_s > 0 &&
            step_s < longest_step_s) {
            const double expected_rad = 0.5 * (velocity + last_velocity_) * step_s;
            const double moved_rad = value.position_rad - last_.position_rad;
            products_ += moved_rad * expected_rad;
            squares_ += expected_rad * expected_rad;
            distance_rad_ += std::abs(moved_rad);
        }
        last_ = value;
        last_velocity_ = velocity;
    }

    hal::JointValue last_;
    double last_velocity_ = 0;
    double products_ = 0, squares_ = 0, distance_rad_ = 0;
};

/// Factory settings of a motor type. 0: two widely used libraries (LeRobot and openarm_can) disagree, so only
/// the motor's own register is reliable.
struct MotorType {
    std::string_view name;
    double velocity; ///< rad/s
    double torque;   ///< N·m
};
constexpr double delivered_position_max = 12.5; ///< rad, all types
constexpr std::array<MotorType, 13> motor_types{{{"DM3507", 0, 0},
                                                 {"DM4310", 30, 10},
                                                 {"DM4310_48V", 50, 10},
                                                 {"DM4340", 0, 28},
                                                 {"DM4340_48V", 10, 28},
                                                 {"DM6006", 45, 20},
                                                 {"DM8006", 45, 40},
                                                 {"DM8009", 45, 54},
                                                 {"DM10010L", 25, 200},
                                                 {"DM10010", 20, 200},
                                                 {"DMH3510", 280, 1},
                                                 {"DMH6215", 45, 10},
                                                 {"DMG6220", 45, 10}}};

const std::vector<FamilyField> damiao_fields{
    {"motor_id", "(1 to 15; register ESC_ID)"},
    {"feedback_id", "(of its answers, its own; register MST_ID)"},
    {"joint", ""},
    {"motor",
     "(`\"DM4310\"`: the maxima of that type as delivered, where libraries agree on them; without: none)"},
    {"position_max", "(rad; register 21, PMAX)"},
    {"velocity_max", "(rad/s; register 22, VMAX; required of DM3507 and DM4340)"},
    {"torque_max", "(N·m; register 23, TMAX; required of DM3507)"},
    {"motor_per_joint", "(1)"},
    {"zero_rad", "(0): angle = motor / motor_per_joint + zero, torque = motor · motor_per_joint"},
};

/// Returns zeros if the field `motor` is absent.
MotorType read_motor_type(const JsonReader& board) {
    const std::string name = board.has("motor") ? board.text("motor") : "";
    const auto* const type = std::ranges::find(motor_types, name, &MotorType::name);
    if (type != motor_types.end()) {
        return *type;
    }
    if (board.has("motor")) {
        std::vector<std::string> names;
        std::ranges::transform(motor_types, std::back_inserter(names),
                               [](const MotorType& known) { return std::string(known.name); });
        throw board.error("motor", "one of " + listed(names), in_quotes(name));
    }
    return {"", 0, 0};
}

/// `delivered`: the factory setting; 0 if unknown.
double read_maximum(const JsonReader& board, const std::string& name, const std::string& motor_register,
                    double delivered) {
    if (board.has(name)) {
        return board.positive_number(name);
    }
    if (delivered == 0) {
        throw board.error(name, "the motor's register " + motor_register + ", for which no default is sure",
                          "none");
    }
    return delivered;
}

BusBoard read_damiao_motor(const JsonReader& board) {
    board.allow_only(names_of(damiao_fields));
    hal::DamiaoMotor::Config config;
    config.motor_id = board.whole_number("motor_id", 1, 15);
    board.text("feedback_id"); // a required field
    config.feedback_id = identifier_or(board, "feedback_id", 0);
    config.joint = read_joint(board);
    const MotorType type = read_motor_type(board);
    config.position_max =
        read_maximum(board, "position_max", "21 (PMAX)", board.has("motor") ? delivered_position_max : 0);
    config.velocity_max = read_maximum(board, "velocity_max", "22 (VMAX)", type.velocity);
    config.torque_max = read_maximum(board, "torque_max", "23 (TMAX)", type.torque);
    config.motor_per_joint = ratio_or(board, "motor_per_joint", 1);
    config.zero_rad = read_zero_rad(board);
    return one_joint<DamiaoMotor>(hal::DamiaoMotor(config), config.joint);
}

void read_damiao_motors(const JsonReader& joints, const std::filesystem::path& /*folder*/,
                        BusDescription& description) {
    read_each_board(joints, read_damiao_motor, description);
}

} // namespace

JointFamily damiao() {
    return {.name = "damiao",
            .board_fields = damiao_fields,
            .fields = {},
            .example = R"({"family": "damiao", "boards": [
                {"motor_id": 1, "feedback_id": "0x11", "joint": 1, "motor": "DM8009"},
                {"motor_id": 2, "feedback_id": "0x12", "joint": 2, "motor": "DM4310", "motor_per_joint": -1}]})",
            .read = read_damiao_motors};
}

} // namespace dfdyn::tools::families
