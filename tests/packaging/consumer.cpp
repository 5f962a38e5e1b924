// SPDX-License-Identifier: Apache-2.0
// Uses a header of the library and one of the bus layer.
#include <dfdyn/dfdyn.hpp>
#include <dfdyn/hal/device/odrive.hpp>

using Model =
    dfdyn::Model<float, dfdyn::Joints<2, 2>, dfdyn::DerivativeFreeReduced<4, 2>, dfdyn::RandomFourier<8>>;
static_assert(dfdyn::Estimator<Model>::footprint().state_bytes > 0);

int main() { return 0; }
