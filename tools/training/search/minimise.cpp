// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/minimise.hpp"

#include "tools/base/numerics/to_vector.hpp"

#include <nlopt.hpp>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <vector>

namespace dfdyn::tools {
namespace {

struct Descent {
    const Differentiable& function;
    int evaluations_most;
    Minimum best;
    double worst = 0;         // largest finite value so far, at least 0: points without a value are worse
    std::exception_ptr error; // thrown by the function: NLopt would not preserve it
};

std::optional<PointValue> guarded(Descent& search, const Eigen::VectorXd& point) {
    try {
        return search.function(point);
    } catch (...) {
        search.error = std::current_exception();
        throw nlopt::forced_stop();
    }
}

double without_value(const Descent& search, std::vector<double>& gradient) {
    std::fill(gradient.begin(), gradient.end(), 0.0);
    return search.worst + 1e3;
}

double evaluate(const std::vector<double>& point, std::vector<double>& gradient, void* context) {
    Descent& search = *static_cast<Descent*>(context);
    if (search.error || search.best.evaluations == search.evaluations_most) {
        return without_value(search, gradient); // NLopt stops only after its line search
    }
    ++search.best.evaluations;
    const Eigen::VectorXd here =
        Eigen::Map<const Eigen::VectorXd>(point.data(), static_cast<Eigen::Index>(point.size()));
    const std::optional<PointValue> found = guarded(search, here);
    if (!found) {
        return without_value(search, gradient);
    }
    std::copy_n(found->gradient.begin(), gradient.size(), gradient.begin());
    search.worst = std::max(search.worst, found->value);
    if (found->value < search.best.value) {
        search.best.value = found->value;
        search.best.point = here;
    }
    return found->value;
}

/// Runs the optimiser once from `start`.
void descend(Descent& search, const Bounds& bounds, const Eigen::VectorXd& start, double tolerance) {
    nlopt::opt optimiser(nlopt::LD_LBFGS, static_cast<unsigned>(start.size()));
    optimiser.set_min_objective(evaluate, &search);
    optimiser.set_lower_bounds(to_vector(bounds.lower));
    optimiser.set_upper_bounds(to_vector(bounds.upper));
    optimiser.set_ftol_abs(tolerance);
    optimiser.set_maxeval(search.evaluations_most - search.best.evaluations);
    std::vector<double> point =
        to_vector(Eigen::VectorXd(start.cwiseMax(bounds.lower).cwiseMin(bounds.upper)));
    double value = 0;
    try {
        optimiser.optimize(point, value);
    } catch (const std::runtime_error&) {
        // NLopt's error for a line search without a lower value, or the function's own error
    }
    if (search.error) {
        std::rethrow_exception(search.error);
    }
}

} // namespace

Minimum minimise(const Differentiable& function, const Bounds& bounds, const Eigen::VectorXd& start,
                 double tolerance, int evaluations_most) {
    if (start.size() == 0) {
        const auto value = function(start);
        return value ? Minimum{start, value->value, 1}
                     : Minimum{{}, std::numeric_limits<double>::infinity(), 1};
    }
    Descent search{function, evaluations_most, {}, 0, nullptr};
    descend(search, bounds, start, tolerance);
    double before = std::numeric_limits<double>::infinity();
    while (before - search.best.value > tolerance && search.best.evaluations < evaluations_most) {
        before = search.best.value;
        descend(search, bounds, search.best.point, tolerance);
    }
    return search.best;
}

} // namespace dfdyn::tools
