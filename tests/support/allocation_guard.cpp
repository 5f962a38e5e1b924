// SPDX-License-Identifier: Apache-2.0
#include "tests/support/allocation_guard.hpp"

#include "tests/support/slow_build.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace {

std::atomic<std::uint64_t> allocations{0};
std::atomic<std::uint64_t> releases{0};

void count_allocation() noexcept { allocations.fetch_add(1, std::memory_order_relaxed); }

void count_release(const volatile void* block) noexcept {
    if (block != nullptr) {
        releases.fetch_add(1, std::memory_order_relaxed);
    }
}

dfdyn::tests::HeapCalls heap_calls() noexcept { return {allocations.load(), releases.load()}; }

} // namespace

#ifdef DFDYN_ADDRESS_SANITIZER

// As in <sanitizer/allocator_interface.h>, which GCC's packages leave out.
// NOLINTNEXTLINE(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));

namespace {

void on_malloc(const volatile void* /*block*/, std::size_t /*size*/) { count_allocation(); }
void on_free(const volatile void* block) { count_release(block); }

const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);

} // namespace

#else

#include <features.h>
#ifndef __GLIBC__
#error "the allocation guard forwards to glibc's own names of the allocation functions"
#endif

// The names of the C library and of its back door are not ours to choose.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void* __libc_pvalloc(std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) noexcept {
    count_allocation();
    return __libc_malloc(size);
}

void* calloc(std::size_t nmemb, std::size_t size) noexcept {
    count_allocation();
    return __libc_calloc(nmemb, size);
}

void* realloc(void* ptr, std::size_t size) noexcept {
    count_allocation();
    count_release(ptr);
    return __libc_realloc(ptr, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
    count_allocation();
    return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
    count_allocation();
    return __libc_memalign(alignment, size);
}

int posix_memalign(void** memptr, std::size_t alignment, std::size_t size) noexcept {
    if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) {
        return EINVAL;
    }
    count_allocation();
    void* const memory = __libc_memalign(alignment, size);
    if (memory == nullptr) {
        return ENOMEM;
    }
    *memptr = memory;
    return 0;
}

void* valloc(std::size_t size) noexcept {
    count_allocation();
    return __libc_valloc(size);
}

void* pvalloc(std::size_t size) noexcept {
    count_allocation();
    return __libc_pvalloc(size);
}

void free(void* ptr) noexcept {
    count_release(ptr);
    __libc_free(ptr);
}

} // extern "C"
  // NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

#endif

namespace dfdyn::tests {

AllocationGuard::AllocationGuard() noexcept : at_start_(heap_calls()) {}

HeapCalls AllocationGuard::calls() const noexcept {
    const HeapCalls now = heap_calls();
    return {now.allocations - at_start_.allocations, now.releases - at_start_.releases};
}

} // namespace dfdyn::tests
