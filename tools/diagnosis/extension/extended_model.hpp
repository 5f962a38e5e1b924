// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <span>

namespace dfdyn::tools {

/// Returns the parametric model (structure P) that starts at the extension's values and continues to adapt.
/// Its parameters are the rigid body's base parameters and the named effects. The prior standard deviations
/// are a tenth for each link's mass and 2 cm for its centre of mass.
///
/// The model reads positions only. Velocities and accelerations are weighted means of the differences of each
/// joint's last positions (up to 0.2 s of them, see mean_difference_row), with the poles that predict
/// `recordings` best. Limits are ten times the recorded maxima. Throws InputError if the recordings are
/// shorter than a window.
TrainedModel extended_model(const ModelExtension& extension, std::span<const Recording> recordings);

} // namespace dfdyn::tools
