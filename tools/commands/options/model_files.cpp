// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/model_files.hpp"

#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/header/model_header.hpp"

#include <vector>

namespace dfdyn::tools {

std::string checked_json(const TrainedModel& model, const std::filesystem::path& path) {
    std::string content = model_to_json(model);
    model_from_json(content, shown(path));
    return content;
}

void add_model(FileSet& files, const TrainedModel& model, const std::filesystem::path& json,
               const std::filesystem::path& header) {
    files.add(json, checked_json(model, json));
    if (!header.empty()) {
        files.add(header, model_to_header(model, to_identifier(header.stem().string())));
    }
}

void describe_reading(const RecordingOptions& recordings, const std::optional<Robot>& robot,
                      TrainedModel& model) {
    TrainingRecord& record = model.training;
    record.rows = recordings.rows;
    record.columns = recordings.columns;
    record.units = recordings.units;
    record.joint_names = robot ? names_of_joints(*robot) : std::vector<std::string>{};
}

} // namespace dfdyn::tools
