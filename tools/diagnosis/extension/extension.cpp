// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extension.hpp"

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Adds the nuisance parameters, which are no findings: small mass errors and torque constants.
void add_nuisance(ModelExtension& extension, const DiagnosisWork& work) {
    const FittedEffects& fitted_effects = work.fitted_effects;
    const Eigen::Index bodies = fitted_effects.uncertain_masses;
    const auto count = static_cast<Eigen::Index>(fitted_effects.nuisance.size());
    const Eigen::VectorXd nominal = nominal_parameters(work.signals->robot, work.signals->kind);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double factor = fitted_effects.nuisance_factor(i);
        if (i < bodies) {
            // a mass error is one of the robot's file, not of a payload on the link
            extension.bodies.segment<10>(10 * i) += (factor - 1) * nominal.segment<10>(10 * i);
        } else {
            scale_output(extension, i - bodies, factor, false);
        }
    }
}

/// A gain multiplies what the arm does, and an effect beyond the arm is added after it. The firmware
/// multiplies all columns by the gain, so that the columns of such effects are divided by it.
void exclude_from_gain(ModelExtension& extension, const Eigen::VectorXd& nominal_gain) {
    for (ExtensionColumn& column : extension.columns) {
        const Effect* const effect = find_effect(column.effect.name);
        if (effect != nullptr && effect->beyond_arm) {
            const double gain = extension.output_gain[column.effect.row] / nominal_gain[column.effect.row];
            column.value /= gain;
            column.deviation /= gain;
        }
    }
}

/// Returns the coefficients of plain least squares of an output. The model is divided by the gain, which is
/// therefore at least a tenth.
Eigen::VectorXd divisible_coefficients(const DiagnosisWork& work, const TextbookFit& fit,
                                       const Eigen::MatrixXd& rigid, Eigen::Index output) {
    constexpr double least_gain = 0.1;
    const Eigen::VectorXd coefficients = fit.coefficients.col(output);
    return coefficients[0] >= least_gain
               ? coefficients
               : coefficients_with_gain(textbook_columns(*work.signals, rigid.col(output), output),
                                        work.measured.col(output), least_gain);
}

/// Replaces the columns of an output by those of plain least squares, in addition to the rigid body.
void take_least_squares(ModelExtension& extension, const DiagnosisWork& work, Eigen::Index output,
                        const Eigen::VectorXd& coefficients) {
    const std::string joint = place_text(PlaceKind::joint, static_cast<std::size_t>(output));
    std::erase_if(extension.columns,
                  [output](const ExtensionColumn& column) { return column.effect.row == output; });
    std::erase_if(extension.carried, [&joint](const ExtendedFinding& carried) {
        return carried.where == joint && effect_named(carried.effect).textbook.has_value();
    });
    for (ExtendedFinding& carried : extension.carried) {
        if (carried.where == joint) {
            carried.how = EffectDisposition::left_out;
        }
    }
    for (const Effect& effect : effect_catalogue()) {
        if (effect.textbook && !work.signals->wrench()) {
            extension.carried.push_back({effect.name, joint, EffectDisposition::adapting});
        }
    }
    const double gain = coefficients[0];
    extension.least_squares_gain[output] = gain;
    extension.output_gain[output] = work.torque_gains[output] * gain;
    const auto add = [&](const EffectKind& kind, double coefficient) {
        EffectModel effect;
        effect.name = kind.name;
        effect.row = static_cast<int>(output);
        if (kind.has(&EffectModel::sign_velocity)) {
            effect.sign_velocity = work.signals->sign_velocity[output];
        }
        add_column(extension, effect, coefficient / gain, std::abs(coefficient / gain));
    };
    if (!work.signals->wrench()) {
        add(effect_kinds::rotor_inertia, coefficients[1]);
        add(effect_kinds::viscous_friction, coefficients[2]);
        add(effect_kinds::coulomb_friction, coefficients[3]);
    }
    add(work.signals->wrench() ? effect_kinds::ft_bias : effect_kinds::torque_offset, coefficients[4]);
}

/// Uses plain least squares at all outputs where it is the extended model.
void take_least_squares(ModelExtension& extension, const DiagnosisWork& work) {
    const std::vector<bool>& chosen = work.diagnosis.by_least_squares;
    if (std::ranges::find(chosen, true) == chosen.end()) {
        return;
    }
    const DiagnosisSignals& signals = *work.signals;
    const Eigen::VectorXd stacked =
        stacked_regressor(extension.robot, extension.kind, signals.measured.motion) * extension.bodies;
    const Eigen::MatrixXd rigid = unstacked(stacked, signals.outputs());
    const TextbookFit fit = textbook_fit(signals, work.measured, rigid, signals.rows());
    for (std::size_t output = 0; output < chosen.size(); ++output) {
        if (chosen[output]) {
            const auto at = static_cast<Eigen::Index>(output);
            take_least_squares(extension, work, at, divisible_coefficients(work, fit, rigid, at));
        }
    }
}

} // namespace

ModelExtension nominal_extension(const DiagnosisWork& work) {
    const DiagnosisSignals& signals = *work.signals;
    return {signals.robot,     signals.kind, nominal_parameters(signals.robot, signals.kind), {},
            work.torque_gains, {},           Eigen::VectorXd::Ones(work.torque_gains.size())};
}

ModelExtension extension_of(const DiagnosisWork& work) {
    ModelExtension extension = nominal_extension(work);
    const FittedEffects& fitted_effects = work.fitted_effects;
    for (std::size_t i = 0; i < fitted_effects.chosen.size(); ++i) {
        const Candidate& candidate = fitted_effects.candidates[fitted_effects.chosen[i].candidate];
        if (!candidate.named()) {
            continue;
        }
        const EffectShape& shape = candidate.shapes[fitted_effects.chosen[i].shape];
        const Eigen::VectorXd coefficients = fitted_effects.coefficients(i);
        const Eigen::VectorXd deviations = fitted_effects.covariance(i).diagonal().cwiseMax(0).cwiseSqrt();
        const ChosenEffect chosen{*work.signals, candidate, shape, coefficients, deviations};
        const Effect& effect = effect_named(candidate.effect);
        const EffectDisposition how =
            effect.extend == nullptr ? EffectDisposition::left_out : effect.extend(extension, chosen);
        extension.carried.push_back({candidate.effect, candidate.where, how});
    }
    for (const StationaryContact& push : work.pushes) {
        extension.carried.push_back({effects::external_contact().name,
                                     place_text(PlaceKind::joint, push.joint), EffectDisposition::left_out});
    }
    exclude_from_gain(extension, work.torque_gains);
    add_nuisance(extension, work);
    take_least_squares(extension, work);
    sort_columns(extension);
    return extension;
}

ModelExtension names_only(const DiagnosisWork& work, const ModelExtension& extension) {
    ModelExtension result = nominal_extension(work);
    result.columns = extension.columns;
    for (ExtensionColumn& column : result.columns) {
        column.deviation = std::max(std::abs(column.value), column.deviation);
        column.value = 0;
    }
    return result;
}

} // namespace dfdyn::tools
