// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace dfdyn::tools {

/// Replay speed of a long recording: six joints and six outputs at 1 kHz, model NP with input DFR and 2d =
/// 200 columns, as in `dfdyn replay` of a CSV file, including the error index. CPU times.
struct HourBench {
    std::size_t rows = 0;
    double read_s = 0;       ///< reading the file
    double replay_s = 0;     ///< ticks, and the index over 25 samples
    double ticks_only_s = 0; ///< ticks without the index
    std::size_t learned = 0;

    double recorded_s() const { return static_cast<double>(rows) / 1000; }
    double times_real_time() const { return recorded_s() / (read_s + replay_s); }
};

/// Writes a recording with `rows` rows of 260 bytes to the folder for temporary files, reads and replays it,
/// and removes it. Throws InputError if it cannot be written.
HourBench run_hour_bench(std::size_t rows, const std::function<void(double)>& on_share_done);

} // namespace dfdyn::tools
