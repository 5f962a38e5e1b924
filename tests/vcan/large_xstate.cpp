// SPDX-License-Identifier: Apache-2.0
// Loaded into user-mode Linux before its own libraries (LD_PRELOAD). That kernel saves the first part of a
// process's extended registers and writes that part back. Processors with AMX have more, and the host accepts
// complete states only, so user-mode Linux would stop at its first process. Here the part is completed by the
// process's current state.
#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstring>
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

namespace {

using Ptrace = long (*)(int, pid_t, void*, void*);

Ptrace original() {
    static const auto found = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
    return found;
}

long set_first_part(pid_t pid, void* kind, const iovec& part) {
    static std::array<char, 1 << 16> state;
    iovec whole{state.data(), state.size()};
    if (original()(PTRACE_GETREGSET, pid, kind, &whole) != 0) {
        return -1;
    }
    std::memcpy(state.data(), part.iov_base, std::min(part.iov_len, whole.iov_len));
    return original()(PTRACE_SETREGSET, pid, kind, &whole);
}

} // namespace

extern "C" long ptrace(enum __ptrace_request request, ...) noexcept {
    va_list arguments;
    va_start(arguments, request);
    const auto pid = va_arg(arguments, pid_t);
    auto* const address = va_arg(arguments, void*);
    auto* const data = va_arg(arguments, void*);
    va_end(arguments);
    if (request == PTRACE_SETREGSET && reinterpret_cast<long>(address) == NT_X86_XSTATE) {
        return set_first_part(pid, address, *static_cast<iovec*>(data));
    }
    return original()(request, pid, address, data);
}
