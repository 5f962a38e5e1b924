// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/ros_message.hpp"

#include "tools/base/bag/byte_reader.hpp"

namespace dfdyn::tools {

namespace {

/// Reads the Common Data Representation of the OMG, as ROS 2 writes it: four bytes that name the byte order,
/// then values at multiples of their size, counted from the end of these four bytes.
class CdrReader {
  public:
    CdrReader(std::span<const std::byte> bytes, const std::string& what) : reader_(bytes, what) {
        const auto header = reader_.take(header_size);
        const auto representation = static_cast<unsigned>(header[1]);
        if (header[0] != std::byte{0} || representation > 1) {
            throw reader_.error("plain CDR, 0x0000 or 0x0001",
                                "representation " + std::to_string(representation));
        }
        swapped_ = representation == 0; // big-endian
    }

    template <class Number>
    Number number() {
        const std::size_t after_header = reader_.position() - header_size;
        reader_.take((sizeof(Number) - after_header % sizeof(Number)) % sizeof(Number));
        return reader_.number<Number>(swapped_);
    }

    /// Reads a text, which ends with a zero byte that its length includes.
    std::string text() {
        const auto bytes = reader_.take(number<std::uint32_t>());
        const std::string_view characters(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return std::string(characters.substr(0, characters.empty() ? 0 : characters.size() - 1));
    }

    /// Reads the number of entries of a sequence, each of at least `size` bytes.
    std::size_t count(std::size_t size) {
        const auto entries = number<std::uint32_t>();
        if (entries > reader_.left() / size) {
            throw reader_.error("at most " + std::to_string(reader_.left() / size) + " entries",
                                std::to_string(entries));
        }
        return entries;
    }

    /// Reads a header: stamp and frame. Returns the stamp in nanoseconds.
    std::int64_t header() {
        const auto seconds = number<std::int32_t>();
        const auto nanoseconds = number<std::uint32_t>();
        text();
        return std::int64_t{seconds} * 1'000'000'000 + std::int64_t{nanoseconds};
    }

    std::vector<double> doubles(std::size_t names) {
        std::vector<double> values(count(sizeof(double)));
        for (double& value : values) {
            value = number<double>();
        }
        if (!values.empty() && values.size() != names) {
            throw reader_.error("no value or one for each of " + std::to_string(names) + " joints",
                                std::to_string(values.size()) + " values");
        }
        return values;
    }

  private:
    static constexpr std::size_t header_size = 4;

    ByteReader reader_;
    bool swapped_ = false;
};

} // namespace

JointStateMessage decode_joint_state(std::span<const std::byte> bytes, const std::string& what) {
    CdrReader reader(bytes, what);
    JointStateMessage message;
    message.stamp_ns = reader.header();
    message.names.resize(reader.count(sizeof(std::uint32_t)));
    for (std::string& name : message.names) {
        name = reader.text();
    }
    message.position = reader.doubles(message.names.size());
    message.velocity = reader.doubles(message.names.size());
    message.effort = reader.doubles(message.names.size());
    return message;
}

WrenchMessage decode_wrench(std::span<const std::byte> bytes, const std::string& what) {
    CdrReader reader(bytes, what);
    WrenchMessage message;
    message.stamp_ns = reader.header();
    for (double& value : message.wrench) {
        value = reader.number<double>();
    }
    return message;
}

} // namespace dfdyn::tools
