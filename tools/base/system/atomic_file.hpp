// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string_view>

namespace dfdyn::tools {

/// A file that appears whole or not at all: written under a temporary name (`TARGET.tmp.PID.N`) beside its
/// target, and renamed onto it by `commit`. Until then an existing target is untouched; without `commit` (an
/// exception, Ctrl-C, a full disk) the temporary file is removed. A symbolic link stays, its file is
/// replaced; an existing file keeps its permissions. A target that is no ordinary file (`/dev/stdout`, a
/// pipe) is written directly.
class AtomicFile {
  public:
    /// Creates the temporary file. Throws InputError with path and the system's reason when it cannot, or
    /// when the target exists and may not be written.
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Where to write; buffered, classic locale. A write that the system refuses throws InputError with path
    /// and reason out of the `<<` or `write` that met it.
    std::ostream& stream() noexcept;

    /// Flushes to the disk, closes and renames. Call once, last. Throws InputError when any step, or an
    /// earlier write, failed; the target is then untouched.
    void commit();

  private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// A file that is written as the work goes on, for work that a person ends or that runs for days: what was
/// flushed is there, whatever ends the program.
class GrowingFile {
  public:
    /// Makes the file, or empties it. Throws InputError with path and the system's reason.
    explicit GrowingFile(const std::filesystem::path& target);
    ~GrowingFile();
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;

    /// As of AtomicFile.
    std::ostream& stream() noexcept;

  private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Throws InputError as the constructor of AtomicFile for `target` does, so that a long work fails before it
/// begins. Leaves nothing behind; pipes and devices are not opened.
void check_writable(const std::filesystem::path& target);

/// Makes `folder`, and those that it lies in, unless they are there. Throws InputError with path and reason.
void make_folder(const std::filesystem::path& folder);

/// Writes `content` as the whole of the file `target`, with the promises of AtomicFile.
void write_file(const std::filesystem::path& target, std::string_view content);

} // namespace dfdyn::tools
