// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/contact_pulse.hpp"

#include "tools/base/text/number.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

std::vector<EffectParameter> contact_parameters(const ContactPulse& pulse, const std::string& unit,
                                                const Eigen::VectorXd& components) {
    std::vector values{contact_start.at(pulse.start_s), contact_end.at(pulse.end_s),
                       contact_peak.at(components.size() == 1 ? components[0] : components.norm())};
    values.back().unit = unit;
    for (std::size_t axis = 0; components.size() > 1 && axis < contact_direction.size(); ++axis) {
        values.push_back(
            contact_direction[axis].at(components[static_cast<Eigen::Index>(axis)] / components.norm()));
    }
    return values;
}

std::string start_words(const ContactPulse& pulse) { return formatted("%.2f s", pulse.start_s); }

double pulse_at(const ContactPulse& pulse, double time_s) {
    const double inside = std::min(time_s - pulse.start_s, pulse.end_s - time_s);
    return (1 - std::cos(std::numbers::pi * std::clamp(inside / pulse.rise_s, 0.0, 1.0))) / 2;
}

Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse) {
    return signals.measured.time_s.unaryExpr([&](double time_s) { return pulse_at(pulse, time_s); });
}

} // namespace dfdyn::tools
