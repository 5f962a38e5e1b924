// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <span>

namespace dfdyn::tools {

/// The parametric model (structure P) that starts at the extension's values and goes on adapting: the rigid
/// body's base parameters, each link's mass a tenth uncertain and its centre 2 cm, and the named effects. It
/// sees positions only: velocities and accelerations are weighted means of the differences of each joint's
/// last positions (up to 0.2 s of them, see mean_difference_row), with the poles that predict `recordings`
/// best. Limits are ten times what the recordings show. Throws InputError where the recordings are shorter
/// than a window.
TrainedModel extended_model(const Extension& extension, std::span<const Recording> recordings);

} // namespace dfdyn::tools
