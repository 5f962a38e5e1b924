// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extension.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Adds the nuisance parameters, which are no findings: small mass errors and torque constants.
void add_nuisance(Extension& extension, const DiagnosisWork& work) {
    const Explanation& explanation = work.explanation;
    const Eigen::Index bodies = explanation.uncertain_masses;
    const auto count = static_cast<Eigen::Index>(explanation.nuisance.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        const double factor = explanation.nuisance_factor(i);
        if (i < bodies) {
            extension.bodies.segment<10>(10 * i) *= factor;
        } else {
            scale_output(extension, i - bodies, factor, false);
        }
    }
}

} // namespace

Extension nominal_extension(const DiagnosisWork& work) {
    const DiagnosisSignals& signals = *work.signals;
    return {signals.robot,
            signals.kind,
            nominal_parameters(signals.robot, signals.kind),
            {},
            work.torque_gains,
            {}};
}

Extension extension_of(const DiagnosisWork& work) {
    Extension extension = nominal_extension(work);
    const Explanation& explanation = work.explanation;
    for (std::size_t i = 0; i < explanation.chosen.size(); ++i) {
        const Candidate& candidate = explanation.candidates[explanation.chosen[i].candidate];
        if (!candidate.named()) {
            continue;
        }
        const EffectShape& shape = candidate.shapes[explanation.chosen[i].shape];
        const Eigen::VectorXd coefficients = explanation.coefficients(i);
        const Eigen::VectorXd deviations = explanation.covariance(i).diagonal().cwiseMax(0).cwiseSqrt();
        const ChosenEffect chosen{*work.signals, candidate, shape, coefficients, deviations};
        const Effect& effect = effect_named(candidate.effect);
        const EffectDisposition how =
            effect.extend == nullptr ? EffectDisposition::left_out : effect.extend(extension, chosen);
        extension.carried.push_back({candidate.effect, candidate.where, how});
    }
    for (const StandingContact& push : work.pushes) {
        extension.carried.push_back(
            {effects::external_contact().name, numbered("joint", push.joint), EffectDisposition::left_out});
    }
    add_nuisance(extension, work);
    sort_columns(extension);
    return extension;
}

Extension names_only(const DiagnosisWork& work, const Extension& extension) {
    Extension result = nominal_extension(work);
    result.columns = extension.columns;
    for (ExtensionColumn& column : result.columns) {
        column.deviation = std::max(std::abs(column.value), column.deviation);
        column.value = 0;
    }
    return result;
}

} // namespace dfdyn::tools
