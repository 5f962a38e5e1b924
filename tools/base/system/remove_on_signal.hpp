// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// Removes the file or empty folder `path` if a signal ends the program (SIGINT, SIGTERM, SIGHUP, SIGPIPE)
/// during the object's lifetime. The program then ends by that signal. Signals that the program handles or
/// ignores are unaffected; the program must then remove the file itself. Folders are removed after all files.
class RemoveOnSignal {
  public:
    /// `path`: absolute. The file need not exist yet. A path longer than the system allows is ignored,
    /// because no file can have it.
    explicit RemoveOnSignal(const std::string& path);
    ~RemoveOnSignal();
    RemoveOnSignal(const RemoveOnSignal&) = delete;
    RemoveOnSignal& operator=(const RemoveOnSignal&) = delete;

    struct Slot;

  private:
    Slot* slot_;
};

} // namespace dfdyn::tools
