// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/link_finding.hpp"

#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

using Eigen::Index;

namespace {

/// Returns the squared Mahalanobis distance of a value from zero, beyond the mean of what noise alone gives.
double beyond_noise(const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
    return value.dot(covariance.ldlt().solve(value)) - static_cast<double>(value.size());
}

/// Returns a parameter of the effect with its interval.
FoundParameter effect_parameter(const Effect& effect, Index number, double value, double variance) {
    const ParameterKind& kind = effect.parameters[static_cast<std::size_t>(number)];
    return parameter_within(kind.name, kind.unit, value, std::sqrt(variance));
}

/// Returns the covariance of the inertia about the centre of mass, to first order.
Eigen::Matrix<double, 6, 6> inertia_covariance(const InertialParameters& found,
                                               const InertialCovariance& covariance) {
    constexpr double part = 1e-3; // of a standard deviation: small enough for linearity
    Eigen::Matrix<double, 6, 10> slope;
    for (Index k = 0; k < slope.cols(); ++k) {
        const double step = part * std::sqrt(covariance(k, k));
        const InertialParameters change = step * InertialParameters::Unit(k);
        slope.col(k) = (central_inertia(found + change) - central_inertia(found - change)) / (2 * step);
    }
    return slope * covariance * slope.transpose();
}

} // namespace

std::vector<FoundParameter> mass_and_centre(const Effect& effect, const InertialParameters& nominal,
                                            const InertialParameters& change,
                                            const InertialCovariance& covariance) {
    const double mass = nominal[0] + change[0];
    std::vector parameters{effect_parameter(effect, 0, change[0], covariance(0, 0))};
    for (Index axis = 1; axis <= 3; ++axis) {
        const double centre = (nominal[axis] + change[axis]) / mass;
        const double before = nominal[0] > 0 ? nominal[axis] / nominal[0] : 0;
        const Eigen::Vector2d slope(-centre / mass, 1 / mass); // by mass and first moment
        const std::array<Index, 2> both{0, axis};
        const double variance = slope.dot(covariance(both, both) * slope);
        parameters.push_back(effect_parameter(effect, axis, centre - before, std::max(0.0, variance)));
    }
    return parameters;
}

Finding link_finding(const InertialParameters& nominal, const InertialParameters& change,
                     const InertialCovariance& covariance) {
    const InertialParameters body = nominal + change;
    const CentralInertia inertia = central_inertia(body) - central_inertia(nominal);
    const Eigen::Matrix<double, 6, 6> of_inertia = inertia_covariance(body, covariance);
    const bool turns =
        beyond_noise(inertia, of_inertia) > beyond_noise(change.head<4>(), covariance.topLeftCorner<4, 4>());
    const Effect effect = turns ? effects::link_rotational_inertia_error() : effects::link_inertia_error();
    Finding finding;
    finding.effect = effect.name;
    if (!turns) {
        finding.parameters = mass_and_centre(effect, nominal, change, covariance);
        return finding;
    }
    for (Index k = 0; k < inertia.size(); ++k) {
        finding.parameters.push_back(effect_parameter(effect, k, inertia[k], of_inertia(k, k)));
    }
    return finding;
}

} // namespace dfdyn::tools
