// SPDX-License-Identifier: Apache-2.0
// Bags with gaps and with several publishers, written here. For bags of other writers see bag_test.cpp.
#include "tools/base/recording/read_bag.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/bag/ros_message.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace read_bag_test {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;
using Names = std::vector<std::string>;

constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t period_ns = 10'000'000;

template <class Number>
void append(std::string& bytes, Number value) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &value, sizeof(Number));
    bytes.append(raw.data(), raw.size());
}

/// Body of a message in CDR: values at multiples of their size.
class CdrWriter {
  public:
    explicit CdrWriter(std::int64_t stamp_ns) {
        number(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
        number(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
        text("base");
    }

    template <class Number>
    void number(Number value) {
        bytes_.resize((bytes_.size() + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number));
        append(bytes_, value);
    }

    void text(const std::string& value) {
        number(static_cast<std::uint32_t>(value.size() + 1));
        bytes_ += value + '\0';
    }

    void numbers(std::span<const double> values) {
        number(static_cast<std::uint32_t>(values.size()));
        for (const double value : values) {
            number(value);
        }
    }

    std::string message() const { return std::string("\0\1\0\0", 4) + bytes_; } // little-endian

  private:
    std::string bytes_;
};

/// An MCAP file with `/joint_states` and `/ft`.
class BagWriter {
  public:
    BagWriter() {
        channel(1, "/joint_states", joint_state_type);
        channel(2, "/ft", wrench_type);
    }

    void joints(std::int64_t time_ns, const JointStateMessage& message) {
        CdrWriter writer(time_ns);
        writer.number(static_cast<std::uint32_t>(message.names.size()));
        for (const std::string& name : message.names) {
            writer.text(name);
        }
        writer.numbers(message.position);
        writer.numbers(message.velocity);
        writer.numbers(message.effort);
        add(1, time_ns, writer.message());
    }

    /// A wrench of six equal values.
    void wrench(std::int64_t time_ns, double value) {
        CdrWriter writer(time_ns);
        for (int k = 0; k < 6; ++k) {
            writer.number(value);
        }
        add(2, time_ns, writer.message());
    }

    std::filesystem::path write(const TemporaryDirectory& directory) const {
        std::string end;
        append(end, std::uint32_t{0});
        return directory.write("run.mcap", bytes_ + record(0x0f, end) + magic());
    }

  private:
    static std::string magic() { return "\x89MCAP0\r\n"; }

    static std::string record(char operation, const std::string& content) {
        std::string bytes(1, operation);
        append(bytes, std::uint64_t{content.size()});
        return bytes + content;
    }

    static void append_text(std::string& bytes, const std::string& text) {
        append(bytes, static_cast<std::uint32_t>(text.size()));
        bytes += text;
    }

    void channel(std::uint16_t id, const std::string& topic, const std::string& type) {
        std::string schema;
        append(schema, id);
        append_text(schema, type);
        append_text(schema, "ros2msg");
        append_text(schema, "");
        std::string topic_channel;
        append(topic_channel, id);
        append(topic_channel, id);
        append_text(topic_channel, topic);
        append_text(topic_channel, "cdr");
        append(topic_channel, std::uint32_t{0}); // no metadata
        bytes_ += record(0x03, schema) + record(0x04, topic_channel);
    }

    void add(std::uint16_t id, std::int64_t time_ns, const std::string& message) {
        std::string content;
        append(content, id);
        append(content, std::uint32_t{0});
        append(content, time_ns);
        append(content, time_ns);
        bytes_ += record(0x05, content + message);
    }

    std::string bytes_ = magic();
};

ReadOptions chain() {
    ReadOptions options;
    options.velocity = true;
    options.joint_names = {"base", "wrist"};
    options.joint_count = 2;
    return options;
}

std::int64_t time_of(int k) { return begin_ns + k * period_ns; }

/// Joint states k = 0..99, with wrenches at the same times and of value k². The sensor is silent from 31 to
/// 59, and loses the message 80.
void add_silent_sensor(BagWriter& bag, std::int64_t wrench_delay_ns) {
    for (int k = 0; k < 100; ++k) {
        bag.joints(time_of(k), {0, {"base", "wrist"}, {0.01 * k, 1}, {}, {}});
        if (k <= 30 || (k >= 60 && k != 80)) {
            bag.wrench(time_of(k) + wrench_delay_ns, k * k);
        }
    }
}

TEST_CASE("a wrench is not interpolated while its sensor is silent") {
    const TemporaryDirectory directory;
    BagWriter bag;
    add_silent_sensor(bag, 0);
    ReadOptions options = chain();
    options.outputs = OutputKind::wrench;
    const Recording recording = read_bag_recording(bag.write(directory), options);
    REQUIRE(recording.row_count() == 71);
    CHECK(recording.notes == Names{"29 joint states between wrenches more than 30 ms apart are not used"});
    for (std::size_t row = 0; row < 71; ++row) {
        CAPTURE(row);
        const int k = static_cast<int>(row) + (row <= 30 ? 0 : 29);
        CHECK(recording.time_ns[row] == time_of(k));
        CHECK(recording.gap_before[row] == (row == 0 || row == 31 ? 1 : 0));
        // One lost message is interpolated: the mean of 79² and 81² is 80² + 1.
        CHECK(recording.output.row(row)[5] == Approx(k == 80 ? 6401 : k * k));
    }
}

TEST_CASE("a joint state between the last wrench before a silence and the first one after it is not used") {
    const TemporaryDirectory directory;
    BagWriter bag;
    add_silent_sensor(bag, 1'000'000);
    ReadOptions options = chain();
    options.outputs = OutputKind::wrench;
    const Recording recording = read_bag_recording(bag.write(directory), options);
    CHECK(recording.row_count() == 69); // without 0, and without 31 to 60
    CHECK(recording.time_ns[30] == time_of(61));
    CHECK(recording.gap_before[30] == 1);
    CHECK(recording.notes == Names{"1 joint states before the first or after the last wrench are not used",
                                   "30 joint states between wrenches more than 30 ms apart are not used"});
}

TEST_CASE("wrenches that arrive in bursts are interpolated between the bursts") {
    const int joint_states = GENERATE(1, 10); // per burst: also a joint state in every millisecond
    const TemporaryDirectory directory;
    BagWriter bag;
    for (int k = 0; k < 100; ++k) {
        for (int state = 0; state < joint_states; ++state) {
            bag.joints(time_of(k) + state * period_ns / joint_states,
                       {0, {"base", "wrist"}, {0.01 * k, 1}, {}, {}});
        }
        for (int member = 0; member < 10; ++member) { // of a sensor of 1 kHz
            bag.wrench(time_of(k) - 1'000'000 + 20'000 * member, 1);
        }
    }
    ReadOptions options = chain();
    options.outputs = OutputKind::wrench;
    const Recording recording = read_bag_recording(bag.write(directory), options);
    CHECK(recording.row_count() == static_cast<std::size_t>(99 * joint_states)); // before the last burst
    CHECK(recording.notes == Names{std::to_string(joint_states) +
                                   " joint states before the first or after the last wrench are not used"});
}

/// Adds 20 messages of a gripper with velocities, each before one of the chain without.
void add_two_publishers(BagWriter& bag, bool gripper_efforts, bool chain_efforts) {
    const std::vector<double> none;
    for (int k = 0; k < 20; ++k) {
        bag.joints(time_of(k),
                   {0, {"finger"}, {0.1}, {0.2}, gripper_efforts ? std::vector<double>{0.3} : none});
        bag.joints(time_of(k) + 1000,
                   {0, {"wrist", "base"}, {0.01 * k, 1}, {}, chain_efforts ? std::vector{4.0, 5.0} : none});
        bag.wrench(time_of(k) + 1000, 6);
    }
}

TEST_CASE("velocities are those of the chain's messages, not of a gripper's on the same topic") {
    const TemporaryDirectory directory;
    BagWriter bag;
    add_two_publishers(bag, true, true);
    ReadOptions options = chain();
    options.outputs = OutputKind::joint_torque;
    const Recording recording = read_bag_recording(bag.write(directory), options);
    REQUIRE(recording.row_count() == 20);
    CHECK_FALSE(recording.velocity.present());
    CHECK(recording.position.row(3)[1] == 0.03);
    CHECK(recording.output.row(3)[0] == 5);
    CHECK(recording.notes == Names{"20 messages without all of base, wrist are not used"});
}

TEST_CASE("the choice of outputs depends on the efforts of the chain, not on a gripper's") {
    const bool chain_efforts = GENERATE(true, false);
    const TemporaryDirectory directory;
    BagWriter bag;
    add_two_publishers(bag, !chain_efforts, chain_efforts);
    ReadOptions options = chain();
    options.output_choices = {OutputKind::joint_torque, OutputKind::wrench};
    const Recording recording = read_bag_recording(bag.write(directory), options);
    CHECK(recording.output.names ==
          output_names(chain_efforts ? OutputKind::joint_torque : OutputKind::wrench, 2));
    CHECK(recording.row_count() == 20);
}

TEST_CASE("joints of the chain in separate messages only are an error") {
    const TemporaryDirectory directory;
    BagWriter bag;
    bag.joints(time_of(0), {0, {"base"}, {0}, {}, {}});
    bag.joints(time_of(1), {0, {"wrist"}, {0}, {}, {}});
    const std::filesystem::path path = bag.write(directory);
    CHECK_THROWS_WITH(read_bag_recording(path, chain()),
                      path.string() + ": expected messages with all of base, wrist, found none");
}

} // namespace read_bag_test
