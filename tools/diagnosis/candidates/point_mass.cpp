// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/point_mass.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Change of the inertial parameters of 1 kg at `centre` if its first moment changes by 1 kg·m along `axis`
/// and its mass remains.
InertialParameters first_moment(const Eigen::Vector3d& centre, Eigen::Index axis) {
    constexpr double step = 1e-4; // m: small enough for linearity
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
    return (point_mass(1, centre + shift) - point_mass(1, centre - shift)) / (2 * step);
}

constexpr std::size_t columns_of_mass = 4; ///< the mass, and its three first moments

/// Part of a column's square below which the motion does not determine its coefficient: a thousandth of the
/// outputs.
constexpr double least_part = 1e-6;
/// Mean square of a column, in SI units, that is a rounding error: a kilogram or 1 kg·m changes the outputs
/// by a millionth.
constexpr double rounding = 1e-12;

/// Products of columns with each other, summed over outputs, as means over the rows.
Eigen::MatrixXd products_of(const std::vector<EffectColumn>& columns) {
    const auto rows = static_cast<double>(columns.front().parts.front().series.size());
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(std::ssize(columns), std::ssize(columns));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        for (std::size_t k = 0; k < columns.size(); ++k) {
            for (std::size_t part = 0; part < columns[i].parts.size(); ++part) {
                products(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) +=
                    columns[i].parts[part].series.dot(columns[k].parts[part].series) / rows;
            }
        }
    }
    return products;
}

/// Returns the part of a column's square that is independent of the columns `of`.
double independent_part(const Eigen::MatrixXd& products, const std::vector<std::size_t>& of,
                        std::size_t column) {
    const auto count = std::ssize(of);
    const auto at = [&](std::size_t one, std::size_t other) {
        const auto i = static_cast<Eigen::Index>(one);
        const auto k = static_cast<Eigen::Index>(other);
        const double size = std::sqrt(products(i, i) * products(k, k));
        return size > 0 ? products(i, k) / size : 0;
    };
    Eigen::MatrixXd square(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const std::size_t one = of[static_cast<std::size_t>(i)];
        right[i] = at(one, column);
        for (Eigen::Index k = 0; k < count; ++k) {
            square(i, k) = at(one, of[static_cast<std::size_t>(k)]);
        }
    }
    return count > 0 ? 1 - right.dot(square.ldlt().solve(right)) : 1;
}

/// Returns the `wanted` columns that the motion determines; of dependent ones, the first.
std::vector<std::size_t> determined(const Eigen::MatrixXd& products, const std::vector<std::size_t>& wanted) {
    const double largest = products.diagonal().tail(products.rows() - 1).maxCoeff(); // of the moments
    std::vector<std::size_t> kept;
    for (const std::size_t column : wanted) {
        const auto at = static_cast<Eigen::Index>(column);
        if (products(at, at) > std::max(least_part * largest, rounding) &&
            independent_part(products, kept, column) > least_part) {
            kept.push_back(column);
        }
    }
    return kept;
}

/// Returns whether columns act on a single output at most.
bool on_single_output(const std::vector<EffectColumn>& columns, const std::vector<std::size_t>& of) {
    const std::vector<EffectColumn::Part>& parts = columns.front().parts;
    std::size_t outputs = 0;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const bool acts = std::ranges::any_of(of, [&](std::size_t column) {
            const Eigen::VectorXd& series = columns[column].parts[part].series;
            return series.squaredNorm() > rounding * static_cast<double>(series.size());
        });
        outputs += acts ? 1 : 0;
    }
    return outputs < 2;
}

/// Returns whether two sets of independent columns have the same linear combinations.
bool same_span(const Eigen::MatrixXd& products, const std::vector<std::size_t>& one,
               const std::vector<std::size_t>& other) {
    return one.size() == other.size() && std::ranges::all_of(one, [&](std::size_t column) {
               return independent_part(products, other, column) <= least_part;
           });
}

} // namespace

InertialParameters point_mass(double mass, const Eigen::Vector3d& centre) {
    return body_parameters(mass, centre, Eigen::Matrix3d::Zero());
}

std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals, Eigen::Index body,
                                       const Eigen::Vector3d& centre, const Eigen::Isometry3d& placement,
                                       const Eigen::Vector3d& displacement) {
    const Eigen::Vector3d midpoint = centre + displacement / 2; // the slope here is that of the secant
    std::vector<EffectColumn> columns{
        on_outputs(signals.of_body(body, moved(point_mass(1, centre), placement)))};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        columns.push_back(on_outputs(signals.of_body(body, moved(first_moment(midpoint, axis), placement))));
    }
    return columns;
}

std::vector<EffectShape> determined_shapes(const std::vector<EffectColumn>& columns,
                                           const std::vector<std::vector<std::size_t>>& wanted) {
    const Eigen::MatrixXd products = products_of(columns);
    std::vector<EffectShape> shapes;
    for (const std::vector<std::size_t>& all : wanted) {
        EffectShape shape{.columns = all.size() > 1 ? determined(products, all) : all, .allowed = {}};
        shape.undetermined = all.size() - shape.columns.size();
        const auto same = [&](const EffectShape& earlier) {
            return same_span(products, shape.columns, earlier.columns);
        };
        // at a single joint they are also an encoder's offset and a rotor's inertia
        const bool offered =
            shape.undetermined == 0 || (!shape.columns.empty() && std::ranges::none_of(shapes, same) &&
                                        !on_single_output(columns, shape.columns));
        if (offered) {
            shapes.push_back(std::move(shape));
        }
    }
    return shapes;
}

MassChange mass_change(const Eigen::VectorXd& coefficients, const EffectShape& shape) {
    MassChange change;
    for (Eigen::Index i = 0; i < coefficients.size(); ++i) {
        const std::size_t column = shape.columns[static_cast<std::size_t>(i)] % columns_of_mass;
        if (column == 0) {
            change.mass = coefficients[i];
        } else {
            change.moments[static_cast<Eigen::Index>(column) - 1] = coefficients[i];
        }
    }
    return change;
}

bool has_moment(const EffectShape& shape, std::size_t axis) {
    return std::ranges::any_of(shape.columns,
                               [axis](std::size_t column) { return column % columns_of_mass == axis + 1; });
}

} // namespace dfdyn::tools
