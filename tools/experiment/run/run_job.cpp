// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/run_job.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double share_of_training = 0.5; ///< share of the progress

/// Returns ε of one output at one tick, with the plan's scale.
double scaled_error(const HorizonIndex& index, std::size_t output, const Plan& plan, const PlanData& data) {
    if (plan.error_scale == ErrorScale::horizon) {
        return index.epsilon[output];
    }
    return index.error_square[output] / (static_cast<double>(plan.horizon) * data.output_variance[output]);
}

std::vector<double> group_error(const ReplayedRecording& replayed, const std::vector<std::size_t>& outputs,
                                const Plan& plan, const PlanData& data) {
    std::vector<double> error(replayed.time_s.size(), std::numeric_limits<double>::quiet_NaN());
    for (const HorizonIndex& index : replayed.horizon) {
        double sum = 0;
        for (const std::size_t output : outputs) {
            sum += scaled_error(index, output, plan, data);
        }
        error[index.tick] = sum / static_cast<double>(outputs.size());
    }
    return error;
}

/// Appends the ticks of a subset, for statistics that do not depend on their order.
void append_ticks(const ReplayedRecording& subset, ReplayedRecording& all) {
    all.measured.insert(all.measured.end(), subset.measured.begin(), subset.measured.end());
    all.predicted.insert(all.predicted.end(), subset.predicted.begin(), subset.predicted.end());
    all.status.insert(all.status.end(), subset.status.begin(), subset.status.end());
    all.duration_us.insert(all.duration_us.end(), subset.duration_us.begin(), subset.duration_us.end());
}

double median_duration_us(const ReplayedRecording& replayed) {
    std::vector<double> durations;
    for (std::size_t tick = 0; tick < replayed.status.size(); ++tick) {
        if (replayed.status[tick].learned()) {
            durations.push_back(replayed.duration_us[tick]);
        }
    }
    return median(std::move(durations));
}

/// Combines the ticks of several recordings into one progress value.
class TickProgress {
  public:
    TickProgress(const PlanData& data, const std::function<void(double)>& progress) : progress_(&progress) {
        total_ = data.online.row_count();
        for (const Recording& subset : data.subsets) {
            total_ += subset.row_count();
        }
    }

    std::function<void(std::size_t)> of_next() {
        const std::size_t before = done_;
        return [this, before](std::size_t done) {
            done_ = before + done;
            const double share = static_cast<double>(done_) / static_cast<double>(total_);
            (*progress_)(share_of_training + (1 - share_of_training) * share);
        };
    }

  private:
    const std::function<void(double)>* progress_;
    std::size_t total_;
    std::size_t done_ = 0;
};

/// Runs each subset from the state `trained`.
void run_subsets(const Plan& plan, const PlanData& data, std::span<const TrainedModel> models,
                 RuntimeEstimator& estimator, TickProgress& ticks, JobResult& result) {
    const std::vector<std::byte> trained = estimator.snapshot();
    ReplayedRecording all;
    for (const Recording& subset : data.subsets) {
        if (!estimator.restore(trained)) {
            throw std::logic_error("an estimator that does not take its own snapshot back");
        }
        const ReplayedRecording replayed = replay(estimator, models, subset, plan.horizon, ticks.of_next());
        for (std::size_t group = 0; group < plan.groups.size(); ++group) {
            result.error[group].push_back(group_error(replayed, data.group_outputs[group], plan, data));
        }
        append_ticks(replayed, all);
    }
    const std::size_t outputs = models.front().outputs.names.size();
    for (std::size_t output = 0; output < outputs; ++output) {
        result.normalised_error.push_back(normalised_error(all, outputs, output, 0, all.status.size()));
    }
    result.median_us = median_duration_us(all);
}

/// Returns the models of the case, or of the cases that it combines.
std::vector<TrainedModel> train_job(const Plan& plan, const CaseContext& context, const Case& one,
                                    std::uint64_t seed, CaseMemories& memories,
                                    const std::function<void(double)>& progress) {
    const std::vector<std::string> names = one.members.empty() ? std::vector{one.name} : one.members;
    std::vector<TrainedModel> models;
    for (const std::string& name : names) {
        models.push_back(
            train_case(case_named(plan, name), context, seed, memories.at(name), [&](double share) {
                const auto before = static_cast<double>(models.size());
                progress((before + share) / static_cast<double>(names.size()));
            }));
    }
    return models;
}

int columns_of(std::span<const TrainedModel> models) {
    int columns = 0;
    for (const TrainedModel& model : models) {
        columns +=
            2 * model.features.count + (model.physics ? static_cast<int>(model.physics->selected.size()) : 0);
    }
    return columns;
}

} // namespace

JobResult run_job(const Plan& plan, const PlanData& data, const Case& one, std::uint64_t seed,
                  CaseMemories& memories, int threads, const std::function<void(double)>& progress) {
    const CaseContext context{plan.robot, plan.outputs, data.start, threads};
    const std::vector<TrainedModel> models = train_job(
        plan, context, one, seed, memories, [&](double share) { progress(share_of_training * share); });
    const auto estimator = make_estimator(models, false);
    TickProgress ticks(data, progress);
    replay(*estimator, models, data.online, 0, ticks.of_next());
    JobResult result;
    result.case_name = one.name;
    result.seed = seed;
    result.sample_period_s = models.front().sample_period_s;
    result.error.resize(plan.groups.size());
    result.operations = estimator->cost().predict + estimator->cost().learn;
    result.state_bytes = estimator->state_bytes();
    result.columns = columns_of(models);
    run_subsets(plan, data, models, *estimator, ticks, result);
    return result;
}

} // namespace dfdyn::tools
