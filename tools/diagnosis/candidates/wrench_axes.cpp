// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/wrench_axes.hpp"

namespace dfdyn::tools {

Candidate on_each_axis(const Eigen::VectorXd& series, const std::array<ParameterKind, 6>& kinds) {
    Candidate result;
    result.where = "ft_sensor";
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        result.columns.push_back(on_output(axis, series));
        result.shapes.push_back({{static_cast<std::size_t>(axis)}, is_anything, 0});
    }
    for (const std::size_t first : {0U, 3U}) {
        result.shapes.push_back({{first, first + 1, first + 2}, is_anything, 0});
    }
    result.shapes.push_back(whole_shape(result, is_anything));
    result.parameters = [kinds](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        std::vector<EffectParameter> values;
        for (std::size_t i = 0; i < shape.columns.size(); ++i) {
            values.push_back(kinds[shape.columns[i]].at(coefficients[static_cast<Eigen::Index>(i)]));
        }
        return values;
    };
    return result;
}

Candidate AxisPair::candidate(const FittedModel& model) const {
    Candidate result = single_column("ft_sensor", on_output(to, model.output.col(from)), is_anything);
    result.detail = std::string(wrench_axes[static_cast<std::size_t>(from)]) + " to " +
                    wrench_axes[static_cast<std::size_t>(to)];
    return result;
}

} // namespace dfdyn::tools
