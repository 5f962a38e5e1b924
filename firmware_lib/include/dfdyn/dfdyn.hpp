// SPDX-License-Identifier: Apache-2.0
#pragma once

// Everything an embedding needs; each header also stands alone.
#include "dfdyn/estimator.hpp"
#include "dfdyn/extrapolation.hpp"
#include "dfdyn/features/random_fourier.hpp"
#include "dfdyn/forecast_combination.hpp"
#include "dfdyn/input/derivative_free.hpp"
#include "dfdyn/input/derivative_free_reduced.hpp"
#include "dfdyn/input/derivative_free_structured.hpp"
#include "dfdyn/input/standard.hpp"
#include "dfdyn/learner/cholesky_information.hpp"
#include "dfdyn/learner/ud_covariance.hpp"
#include "dfdyn/model.hpp"
#include "dfdyn/physics/effects.hpp"
#include "dfdyn/physics/physics.hpp"
#include "dfdyn/physics/rigid_body.hpp"
#include "dfdyn/snapshot_writer.hpp"
#include "dfdyn/structure/parametric.hpp"
#include "dfdyn/structure/semiparametric_kernel.hpp"
#include "dfdyn/structure/semiparametric_mean.hpp"
