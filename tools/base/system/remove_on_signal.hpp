// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace dfdyn::tools {

/// While it lives, a signal that would end the program (SIGINT, SIGTERM, SIGHUP, SIGPIPE) removes the file
/// `path` first; the program then ends by that signal as it would have. A signal that the program handles
/// itself, or ignores, is left alone: the program then removes the file by ordinary means.
class RemoveOnSignal {
  public:
    /// `path`: absolute. The file need not exist yet. A path longer than the system allows is not kept: no
    /// file can have it. Throws InputError when 16 files are kept already.
    explicit RemoveOnSignal(const std::string& path);
    ~RemoveOnSignal();
    RemoveOnSignal(const RemoveOnSignal&) = delete;
    RemoveOnSignal& operator=(const RemoveOnSignal&) = delete;

  private:
    std::size_t slot_;
};

} // namespace dfdyn::tools
