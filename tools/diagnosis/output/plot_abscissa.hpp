// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <Eigen/Core>

#include <string>

namespace dfdyn::tools {

/// Abscissa for the plot of a finding's contribution to an output: velocity for friction, the angle within a
/// turn for periodic effects, load, time, … If an effect depends on several inputs, the abscissa is the
/// contribution itself, so that a correct cause lies on the diagonal.
struct PlotAbscissa {
    std::string label;
    Eigen::VectorXd value;             ///< T
    Eigen::Index first = 0, count = 0; ///< the rows to draw
    bool time = false;                 ///< drawn as a line over time
};

/// A finding and the signals for its plot.
struct PlottedFinding {
    const DiagnosisSignals& signals;
    const Finding& finding;
    const Eigen::VectorXd& share; ///< T: contribution to its output

    /// Returns the index of the finding's joint (`jointK`, `encoderK`), from 0. Throws
    /// std::bad_optional_access for a place without a number.
    Eigen::Index joint() const;
    /// Returns `velocity of joint 2 (rad/s)`. `unit`: at a revolute joint.
    std::string named(const char* what, const char* unit) const;
    /// value of a parameter; 0 if the finding has none with this name
    double parameter(const char* name) const;
    /// Returns the abscissa `value` (T) with all rows.
    PlotAbscissa whole(std::string label, Eigen::VectorXd value) const;
};

/// The parameter with the number of cycles per turn; a finding without it repeats once per turn.
inline constexpr const char* cycles_per_turn = "cycles_per_rev";

// Abscissas that several effects share.
PlotAbscissa over_velocity(const PlottedFinding& at);
PlotAbscissa over_position(const PlottedFinding& at);
PlotAbscissa over_time(const PlottedFinding& at);
PlotAbscissa over_load(const PlottedFinding& at);
PlotAbscissa over_output(const PlottedFinding& at);
/// The angle within one turn, or the part of it that the joint covers. For a ripple with many cycles, the
/// angle within one cycle, because a whole turn would be illegible.
PlotAbscissa over_angle(const PlottedFinding& at);

/// Returns the abscissa for the finding's effect. `share` (T): contribution of the finding to its output.
PlotAbscissa plot_abscissa(const DiagnosisSignals& signals, const Finding& finding,
                           const Eigen::VectorXd& share);

} // namespace dfdyn::tools
