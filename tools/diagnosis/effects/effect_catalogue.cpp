// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <algorithm>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

std::size_t count_of(Each each, const DiagnosisSignals& signals) {
    switch (each) {
    case Each::sensor:
        return signals.wrench() ? 1 : 0;
    case Each::axis_pair:
        return signals.wrench() ? 36 : 0;
    case Each::reading:
        return signals.wrench() ? 1 : signals.joints();
    case Each::torque_joint:
        return signals.wrench() ? 0 : signals.joints();
    case Each::arm:
        return 1;
    case Each::body:
        return static_cast<std::size_t>(signals.regressor.cols() / 10);
    case Each::joint:
        return signals.joints();
    }
    return 0;
}

/// Returns the candidates of the effects at all their places. `make` returns those of one effect at one
/// place.
template <class Make>
std::vector<Candidate> candidates_by(const DiagnosisSignals& signals, std::span<const Effect> effects,
                                     const Make& make) {
    std::vector<Candidate> result;
    if (effects.empty()) {
        return result;
    }
    const Each last = std::ranges::max_element(effects, {}, &Effect::each)->each;
    for (int kind = 0; kind <= static_cast<int>(last); ++kind) {
        const auto each = static_cast<Each>(kind);
        for (std::size_t number = 0; number < count_of(each, signals); ++number) {
            for (const Effect& effect : effects) {
                if (effect.each != each) {
                    continue;
                }
                for (Candidate& candidate : make(effect, number)) {
                    candidate.effect = effect.name;
                    result.push_back(std::move(candidate));
                }
            }
        }
    }
    return result;
}

} // namespace

const std::vector<Effect>& effect_catalogue() {
    using namespace effects;
    static const std::vector<Effect> catalogue{
        viscous_friction(),
        coulomb_friction(),
        stribeck_friction(),
        presliding_hysteresis(),
        joint_spring(),
        load_dependent_friction(),
        torque_offset(),
        rotor_inertia(),
        torque_ripple(),
        friction_drift(),
        external_contact(),
        payload(),
        gravity_tilt(),
        link_inertia_error(),
        link_rotational_inertia_error(),
        encoder_offset(),
        encoder_eccentricity(),
        joint_flexibility(),
        backlash(),
        delay(),
        actuator_gain(),
        ft_bias(),
        ft_drift(),
        ft_rotation(),
        ft_gain(),
        ft_crosstalk(),
    };
    return catalogue;
}

const Effect* find_effect(const std::string& name) {
    const std::vector<Effect>& catalogue = effect_catalogue();
    const auto found =
        std::ranges::find_if(catalogue, [&](const Effect& effect) { return name == effect.name; });
    return found == catalogue.end() ? nullptr : &*found;
}

const Effect& effect_named(const std::string& name) {
    const Effect* const effect = find_effect(name);
    if (effect == nullptr) {
        throw std::logic_error("no effect " + name + " in the catalogue");
    }
    return *effect;
}

bool has_trait(const std::string& effect, bool Effect::*trait) {
    const Effect* const found = find_effect(effect);
    return found != nullptr && found->*trait;
}

std::vector<Candidate> static_candidates(const DiagnosisSignals& signals, std::span<const Effect> effects) {
    return candidates_by(signals, effects, [&](const Effect& effect, std::size_t number) {
        return effect.candidates == nullptr ? std::vector<Candidate>() : effect.candidates(signals, number);
    });
}

std::vector<Candidate> fitted_candidates(const DiagnosisSignals& signals, const FittedModel& model,
                                         std::span<const Effect> effects) {
    return candidates_by(signals, effects, [&](const Effect& effect, std::size_t number) {
        return effect.fitted_candidates == nullptr ? std::vector<Candidate>()
                                                   : effect.fitted_candidates(signals, model, number);
    });
}

} // namespace dfdyn::tools
