// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan_names.hpp"

#include <cctype>

namespace dfdyn::tools {

std::string plain_name(const JsonReader& reader, const std::string& name) {
    const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
    std::string text = reader.text(name);
    if (text.empty() || !std::ranges::all_of(text, plain)) {
        throw reader.error(name, "letters, digits, - and _", in_quotes(text));
    }
    return text;
}

std::vector<std::string> names_in(const JsonReader& reader, const std::string& name) {
    constexpr int most = 1000;
    return reader.is_array(name) ? reader.texts(name, most) : std::vector{reader.text(name)};
}

} // namespace dfdyn::tools
