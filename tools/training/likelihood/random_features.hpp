// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <cstdint>

namespace dfdyn::tools {

/// Draws d = `count` frequencies of `inputs` elements (paper, Section IV-A). Plain: independent N(0, 1).
/// `orthogonal`: in blocks of `inputs` rows that are orthogonal to each other, with uniformly random
/// directions and the lengths of independent rows. Each row is still N(0, I), and the kernel's error is
/// smaller. Equal seeds give equal frequencies.
FeatureModel draw_features(int count, int inputs, bool orthogonal, double length_scale, std::uint64_t seed);

/// phi = [cos(omega xi / l); sin(omega xi / l)] / sqrt(d) for each row xi of `inputs` (N x n k): N x 2d.
Eigen::MatrixXd random_features(const FeatureModel& model, const Eigen::MatrixXd& inputs);

} // namespace dfdyn::tools
