// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/snapshot.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <limits>
#include <string_view>
#include <vector>

namespace snapshot_test {

using namespace dfdyn;

constexpr std::uint32_t model = 77;

/// A state with one part of each kind.
struct State {
    std::array<float, 3> numbers{1, -2, 3};
    std::array<double, 2> variances{4, 5};
    int index = 2;

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.array(self.numbers.data(), 3);
        visitor.positive_array(self.variances.data(), 2);
        visitor.ranged(self.index, 0, 9);
    }

    bool operator==(const State&) const = default;
};

std::vector<std::byte> written(const State& state) {
    std::vector<std::byte> bytes(snapshot_bytes(state));
    REQUIRE(write_snapshot(state, model, bytes) == SnapshotResult::ok);
    return bytes;
}

/// Reads a snapshot and returns the result; checks that a rejected snapshot changes nothing.
SnapshotResult read(const std::vector<std::byte>& bytes) {
    State state{{7, 7, 7}, {7, 7}, 7};
    const State before = state;
    const SnapshotResult result = read_snapshot(state, model, bytes);
    CHECK((result == SnapshotResult::ok || state == before));
    return result;
}

SnapshotResult read_of(const State& state) { return read(written(state)); }

TEST_CASE("the checksum is the CRC-32 of ISO 3309") {
    constexpr std::string_view digits = "123456789";
    const auto bytes = std::as_bytes(std::span(digits));
    CHECK(crc32(bytes) == 0xCBF43926U);
    CHECK(crc32({}) == 0);
    CHECK(crc32(bytes.subspan(4), crc32(bytes.first(4))) == 0xCBF43926U);
}

TEST_CASE("a state is restored unchanged") {
    const State state{{0.5F, -0.0F, 1e30F}, {1e-300, 2}, 9};
    const auto bytes = written(state);
    CHECK(bytes.size() == sizeof(SnapshotHeader) + 3 * sizeof(float) + 2 * sizeof(double) + sizeof(int) +
                              sizeof(SnapshotChecksum));
    State restored;
    CHECK(read_snapshot(restored, model, bytes) == SnapshotResult::ok);
    CHECK(restored == state);
}

TEST_CASE("a snapshot uses the front of a larger buffer and does not change the rest") {
    const State state;
    std::vector<std::byte> buffer(snapshot_bytes(state) + 10, std::byte{0xAB});
    CHECK(write_snapshot(state, model, buffer) == SnapshotResult::ok);
    CHECK(std::vector<std::byte>(buffer.end() - 10, buffer.end()) ==
          std::vector<std::byte>(10, std::byte{0xAB}));
    CHECK(read(buffer) == SnapshotResult::ok);
}

TEST_CASE("a buffer that is too small is not changed") {
    const State state;
    for (std::size_t size = 0; size < snapshot_bytes(state); ++size) {
        std::vector<std::byte> buffer(size, std::byte{0xAB});
        CHECK(write_snapshot(state, model, buffer) == SnapshotResult::wrong_size);
        CHECK(buffer == std::vector<std::byte>(size, std::byte{0xAB}));
    }
}

TEST_CASE("every flipped bit and every truncation is rejected and changes nothing") {
    const auto bytes = written({});
    for (std::size_t place = 0; place < bytes.size(); ++place) {
        for (int bit = 0; bit < 8; ++bit) {
            auto damaged = bytes;
            damaged[place] ^= std::byte{1} << bit;
            CHECK(read(damaged) != SnapshotResult::ok);
        }
        CHECK(read({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(place)}) ==
              SnapshotResult::wrong_size);
    }
}

TEST_CASE("each part of the header has its own reason") {
    const auto bytes = written({});
    const auto with_word = [&](std::size_t word, std::uint32_t value) {
        auto changed = bytes;
        std::memcpy(changed.data() + 4 * word, &value, sizeof value);
        return read(changed);
    };
    CHECK(with_word(0, 0x44464459) == SnapshotResult::not_a_snapshot); // the other byte order
    CHECK(with_word(1, SnapshotHeader::expected_version + 1) == SnapshotResult::wrong_version);
    CHECK(with_word(2, model + 1) == SnapshotResult::wrong_model);
    CHECK(with_word(3, 0) == SnapshotResult::wrong_size);
    CHECK(with_word(3, 0xFFFFFFFF) == SnapshotResult::wrong_size);
    CHECK(with_word(4, 0) == SnapshotResult::corrupted); // the first number of a state whose checksum differs
    CHECK(with_word(bytes.size() / 4 - 1, 0) == SnapshotResult::corrupted); // the checksum
}

TEST_CASE("content that is not a valid state is rejected despite a correct checksum") {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(read_of({{1, 2, nan}, {1, 1}, 0}) == SnapshotResult::corrupted);
    CHECK(read_of({{nan, 2, 3}, {1, 1}, 0}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {1, infinity}, 0}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {0, 1}, 0}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {1, -1}, 0}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {1, 1}, -1}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {1, 1}, 10}) == SnapshotResult::corrupted);
    CHECK(read_of({{1, 2, 3}, {1, 1}, 9}) == SnapshotResult::ok);
}

} // namespace snapshot_test
