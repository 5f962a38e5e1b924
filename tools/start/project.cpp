// SPDX-License-Identifier: Apache-2.0
#include "tools/start/project.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/file_set.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/header/model_header.hpp"
#include "tools/model/output_units.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/replay/replay.hpp"
#include "tools/start/embedded_files.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <system_error>

namespace dfdyn::tools {

namespace {

constexpr std::size_t predicted_ticks = 100;

/// Files of the examples for bare cores that the project uses.
constexpr std::array<std::string_view, 9> board_files{"systick.hpp",
                                                      "image.ld",
                                                      "startup.cpp",
                                                      "semihosting.cpp",
                                                      "semihosting.hpp",
                                                      "instruction_counter.cpp",
                                                      "instruction_counter.hpp",
                                                      "report.hpp",
                                                      "stack_watermark.hpp"};

/// Templates and their places in the project.
constexpr std::array<std::array<std::string_view, 2>, 4> templates{{
    {"CMakeLists.txt.in", "CMakeLists.txt"},
    {"replay_ticks.hpp.in", "src/replay_ticks.hpp"},
    {"main.cpp.in", "src/main.cpp"},
    {"application.cpp.in", "cortex_m/application.cpp"},
}};

/// Ticks for the project, and the prediction of the last one.
struct CheckedTicks {
    std::size_t rows = 0;
    std::vector<float> last_prediction;
};

CheckedTicks checked_ticks(const TrainedModel& model, const Recording& recording) {
    const auto estimator = make_estimator(model, false);
    CheckedTicks ticks;
    std::size_t predicted = 0;
    for (; ticks.rows < recording.row_count() && predicted < predicted_ticks; ++ticks.rows) {
        const Tick tick = estimator->tick(sample_at(recording, ticks.rows));
        if (tick.status.predicted()) {
            ++predicted;
            ticks.last_prediction.assign(tick.prediction.begin(), tick.prediction.end());
        }
    }
    ticks.last_prediction.resize(model.outputs.names.size());
    return ticks;
}

void write_numbers(std::ostream& out, std::span<const double> numbers) {
    std::string_view separator = "{";
    for (const double number : numbers) {
        out << separator << number_text(static_cast<double>(static_cast<float>(number)));
        separator = ", ";
    }
    out << '}';
}

void write_texts(std::ostream& out, const char* name, const std::vector<std::string>& texts) {
    out << "[[maybe_unused]] inline constexpr const char* " << name << "[] = {";
    for (const std::string& text : texts) {
        out << '"' << text << "\", ";
    }
    out << "};\n";
}

std::string ticks_header(const TrainedModel& model, const Recording& recording) {
    const CheckedTicks ticks = checked_ticks(model, recording);
    std::ostringstream header;
    header << "// Rows of the recording that were not used for training, and the last prediction of `dfdyn "
              "replay`.\n"
           << "// clang-format off\n#pragma once\n\n#include \"robot_model.hpp\"\n\n#include <cstdint>\n\n"
           << "struct RecordedTick {\n    std::int64_t time_ns;\n"
           << "    float position[robot_model::Model::joints]; // rad (m for prismatic joints)\n"
           << "    float output[robot_model::Model::outputs];\n};\n\n";
    write_texts(header, "output_names", model.outputs.names);
    write_texts(header, "output_units", output_units(model));
    header << "inline constexpr float expected_prediction[robot_model::Model::outputs] = ";
    write_numbers(header, std::vector<double>(ticks.last_prediction.begin(), ticks.last_prediction.end()));
    header << ";\n\ninline constexpr RecordedTick recorded_ticks[] = {\n";
    for (std::size_t row = 0; row < ticks.rows; ++row) {
        header << "    {" << recording.time_ns[row] << ", ";
        write_numbers(header, recording.position.row(row));
        header << ", ";
        write_numbers(header, recording.output.row(row));
        header << "},\n";
    }
    header << "};\n";
    return header.str();
}

/// Returns the embedded files whose path begins with `prefix`, under `place`.
void copy_embedded(FolderContent& content, std::string_view prefix, const std::string& place) {
    for (const EmbeddedFile& file : embedded_files()) {
        if (file.path.starts_with(prefix)) {
            content[place + std::string(file.path.substr(prefix.size()))] = file.content;
        }
    }
}

} // namespace

FolderContent project_files(const TrainedModel& model, std::span<const Recording> recordings) {
    const Recording& longest = *std::ranges::max_element(recordings, {}, &Recording::row_count);
    FolderContent content;
    copy_embedded(content, "include/", "include/");
    copy_embedded(content, "licence", "include/dfdyn/LICENSE");
    copy_embedded(content, "toolchains/cortex-m.cmake", "cmake/cortex-m.cmake");
    for (const std::string_view file : board_files) {
        copy_embedded(content, "cortex_m/" + std::string(file), "cortex_m/" + std::string(file));
    }
    for (const auto& [from, to] : templates) {
        copy_embedded(content, "templates/" + std::string(from), std::string(to));
    }
    content["include/robot_model.hpp"] = model_to_header(model, "robot_model");
    content["src/recorded_ticks.hpp"] = ticks_header(model, longest);
    return content;
}

void require_new_folder(const std::filesystem::path& folder) {
    std::error_code ignored;
    if (std::filesystem::exists(folder, ignored) && !std::filesystem::is_directory(folder, ignored)) {
        throw InputError(shown(folder) + ": expected a new or empty folder, found a file");
    }
    if (std::filesystem::exists(folder, ignored) && !std::filesystem::is_empty(folder, ignored)) {
        throw InputError(shown(folder) + ": expected a new or empty folder, found files in it");
    }
    const std::filesystem::path parent =
        std::filesystem::absolute(folder / "").lexically_normal().parent_path().parent_path();
    if (!std::filesystem::is_directory(parent, ignored)) {
        throw InputError(shown(folder) + ": expected an existing folder around the new one, found none");
    }
    check_folder(folder);
}

void write_folder(const std::filesystem::path& folder, const FolderContent& content) {
    FileSet files;
    files.add_folder(folder);
    for (const auto& [path, text] : content) {
        files.add_folder((folder / path).parent_path());
        files.add(folder / path, text);
    }
    files.commit();
}

} // namespace dfdyn::tools
