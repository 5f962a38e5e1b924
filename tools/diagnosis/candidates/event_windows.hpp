// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <functional>
#include <vector>

namespace dfdyn::tools {

/// A time window that may contain an event.
struct EventWindow {
    double score = 0; ///< evidence for an event in this window
    double start_s = 0, end_s = 0;
};

/// Returns the best window of each event, in descending order of score. Windows closer than `apart_s` belong
/// to the same event.
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
