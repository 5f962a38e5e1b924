// SPDX-License-Identifier: Apache-2.0
// Declarations that the documentation's C++ requires: the user's functions, and a model of the user's arm.
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "examples/ur5/ur5_model.hpp"

#include <array>
#include <cstdint>

namespace robot_model = ur5_model;
namespace arm = ur5_model;

using Estimator = dfdyn::Estimator<ur5_model::Model>;

inline dfdyn::Sample<float, 6, 6> sample;
inline constexpr dfdyn::Budget budget{1000};
void report(const char* name);

inline constexpr std::int64_t period_ns = 1'000'000;
inline constexpr int ticks_per_sample = 8;
using Six = dfdyn::Storage<float, 6>;
inline constexpr Six ten{{10, 10, 10, 10, 10, 10}};
inline constexpr dfdyn::FeedForwardSettings<float, 6> forward_settings{
    .period_ns = period_ns, .ticks_per_sample = ticks_per_sample, .limit = ten, .cap = ten, .rate = ten};
std::int64_t clock_ns();
const float* encoders_rad();
dfdyn::Reference<float, 6> reference();
const float* nominal_effort();
const float* feedback();
bool send(const Six& feed, const float* feedback, Six& effort);
