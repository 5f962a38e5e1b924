// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <Eigen/Cholesky>

namespace dfdyn::tools {

namespace {

constexpr const char* last_body = "last body"; // a payload is part of the last link

/// Point mass at `centre`, per kg; and its first moment moved by 1 kg·m along `axis` while the mass stays.
InertialParameters point_mass(const Eigen::Vector3d& centre) {
    return body_parameters(1, centre, Eigen::Matrix3d::Zero());
}
InertialParameters first_moment(const Eigen::Vector3d& centre, Eigen::Index axis) {
    constexpr double step = 1e-4; // m: linear in it up to this
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
    return (point_mass(centre + shift) - point_mass(centre - shift)) / (2 * step);
}

/// Mass at `centre`, then the three first moments about it, of body `body`; seen in a frame at `placement` of
/// it.
std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals, Eigen::Index body,
                                       const Eigen::Vector3d& centre, const Eigen::Isometry3d& placement) {
    std::vector<EffectColumn> columns{
        on_outputs(signals.of_body(body, moved(point_mass(centre), placement)))};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        columns.push_back(on_outputs(signals.of_body(body, moved(first_moment(centre, axis), placement))));
    }
    return columns;
}

constexpr double farthest_payload = 0.5; // m from the tip

/// The best mass and moments with the centre of mass as far off as it may be, by the multiplier of that
/// bound.
Eigen::VectorXd at_farthest(const Eigen::MatrixXd& squares, const Eigen::VectorXd& moments) {
    constexpr double margin = 0.999;
    const double bound = margin * farthest_payload;
    const Eigen::Vector4d cone(-bound * bound, 1, 1, 1); // times the coefficients' squares: 0 at the bound
    const auto at = [&](double multiplier) {
        Eigen::MatrixXd system = squares;
        system.diagonal() += multiplier * cone;
        const Eigen::LLT<Eigen::MatrixXd> factor(system);
        return factor.info() == Eigen::Success ? Eigen::VectorXd(factor.solve(moments))
                                               : Eigen::VectorXd::Zero(4).eval();
    };
    double low = 0;
    double high = 1e-9 * squares.trace();
    const auto outside = [&](const Eigen::VectorXd& c) { return c.cwiseAbs2().dot(cone) > 0; };
    for (int doubling = 0; doubling < 60 && outside(at(high)); ++doubling) {
        low = high;
        high *= 2;
    }
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = (low + high) / 2;
        (outside(at(middle)) ? low : high) = middle;
    }
    return at(high);
}

bool within_reach(const Eigen::VectorXd& coefficients) {
    return coefficients[0] > 0 &&
           coefficients.tail(coefficients.size() - 1).norm() <= farthest_payload * coefficients[0];
}

std::vector<EffectParameter> payload_parameters(const Eigen::VectorXd& coefficients, const EffectShape&) {
    std::vector<EffectParameter> values{{"mass", "kg", coefficients[0]}};
    constexpr std::array names{"com_x", "com_y", "com_z"};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const bool fitted = coefficients.size() == 4;
        values.push_back({names[static_cast<std::size_t>(axis)], "m",
                          fitted ? coefficients[axis + 1] / coefficients[0] : 0.0});
    }
    return values;
}

Candidate payload(const DiagnosisSignals& signals) {
    Candidate result;
    result.effect = "payload";
    result.where = "tool";
    result.span = last_body;
    result.columns = payload_columns(signals);
    result.shapes = {{{0}, within_reach, 0}, {{0, 1, 2, 3}, within_reach, 0, 3, at_farthest}};
    result.parameters = payload_parameters;
    return result;
}

Candidate link_inertia(const DiagnosisSignals& signals, Eigen::Index number) {
    const Eigen::VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    const Eigen::Index bodies = nominal.size() / 10;
    const auto link = signals.joints() - static_cast<std::size_t>(bodies - number);
    const double mass = nominal[10 * number];
    const Eigen::Vector3d centre =
        mass > 0 ? Eigen::Vector3d(nominal.segment<3>(10 * number + 1) / mass) : Eigen::Vector3d::Zero();
    Candidate result;
    result.effect = "link_inertia_error";
    result.where = numbered("link", link);
    result.span = number + 1 == bodies ? last_body : "";
    result.columns = mass_columns(signals, number, centre, Eigen::Isometry3d::Identity());
    const auto body = [mass](double delta_mass, const Eigen::VectorXd& moments) {
        constexpr double farthest = 0.3; // m that a centre of mass is off
        constexpr double heaviest = 5;   // times what the robot's file says
        return mass + delta_mass > 0 && mass + delta_mass <= heaviest * mass &&
               moments.norm() <= farthest * (mass + delta_mass);
    };
    result.shapes = {
        {{0}, [body](const Eigen::VectorXd& c) { return body(c[0], Eigen::VectorXd::Zero(3)); }, 0},
        {{1, 2, 3}, [body](const Eigen::VectorXd& c) { return body(0, c); }, 0},
        {{0, 1, 2, 3}, [body](const Eigen::VectorXd& c) { return body(c[0], c.tail(3)); }, 0, 3}};
    result.parameters = [mass](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        const bool with_mass = shape.columns.front() == 0;
        const double delta_mass = with_mass ? coefficients[0] : 0;
        std::vector<EffectParameter> values{{"delta_mass", "kg", delta_mass}};
        constexpr std::array names{"delta_com_x", "delta_com_y", "delta_com_z"};
        for (Eigen::Index axis = 0; axis < 3 && shape.columns.size() > 1; ++axis) {
            values.push_back({names[static_cast<std::size_t>(axis)], "m",
                              coefficients[axis + (with_mass ? 1 : 0)] / (mass + delta_mass)});
        }
        return values;
    };
    return result;
}

/// The outputs of an arm whose base turned by +x, then +y: it sees gravity turned the other way.
Eigen::MatrixXd tilted(const DiagnosisSignals& signals, double x, double y) {
    Robot robot = signals.robot;
    robot.gravity = Eigen::AngleAxisd(-x, Eigen::Vector3d::UnitX()) *
                    (Eigen::AngleAxisd(-y, Eigen::Vector3d::UnitY()) * robot.gravity);
    return rigid_outputs(robot, signals.kind, signals.measured.motion);
}

/// About a tilt by x and y: the columns' sum with these coefficients is what that tilt brings, exactly.
Candidate tilt(const DiagnosisSignals& signals, double x, double y) {
    Candidate result;
    result.effect = "gravity_tilt";
    result.where = "base";
    const double along_x = at_least_small(x);
    const double along_y = at_least_small(y);
    const Eigen::MatrixXd first = tilted(signals, 0, along_y);
    result.columns = {on_outputs((tilted(signals, along_x, along_y) - first) / along_x),
                      on_outputs((first - signals.nominal) / along_y)};
    result.shapes = {whole_shape(result, up_to(0.6))};
    result.about = [&signals](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return tilt(signals, coefficients[0], coefficients[1]);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"tilt_x", "rad", coefficients[0]},
                                            {"tilt_y", "rad", coefficients[1]}};
    };
    return result;
}

} // namespace

std::vector<EffectColumn> payload_columns(const DiagnosisSignals& signals) {
    const Eigen::Index last = signals.regressor.cols() / 10 - 1;
    return mass_columns(signals, last, Eigen::Vector3d::Zero(), signals.robot.tip_placement);
}

Candidate taken_payload(const DiagnosisSignals& signals, const std::vector<EffectColumn>& lasting,
                        const std::vector<double>& times_s) {
    Candidate result;
    result.effect = "payload";
    result.where = "tool";
    result.detail = "taken";
    result.family = "payload";
    for (const double time_s : times_s) {
        const std::size_t first = result.columns.size();
        const Eigen::VectorXd there = (signals.measured.time_s.array() >= time_s).cast<double>();
        for (EffectColumn column : lasting) {
            for (EffectColumn::Part& part : column.parts) {
                part.series = part.series.cwiseProduct(there);
            }
            result.columns.push_back(std::move(column));
        }
        result.shapes.push_back({{first}, within_reach, time_s});
        result.shapes.push_back({{first, first + 1, first + 2, first + 3}, within_reach, time_s, 3});
    }
    result.about = [&signals, &lasting](const EffectShape& shape, const Eigen::VectorXd&) {
        const double time_s = shape.value;
        return taken_payload(signals, lasting,
                             {time_s, time_s - 0.12, time_s - 0.04, time_s + 0.04, time_s + 0.12});
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        std::vector<EffectParameter> values = payload_parameters(coefficients, shape);
        values.push_back({"attached", "s", shape.value, shape.value});
        return values;
    };
    return result;
}

std::vector<Candidate> body_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> result{payload(signals), tilt(signals, 0, 0)};
    result.front().family = "payload";
    for (Eigen::Index body = 0; body < signals.regressor.cols() / 10; ++body) {
        result.push_back(link_inertia(signals, body));
    }
    return result;
}

} // namespace dfdyn::tools
