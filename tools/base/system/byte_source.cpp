// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/byte_source.hpp"

#include "tools/base/system/read_file.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>
#include <utility>
#include <zlib.h>

namespace dfdyn::tools {
namespace {

constexpr std::string_view gzip_magic = "\x1f\x8b";
constexpr std::size_t inflate_size = std::size_t{1} << 16U;

/// Returns the path for a message.
std::filesystem::path input_name(const std::filesystem::path& path) {
    return path == "-" ? "standard input" : path;
}

int open_input(const std::filesystem::path& path) {
    const int descriptor =
        path == "-" ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        throw input_error(input_name(path), "cannot open", errno);
    }
    return descriptor;
}

} // namespace

std::string shown_input(const std::filesystem::path& path) { return shown(input_name(path)); }

/// State of the decompression; the compressed bytes that are not used yet are in `input`.
struct ByteSource::Inflater {
    z_stream stream{};
    std::array<char, inflate_size> input{};
    bool member_ended = false; ///< a file may have several members, one after the other
    bool ended = false;

    explicit Inflater(std::string_view first) {
        std::ranges::copy(first, input.begin());
        set_input(first.size());
        constexpr int gzip_window = 15 + 16; // largest window, gzip header required
        ::inflateInit2(&stream, gzip_window);
    }
    ~Inflater() { ::inflateEnd(&stream); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    void set_input(std::size_t size) {
        stream.next_in = reinterpret_cast<Bytef*>(input.data());
        stream.avail_in = static_cast<uInt>(size);
    }
};

ByteSource::ByteSource(const std::filesystem::path& path) : path_(path), descriptor_(open_input(path)) {}

ByteSource::~ByteSource() { ::close(descriptor_); }

std::size_t ByteSource::read(std::span<char> buffer) {
    if (!started_) {
        detect_compression();
    }
    if (inflater_ != nullptr) {
        return read_inflated(buffer);
    }
    if (first_.empty()) {
        return read_raw(buffer);
    }
    const std::size_t count = std::min(first_.size(), buffer.size());
    std::copy_n(first_.begin(), count, buffer.begin());
    first_.erase(0, count);
    return count;
}

std::size_t ByteSource::read_raw(std::span<char> buffer) {
    ssize_t count = 0;
    do {
        count = ::read(descriptor_, buffer.data(), buffer.size());
    } while (count < 0 && errno == EINTR);
    if (count < 0) {
        throw system_error(input_name(path_), "cannot read", errno);
    }
    return static_cast<std::size_t>(count);
}

void ByteSource::detect_compression() {
    started_ = true;
    std::array<char, gzip_magic.size()> bytes{};
    while (first_.size() < gzip_magic.size()) {
        const std::size_t count = read_raw(std::span(bytes).first(gzip_magic.size() - first_.size()));
        if (count == 0) {
            return;
        }
        first_.append(bytes.data(), count);
    }
    if (first_ == gzip_magic) {
        inflater_ = std::make_unique<Inflater>(first_);
    }
}

std::size_t ByteSource::read_inflated(std::span<char> buffer) {
    Inflater& state = *inflater_;
    state.stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    state.stream.avail_out = static_cast<uInt>(std::min<std::size_t>(buffer.size(), inflate_size));
    const uInt room = state.stream.avail_out;
    while (!state.ended && state.stream.avail_out == room) {
        if (state.stream.avail_in == 0) {
            state.set_input(read_raw(state.input));
        }
        if (state.stream.avail_in == 0) {
            if (!state.member_ended) {
                throw InputError(shown_input(path_) +
                                 ": expected complete gzip data, found the end of the file within it");
            }
            state.ended = true;
            break;
        }
        if (std::exchange(state.member_ended, false)) {
            ::inflateReset(&state.stream);
        }
        const int result = ::inflate(&state.stream, Z_NO_FLUSH);
        state.member_ended = result == Z_STREAM_END;
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) {
            throw InputError(shown_input(path_) + ": expected gzip data, found damaged data" +
                             (state.stream.msg != nullptr ? std::string(" (") + state.stream.msg + ")" : ""));
        }
    }
    return room - state.stream.avail_out;
}

} // namespace dfdyn::tools
