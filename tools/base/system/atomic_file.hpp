// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string_view>

namespace dfdyn::tools {

/// A file that is replaced atomically. It is written under a temporary name (`TARGET.tmp.PID.N`) in the
/// folder of its target, and `commit` renames it. Until then an existing target is unchanged. Without
/// `commit` (an exception, Ctrl-C, a full disk) the temporary file is removed. A symbolic link remains, and
/// its file is replaced. An existing file keeps its permissions. A target that is no ordinary file
/// (`/dev/stdout`, a pipe) is written directly.
class AtomicFile {
  public:
    /// Creates the temporary file. Throws InputError with the path and the system's reason if this fails, or
    /// if the target exists and is not writable. `shown_as`: the path in messages; empty: `target`.
    explicit AtomicFile(const std::filesystem::path& target, const std::filesystem::path& shown_as = {});
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Returns the stream to write to; buffered, with the classic locale. If the system rejects a write, the
    /// `<<` or `write` throws InputError with path and reason.
    std::ostream& stream() noexcept;

    /// Flushes to the disk, closes and renames. Call once, at the end. Throws InputError if any step, or an
    /// earlier write, failed; the target is then unchanged.
    void commit();

    // The steps of `commit` for several files (FileSet), which are renamed when all of them are complete.

    /// Returns whether the target is no ordinary file. It is then complete after `finish`, and `publish` and
    /// `undo` have no effect.
    bool is_direct() const noexcept;
    /// Flushes to the disk and closes. Further calls have no effect. Throws like `commit`.
    void finish();
    /// Renames and keeps the earlier target for `undo`. Throws InputError; call `undo` then as well.
    void publish();
    /// Restores the earlier target, or removes the new one if there was none.
    void undo() noexcept;
    /// Removes the earlier target that `publish` kept.
    void keep() noexcept;

  private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// A file that is written continuously, for work that a user ends or that runs for days. Flushed data remains
/// even if the program is aborted.
class GrowingFile {
  public:
    /// Creates the file, or empties it. Throws InputError with the path and the system's reason.
    explicit GrowingFile(const std::filesystem::path& target);
    ~GrowingFile();
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;

    /// As in AtomicFile.
    std::ostream& stream() noexcept;

  private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Throws InputError under the same conditions as the constructor of AtomicFile for `target`, so that long
/// work fails before it begins. Leaves no file behind, and does not open pipes and devices.
void check_writable(const std::filesystem::path& target);

/// Throws InputError unless `folder` is a folder in which files can be written, or can be created as one.
/// Leaves nothing behind.
void check_folder(const std::filesystem::path& folder);

/// Creates `folder` and its parents if they do not exist. Throws InputError with path and reason.
void make_folder(const std::filesystem::path& folder);

/// Writes `content` as the whole of the file `target`, with the guarantees of AtomicFile.
void write_file(const std::filesystem::path& target, std::string_view content);

} // namespace dfdyn::tools
