// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/run_plan.hpp"

#include "tools/base/text/error.hpp"
#include "tools/experiment/run/common_ticks.hpp"
#include "tools/experiment/run/job_file.hpp"
#include "tools/experiment/run/run_job.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

namespace dfdyn::tools {

namespace {

/// One case with one draw, and its result.
struct Job {
    Job(const Case& its_case, std::uint64_t its_seed, std::filesystem::path its_path)
        : one(its_case), seed(its_seed), path(std::move(its_path)) {}

    const Case& one;
    std::uint64_t seed;
    std::filesystem::path path;
    std::optional<JobResult> result;
    std::string failure;
    bool reused = false;
    std::atomic<double> done = 0; ///< completed share
};

/// The work of one call of run_plan.
class PlanRun {
  public:
    PlanRun(const Plan& plan, const PlanData& data, const RunOptions& options)
        : plan_(plan), data_(data), options_(options) {
        const int cores = static_cast<int>(std::thread::hardware_concurrency());
        threads_ = std::max(1, cores / options.jobs);
        for (const Case& one : plan.cases) {
            memories_.try_emplace(one.name);
            for (const std::uint64_t seed : plan.seeds) {
                jobs_.emplace_back(one, seed,
                                   options.folder / "cases" / one.name / (std::to_string(seed) + ".json"));
            }
        }
    }

    void run(const std::function<void(double)>& progress) {
        std::vector<std::jthread> workers;
        running_ = options_.jobs;
        for (int job = 0; job < options_.jobs; ++job) {
            workers.emplace_back([this] { work(); });
        }
        std::unique_lock lock(mutex_);
        while (!finished_.wait_for(lock, std::chrono::milliseconds(100), [this] { return running_ == 0; })) {
            progress(share_done());
        }
        if (fault_) {
            std::rethrow_exception(fault_);
        }
    }

    EvaluationResults results() {
        EvaluationResults results;
        for (Job& job : jobs_) {
            if (job.result) {
                results.jobs.push_back(std::move(*job.result));
                results.reused += job.reused ? 1 : 0;
            } else {
                results.failed.push_back({job.one.name, job.seed, job.failure});
            }
        }
        keep_common_ticks(plan_, data_, results.jobs);
        return results;
    }

  private:
    void work() {
        try {
            for (std::size_t next = next_++; next < jobs_.size(); next = next_++) {
                finish_job(job_in_turn(next));
            }
        } catch (...) {
            const std::lock_guard lock(mutex_);
            fault_ = std::current_exception();
            next_ = jobs_.size();
        }
        const std::lock_guard lock(mutex_);
        --running_;
        finished_.notify_all();
    }

    /// Returns the jobs in the order of the work: the first draws of all cases before any second draw. The
    /// cases are then tuned in parallel, and no draw waits for the tuning of its case.
    Job& job_in_turn(std::size_t turn) {
        const std::size_t cases = plan_.cases.size();
        return jobs_[turn % cases * plan_.seeds.size() + turn / cases];
    }

    void finish_job(Job& job) {
        const nlohmann::ordered_json inputs = job_inputs(plan_, data_, job.one, job.seed);
        if (!options_.fresh) {
            job.result = read_job(job.path, inputs);
            job.reused = job.result.has_value();
        }
        if (!job.reused) {
            compute(job);
            if (job.result) { // what cannot be written ends the run: the other jobs would be lost as well
                job.result = write_job(job.path, inputs, *job.result);
            }
        }
        job.done = 1;
    }

    /// Sets the result of the job, or its failure.
    void compute(Job& job) {
        try {
            job.result = run_job(plan_, data_, job.one, job.seed, memories_, threads_,
                                 [&job](double share) { job.done = share; });
        } catch (const InputError& error) {
            job.failure = error.what();
        }
    }

    double share_done() const {
        double sum = 0;
        for (const Job& job : jobs_) {
            sum += job.done;
        }
        return sum;
    }

    const Plan& plan_;
    const PlanData& data_;
    const RunOptions& options_;
    CaseMemories memories_; ///< complete before the work begins
    std::deque<Job> jobs_;  ///< in the order of cases, then draws
    int threads_ = 1;       ///< per training
    std::atomic<std::size_t> next_ = 0;
    std::mutex mutex_;
    std::condition_variable finished_;
    int running_ = 0;
    std::exception_ptr fault_;
};

} // namespace

EvaluationResults run_plan(const Plan& plan, const PlanData& data, const RunOptions& options,
                           const std::function<void(double)>& progress) {
    PlanRun run(plan, data, options);
    run.run(progress);
    return run.results();
}

} // namespace dfdyn::tools
