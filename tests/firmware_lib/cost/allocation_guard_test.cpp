// SPDX-License-Identifier: Apache-2.0
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace allocation_guard_test {

using dfdyn::tests::AllocationGuard;
using dfdyn::tests::HeapCalls;

// Prevents the compiler from omitting an allocation whose memory is not used.
template <typename T>
void keep(T& value) {
    asm volatile("" : : "g"(&value) : "memory");
}

template <typename Action>
HeapCalls calls_of(Action action) {
    const AllocationGuard guard;
    action();
    return guard.calls();
}

void check_one_block(const HeapCalls& calls) {
    CHECK(calls.allocations == 1);
    CHECK(calls.releases == 1);
}

TEST_CASE("the guard counts nothing without allocations") {
    const HeapCalls calls = calls_of([] {
        std::array<double, 100> numbers{};
        keep(numbers);
        Eigen::Matrix4d product = Eigen::Matrix4d::Identity() * 2.0;
        keep(product);
    });
    CHECK(calls.allocations == 0);
    CHECK(calls.releases == 0);
}

TEST_CASE("the guard counts new and delete") {
    check_one_block(calls_of([] {
        auto number = std::make_unique<int>(1);
        keep(*number);
    }));
    check_one_block(calls_of([] {
        auto numbers = std::make_unique<int[]>(10);
        keep(*numbers.get());
    }));
}

TEST_CASE("the guard counts new of an over-aligned type") {
    struct alignas(128) Aligned {
        int number = 0;
    };
    check_one_block(calls_of([] {
        auto aligned = std::make_unique<Aligned>();
        keep(*aligned);
    }));
}

TEST_CASE("the guard counts the C library's functions") {
    check_one_block(calls_of([] {
        void* block = std::malloc(10);
        keep(block);
        std::free(block);
    }));
    check_one_block(calls_of([] {
        void* block = std::calloc(2, 10);
        keep(block);
        std::free(block);
    }));
    check_one_block(calls_of([] {
        void* block = std::aligned_alloc(64, 128);
        keep(block);
        std::free(block);
    }));
    check_one_block(calls_of([] {
        void* block = nullptr;
        const int error = ::posix_memalign(&block, 64, 128);
        keep(block);
        std::free(error == 0 ? block : nullptr);
    }));
}

TEST_CASE("the guard counts each realloc as an allocation and a release") {
    const HeapCalls calls = calls_of([] {
        void* block = std::realloc(nullptr, 10);
        keep(block);
        block = std::realloc(block, 100'000);
        keep(block);
        std::free(block);
    });
    CHECK(calls.allocations == 2);
    CHECK(calls.releases == 2);
}

TEST_CASE("blocks have the requested alignment") {
    void* block = nullptr;
    REQUIRE(::posix_memalign(&block, 4096, 10) == 0);
    CHECK(reinterpret_cast<std::uintptr_t>(block) % 4096 == 0);
    std::free(block);
}

TEST_CASE("the guard counts the growth of a std::vector and a std::string") {
    check_one_block(calls_of([] {
        std::vector<double> numbers;
        numbers.push_back(1.0);
        keep(numbers);
    }));
    check_one_block(calls_of([] {
        std::string text(1000, 'x');
        keep(text);
    }));
}

TEST_CASE("the guard counts Eigen's dynamic matrices and the temporary of an aliased product") {
    check_one_block(calls_of([] {
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(10, 10);
        keep(matrix);
    }));
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(10, 10);
    const HeapCalls calls = calls_of([&] {
        matrix = matrix * matrix;
        keep(matrix);
    });
    CHECK(calls.allocations >= 1);
}

TEST_CASE("the guard counts allocations of other threads and of a library") {
    const HeapCalls calls = calls_of([] {
        std::thread([] {
            void* block = std::malloc(10);
            keep(block);
            std::free(block);
        }).join();
    });
    CHECK(calls.allocations >= 2); // the block, and the storage of std::thread for its function
}

TEST_CASE("guards can be nested, and a guard continues to count after it was read") {
    const AllocationGuard outer;
    const HeapCalls inner = calls_of([] {
        auto number = std::make_unique<int>(1);
        keep(*number);
    });
    const HeapCalls first = outer.calls();
    auto number = std::make_unique<int>(2);
    keep(*number);
    const HeapCalls second = outer.calls();
    check_one_block(inner);
    check_one_block(first);
    CHECK(second.allocations == 2);
    CHECK(second.releases == 1);
}

} // namespace allocation_guard_test
