// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/instant.hpp"

#include "tools/base/text/number.hpp"

#include <array>
#include <cmath>
#include <ctime>

namespace dfdyn::tools {

namespace {

constexpr double first_epoch_s = 1e9;
constexpr double last_epoch_s = 8.64e12; // of the dates that browsers know

} // namespace

bool is_epoch_time(double time_s) { return time_s >= first_epoch_s && time_s < last_epoch_s; }

std::string instant_text(double time_s) {
    if (!is_epoch_time(time_s)) {
        return formatted("%.2f", time_s) + " s";
    }
    const double hundredths = std::round(100 * time_s);
    const double whole_s = std::floor(hundredths / 100);
    const auto seconds = static_cast<std::time_t>(whole_s);
    std::tm date{};
    ::gmtime_r(&seconds, &date);
    std::array<char, 64> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &date);
    return text.data() + formatted(".%02.0f", hundredths - 100 * whole_s) + " UTC";
}

} // namespace dfdyn::tools
