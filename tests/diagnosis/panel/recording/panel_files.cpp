// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_files.hpp"

#include "tools/base/recording/csv_writer.hpp"
#include "tools/base/system/atomic_file.hpp"

#include <nlohmann/json.hpp>

namespace dfdyn::tests {

using namespace tools;

namespace {

const char* name_of(OutputKind kind) {
    return kind == OutputKind::wrench ? "wrench" : kind == OutputKind::motor_current ? "i" : "tau";
}

nlohmann::ordered_json json_of(const HiddenEffect& hidden) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const auto& [name, value] : hidden.parameters) {
        parameters.push_back({{"name", name}, {"value", value}});
    }
    return {{"effect", hidden.effect},
            {"where", hidden.where},
            {"parameters", parameters},
            {"main_output", hidden.main_output},
            {"strength", hidden.strength}};
}

nlohmann::ordered_json truth_of(const PanelCase& panel_case) {
    nlohmann::ordered_json truth{{"schema", "dfdyn.panel_truth/1"},
                                 {"seed", panel_case.seed},
                                 {"robot", panel_case.robot_name},
                                 {"urdf", panel_case.urdf},
                                 {"tip", panel_case.tip},
                                 {"outputs", name_of(panel_case.outputs)},
                                 {"masses_off", panel_case.masses_off},
                                 {"mass_errors", panel_case.mass_errors},
                                 {"noise", panel_case.noise},
                                 {"noise_rms", panel_case.noise_rms},
                                 {"torque_constants_known", panel_case.torque_constants_known},
                                 {"torque_constants", panel_case.torque_constants},
                                 {"outside_catalogue", panel_case.outside_catalogue},
                                 {"redraws", panel_case.redraws},
                                 {"simulations", panel_case.simulations}};
    truth["hidden"] = nlohmann::ordered_json::array();
    for (const HiddenEffect& hidden : panel_case.hidden) {
        truth["hidden"].push_back(json_of(hidden));
    }
    return truth;
}

void write_recording(std::ostream& out, const Recording& recording) {
    std::vector<std::string> names{"t"};
    names.insert(names.end(), recording.position.names.begin(), recording.position.names.end());
    names.insert(names.end(), recording.output.names.begin(), recording.output.names.end());
    CsvWriter csv(out, names);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        csv.field(recording.time_s[row])
            .fields(recording.position.row(row))
            .fields(recording.output.row(row));
        csv.end_row();
    }
}

} // namespace

void write_panel_case(const PanelCase& panel_case, const std::filesystem::path& directory,
                      const std::string& name) {
    AtomicFile recording(directory / (name + ".csv"));
    write_recording(recording.stream(), panel_case.recording);
    AtomicFile truth(directory / (name + ".truth.json"));
    truth.stream() << truth_of(panel_case).dump(2) << '\n';
    recording.commit();
    truth.commit();
}

} // namespace dfdyn::tests
