// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::tests {

/// Calls to the heap, of the whole process.
struct HeapCalls {
    std::uint64_t allocations =
        0; ///< malloc, calloc, realloc, memalign and their kin, and what ends there: operator new
    std::uint64_t releases = 0; ///< free and realloc of something that was not null
};

/// Counts every call to the heap while it lives, by any thread and any library of the process: the test
/// program's own malloc stands before the C library's (under AddressSanitizer: its hooks). Guards may nest.
/// Take the counts before an assertion of Catch2, which itself allocates.
///
///     const AllocationGuard guard;
///     estimator.tick(sample, budget);
///     const HeapCalls calls = guard.calls();
///     CHECK(calls.allocations == 0);
class AllocationGuard {
  public:
    AllocationGuard() noexcept;

    /// The calls since the guard was made.
    HeapCalls calls() const noexcept;

  private:
    HeapCalls at_start_;
};

} // namespace dfdyn::tests
