// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/result/evaluation_page.hpp"
#include "tools/experiment/run/plan_opponents.hpp"
#include "tools/experiment/run/run_plan.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct EvaluateOptions {
    std::filesystem::path plan;
    RunOptions run;
    bool quick = false;
    bool json = false;
};

EvaluationResults run_with_progress(const Plan& plan, const PlanData& data, const RunOptions& options) {
    const std::size_t jobs = plan.cases.size() * plan.seeds.size();
    Progress progress("evaluating, units done", jobs);
    return run_plan(plan, data, options, [&progress](double done) { progress.update_part(done); });
}

int run(const EvaluateOptions& options) {
    const JsonOutput output(options.json);
    check_folder(options.run.folder);
    const Plan plan = options.quick ? quick_plan(read_plan(options.plan)) : read_plan(options.plan);
    const PlanData data = load_plan_data(plan);
    EvaluationResults results = run_with_progress(plan, data, options.run);
    results.opponents = plan_opponents(plan, data);
    write_evaluation(options.run.folder, plan, data, results);
    for (const FailedJob& job : results.failed) {
        std::cerr << job.case_name << ", draw " << job.seed << ": " << job.reason << '\n';
    }
    output.print({{"schema", "dfdyn.evaluation/1"},
                  {"done", results.jobs.size()},
                  {"failed", results.failed.size()},
                  {"reused", results.reused},
                  {"folder", options.run.folder.string()}});
    std::cout << results.jobs.size() << " of " << results.jobs.size() + results.failed.size()
              << " cases x draws done (" << results.reused
              << " found from an earlier run): " << (options.run.folder / "report.html").string() << '\n';
    return results.failed.empty() ? 0 : 1;
}

} // namespace

void add_evaluate_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = app.add_subcommand(
        "evaluate", "Runs the paper's experiment over a plan's cases; writes tables, curves and box plots");
    command->add_option("--plan", options->plan, "Cases, data and comparisons: see docs/guide/evaluation.md")
        ->required()
        ->type_name("P.json");
    command
        ->add_option("-o,--output", options->run.folder,
                     "Folder for report.html, results.csv, tables.md, findings.md, pictures/ and cases/")
        ->required()
        ->type_name("DIR");
    command->add_option("--jobs", options->run.jobs, "Cases x draws in parallel")
        ->check(whole_number_in(1, 256))
        ->capture_default_str();
    command->add_flag("--fresh", options->run.fresh,
                      "Repeat all cases x draws, even if DIR has results of an earlier run");
    command->add_flag("--quick", options->quick,
                      "One draw, few features and rows: a functional test of every case without meaningful "
                      "accuracy. Use a separate DIR");
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn evaluate --plan plan.json -o evaluation --jobs 2\n"
        "An interrupted run can be continued: cases x draws with unchanged inputs are not repeated.\nExit "
        "status: 0 done, 1 some cases failed (the report names them), 2 bad usage or "
        "input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
