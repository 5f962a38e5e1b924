// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/fit.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/training/search/fit_problem.hpp"
#include "tools/training/search/minimise.hpp"
#include "tools/training/search/multi_start.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int structured_starts = 2;

const Minimum& best_of(const std::vector<Minimum>& minima) {
    const auto best = std::min_element(minima.begin(), minima.end(),
                                       [](const Minimum& a, const Minimum& b) { return a.value < b.value; });
    if (!std::isfinite(best->value)) {
        throw InputError("training: expected a finite likelihood from at least one of " +
                         std::to_string(minima.size()) + " starts, found none");
    }
    return *best;
}

/// Returns whether DFR starts from the result of DFSR.
bool begins_structured(const TrainingOptions& options) {
    return input_description(options.input).starts_from && options.lags >= 2 && options.rows_per_joint >= 2;
}

PhysicsPrior prior_of(const TrainingOptions& options) {
    if (!options.model->learns_parameters()) {
        return PhysicsPrior::none;
    }
    return options.physics.prior == PriorForm::diagonal ? PhysicsPrior::diagonal : PhysicsPrior::shared;
}

/// A point of a search with all values that are optimal there.
struct Found {
    VectorXd theta;
    LikelihoodValue value;
};

/// Fits one FitModel by likelihood.
class Search {
  public:
    Search(const TrainingSetup& setup, const FitModel& model, MultiStart& starts)
        : setup_(setup), model_(model), starts_(starts),
          problem_(setup, setup.options.input, setup.rows.likelihood, model) {}

    const FitProblem& problem() const { return problem_; }

    std::vector<Minimum> run(bool announced) {
        std::vector<VectorXd> starts;
        if (begins_structured(setup_.options)) {
            starts.push_back(structured_start());
        }
        for (int i = 0; static_cast<int>(starts.size()) < setup_.options.starts; ++i) {
            starts.push_back(problem_.start(i));
        }
        return starts_.run(problem_.exact(), problem_.bounds(), starts, announced);
    }

    /// Continues from `theta` with the likelihood of the estimator's model, over all usable rows.
    Found refined(const VectorXd& theta) {
        Found found{theta, *problem_.exact().evaluate(theta)};
        if (setup_.options.refinement_evaluations == 0) {
            return found;
        }
        const FitProblem everywhere(setup_, setup_.options.input, setup_.rows.usable, model_);
        const std::unique_ptr<Likelihood> likelihood = everywhere.running();
        const Minimum minimum = starts_.refine(*likelihood, problem_.bounds(), theta);
        if (!std::isfinite(minimum.value)) {
            return found;
        }
        return {minimum.point, *likelihood->evaluate(minimum.point)};
    }

  private:
    VectorXd structured_start() {
        const FitProblem structured(setup_, *input_description(setup_.options.input).starts_from,
                                    setup_.rows.likelihood, model_);
        const auto minima = starts_.run(structured.exact(), structured.bounds(),
                                        {structured.start(0), structured.start(1)}, false);
        const Minimum& best = minima[1].value < minima[0].value ? minima[1] : minima[0];
        return std::isfinite(best.value) ? problem_.start_from(structured, best.point) : problem_.start(0);
    }

    const TrainingSetup& setup_;
    const FitModel& model_;
    MultiStart& starts_;
    FitProblem problem_;
};

PhysicsPart part_of(const FitProblem& problem, const FitModel& model, const Found& found) {
    const Hyperparameters hyper = problem.split(found.theta);
    return {*model.columns, concatenated(hyper.input, hyper.physics), found.value.physics};
}

/// Physics with white noise only.
FitModel physics_alone(const TrainingSetup& setup, PhysicsPrior prior) {
    FitModel model;
    model.kernel = false;
    model.offset = output_offset(setup);
    model.columns = choose_columns(setup);
    model.prior = prior;
    return model;
}

PhysicsPart least_squares_physics(const TrainingSetup& setup, MultiStart& starts) {
    const FitModel model = physics_alone(setup, PhysicsPrior::none);
    Search search(setup, model, starts);
    const VectorXd theta = best_of(search.run(false)).point;
    return part_of(search.problem(), model, {theta, *search.problem().exact().evaluate(theta)});
}

FitModel model_to_fit(const TrainingSetup& setup, MultiStart& starts) {
    const TrainingOptions& options = setup.options;
    FitModel model;
    model.offset = output_offset(setup);
    if (!options.model->features) {
        return physics_alone(setup, prior_of(options));
    }
    if (options.model->physics == PhysicsRole::fixed_first) {
        model.mean = options.physics.given ? given_physics(setup) : least_squares_physics(setup, starts);
    } else if (options.model->has_physics()) {
        model.columns = choose_columns(setup);
        model.prior = prior_of(options);
    }
    return model;
}

int searches(const TrainingOptions& options) {
    const int once = options.starts + (begins_structured(options) ? structured_starts : 0);
    return options.model->physics == PhysicsRole::fixed_first && !options.physics.given ? 2 * once : once;
}

TrainingRecord record_of(const std::vector<Minimum>& minima, const TrainingSetup& setup) {
    TrainingRecord record;
    record.method = "ML";
    record.seed = setup.options.seed;
    record.likelihood_rows = static_cast<int>(setup.rows.likelihood.size());
    record.log_likelihood = -0.5 * best_of(minima).value;
    for (const Minimum& minimum : minima) {
        if (std::isfinite(minimum.value)) {
            record.all_starts.push_back(-0.5 * minimum.value);
        }
    }
    return record;
}

Fit fit_of(const FitProblem& problem, const FitModel& model, const Found& found, TrainingRecord record) {
    Fit fit{problem.split(found.theta),
            found.value.output_variance,
            model.offset,
            model.mean,
            std::move(record),
            {}};
    if (model.columns) {
        fit.physics = part_of(problem, model, found);
    }
    return fit;
}

} // namespace

Fit fit_by_likelihood(const TrainingSetup& setup, const ProgressCallback& progress) {
    MultiStart starts(setup.options, progress, searches(setup.options));
    const FitModel model = model_to_fit(setup, starts);
    Search search(setup, model, starts);
    const std::vector<Minimum> minima = search.run(true);
    const Found found = search.refined(best_of(minima).point);
    return fit_of(search.problem(), model, found, record_of(minima, setup));
}

} // namespace dfdyn::tools
