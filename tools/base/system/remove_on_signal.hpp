// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace dfdyn::tools {

/// Removes the file `path` if a signal ends the program (SIGINT, SIGTERM, SIGHUP, SIGPIPE) during the
/// object's lifetime. The program then ends by that signal. Signals that the program handles or ignores are
/// unaffected; the program must then remove the file itself.
class RemoveOnSignal {
  public:
    /// `path`: absolute. The file need not exist yet. A path longer than the system allows is ignored,
    /// because no file can have it. Throws InputError if 16 files are registered already.
    explicit RemoveOnSignal(const std::string& path);
    ~RemoveOnSignal();
    RemoveOnSignal(const RemoveOnSignal&) = delete;
    RemoveOnSignal& operator=(const RemoveOnSignal&) = delete;

  private:
    std::size_t slot_;
};

} // namespace dfdyn::tools
