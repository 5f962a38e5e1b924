// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <cstdint>

namespace dfdyn::tools {

/// Draws d = `count` frequencies of `inputs` elements (sections "Kernel approximation"). Plain: independent
/// N(0, 1). `orthogonal`: in blocks of `inputs` rows that are orthogonal to each other, in uniformly random
/// directions and with the lengths that independent rows would have: each row alone is still N(0, I), the
/// kernel's error is smaller. The same for the same seed.
FeatureModel draw_features(int count, int inputs, bool orthogonal, double length_scale, std::uint64_t seed);

/// phi = [cos(omega xi / l); sin(omega xi / l)] / sqrt(d) for each row xi of `inputs` (N x n k): N x 2d.
Eigen::MatrixXd random_features(const FeatureModel& model, const Eigen::MatrixXd& inputs);

} // namespace dfdyn::tools
