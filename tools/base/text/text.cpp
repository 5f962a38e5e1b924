// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <system_error>

namespace dfdyn::tools {
namespace {

constexpr std::size_t longest_quote = 40;
constexpr std::size_t longest_list = 30;

enum class Letters { ascii, any };

/// Returns `text` with control characters as \xNN. If only ASCII is allowed, all bytes outside it are
/// converted as well.
std::string escaped(std::string_view text, Letters letters) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string out;
    for (const char character : text) {
        const auto byte = static_cast<unsigned char>(character);
        if (byte < 0x20 || byte == 0x7f || (byte >= 0x80 && letters == Letters::ascii)) {
            out += {'\\', 'x', digits[byte / 16U], digits[byte % 16U]};
        } else {
            out += character;
        }
    }
    return out;
}

std::string shortened(std::string_view text) {
    return escaped(text.substr(0, longest_quote), Letters::ascii) +
           (text.size() > longest_quote ? "..." : "");
}

} // namespace

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

std::string shown(const std::filesystem::path& path) { return escaped(path.native(), Letters::any); }

std::string shell_word(std::string_view text) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:@%=";
    if (!text.empty() && text.find_first_not_of(plain) == std::string_view::npos) {
        return std::string(text);
    }
    std::string quoted = "'";
    for (const char character : text) {
        quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
    }
    return quoted + "'";
}

std::string listed(std::span<const std::string> names) {
    std::string out;
    for (const std::string& name : names.first(std::min(names.size(), longest_list))) {
        out += (out.empty() ? "" : ", ") + shortened(name);
    }
    if (names.size() > longest_list) {
        out += ", ... (" + std::to_string(names.size()) + " in all)";
    }
    return out;
}

std::string counted_from_one(std::span<const std::size_t> indices) {
    std::string text;
    for (const std::size_t index : indices) {
        text += (text.empty() ? "" : ", ") + std::to_string(index + 1);
    }
    return text;
}

std::string_view trimmed(std::string_view text) noexcept {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

InputError system_error(const std::filesystem::path& path, std::string_view cannot, int error_number) {
    return InputError(shown(path) + ": " + std::string(cannot) + ": " +
                      std::system_category().message(error_number));
}

} // namespace dfdyn::tools
