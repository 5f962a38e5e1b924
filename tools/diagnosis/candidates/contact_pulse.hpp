// SPDX-License-Identifier: Apache-2.0
// The course of a contact over time.
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A contact pulse from start to end, which rises and falls within `rise_s`.
struct ContactPulse {
    double start_s = 0, end_s = 0, rise_s = 0;
};

/// Lengths of the pulses in the search, and the share of a pulse during which it rises, and falls.
inline constexpr std::array push_lengths_s{0.5, 0.75, 1.1, 1.7, 2.5, 3.75, 5.5};
inline constexpr double push_flanks = 0.3;

/// Values of a pulse with height one, at one time and over the recording (T).
double pulse_at(const ContactPulse& pulse, double time_s);
Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse);

/// The catalogue's parameters of a contact.
inline constexpr ParameterKind contact_start{"start", "s", std::nullopt};
inline constexpr ParameterKind contact_end{"end", "s", std::nullopt};
inline constexpr ParameterKind contact_peak{"peak", "N·m, N"}; ///< at a joint, at the tip
inline constexpr std::array contact_direction{ParameterKind{"base_x", "1"}, ParameterKind{"base_y", "1"},
                                              ParameterKind{"base_z", "1"}};

/// Returns these parameters, from the magnitudes of a site's components.
std::vector<EffectParameter> contact_parameters(const ContactPulse& pulse, const std::string& unit,
                                                const Eigen::VectorXd& components);

/// Returns a text that distinguishes contacts at one site: `16.20 s`.
std::string start_words(const ContactPulse& pulse);

} // namespace dfdyn::tools
