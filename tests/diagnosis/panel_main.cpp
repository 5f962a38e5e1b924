// SPDX-License-Identifier: Apache-2.0
// Makes recordings with hidden effects and their answers, and scores the diagnosis on them.
#include "tests/diagnosis/panel/changes/change_panel.hpp"
#include "tests/diagnosis/panel/changes/push_panel.hpp"
#include "tests/diagnosis/panel/recording/panel_files.hpp"
#include "tests/diagnosis/panel/score/panel_table.hpp"
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tools/base/system/atomic_file.hpp"

#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <random>

namespace {

using namespace dfdyn::tests;

struct PanelOptions {
    std::optional<std::uint64_t> seed;
    int cases = 1;
    PanelMix mix;
    std::filesystem::path directory; ///< for generate
    int threads = 2;                 ///< for score
    std::filesystem::path tables;    ///< for score and changes
    bool hold = false;               ///< for score: fail if a rate is below its floor
    ChangeMix changes;
};

std::string case_name(int number) {
    char text[32];
    std::snprintf(text, sizeof text, "case%04d", number);
    return text;
}

std::string in_words(const PanelCase& panel_case) {
    std::string text = panel_case.hidden.empty() ? " nothing" : "";
    for (const HiddenEffect& hidden : panel_case.hidden) {
        char strength[32];
        std::snprintf(strength, sizeof strength, " %.3g", hidden.strength);
        text.append(" ").append(hidden.effect).append(" ").append(hidden.where).append(strength);
    }
    return text;
}

int generate(const PanelOptions& options) {
    std::filesystem::create_directories(options.directory);
    int redraws = 0;
    for (int number = 0; number < options.cases; ++number) {
        const auto start = std::chrono::steady_clock::now();
        const std::uint64_t seed = *options.seed + static_cast<std::uint64_t>(number);
        const PanelCase panel_case = make_panel_case(seed, options.mix);
        write_panel_case(panel_case, options.directory, case_name(number));
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        redraws += panel_case.redraws;
        std::printf("%s seed %llu %s %s%s:%s; %d simulations, %d redraws, %.2f s\n",
                    case_name(number).c_str(), static_cast<unsigned long long>(seed),
                    panel_case.robot_name.c_str(), panel_case.noise.c_str(),
                    panel_case.masses_off ? " masses off" : "", in_words(panel_case).c_str(),
                    panel_case.simulations, panel_case.redraws, took.count());
        std::fflush(stdout);
    }
    std::printf("%d cases, %d redraws\n", options.cases, redraws);
    return 0;
}

void tell(const PanelOptions& options, const std::string& tables, std::size_t made) {
    std::printf("%zu recordings, seeds from %llu\n\n%s", made, static_cast<unsigned long long>(*options.seed),
                tables.c_str());
    if (!options.tables.empty()) {
        dfdyn::tools::write_file(options.tables, tables);
    }
}

int score(const PanelOptions& options) {
    const std::vector<CaseScore> scores =
        run_panel(*options.seed, options.cases, options.mix, options.threads, [](const CaseScore& one) {
            std::printf("%s\n", describe(one).c_str());
            std::fflush(stdout);
        });
    tell(options, panel_tables(scores), scores.size());
    constexpr double long_s = 200;
    const std::vector<std::string> worse = options.hold
                                               ? setbacks(summarise(scores), options.mix.duration_s >= long_s)
                                               : std::vector<std::string>{};
    for (const std::string& line : worse) {
        std::fprintf(stderr, "%s\n", line.c_str());
    }
    return worse.empty() ? 0 : 1;
}

int watch(const PanelOptions& options) {
    const std::vector<ChangeScore> scores =
        run_change_panel(*options.seed, options.cases, options.changes, [](const ChangeScore& one) {
            std::printf("%s\n", describe(one).c_str());
            std::fflush(stdout);
        });
    tell(options, change_tables(scores), scores.size());
    return 0;
}

int push(const PanelOptions& options) {
    const std::vector<PushScore> scores =
        run_push_panel(*options.seed, options.cases, [](const PushScore& one) {
            std::printf("%s\n", describe(one).c_str());
            std::fflush(stdout);
        });
    tell(options, push_tables(scores), scores.size());
    return 0;
}

void add_seeds(CLI::App& command, PanelOptions& options) {
    command.add_option("--seed", options.seed,
                       "Seed of the first case; each further case has the next seed. Default: a random seed");
    command.add_option("--cases", options.cases, "How many")->required()->check(CLI::PositiveNumber);
}

void add_tables(CLI::App& command, PanelOptions& options) {
    command.add_option("-o,--output", options.tables, "The tables, as Markdown");
}

CLI::App* add_pushes(CLI::App& app, PanelOptions& options) {
    CLI::App* command = app.add_subcommand("pushes", "Diagnoses arms that are pushed during standstill");
    add_seeds(*command, options);
    add_tables(*command, options);
    return command;
}

CLI::App* add_changes(CLI::App& app, PanelOptions& options) {
    CLI::App* command = app.add_subcommand(
        "changes", "Replays arms that change while they are learned; reports the findings of the monitor");
    add_seeds(*command, options);
    command->add_option("--robot", options.changes.robot, "Always this arm")
        ->check(CLI::IsMember(change_robot_names()));
    command
        ->add_option_function<std::string>(
            "--cause",
            [&options](const std::string& text) {
                for (int c = 0; c < dfdyn::cause_count; ++c) {
                    const auto cause = static_cast<dfdyn::Cause>(c);
                    options.changes.cause =
                        text == dfdyn::name(cause) ? std::optional(cause) : options.changes.cause;
                }
            },
            "Always this change")
        ->check(CLI::IsMember(
            {"payload", "friction_changed", "bias_moved", "external_contact", "sensor_frozen"}));
    command->add_flag("--never", options.changes.never, "Nothing changes");
    command->add_option("--duration", options.changes.duration_s, "Seconds per case")
        ->check(CLI::Range(81.0, 1e5));
    add_tables(*command, options);
    return command;
}

void add_mix(CLI::App& command, PanelOptions& options, const std::vector<std::string>& robots,
             const std::string& robot_help) {
    add_seeds(command, options);
    command.add_option("--effect", options.mix.effect, "Always this effect");
    command.add_option("--strength", options.mix.strength, "Always this strength")
        ->check(CLI::PositiveNumber);
    command.add_option("--robot", options.mix.robot, robot_help)->check(CLI::IsMember(robots));
    command.add_option("--noise", options.mix.noise, "Always this noise")
        ->check(CLI::IsMember(panel_noise_names()));
    command.add_option("--masses-off", options.mix.masses_off, "Nominal masses wrong: 0 never, 1 always");
    command.add_option("--duration", options.mix.duration_s, "Seconds of each recording, otherwise 40 to 60")
        ->check(CLI::Range(20.0, 1000.0));
    command.add_option("--null-share", options.mix.null_share, "Share of cases without any effect");
    command.add_option("--two-share", options.mix.two_effects_share, "Share with two effects");
    command.add_option("--outside-share", options.mix.outside_share,
                       "Share with effects outside the catalogue");
}

int run(int argc, char** argv) {
    CLI::App app("Recordings of simulated arms with hidden effects, to test methods that identify them");
    app.require_subcommand(1);
    PanelOptions options;
    CLI::App* generating = app.add_subcommand(
        "generate", "Writes caseNNNN.csv, the recording, and caseNNNN.truth.json, the answer");
    add_mix(*generating, options, panel_robot_names(), "Always this arm");
    generating->add_option("-o,--output", options.directory, "Folder")->required();
    CLI::App* scoring = app.add_subcommand("score", "Diagnoses the cases and prints the results as tables");
    std::vector<std::string> robots = panel_robot_names();
    robots.emplace_back(unknown_arm); // has no file that could be written
    add_mix(*scoring, options, robots,
            "Always this arm. unknown_arm: each case has another arm, motion and recording");
    scoring->add_option("--threads", options.threads, "Cases in parallel")->check(CLI::Range(1, 64));
    add_tables(*scoring, options);
    scoring->add_flag("--hold", options.hold,
                      "Status 1 if a rate is below its limit from the tests' panels: 60 short recordings, or "
                      "from 200 s on a thousand long ones");
    const CLI::App* const changes = add_changes(app, options);
    const CLI::App* const pushes = add_pushes(app, options);
    CLI11_PARSE(app, argc, argv);
    if (!options.seed) {
        options.seed = std::random_device{}();
    }
    if (changes->parsed()) {
        return watch(options);
    }
    if (pushes->parsed()) {
        return push(options);
    }
    return generating->parsed() ? generate(options) : score(options);
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
