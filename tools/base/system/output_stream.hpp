// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <streambuf>
#include <utility>

namespace dfdyn::tools {

// Common parts of AtomicFile and of files that are written continuously.

/// Buffer for a file descriptor. Throws InputError about `path` if the system rejects a write.
class DescriptorBuffer : public std::streambuf {
  public:
    explicit DescriptorBuffer(std::filesystem::path path) : path_(std::move(path)) { reset(); }

    void attach(int descriptor) noexcept { descriptor_ = descriptor; }

  protected:
    int_type overflow(int_type character) override {
        drain();
        if (!traits_type::eq_int_type(character, traits_type::eof())) {
            sputc(traits_type::to_char_type(character));
        }
        return traits_type::not_eof(character);
    }

    int sync() override {
        drain();
        return 0;
    }

  private:
    void reset() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }

    void drain();

    std::filesystem::path path_;
    int descriptor_ = -1;
    std::array<char, 1U << 16U> buffer_{};
};

/// Ignores SIGXFSZ, so that a write beyond `ulimit -f` fails with a reason instead of ending the program.
void ignore_file_size_signal();

/// Throws InputError if `target` is `-`: recordings are read from it, but nothing is written to it.
void refuse_dash(const std::filesystem::path& target);

/// Throws InputError if there is no folder for the file `target`.
void require_parent(const std::filesystem::path& target);

} // namespace dfdyn::tools
