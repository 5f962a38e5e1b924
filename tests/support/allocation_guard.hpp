// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::tests {

/// Numbers of heap calls in the whole process.
struct HeapCalls {
    /// malloc, calloc, realloc, memalign and similar, and through them operator new.
    std::uint64_t allocations = 0;
    std::uint64_t releases = 0; ///< free and realloc of a pointer that was not null
};

/// Counts every heap call during its lifetime, by any thread and any library of the process. The test
/// program's own malloc replaces the C library's (under AddressSanitizer: through its hooks). Guards may
/// nest. Read the counts before an assertion of Catch2, which itself allocates.
///
///     const AllocationGuard guard;
///     estimator.tick(sample, budget);
///     const HeapCalls calls = guard.calls();
///     CHECK(calls.allocations == 0);
class AllocationGuard {
  public:
    AllocationGuard() noexcept;

    /// The calls since the guard was created.
    HeapCalls calls() const noexcept;

  private:
    HeapCalls at_start_;
};

} // namespace dfdyn::tests
