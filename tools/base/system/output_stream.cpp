// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/output_stream.hpp"

#include "tools/base/text/text.hpp"

#include <cerrno>
#include <csignal>
#include <string>
#include <unistd.h>

namespace dfdyn::tools {

namespace fs = std::filesystem;

void DescriptorBuffer::drain() {
    const char* from = pbase();
    const char* const to = pptr();
    reset();
    while (from != to) {
        const ssize_t count = ::write(descriptor_, from, static_cast<std::size_t>(to - from));
        if (count < 0 && errno != EINTR) {
            throw system_error(path_, "cannot write", errno);
        }
        from += count < 0 ? 0 : count;
    }
}

void ignore_file_size_signal() {
    struct sigaction action {};
    if (::sigaction(SIGXFSZ, nullptr, &action) == 0 && action.sa_handler == SIG_DFL) {
        action.sa_handler = SIG_IGN;
        ::sigaction(SIGXFSZ, &action, nullptr);
    }
}

void refuse_dash(const fs::path& target) {
    if (target == "-") {
        throw InputError("-: expected a name, found -; standard output is /dev/stdout");
    }
}

void require_parent(const fs::path& target) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code ignored;
    const fs::file_type found = fs::status(folder, ignored).type();
    if (found != fs::file_type::directory && found != fs::file_type::none) { // none: the system cannot tell
        throw InputError(shown(target) + ": expected an existing folder " + shown(folder) + ", found " +
                         (found == fs::file_type::not_found ? "none" : "a file"));
    }
}

} // namespace dfdyn::tools
