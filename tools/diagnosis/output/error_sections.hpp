// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"
#include "tools/report/chart.hpp"
#include "tools/report/figure_page.hpp"

#include <Eigen/Core>

#include <ostream>
#include <string>

namespace dfdyn::tools {

/// Outputs at the rows of the diagnosis, in their units, T x m each.
struct ComparedOutputs {
    Eigen::MatrixXd measured;
    Eigen::MatrixXd simulated; ///< by the rigid body of the robot's file
    Eigen::MatrixXd extended;  ///< DiagnosisWork::extended
};

ComparedOutputs compared_outputs(const DiagnosisWork& work);

/// Writes every row of the comparison as a table: `t`, then per output `tau1`, `tau1_simulated` and
/// `tau1_extended`.
void write_comparison_csv(std::ostream& out, const DiagnosisWork& work);

/// Measured, simulated and extended outputs over a time window, and the errors of both models, per output.
/// `full_data`: name of the file from `write_comparison_csv` in the page's folder; empty: none.
PageSection comparison_section(const DiagnosisWork& work, const std::string& full_data);

/// Returns the root mean square per bin of an output's error (T), up to the highest frequency of its motion
/// that the output answers to.
ChartCurve error_spectrum(const SpectralRows& rows, std::string name, const Eigen::VectorXd& error,
                          Eigen::Index output);

/// Spectra of the errors, whiteness of the residual, and its remaining dependences.
PageSection rest_section(const DiagnosisWork& work);

} // namespace dfdyn::tools
