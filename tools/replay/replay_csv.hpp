// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/csv_writer.hpp"
#include "tools/base/system/atomic_file.hpp"
#include "tools/replay/replay.hpp"

#include <filesystem>
#include <optional>
#include <ostream>
#include <span>

namespace dfdyn::tools {

/// Writes one row per tick: `t`, then for each output its measured value, prediction and standard deviation
/// (`tau1`, `tau1_pred`, `tau1_std`), `nis`, `learned` (0 or 1), `status`. Values without a prediction are
/// nan. Recordings follow each other, and t restarts at the beginning of each.
void write_replay_csv(std::ostream& out, const TrainedModel& model,
                      std::span<const ReplayedRecording> recordings);

/// Writes such a table tick by tick. The file is created with the first tick; flushed rows remain even if the
/// program is aborted. Keeps a reference to `model`.
class ReplayCsvFile final : public TickSink {
  public:
    ReplayCsvFile(std::filesystem::path path, const TrainedModel& model);

    void take(const ReplayedRecording& replayed, std::size_t tick) override;
    void flush() override;

  private:
    std::filesystem::path path_;
    const TrainedModel& model_;
    std::optional<GrowingFile> file_;
    std::optional<CsvWriter> writer_;
};

} // namespace dfdyn::tools
