// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/file_place.hpp"
#include "tools/base/system/file_set.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/model_files.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/diagnosis/extension/corrected_robot.hpp"
#include "tools/diagnosis/extension/extended_model.hpp"
#include "tools/diagnosis/extension/online_view.hpp"
#include "tools/diagnosis/output/diagnosis_json.hpp"
#include "tools/diagnosis/output/diagnosis_page.hpp"
#include "tools/diagnosis/output/diagnosis_summary.hpp"
#include "tools/diagnosis/output/error_sections.hpp"
#include "tools/diagnosis/recordings/diagnose_recordings.hpp"
#include "tools/robot/identification/torque_gains.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

namespace dfdyn::tools {

namespace {

struct DiagnoseOptions {
    RobotOptions robot;
    RecordingOptions recordings;
    std::string outputs;
    std::vector<double> torque_constants;
    std::filesystem::path folder;
    std::filesystem::path header;
    std::vector<std::string> formats; ///< names of robot_formats()
    std::string changed;              ///< the name of the payload, or nothing
    bool quick = false;
    bool no_setup_check = false;
    bool json = false;

    std::filesystem::path findings() const { return folder / "diagnosis.json"; }
    std::filesystem::path page() const { return folder / "report.html"; }
    std::filesystem::path model() const { return folder / "extended_model.json"; }
    std::filesystem::path curves() const { return folder / "curves.csv"; }

    /// Returns all files that a run writes, or removes because it no longer has them.
    std::vector<std::filesystem::path> all_files() const {
        std::vector<std::filesystem::path> files{findings(), page(), model(), curves(), header};
        for (const RobotFormat& format : robot_formats()) {
            files.push_back(folder / format.file);
        }
        return files;
    }
};

void check_changed(const DiagnoseOptions& options, OutputKind outputs, std::size_t recordings) {
    if (!options.changed.empty() && (recordings < 2 || outputs == OutputKind::wrench)) {
        throw InputError(
            std::string("--changed: expected several recordings of joint torques or currents, found ") +
            (recordings < 2 ? "one recording" : "--outputs wrench"));
    }
}

DiagnosisOptions diagnosis_options(const DiagnoseOptions& options, OutputKind outputs) {
    DiagnosisOptions how;
    how.outputs = outputs;
    how.torque_constants = options.torque_constants;
    how.measure = !options.quick;
    how.check_setup = !options.no_setup_check;
    return how;
}

/// Makes the model from the original recordings, with their gaps, instead of the joined one.
std::optional<TrainedModel> make_model(const DiagnosisWork& work, const ModelExtension& extension,
                                       const std::vector<Recording>& recordings,
                                       const DiagnoseOptions& options, const Robot& robot) {
    if (!effects_fitted(work)) {
        return std::nullopt;
    }
    const Progress progress("building the extended model", 0);
    TrainedModel model = extended_model(extension, recordings);
    describe_reading(options.recordings, robot, model);
    return model;
}

/// Calls `use` with each wanted format of the corrected robot and its file.
template <class Use>
void for_each_export(const DiagnoseOptions& options, const Use& use) {
    for (const RobotFormat& format : robot_formats()) {
        if (std::ranges::find(options.formats, format.name) != options.formats.end()) {
            use(format, options.folder / format.file);
        }
    }
}

void add_exports(const DiagnoseOptions& options, const ModelExtension& extension, FileSet& files) {
    const RobotExport corrected =
        options.formats.empty() ? RobotExport{} : corrected_robot(extension, options.formats);
    for_each_export(options, [&](const RobotFormat& format, const std::filesystem::path& file) {
        files.add(file, format.text(corrected));
    });
    for (const std::string& part : corrected.left_out) {
        print_note("note: not in the exported robot: " + part);
    }
}

/// Removes the robots of an earlier run that this one does not replace, and model, header and curves if there
/// are none now: they could be mistaken for results of this run.
void remove_earlier(const DiagnoseOptions& options, bool has_model, FileSet& files) {
    if (!has_model) {
        files.remove(options.model());
        files.remove(options.curves());
        if (!options.header.empty()) {
            files.remove(options.header);
        }
    }
    for (const RobotFormat& format : robot_formats()) {
        if (!has_model || std::ranges::find(options.formats, format.name) == options.formats.end()) {
            files.remove(options.folder / format.file);
        }
    }
}

/// Throws InputError unless all results can be written.
void check_folders(const DiagnoseOptions& options) {
    check_folder(options.folder);
    if (std::filesystem::exists(options.folder)) {
        for (const std::filesystem::path& output :
             {options.findings(), options.page(), options.model(), options.curves()}) {
            check_writable(output);
        }
        for_each_export(options,
                        [](const RobotFormat&, const std::filesystem::path& file) { check_writable(file); });
    }
    if (!options.header.empty() && !in_same_folder(options.header, options.page())) {
        check_writable(options.header);
    }
}

/// Returns the exit status. Prints on stderr why the diagnosis is refused, one line for each reason.
int exit_status(const Diagnosis& diagnosis, const std::vector<Recording>& recordings) {
    std::vector<std::string> names;
    for (const Recording& recording : recordings) {
        names.push_back(shown(recording.source));
    }
    for (const Suspicion& suspicion : diagnosis.suspicions) {
        if (!suspicion.code.empty()) {
            std::cerr << "dfdyn: " << (suspicion.recording.empty() ? listed(names) + ": " : "")
                      << suspicion.words() << '\n';
        }
    }
    return refused(diagnosis) ? 1 : 0;
}

int run(const DiagnoseOptions& options) {
    const JsonOutput output(options.json);
    check_distinct(options.all_files(), options.recordings.with({options.robot.urdf}));
    const OutputKind outputs = parse_output_kind(options.outputs);
    const Robot robot = options.robot.read(outputs);
    check_torque_constants(options.torque_constants, outputs, robot.joints.size());
    std::vector<Recording> recordings = options.recordings.read_each_once(columns_for(robot, outputs));
    check_changed(options, outputs, recordings.size());
    check_folders(options);
    const DiagnosisWork work =
        diagnose_recordings(robot, recordings, diagnosis_options(options, outputs), !options.changed.empty());
    const ModelExtension extension = effects_fitted(work) ? extension_of(work) : ModelExtension{};
    const std::optional<TrainedModel> model = make_model(work, extension, recordings, options, robot);
    const OnlineView online = model ? online_view(work, extension, *model, recordings) : OnlineView{};
    const nlohmann::ordered_json findings = diagnosis_json(work.diagnosis);
    FileSet files;
    files.add_folder(options.folder);
    files.add(options.findings(), json_text(findings) + '\n');
    files.add(options.page(), diagnosis_page({robot, recordings, work, extension, online,
                                              options.curves().filename().string()}));
    if (effects_fitted(work)) {
        write_comparison_csv(files.add(options.curves()), work);
    }
    remove_earlier(options, model.has_value(), files);
    if (model) {
        add_model(files, *model, options.model(), options.header);
        add_exports(options, extension, files);
    }
    files.commit();
    output.print(findings);
    print_diagnosis(std::cout, work.diagnosis, extension.carried);
    std::cout << "report: " << options.page().string() << '\n';
    return exit_status(work.diagnosis, recordings);
}

/// Adds the options for what the diagnosis writes.
void add_result_options(CLI::App& command, DiagnoseOptions& options) {
    command
        .add_option("-o,--output", options.folder,
                    "Folder for diagnosis.json, report.html, curves.csv (every row of the curves) and "
                    "extended_model.json")
        ->required()
        ->type_name("DIR");
    command.add_option("--header", options.header, "The extended model as C++ constants for flash")
        ->type_name("M.hpp");
    std::vector<std::string> formats;
    for (const RobotFormat& format : robot_formats()) {
        formats.emplace_back(format.name);
    }
    command
        .add_option("--export", options.formats,
                    "The corrected robot for simulators: masses, centres, friction, armature")
        ->delimiter(',')
        ->check(one_of(formats))
        ->type_name("FORMAT,...");
}

} // namespace

void add_diagnose_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<DiagnoseOptions>();
    CLI::App* command = app.add_subcommand(
        "diagnose", "Measures the errors of a robot's simulation, names their causes, extends the model");
    options->robot.add_to(*command, true);
    options->recordings.add_to(*command);
    command
        ->add_option("--outputs", options->outputs,
                     "What was measured: tau (torques), i (motor currents), wrench")
        ->required()
        ->type_name("tau|i|wrench");
    command
        ->add_option("--torque-constants", options->torque_constants,
                     "N m/A at each joint, for --outputs i; default: each joint's factor is estimated")
        ->delimiter(',')
        ->check(positive_number())
        ->type_name("K1,K2...");
    command
        ->add_option("--changed", options->changed,
                     "What differs between several recordings: the load at the tip, which is estimated for "
                     "each recording")
        ->check(one_of({effects::payload().name}))
        ->type_name(effects::payload().name);
    add_result_options(*command, *options);
    command->add_flag("--no-held-out", options->quick,
                      "Omit the error on held-out time, which takes half of the run time");
    command->add_flag("--no-setup-check", options->no_setup_check,
                      "Go on although units, clock, columns or signs of a recording look wrong");
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn diagnose --robot arm.urdf --tip tool0 --log run.csv --outputs tau -o diagnosis\n"
        "  dfdyn diagnose --robot arm.urdf --tip tool0 --log empty.csv --log loaded.csv --changed payload "
        "--outputs tau -o load\n"
        "  dfdyn replay --model diagnosis/extended_model.json --log other.csv\n"
        "Exit status: 0 the report is written, whether or not it names a cause; 1 refused: the set-up is "
        "wrong or the recording is unsuitable (the report states the reason; no model is written); 2 bad "
        "usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
