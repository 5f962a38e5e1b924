// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/opponents/opponents.hpp"

#include <cmath>

namespace dfdyn::tools {

Forecasts persistence(const ReplayedRecording& replayed, std::size_t outputs) {
    Forecasts forecasts(replayed.measured.size());
    std::vector<double> last(outputs);
    for (std::size_t element = 0; element < forecasts.size(); ++element) {
        double& previous = last[element % outputs];
        forecasts[element] = previous;
        previous = std::isfinite(replayed.measured[element]) ? replayed.measured[element] : previous;
    }
    return forecasts;
}

} // namespace dfdyn::tools
