// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/nuisance_parameters.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

namespace dfdyn::tools {

namespace {

/// standard deviation of a link's relative mass error, uniform within ±10 %
constexpr double mass_error = 0.058;
constexpr double any_gain = 10;      ///< of the relative error of an unknown torque constant
constexpr double no_friction = 1e-9; ///< N·m
/// Standard deviation of a lag relative to the friction: the weight of a way is between 0 and 1.
constexpr double lag_share = 0.5;

std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals) {
    const Eigen::VectorXd parameters = nominal_parameters(signals.robot, signals.kind);
    std::vector<EffectColumn> columns;
    for (Eigen::Index body = 0; body < parameters.size() / 10; ++body) {
        columns.push_back(on_outputs(signals.of_body(body, parameters.segment<10>(10 * body))));
    }
    return columns;
}

bool is_dry_friction(const std::string& name) {
    const Effect* const effect = find_effect(name);
    return effect != nullptr && effect->friction && effect->textbook != TextbookTerm::viscous;
}

/// Returns the differences between friction that builds up over longer and over shorter ways.
std::vector<EffectColumn> lag_columns(const JointSignals& joint) {
    std::vector<Eigen::VectorXd> ways = sliding_directions(joint);
    ways.push_back(dahl(joint, shortest_presliding));
    std::vector<EffectColumn> columns;
    for (std::size_t way = 1; way < ways.size(); ++way) {
        columns.push_back(joint.column(ways[way] - ways[way - 1]));
    }
    return columns;
}

} // namespace

FittedEffects model_without_effects(const DiagnosisSignals& signals, bool gains_known) {
    FittedEffects model;
    model.nuisance = mass_columns(signals);
    model.uncertain_masses = std::ssize(model.nuisance);
    for (Eigen::Index joint = 0; !gains_known && joint < signals.outputs(); ++joint) {
        model.nuisance.push_back(on_output(joint, signals.nominal.col(joint)));
    }
    return model;
}

NuisanceParameters::NuisanceParameters(const DiagnosisSignals& signals, const SpectralRows& rows,
                                       const FittedEffects& model) {
    const auto add = [&](const EffectColumn& column) {
        columns_.push_back(std::make_shared<const SpectralColumn>(rows, column));
    };
    for (const EffectColumn& column : model.nuisance) {
        deviations_.push_back(std::ssize(deviations_) < model.uncertain_masses ? mass_error : any_gain);
        add(column);
    }
    for (std::size_t number = 0; !signals.wrench() && number < signals.joints(); ++number) {
        if (signals.hardly_moves(number)) {
            continue;
        }
        const JointSignals joint(signals, number);
        for (const EffectColumn& column : lag_columns(joint)) {
            add(column);
            lag_joints_.push_back(joint.where);
        }
    }
}

std::vector<NuisanceColumn> NuisanceParameters::priors() const {
    std::vector<NuisanceColumn> result;
    for (const double deviation : deviations_) {
        result.push_back({std::ssize(result), deviation});
    }
    return result;
}

std::vector<NuisanceColumn> NuisanceParameters::lags(const DiagnosisSignals& signals,
                                                     const FittedEffects& fitted) const {
    Eigen::Index column = std::ssize(deviations_);
    std::vector<NuisanceColumn> result;
    for (const std::string& joint : lag_joints_) {
        const Eigen::MatrixXd friction =
            fitted.contribution_of(signals, [&joint](const Candidate& candidate) {
                return candidate.where == joint && is_dry_friction(candidate.effect);
            });
        const double level = std::sqrt(friction.squaredNorm() / static_cast<double>(friction.rows()));
        result.push_back({column++, std::max(lag_share * level, no_friction)});
    }
    return result;
}

} // namespace dfdyn::tools
