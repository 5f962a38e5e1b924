// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_csv.hpp"

#include <utility>

namespace dfdyn::tools {

namespace {

std::vector<std::string> column_names(const TrainedModel& model) {
    std::vector<std::string> names{"t"};
    for (const std::string& output : model.outputs.names) {
        names.insert(names.end(), {output, output + "_pred", output + "_std"});
    }
    names.insert(names.end(), {"nis", "learned", "status"});
    return names;
}

void write_row(CsvWriter& writer, const ReplayedRecording& recording, std::size_t tick, std::size_t outputs) {
    writer.field(recording.time_s[tick]);
    for (std::size_t element = tick * outputs; element < (tick + 1) * outputs; ++element) {
        writer.field(recording.measured[element])
            .field(static_cast<double>(recording.predicted[element]))
            .field(static_cast<double>(recording.standard_deviation[element]));
    }
    const Status& status = recording.status[tick];
    writer.field(static_cast<double>(recording.normalised_innovation_squared[tick]))
        .field(status.learned() ? 1 : 0)
        .name(reason_name(recording, tick));
    writer.end_row();
}

} // namespace

void write_replay_csv(std::ostream& out, const TrainedModel& model,
                      std::span<const ReplayedRecording> recordings) {
    CsvWriter writer(out, column_names(model));
    for (const ReplayedRecording& recording : recordings) {
        for (std::size_t tick = 0; tick < recording.time_s.size(); ++tick) {
            write_row(writer, recording, tick, model.outputs.names.size());
        }
    }
}

ReplayCsvFile::ReplayCsvFile(std::filesystem::path path, const TrainedModel& model)
    : path_(std::move(path)), model_(model) {}

void ReplayCsvFile::take(const ReplayedRecording& replayed, std::size_t tick) {
    if (!writer_) {
        file_.emplace(path_);
        writer_.emplace(file_->stream(), column_names(model_));
    }
    write_row(*writer_, replayed, tick, model_.outputs.names.size());
}

void ReplayCsvFile::flush() {
    if (file_) {
        file_->stream().flush();
    }
}

} // namespace dfdyn::tools
