// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/storage.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <cstdint>
#include <numeric>
#include <type_traits>

namespace storage_test {

using namespace dfdyn;

template <class S>
bool aligned(const S& storage, std::uintptr_t bytes) {
    return reinterpret_cast<std::uintptr_t>(storage.data()) % bytes == 0;
}

template <class S>
void check_holds_numbers(S& storage) {
    CHECK(std::accumulate(storage.begin(), storage.end(), 0.0F) == 0);
    std::iota(storage.begin(), storage.end(), 1.0F);
    CHECK(storage[0] == 1);
    CHECK(storage.data()[storage.size() - 1] == static_cast<float>(storage.size()));
    CHECK(storage.end() - storage.begin() == storage.size());
}

TEST_CASE("storage of a fixed size is an aggregate in place, aligned for vectors") {
    auto storage = Storage<float, 7>::zeros({});
    check_holds_numbers(storage);
    CHECK(aligned(storage, 32));
    static_assert(std::is_aggregate_v<Storage<float, 7>> && std::is_trivially_copyable_v<Storage<float, 7>>);
    static_assert(sizeof(Storage<float, 8>) == 32);
    static constexpr Storage<double, 2> table{{1, 2}}; // as for a table of constants in flash
    static_assert(table[1] == 2 && table.size() == 2);
}

TEST_CASE("the host's storage with run-time sizes behaves in the same way") {
    auto storage = Storage<float, dynamic>::zeros({7});
    CHECK(storage.size() == 7);
    check_holds_numbers(storage);
    CHECK(aligned(storage, 16));
}

TEST_CASE("an extent of fixed size takes no memory and converts to its value") {
    struct Holder {
        [[no_unique_address]] Extent<3> three;
        float number;
    };
    STATIC_REQUIRE(sizeof(Holder) == sizeof(float));
    STATIC_REQUIRE(Extent<3>{} == 3 && extent<3>(3) == 3);
    STATIC_REQUIRE(extent<dynamic>(5) == 5);
    STATIC_REQUIRE(product(2, 3) == 6 && sum(2, 3) == 5);
    STATIC_REQUIRE(product(dynamic, 3) == dynamic && product(3, dynamic) == dynamic);
    STATIC_REQUIRE(sum(dynamic, 1) == dynamic && sum(1, dynamic) == dynamic);
}

} // namespace storage_test
