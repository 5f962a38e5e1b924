// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/identification/fit_parameters.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Estimate of a robot's inertial parameters from a recording.
struct Identification {
    OutputKind outputs = OutputKind::joint_torque;
    std::vector<std::string> output_names;
    Eigen::Index samples = 0;
    BaseParameters base;
    std::vector<std::string> base_names, base_units; ///< per base parameter
    BaseFit fit;
    std::optional<Eigen::VectorXd> consistent; ///< all parameters, of physically consistent bodies
    /// Residuals per output for the nominal, the fitted and, if present, the consistent parameters.
    Eigen::VectorXd rms_nominal, rms_fitted, rms_consistent;
};

/// Identifies the parameters that influence the outputs of `motion`.
Identification identify(const Robot& robot, OutputKind outputs, const RecordedMotion& recorded,
                        std::vector<std::string> output_names, bool consistent);

/// Returns the identification as JSON, schema `dfdyn.parameters/1`.
nlohmann::ordered_json identification_json(const Robot& robot, const Identification& identification);

} // namespace dfdyn::tools
