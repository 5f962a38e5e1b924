// SPDX-License-Identifier: Apache-2.0
#pragma once

// Includes the whole library; each header can also be included by itself.
//
// In all comments "the paper" is D. Romeres, M. Zorzi, R. Camoriano, S. Traversaro and A. Chiuso,
// "Derivative-free online learning of inverse dynamics models", IEEE Trans. Control Systems Technology 28(3),
// 2020.
#include "dfdyn/control/disturbance_observer.hpp"
#include "dfdyn/control/feed_forward.hpp"
#include "dfdyn/control/learned_torque.hpp"
#include "dfdyn/control/learner_pair.hpp"
#include "dfdyn/control/loop_margin.hpp"
#include "dfdyn/control/vibration_watch.hpp"
#include "dfdyn/core/snapshot_writer.hpp"
#include "dfdyn/estimator.hpp"
#include "dfdyn/extrapolation.hpp"
#include "dfdyn/features/random_fourier.hpp"
#include "dfdyn/forecast_combination.hpp"
#include "dfdyn/input/derivative_free.hpp"
#include "dfdyn/input/derivative_free_reduced.hpp"
#include "dfdyn/input/derivative_free_structured.hpp"
#include "dfdyn/input/standard.hpp"
#include "dfdyn/learner/ud_covariance.hpp"
#include "dfdyn/model.hpp"
#include "dfdyn/monitor/contact_calibration.hpp"
#include "dfdyn/monitor/contact_detector.hpp"
#include "dfdyn/monitor/monitor.hpp"
#include "dfdyn/physics/effects.hpp"
#include "dfdyn/physics/physics.hpp"
#include "dfdyn/physics/rigid_body.hpp"
#include "dfdyn/structure/parametric.hpp"
#include "dfdyn/structure/semiparametric_kernel.hpp"
#include "dfdyn/structure/semiparametric_mean.hpp"
