// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace dfdyn::tools {

/// Returns the name of an input for a message: the path as in `shown`, or `standard input` for `-`.
std::string shown_input(const std::filesystem::path& path);

/// Bytes of a file, pipe, device or, for the path `-`, of standard input. Content compressed with gzip is
/// decompressed, independent of its name.
class ByteSource {
  public:
    /// Opens `path`. Throws InputError with the system's reason if it cannot be opened.
    explicit ByteSource(const std::filesystem::path& path);
    ~ByteSource();
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    /// Writes the next bytes to `buffer`, which must not be empty. Returns their number; 0 at the end. Throws
    /// InputError if the system cannot read, and for damaged or incomplete compressed content.
    std::size_t read(std::span<char> buffer);

  private:
    struct Inflater;

    std::size_t read_raw(std::span<char> buffer);
    std::size_t read_inflated(std::span<char> buffer);
    void detect_compression();

    std::filesystem::path path_;
    int descriptor_;
    std::unique_ptr<Inflater> inflater_; ///< empty: not compressed
    std::string first_;                  ///< bytes that were read to detect the compression
    bool started_ = false;
};

} // namespace dfdyn::tools
