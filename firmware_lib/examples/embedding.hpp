// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Runs the embedding example from its start. `after_tick`, where given, is called after each tick of the
/// estimator, so that the caller can measure. Returns 0 when the outcome is as expected; prints nothing,
/// allocates nothing.
int run_example(void (*after_tick)() = nullptr);
