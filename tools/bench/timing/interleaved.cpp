// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/interleaved.hpp"

#include <algorithm>
#include <chrono>
#include <sys/resource.h>

namespace dfdyn::tools {

namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::micro>(duration).count();
}

/// Number of involuntary context switches of this thread.
long switches_so_far() {
    rusage usage{};
    ::getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nivcsw;
}

/// Measures a repetition. Two untimed ticks first bring the subject back into the caches.
std::vector<double> timed_ticks(Ticking& subject, const RepetitionOptions& options, double clock_cost_ns) {
    std::vector<double> times;
    subject.tick();
    subject.tick();
    for (double total = 0; total < options.repetition_us || times.size() < options.fewest_ticks;) {
        const auto begin = Clock::now();
        subject.tick();
        const double time = microseconds(Clock::now() - begin) - clock_cost_ns / 1000;
        total += time + clock_cost_ns / 1000;
        times.push_back(std::max(time, 0.0));
    }
    return times;
}

} // namespace

std::vector<TickTimes> time_interleaved(std::span<Ticking* const> subjects, const RepetitionOptions& options,
                                        MultiplyAddProbe& probe, double clock_cost_ns,
                                        const std::function<void(int)>& on_pass) {
    std::vector<std::vector<Repetition>> repetitions(subjects.size());
    for (int pass = 0; pass < options.passes; ++pass) {
        for (std::size_t i = 0; i < subjects.size(); ++i) {
            const double before = probe.run();
            const long switches = switches_so_far();
            std::vector<double> times = timed_ticks(*subjects[i], options, clock_cost_ns);
            const bool interrupted = switches_so_far() != switches;
            repetitions[i].push_back({std::min(before, probe.run()), interrupted, std::move(times)});
        }
        on_pass(pass + 1);
    }
    std::vector<TickTimes> results;
    for (const std::vector<Repetition>& own : repetitions) {
        results.push_back(summarise_undisturbed(own, probe.best(), options.undisturbed));
    }
    return results;
}

TickTimes summarise_undisturbed(const std::vector<Repetition>& repetitions, double best_rate,
                                double undisturbed) {
    const auto counts = [&](const Repetition& one) {
        return !one.interrupted && one.probe_rate >= undisturbed * best_rate;
    };
    const auto accepted = static_cast<std::size_t>(std::ranges::count_if(repetitions, counts));
    std::vector<double> times;
    for (const Repetition& one : repetitions) {
        if (10 * accepted < repetitions.size() || counts(one)) {
            times.insert(times.end(), one.times_us.begin(), one.times_us.end());
        }
    }
    return summarise(std::move(times), static_cast<double>(accepted) /
                                           static_cast<double>(std::max<std::size_t>(repetitions.size(), 1)));
}

} // namespace dfdyn::tools
