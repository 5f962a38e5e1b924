// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"

#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double longest_delay_s = 0.25;
constexpr std::array<const char*, 6> axes{"fx", "fy", "fz", "mx", "my", "mz"};
constexpr std::array<const char*, 6> axis_units{"N", "N", "N", "N·m", "N·m", "N·m"};

/// One column per axis; each axis alone, or all of them together.
Candidate per_axis(const char* effect, const Eigen::VectorXd& series, const char* per) {
    Candidate result;
    result.effect = effect;
    result.where = "ft_sensor";
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        result.columns.push_back(on_output(axis, series));
        result.shapes.push_back({{static_cast<std::size_t>(axis)}, is_anything, 0});
    }
    for (const std::size_t first : {0U, 3U}) {
        result.shapes.push_back({{first, first + 1, first + 2}, is_anything, 0});
    }
    result.shapes.push_back(whole_shape(result, is_anything));
    result.parameters = [per = std::string(per)](const Eigen::VectorXd& coefficients,
                                                 const EffectShape& shape) {
        std::vector<EffectParameter> values;
        for (std::size_t i = 0; i < shape.columns.size(); ++i) {
            const std::size_t axis = shape.columns[i];
            values.push_back(
                {axes[axis], axis_units[axis] + per, coefficients[static_cast<Eigen::Index>(i)]});
        }
        return values;
    };
    return result;
}

/// From `from` into `to`; the gain of an axis where both are the same.
Candidate axis_gain(const Eigen::MatrixXd& wrench, Eigen::Index from, Eigen::Index to) {
    const bool own = from == to;
    const auto source = static_cast<std::size_t>(from);
    const auto sink = static_cast<std::size_t>(to);
    const std::string unit = std::string(axis_units[sink]) + "/" + axis_units[source];
    Candidate result = single_column(own ? "ft_gain" : "ft_crosstalk", "ft_sensor",
                                     on_output(to, wrench.col(from)), is_anything);
    result.detail = std::string(axes[source]) + " to " + axes[sink];
    result.parameters = [own, from, to, unit](const Eigen::VectorXd& coefficients, const EffectShape&) {
        const auto axis_from = static_cast<double>(from);
        const auto axis_to = static_cast<double>(to);
        if (own) {
            return std::vector<EffectParameter>{{"gain", "1", 1 + coefficients[0], 1}, {"axis", "", axis_to}};
        }
        return std::vector<EffectParameter>{
            {"gain", unit, coefficients[0]}, {"from_axis", "", axis_from}, {"to_axis", "", axis_to}};
    };
    return result;
}

/// Measured = rotation · true, of force and torque: roll, pitch, yaw about x, y, z.
Candidate rotation(const Eigen::MatrixXd& wrench) {
    Candidate result;
    result.effect = "ft_rotation";
    result.where = "ft_sensor";
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Eigen::MatrixXd change(wrench.rows(), 6);
        for (Eigen::Index row = 0; row < wrench.rows(); ++row) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
            const Eigen::Vector3d force = wrench.row(row).head<3>();
            const Eigen::Vector3d torque = wrench.row(row).tail<3>();
            change.row(row) << unit.cross(force).transpose(), unit.cross(torque).transpose();
        }
        result.columns.push_back(on_outputs(change));
        result.shapes.push_back({{static_cast<std::size_t>(axis)}, up_to(0.6), 0});
    }
    result.shapes.push_back(whole_shape(result, up_to(0.6)));
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        constexpr std::array names{"roll", "pitch", "yaw"};
        std::vector<EffectParameter> values;
        for (std::size_t i = 0; i < shape.columns.size(); ++i) {
            values.push_back({names[shape.columns[i]], "rad", coefficients[static_cast<Eigen::Index>(i)]});
        }
        return values;
    };
    return result;
}

std::vector<Candidate> wrench_candidates(const DiagnosisSignals& signals, const Eigen::MatrixXd& modelled,
                                         const Eigen::VectorXd& delays_s) {
    const Eigen::VectorXd elapsed = signals.measured.time_s.array() - signals.measured.time_s[0];
    std::vector<Candidate> result{per_axis("ft_bias", Eigen::VectorXd::Ones(signals.rows()), ""),
                                  per_axis("ft_drift", elapsed, "/s"), rotation(modelled)};
    for (Eigen::Index from = 0; from < 6; ++from) {
        for (Eigen::Index to = 0; to < 6; ++to) {
            result.push_back(axis_gain(modelled, from, to));
        }
    }
    Eigen::MatrixXd rates(modelled.rows(), 6);
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        rates.col(axis) = signals.per_delay(modelled.col(axis), delays_s[axis]);
    }
    result.push_back(single_column("delay", "ft_sensor", on_outputs(rates), positive_up_to(longest_delay_s),
                                   "delay", "s"));
    return result;
}

} // namespace

std::vector<Candidate> sensor_candidates(const DiagnosisSignals& signals, const Eigen::MatrixXd& modelled,
                                         const Eigen::VectorXd& delays_s, bool gains_known) {
    if (signals.wrench()) {
        return wrench_candidates(signals, modelled, delays_s);
    }
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        const auto output = static_cast<Eigen::Index>(joint);
        const std::string where = numbered("actuator", joint);
        const Eigen::VectorXd own = modelled.col(output);
        result.push_back(single_column("delay", where,
                                       on_output(output, signals.per_delay(own, delays_s[output])),
                                       positive_up_to(longest_delay_s), "delay", "s"));
        if (gains_known) {
            Candidate gain = single_column("actuator_gain", where, on_output(output, own), up_to(0.8));
            gain.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
                return std::vector<EffectParameter>{{"gain", "1", 1 / (1 + coefficients[0]), 1}};
            };
            result.push_back(std::move(gain));
        }
    }
    return result;
}

} // namespace dfdyn::tools
