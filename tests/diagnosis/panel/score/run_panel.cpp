// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/run_panel.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace dfdyn::tests {

namespace {

std::optional<CaseScore> run_case(std::uint64_t seed, const PanelMix& mix) {
    const std::optional<PanelCase> made = make_possible_case(seed, mix);
    if (!made) {
        return std::nullopt;
    }
    const PanelCase& panel_case = *made;
    tools::DiagnosisOptions options;
    options.outputs = panel_case.outputs;
    options.measure = is_exact(panel_case);
    if (panel_case.torque_constants_known) {
        options.torque_constants = panel_case.torque_constants;
    }
    const auto start = std::chrono::steady_clock::now();
    const tools::DiagnosisWork work = tools::diagnose(panel_case.nominal, panel_case.recording, options);
    CaseScore score = score_case(panel_case, work.diagnosis);
    score.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return score;
}

} // namespace

std::vector<CaseScore> run_panel(std::uint64_t seed, int cases, const PanelMix& mix, int threads,
                                 const std::function<void(const CaseScore&)>& done) {
    std::vector<std::optional<CaseScore>> scores(static_cast<std::size_t>(cases));
    std::atomic<int> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (int number = next++; number < cases; number = next++) {
                std::optional<CaseScore> score = run_case(seed + static_cast<std::uint64_t>(number), mix);
                const std::lock_guard lock(mutex);
                if (score) {
                    done(*score);
                }
                scores[static_cast<std::size_t>(number)] = std::move(score);
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            failure = std::current_exception();
            next = cases;
        }
    };
    std::vector<std::thread> pool;
    for (int thread = 0; thread < threads; ++thread) {
        pool.emplace_back(work);
    }
    for (std::thread& thread : pool) {
        thread.join();
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
    std::vector<CaseScore> made;
    for (std::optional<CaseScore>& score : scores) {
        if (score) {
            made.push_back(*std::move(score));
        }
    }
    return made;
}

} // namespace dfdyn::tests
