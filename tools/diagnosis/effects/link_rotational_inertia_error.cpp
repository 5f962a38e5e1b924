// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"

#include <Eigen/Eigenvalues>

#include <array>

namespace dfdyn::tools {

namespace {

/// A moment or product of inertia, and its index among the ten parameters of a body.
struct InertiaElement {
    ParameterKind parameter;
    Eigen::Index index;
};

constexpr std::array inertia_elements{
    InertiaElement{{"delta_ixx", "kg·m²"}, 4}, InertiaElement{{"delta_iyy", "kg·m²"}, 7},
    InertiaElement{{"delta_izz", "kg·m²"}, 9}, InertiaElement{{"delta_ixy", "kg·m²"}, 5},
    InertiaElement{{"delta_ixz", "kg·m²"}, 6}, InertiaElement{{"delta_iyz", "kg·m²"}, 8}};
constexpr std::size_t moment_count = 3; ///< number of moments, which come first

/// Log prior odds against this effect: rotors, which robot files lack, and masses explain most such torques.
constexpr double rotational_rarity = 4;

/// Nominal parameters of the effect's body in the frame of its link.
InertialParameters nominal_link(const DiagnosisSignals& signals, Eigen::Index number) {
    return nominal_parameters(signals.robot, signals.kind).segment<10>(10 * number);
}

/// Requires an inertia that a body can have, with moments of at most five times the nominal ones.
CoefficientRule possible_inertia(const InertialParameters& nominal,
                                 const std::vector<const InertiaElement*>& changed) {
    return [nominal, changed](const Eigen::VectorXd& coefficients) {
        constexpr double largest = 5;
        InertialParameters body = nominal;
        for (std::size_t i = 0; i < changed.size(); ++i) {
            body[changed[i]->index] += coefficients[static_cast<Eigen::Index>(i)];
        }
        const auto trace = [](const InertialParameters& of) { return of[4] + of[7] + of[9]; };
        return !inertia_fault(body).has_value() && trace(body) <= largest * trace(nominal);
    };
}

/// Returns whether the columns of `outputs` are separable: each coefficient can be identified.
bool separable(Eigen::MatrixXd outputs) {
    constexpr double smallest_eigenvalue = 1e-3;
    outputs.colwise().normalize();
    const Eigen::MatrixXd gram = outputs.transpose() * outputs;
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues()[0] > smallest_eigenvalue;
}

/// Errors of one moment of inertia, and of all elements if the motion can tell them apart. The mass
/// and the centre of mass remain. So the change about the centre of mass equals the one about the link's
/// origin.
std::vector<Candidate> rotational_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const auto index = static_cast<Eigen::Index>(number);
    const Eigen::Index bodies = signals.regressor.cols() / 10;
    const InertialParameters nominal = nominal_link(signals, index);
    Candidate result;
    result.where = numbered("link", signals.joints() - static_cast<std::size_t>(bodies - index));
    result.extra_price = rotational_rarity;
    std::vector<const InertiaElement*> kept;
    Eigen::MatrixXd outputs(signals.nominal.size(), 0);
    for (std::size_t i = 0; i < inertia_elements.size(); ++i) {
        const Eigen::MatrixXd series =
            signals.of_body(index, InertialParameters::Unit(inertia_elements[i].index));
        if (!(series.norm() > 1e-6 * std::sqrt(static_cast<double>(series.size())))) {
            continue; // the outputs do not depend on it
        }
        if (i < moment_count) {
            result.shapes.push_back({{kept.size()}, possible_inertia(nominal, {&inertia_elements[i]})});
        }
        result.columns.push_back(on_outputs(series));
        kept.push_back(&inertia_elements[i]);
        outputs.conservativeResize(Eigen::NoChange, outputs.cols() + 1);
        outputs.rightCols<1>() = series.reshaped();
    }
    if (kept.size() > 1 && separable(outputs)) {
        result.shapes.push_back(whole_shape(result, possible_inertia(nominal, kept)));
    }
    result.parameters = [kept](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        std::vector<EffectParameter> values;
        for (std::size_t i = 0; i < shape.columns.size(); ++i) {
            values.push_back(
                kept[shape.columns[i]]->parameter.at(coefficients[static_cast<Eigen::Index>(i)]));
        }
        return values;
    };
    return result.shapes.empty() ? std::vector<Candidate>() : std::vector{std::move(result)};
}

/// Changes the link's inertia in the model.
EffectDisposition extend_by_inertia(Extension& extension, const ChosenEffect& chosen) {
    auto body = extension.body(chosen.number());
    const std::vector<EffectParameter> found = chosen.candidate.parameters(chosen.coefficients, chosen.shape);
    for (const EffectParameter& parameter : found) {
        for (const InertiaElement& element : inertia_elements) {
            body[element.index] += parameter.name == element.parameter.name ? parameter.value : 0;
        }
    }
    return EffectDisposition::adapting;
}

} // namespace

Effect effects::link_rotational_inertia_error() {
    return {.name = "link_rotational_inertia_error",
            .where = "linkK",
            .parameters = {inertia_elements[0].parameter, inertia_elements[1].parameter,
                           inertia_elements[2].parameter, inertia_elements[3].parameter,
                           inertia_elements[4].parameter, inertia_elements[5].parameter},
            .evidence = "follows the accelerations that turn the link, like a moment of inertia that differs "
                        "from the model's",
            .experiment = "turn this link fast and slowly about its own axes in the same postures; a rotor's "
                          "inertia depends on one joint only",
            .in_extended_model = "adapting: the rigid body's parameters start there",
            .error_of_link = true,
            .each = Each::body,
            .candidates = rotational_candidates,
            .extend = extend_by_inertia};
}

} // namespace dfdyn::tools
