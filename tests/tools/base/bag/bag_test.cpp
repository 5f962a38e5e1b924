// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/bag.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/bag/ros_message.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace bag_test {

using namespace dfdyn::tools;
using dfdyn::tests::file_content;
using dfdyn::tests::TemporaryDirectory;
using Names = std::vector<std::string>;

// tests/data/ros2_bags/make_bags.mjs wrote these files: 40 joint states, 20 wrenches, 40 texts.
const std::filesystem::path bags = std::filesystem::path(DFDYN_TEST_DATA_DIR) / "ros2_bags";
constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t period_ns = 10'000'000;

ReadOptions chain(OutputKind outputs) {
    ReadOptions options;
    options.outputs = outputs;
    options.velocity = true;
    options.joint_names = {"base", "wrist", "elbow"};
    options.joint_count = 3;
    return options;
}

std::string refusal(const std::filesystem::path& path, const ReadOptions& options) {
    try {
        read_recording(path, options);
        return "";
    } catch (const InputError& error) {
        return std::string(error.what()).substr(path.string().size());
    }
}

TEST_CASE("joint states of a bag are read in the order of the chain, with their stamps") {
    const std::string file = GENERATE("plain.mcap", "lz4.mcap", "zstd.mcap", "sqlite.db3");
    CAPTURE(file);
    const Recording recording = read_recording(bags / file, chain(OutputKind::joint_torque));
    REQUIRE(recording.row_count() == 40);
    CHECK(recording.position.names == Names{"q1", "q2", "q3"});
    CHECK(recording.output.names == Names{"tau1", "tau2", "tau3"});
    CHECK(recording.notes.empty());
    for (std::size_t k = 0; k < 40; ++k) {
        CAPTURE(k);
        CHECK(recording.time_ns[k] == begin_ns + static_cast<std::int64_t>(k) * period_ns);
        CHECK(recording.gap_before[k] == (k == 0 ? 1 : 0));
        for (std::size_t j = 0; j < 3; ++j) {
            const double phase = static_cast<double>(k) / 10 + static_cast<double>(j);
            CHECK(std::abs(recording.position.row(k)[j] - std::sin(phase)) < 1e-15);
            CHECK(std::abs(recording.velocity.row(k)[j] - 10 * std::cos(phase)) < 1e-14);
            CHECK(recording.output.row(k)[j] == 100 * static_cast<double>(j) + static_cast<double>(k));
        }
    }
}

TEST_CASE("a wrench is interpolated at the times of the joint states, and only between its messages") {
    const std::string file = GENERATE("zstd.mcap", "sqlite.db3");
    const Recording recording = read_recording(bags / file, chain(OutputKind::wrench));
    REQUIRE(recording.row_count() == 38); // the wrench is there from 4 to 384 ms, the joints from 0 to 390 ms
    CHECK(recording.notes == Names{"2 joint states before the first or after the last wrench are not used"});
    for (std::size_t row = 0; row < 38; ++row) {
        const double t = static_cast<double>(row + 1) / 100;
        CHECK(recording.time_ns[row] == begin_ns + static_cast<std::int64_t>(row + 1) * period_ns);
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(std::abs(recording.output.row(row)[k] - (1 + static_cast<double>(k) + t)) < 1e-12);
        }
    }
}

TEST_CASE("without a chain the joints of a bag have the order of its first message") {
    ReadOptions options;
    options.outputs = OutputKind::motor_current;
    options.rows = parse_row_range("10:12");
    const Recording recording = read_recording(bags / "plain.mcap", options);
    REQUIRE(recording.row_count() == 2);
    CHECK(recording.output.row(0)[0] == 210);
    CHECK(recording.output.row(0)[2] == 910);
    CHECK(recording.notes == Names{"joints in the order of the bag: elbow, base, gripper, wrist (--robot and "
                                   "--tip choose another order)"});
}

TEST_CASE("topics and joints that a bag does not have are rejected with the nearest ones") {
    ReadOptions options = chain(OutputKind::joint_torque);
    options.topics = {"/joint_state"};
    CHECK(refusal(bags / "plain.mcap", options) ==
          ": --topic: expected topics of the bag, found \"/joint_state\" (did you mean \"/joint_states\"?); "
          "the "
          "bag has /ft/wrench WrenchStamped, /joint_states JointState, /log String");
    options.topics = {"/log"};
    CHECK(refusal(bags / "plain.mcap", options) ==
          ": expected one topic of type sensor_msgs/msg/JointState, found none; the bag has /ft/wrench "
          "WrenchStamped, /joint_states JointState, /log String");
    options.topics = {"/joint_states"};
    CHECK(refusal(bags / "plain.mcap", options).empty());
    options.joint_names = {"base", "wrist", "elbwo"};
    CHECK(refusal(bags / "plain.mcap", options) == ": expected the joints of the chain, base, wrist, elbwo, "
                                                   "found no elbwo (did you mean \"elbow\"?); the "
                                                   "bag has elbow, base, gripper, wrist");
    options = {};
    options.columns = parse_column_patterns("q=a*");
    CHECK(refusal(bags / "plain.mcap", options) ==
          ": --columns: expected a CSV recording, found a ROS 2 bag (--topic)");
    options = {};
    options.rows = parse_row_range("30:41");
    CHECK(refusal(bags / "plain.mcap", options) ==
          ": --rows: expected at least 41 rows in the recording, found 40");
}

TEST_CASE("a folder with bag files is read as one bag, in the order of their numbers") {
    const TemporaryDirectory directory;
    directory.write("metadata.yaml", "rosbag2_bagfile_information:\n");
    directory.write("run_0.mcap", file_content(bags / "plain.mcap"));
    CHECK(read_recording(directory.path(), chain(OutputKind::joint_torque)).row_count() == 40);
    directory.write("run_1.mcap", file_content(bags / "zstd.mcap")); // the same times again
    CHECK(refusal(directory.path(), chain(OutputKind::joint_torque)) ==
          ": row 1: expected a time after that of the message before, found the same time "
          "(the bags of this folder are one recording: run_0.mcap, run_1.mcap)");
    ReadOptions options = chain(OutputKind::joint_torque);
    options.skip_bad_rows = true;
    const Recording recording = read_recording(directory.path(), options);
    CHECK(recording.row_count() == 40);
    CHECK(recording.skipped.time_not_increasing == 40);
}

TEST_CASE("every prefix of a bag is rejected with the place where it ends") {
    const TemporaryDirectory directory;
    const std::string file = GENERATE("plain.mcap", "lz4.mcap", "zstd.mcap");
    const std::string whole = file_content(bags / file);
    const std::size_t data_end = whole.rfind(std::string("\x0f\x04\0\0\0\0\0\0\0", 9));
    for (std::size_t length = 16; length < data_end; length += 37) {
        const std::string path = directory.write("part.mcap", std::string_view(whole).substr(0, length));
        CHECK_THAT(refusal(path, chain(OutputKind::joint_torque)),
                   Catch::Matchers::ContainsSubstring("more bytes of a complete MCAP file, found "));
    }
}

TEST_CASE("a bag with changed bytes is read or rejected in one line") {
    DFDYN_SEEDED_ENGINE(engine);
    const TemporaryDirectory directory;
    for (const std::string file : {"plain.mcap", "lz4.mcap", "zstd.mcap", "sqlite.db3"}) {
        const std::string whole = file_content(bags / file);
        int rejected = 0;
        for (int count = 0; count < 150; ++count) {
            std::string content = whole;
            for (int change = 0; change < 1 + count % 5; ++change) {
                content[16 + engine() % (content.size() - 16)] = static_cast<char>(engine() % 256);
            }
            const std::string message =
                refusal(directory.write("changed", content), chain(OutputKind::joint_torque));
            CAPTURE(file, count, message);
            CHECK(message.find('\n') == std::string::npos);
            rejected += message.empty() ? 0 : 1;
        }
        CHECK(rejected > 0);
    }
}

/// Runs `decode` over all prefixes of a message and over changed bytes. It must return or throw InputError.
template <class Decode>
void check_decoder(const std::string& topic, Decode decode, std::mt19937_64& engine) {
    std::vector<std::byte> bytes;
    visit_bag(bags / "plain.mcap", [&](const BagMessage& message) {
        if (message.topic.name == topic) {
            bytes.assign(message.bytes.begin(), message.bytes.end());
        }
    });
    REQUIRE_FALSE(bytes.empty());
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const std::vector<std::byte> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        CHECK_THROWS_AS(decode(part, "message"), InputError);
    }
    for (int count = 0; count < 2000; ++count) {
        std::vector<std::byte> changed = bytes;
        for (int change = 0; change < 1 + count % 3; ++change) {
            changed[engine() % changed.size()] = static_cast<std::byte>(engine() % 256);
        }
        try {
            decode(changed, "message");
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), Catch::Matchers::StartsWith("message: at byte "));
        }
    }
}

TEST_CASE("decoders of messages survive every prefix and changed bytes") {
    DFDYN_SEEDED_ENGINE(engine);
    std::mt19937_64 random(engine());
    check_decoder("/joint_states", decode_joint_state, random);
    check_decoder("/ft/wrench", decode_wrench, random);
}

TEST_CASE("a message in big-endian order is decoded") {
    const std::vector<unsigned char> bytes{0, 0, 0, 0,             // CDR, big-endian
                                           0, 0, 0, 7, 0, 0, 0, 9, // stamp
                                           0, 0, 0, 1, 0, 0, 0, 0, // frame "", and padding
                                           0, 0, 0, 0,             // no name
                                           0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    std::vector<std::byte> raw;
    for (const unsigned char byte : bytes) {
        raw.push_back(static_cast<std::byte>(byte));
    }
    const JointStateMessage message = decode_joint_state(raw, "message");
    CHECK(message.stamp_ns == 7'000'000'009);
    CHECK(message.names.empty());
}

} // namespace bag_test
