// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/chunk.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <memory>

#ifdef DFDYN_HAVE_LZ4
#include <lz4frame.h>
#endif
#ifdef DFDYN_HAVE_ZSTD
#include <zstd.h>
#endif

namespace dfdyn::tools {

namespace {

using Bytes = std::vector<std::byte>;

InputError damaged(const std::string& what, std::string_view compression) {
    return InputError(what + ": expected " + std::string(compression) + " data of the chunk's size, found " +
                      "damaged data");
}

[[maybe_unused]] InputError missing(const std::string& what, std::string_view compression,
                                    const char* package) {
    return InputError(what + ": expected a program built with " + package + " for chunks compressed with " +
                      std::string(compression) + ", found one without it");
}

Bytes lz4_content(std::span<const std::byte> content, std::size_t size, const std::string& what) {
#ifdef DFDYN_HAVE_LZ4
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) {
        throw damaged(what, "lz4");
    }
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
        context, &LZ4F_freeDecompressionContext);
    Bytes result(size);
    std::size_t read = 0;
    std::size_t written = 0;
    std::size_t hint = 1;
    while (hint != 0) {
        std::size_t in = content.size() - read;
        std::size_t out = size - written;
        hint = LZ4F_decompress(context, result.data() + written, &out, content.data() + read, &in, nullptr);
        if (LZ4F_isError(hint) != 0U || (in == 0 && out == 0 && hint != 0)) {
            throw damaged(what, "lz4");
        }
        read += in;
        written += out;
    }
    if (written != size) {
        throw damaged(what, "lz4");
    }
    return result;
#else
    (void)content, (void)size;
    throw missing(what, "lz4", "liblz4-dev");
#endif
}

Bytes zstd_content(std::span<const std::byte> content, std::size_t size, const std::string& what) {
#ifdef DFDYN_HAVE_ZSTD
    Bytes result(size);
    if (ZSTD_decompress(result.data(), size, content.data(), content.size()) != size) {
        throw damaged(what, "zstd");
    }
    return result;
#else
    (void)content, (void)size;
    throw missing(what, "zstd", "libzstd-dev");
#endif
}

} // namespace

Bytes decompressed_chunk(std::span<const std::byte> content, std::string_view compression, std::uint64_t size,
                         const std::string& what) {
    constexpr std::uint64_t largest_ratio = 10'000; // beyond what messages of numbers compress to
    constexpr std::uint64_t largest_size = std::uint64_t{1} << 30U;
    if (compression.empty()) {
        return {content.begin(), content.end()};
    }
    if (size > largest_size || size > largest_ratio * content.size()) {
        throw InputError(what + ": expected a chunk of at most " +
                         std::to_string(std::min(largest_size, largest_ratio * content.size())) +
                         " bytes, found a size of " + std::to_string(size));
    }
    if (compression == "lz4") {
        return lz4_content(content, static_cast<std::size_t>(size), what);
    }
    if (compression == "zstd") {
        return zstd_content(content, static_cast<std::size_t>(size), what);
    }
    throw InputError(what + ": expected a chunk without compression, or with lz4 or zstd, found " +
                     in_quotes(compression));
}

} // namespace dfdyn::tools
