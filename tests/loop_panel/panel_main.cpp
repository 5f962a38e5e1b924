// SPDX-License-Identifier: Apache-2.0
// Runs the loops of random arms and prints a table: stops, command changes and tracking errors.
#include "tests/loop_panel/loop_trial.hpp"
#include "tests/loop_panel/strangers_loop.hpp"
#include "tests/tools/control/commissioned_model.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tests;

/// All cases of one variant of the loop.
class Variant {
  public:
    explicit Variant(std::string name) : name_(std::move(name)) {}

    /// `nominal`: the same loop with rigid body and feedback alone.
    void add(const LoopTrial& trial, const LoopTrial& nominal) {
        constexpr double nearly_most = 0.099; // of the limit: the loop allows 10 %
        ++cases_;
        stops_ += trial.stop.empty() ? 0 : 1;
        kicks_ += trial.step > nearly_most ? 1 : 0;
        late_kicks_ += trial.late_step > nearly_most ? 1 : 0;
        step_ = std::max(step_, trial.step);
        if (trial.stop.empty() && nominal.stop.empty()) {
            ratios_.push_back(trial.error / nominal.error);
            worse_ += trial.second > 1.1 * nominal.second ? 1 : 0;
        }
    }

    void print() {
        std::ranges::sort(ratios_);
        const std::size_t last = ratios_.empty() ? 0 : ratios_.size() - 1;
        std::printf("| %s | %d | %d | %d | %d | %.1f %% |", name_.c_str(), cases_, stops_, kicks_,
                    late_kicks_, 100 * step_);
        if (ratios_.empty()) {
            std::printf(" | | %d |\n", worse_);
            return;
        }
        std::printf(" %.3f | %.3f | %d |\n", ratios_[last / 2], ratios_[last], worse_);
    }

  private:
    std::string name_;
    int cases_ = 0, stops_ = 0, kicks_ = 0, late_kicks_ = 0, worse_ = 0;
    double step_ = 0;
    std::vector<double> ratios_;
};

void print_case(std::uint64_t seed, const StrangersLoop& loop, const std::vector<LoopTrial>& trials) {
    std::printf("seed %llu, %s:", static_cast<unsigned long long>(seed), loop.summary().c_str());
    for (const LoopTrial& trial : trials) {
        std::printf("  %.2f mrad, %.1f and %.1f %%%s%s", 1e3 * trial.error, 100 * trial.step,
                    100 * trial.late_step, trial.stop.empty() ? "" : " ", trial.stop.c_str());
    }
    std::printf("\n");
    std::fflush(stdout);
}

int run(std::uint64_t first, int cases, double duration_s, double gear_hz, bool learned) {
    std::vector<Variant> variants{Variant("nominal"), Variant("observer")};
    if (learned) {
        variants.emplace_back("learned");
    }
    int untuned = 0;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(cases); ++seed) {
        const std::optional<StrangersLoop> loop = draw_strangers_loop(seed, gear_hz);
        if (!loop) {
            ++untuned;
            continue;
        }
        std::vector<LoopTrial> trials{run_loop(*loop, false, nullptr, duration_s),
                                      run_loop(*loop, true, nullptr, duration_s)};
        if (learned) {
            const dfdyn::tools::LoopModel model = commissioned_model(loop->robot, loop->scenario);
            trials.push_back(run_loop(*loop, true, &model, duration_s));
        }
        for (std::size_t variant = 0; variant < variants.size(); ++variant) {
            variants[variant].add(trials[variant], trials.front());
        }
        print_case(seed, *loop, trials);
    }
    std::printf("\n%d of %d arms could not be tuned\n\n", untuned, cases);
    std::printf("| loop | arms | stops | steps of 10 %% | in the second half | largest step | "
                "error by nominal, median | largest | worst second above 1.1 nominal |\n"
                "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    std::ranges::for_each(variants, &Variant::print);
    return 0;
}

} // namespace

int main(int argc, char** argv) try {
    std::uint64_t seed = 1;
    int cases = 20;
    double duration_s = 20;
    double gear_hz = 0;
    bool learned = false;
    CLI::App app("Runs the loops of random arms: docs/results/loop.md");
    app.add_option("--seed", seed, "Of the first arm; the others follow")->capture_default_str();
    app.add_option("--cases", cases, "Arms")->capture_default_str();
    app.add_option("--duration", duration_s, "Of each run, seconds")->capture_default_str();
    app.add_option("--gear", gear_hz, "Frequency of the links on elastic gears, Hz; 0: rigid")
        ->capture_default_str();
    app.add_flag("--learned", learned, "Also with an SPK model, trained on half a minute of each arm");
    CLI11_PARSE(app, argc, argv);
    return run(seed, cases, duration_s, gear_hz, learned);
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
