// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/model_files.hpp"

#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/header/model_header.hpp"

#include <string>

namespace dfdyn::tools {

void add_model(FileSet& files, const TrainedModel& model, const std::filesystem::path& json,
               const std::filesystem::path& header) {
    const std::string content = model_to_json(model);
    model_from_json(content, shown(json)); // nothing is written that `replay` would reject
    files.add(json, content);
    if (!header.empty()) {
        files.add(header, model_to_header(model, to_identifier(header.stem().string())));
    }
}

} // namespace dfdyn::tools
