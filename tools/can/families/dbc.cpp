// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/dbc_fields.hpp"
#include "tools/can/families/family_fields.hpp"

namespace dfdyn::tools::families {

namespace {

class DbcBoard final : public BoardOf<DbcBoard, DbcJoint> {
  public:
    using BoardOf::BoardOf;
    bool measures_effort() const override { return codec().config().effort.has_value(); }
};

class DbcWrenchSensor final : public SensorOf<DbcWrenchSensor, DbcSensor> {
  public:
    using SensorOf::SensorOf;
};

void read_joints(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description) {
    const Dbc dbc = read_dbc(folder / joints.text("file"));
    std::vector<DbcJoint> before;
    const auto read = [&](const JsonReader& board) {
        before.push_back(read_dbc_joint(board, dbc, before));
        return one_joint<DbcBoard>(before.back(), before.back().config().joint);
    };
    read_each_board(joints, read, description);
}

DescribedWrenchSensor read_sensor(const JsonReader& output, const std::filesystem::path& folder) {
    const DbcSensor sensor = read_dbc_sensor(output, read_dbc(folder / output.text("file")));
    return {AnySensor(std::make_unique<DbcWrenchSensor>(sensor)), read_limit(output)};
}

/// Encodes all boards together, because joints of a DBC file may share messages.
std::vector<hal::Frame> encode_together(std::span<const BusBoard> boards,
                                        std::span<const std::array<hal::JointValue, 2>> values) {
    std::vector<DbcValue> fields;
    for (std::size_t i = 0; i < boards.size(); ++i) {
        const DbcJoint::Config& config = dynamic_cast<const DbcBoard&>(*boards[i].board).codec().config();
        fields.push_back({&config.position, values[i][0].position_rad});
        if (config.effort) {
            fields.push_back({&*config.effort, values[i][0].effort});
        }
    }
    std::vector<hal::Frame> frames(fields.size());
    frames.resize(encode_fields(fields, frames));
    return frames;
}

} // namespace

JointFamily dbc_joints() {
    return {.name = "dbc",
            .board_fields = {{"joint", ""},
                             {"position", ""},
                             {"effort",
                              "(optional), each `message`, `signal` of the DBC file, `scale` (1), "
                              "`offset` (0); of a position also `unit` (`rad`, `deg`, `turn`) and "
                              "`count_rad` (rad; one count of the encoder, if the signal is finer): value = "
                              "(what the DBC file says · scale + offset) in that unit"}},
            .fields = {{"file", "(the DBC file, relative to the description)"}},
            .read = read_joints,
            .devices = "Joints whose messages a DBC file describes",
            .encode_together = encode_together};
}

SensorFamily dbc_sensor() {
    return {.name = "dbc",
            .fields = {{"file", ""},
                       {"wrench",
                        "(fx fy fz mx my mz, each `message`, `signal`, `scale`, `offset` as for a joint; "
                        "in two frames, which are two messages or two variants (`m0`, `m1`) of a "
                        "multiplexed one)"}},
            .devices = "Force/torque sensors whose messages a DBC file describes",
            .read = read_sensor};
}

} // namespace dfdyn::tools::families
