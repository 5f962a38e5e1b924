// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string_view>

namespace dfdyn::tools {

/// The results of one command: files and new folders that appear together, or not at all. Files are written
/// under temporary names in the folders of their targets (AtomicFile), new folders with their content as
/// `FOLDER.tmp.PID.N`. `commit` renames all of them when the last one is complete. Without `commit` (an
/// exception, Ctrl-C, a full disk), and if a rename fails, every target is as it was before. Signals are
/// delivered before or after the renames. Only SIGKILL or a power failure during the renames leaves a part.
class FileSet {
  public:
    FileSet();
    ~FileSet();
    FileSet(const FileSet&) = delete;
    FileSet& operator=(const FileSet&) = delete;

    /// Adds the folder and its parents, unless they exist. Throws InputError with path and reason.
    void add_folder(const std::filesystem::path& folder);

    /// Adds a file in an existing or added folder and returns the stream to write to, which is valid until
    /// `commit`. A second call for one target replaces the first one's content. Throws InputError like
    /// AtomicFile.
    std::ostream& add(const std::filesystem::path& target);

    /// Adds a file with this content. A named pipe is opened by `commit`, which waits for its reader.
    void add(const std::filesystem::path& target, std::string_view content);

    /// Lets `commit` remove the file if it exists; folders remain.
    void remove(const std::filesystem::path& target);

    /// Completes all files, then renames them. Targets that are no ordinary files (pipes, devices) are
    /// completed last, because they cannot be undone. Call once, at the end. Throws InputError.
    void commit();

  private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace dfdyn::tools
