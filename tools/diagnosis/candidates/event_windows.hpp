// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <functional>
#include <vector>

namespace dfdyn::tools {

/// A stretch of time in which something may have happened.
struct EventWindow {
    double score = 0; ///< how much speaks for it
    double start_s = 0, end_s = 0;
};

/// The best window of each event, the best event first; windows closer than `apart_s` tell of the same one.
template <std::derived_from<EventWindow> Window>
std::vector<Window> events_of(std::vector<Window> windows, double apart_s) {
    std::ranges::sort(windows, std::greater<>{}, &Window::score);
    std::vector<Window> events;
    for (const Window& window : windows) {
        if (std::ranges::none_of(events, [&](const EventWindow& one) {
                return one.start_s < window.end_s + apart_s && window.start_s < one.end_s + apart_s;
            })) {
            events.push_back(window);
        }
    }
    return events;
}

} // namespace dfdyn::tools
