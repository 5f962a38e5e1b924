// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <Eigen/Core>

#include <string>

namespace dfdyn::tools {

/// What a finding's share of an output is drawn over: velocity for friction, the angle within a turn for what
/// repeats with it, load, time, … Where an effect depends on several inputs at once, the share itself, so
/// that a right cause lies on the diagonal.
struct ExplainingVariable {
    std::string label;
    Eigen::VectorXd value;             ///< T
    Eigen::Index first = 0, count = 0; ///< the rows that are worth drawing
    bool time = false;                 ///< drawn as a line over time
};

/// A finding and what there is to plot it over.
struct PlottedFinding {
    const DiagnosisSignals& signals;
    const Finding& finding;
    const Eigen::VectorXd& share; ///< T: what it gives on its output

    Eigen::Index joint() const;                ///< of `jointK`, from 0
    std::string named(const char* what) const; ///< `velocity of joint 2`
    double parameter(const char* name) const;  ///< 0 where it has none of this name
    /// All rows of `value` (T).
    ExplainingVariable whole(std::string label, Eigen::VectorXd value) const;
};

/// The parameter of a finding that repeats so many times in a turn; once where there is none.
inline constexpr const char* cycles_per_turn = "cycles_per_rev";

// Variables that several effects are plotted over.
ExplainingVariable over_velocity(const PlottedFinding& at);
ExplainingVariable over_position(const PlottedFinding& at);
ExplainingVariable over_time(const PlottedFinding& at);
ExplainingVariable over_load(const PlottedFinding& at);
ExplainingVariable over_output(const PlottedFinding& at);
/// One turn, or what the joint covers of it; for a fine ripple one wave of it, which a turn would show as a
/// blur.
ExplainingVariable over_angle(const PlottedFinding& at);

/// The variable of the finding's effect. `share` (T): what the finding gives on its output.
ExplainingVariable explaining_variable(const DiagnosisSignals& signals, const Finding& finding,
                                       const Eigen::VectorXd& share);

} // namespace dfdyn::tools
