// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/explanation.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/candidates.hpp"
#include "tools/diagnosis/candidates/scans.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/search/candidate_entry.hpp"
#include "tools/diagnosis/search/robust_values.hpp"
#include "tools/diagnosis/search/settle_explanation.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr int most_rounds = 10;
constexpr int white_rounds = 3;
/// standard deviation of a link's relative mass error, uniform within ±10 %
constexpr double mass_deviation = 0.058;

/// Returns a chosen candidate, relinearized about its estimate. The number of its new shapes does not change
/// its prior.
Candidate about(const Candidate& chosen, const EffectShape& shape, const Eigen::VectorXd& coefficients) {
    Candidate result = chosen.about(shape, coefficients);
    result.effect = chosen.effect;
    result.family = chosen.family;
    result.extra_price = chosen.extra_price;
    result.tried =
        chosen.tried * static_cast<double>(chosen.shapes.size()) / static_cast<double>(result.shapes.size());
    return result;
}

/// Returns the joint (from 0) at which a named candidate acts on measured torques; empty for other places.
std::optional<std::size_t> own_joint(const DiagnosisSignals& signals, const Candidate& candidate) {
    const std::string& where = candidate.where;
    const bool at_joint = where.starts_with("joint") || where.starts_with("actuator");
    const std::size_t digits = where.find_first_of("0123456789");
    if (signals.wrench() || !candidate.named() || !at_joint || digits == std::string::npos) {
        return std::nullopt;
    }
    return std::stoul(where.substr(digits)) - 1;
}

/// Returns whether a candidate can be seen: nothing can be at a joint that hardly moves.
bool visible(const DiagnosisSignals& signals, const Candidate& candidate) {
    const std::optional<std::size_t> joint = own_joint(signals, candidate);
    return !joint || !signals.hardly_moves(*joint);
}

class Search {
  public:
    Search(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
           const ExplanationOptions& options)
        : signals_(signals), options_(options), rows_(signals.measured),
          regression_(rows_, measured - signals.nominal, rows_.frames_within(options.fitted_share)) {
        add_nuisance();
        for (Candidate& candidate : lasting_candidates(signals_, options_.effects)) {
            if (visible(signals_, candidate)) {
                lasting_.emplace_back(rows_, std::move(candidate));
            }
        }
        for (const Effect& effect : options_.effects) {
            if (effect.scan != nullptr) {
                scans_.push_back({&effect, effect.scan(signals_, rows_)});
            }
        }
        for (Candidate& candidate : dependence_candidates(signals_, measured - signals.nominal)) {
            lasting_.emplace_back(rows_, std::move(candidate));
        }
        gather({});
        at_.fit = fit_effects(at_.problem, {});
        estimate_noise(true);
    }

    Explanation run() {
        std::vector<std::string> last;
        for (int round = 0; round < most_rounds; ++round) {
            if (options_.progress) {
                options_.progress(round);
            }
            std::vector<CandidateEntry> dependent = passing();
            refine();
            gather(std::move(dependent));
            at_.chosen = search_effects(at_.problem, at_.chosen);
            at_.fit = fit_effects(at_.problem, at_.chosen);
            // with the spectrum of a residual that still contains effects, these effects would be taken for
            // noise
            estimate_noise(round + 1 < white_rounds);
            if (round + 1 == white_rounds) {
                forget_prices();
            }
            std::vector<std::string> keys = chosen_keys();
            if (keys == last && round > white_rounds) {
                break;
            }
            last = std::move(keys);
        }
        settle(at_, regression_);
        make_robust(at_, regression_);
        return std::move(at_);
    }

  private:
    void add_nuisance();
    FittedModel fitted_model() const;
    FittedResidual fitted_residual() const;
    std::vector<CandidateEntry> passing() const;
    void refine();
    void place_nuisance();
    void count_rivals();
    void gather(std::vector<CandidateEntry> passing);
    void estimate_noise(bool white);
    void forget_prices();
    std::vector<std::string> chosen_keys() const;
    Eigen::VectorXd of_named(Eigen::VectorXd coefficients) const;

    const DiagnosisSignals& signals_;
    const ExplanationOptions& options_;
    SpectralRows rows_;
    struct Scan {
        const Effect* effect;
        std::unique_ptr<EffectScan> scan;
    };
    std::vector<Scan> scans_;
    EffectRegression regression_;
    std::vector<CandidateEntry> lasting_; ///< candidates that do not depend on the current model
    std::vector<SpectralColumnPointer> nuisance_;
    std::vector<double> nuisance_deviation_;
    Explanation at_;
};

/// Adds the nuisance parameters: small errors of the links' masses, and unknown torque constants.
void Search::add_nuisance() {
    const auto add = [this](EffectColumn column, double deviation) {
        nuisance_.push_back(std::make_shared<const SpectralColumn>(rows_, column));
        nuisance_deviation_.push_back(deviation);
        at_.nuisance.push_back(std::move(column));
    };
    const Eigen::VectorXd parameters = nominal_parameters(signals_.robot, signals_.kind);
    for (Eigen::Index body = 0; body < parameters.size() / 10; ++body) {
        add(on_outputs(signals_.of_body(body, parameters.segment<10>(10 * body))), mass_deviation);
    }
    for (Eigen::Index joint = 0; !options_.gains_known && joint < signals_.outputs(); ++joint) {
        add(on_output(joint, signals_.nominal.col(joint)), 10);
    }
    at_.uncertain_masses = parameters.size() / 10;
}

FittedModel Search::fitted_model() const {
    const auto of = [&](bool Effect::*trait, bool value) {
        return at_.effects(signals_, [trait, value](const Candidate& candidate) {
            return has_trait(candidate.effect, trait) == value;
        });
    };
    FittedModel model{signals_.nominal + of(&Effect::beyond_arm, false),
                      signals_.wrench() ? Eigen::MatrixXd() : of(&Effect::friction, true),
                      Eigen::VectorXd::Zero(signals_.outputs()), options_.gains_known};
    for (std::size_t i = 0; i < at_.chosen.size(); ++i) {
        const Candidate& candidate = at_.candidates[at_.chosen[i].candidate];
        if (has_trait(candidate.effect, &Effect::delays_output)) {
            for (const EffectColumn::Part& part : candidate.columns.front().parts) {
                model.delay_s[part.output] = at_.fit.coefficients[at_.first_column(i)];
            }
        }
    }
    return model;
}

FittedResidual Search::fitted_residual() const {
    const Eigen::VectorXd coefficients = at_.fit.of_all(regression_.columns());
    return {signals_, regression_, coefficients, of_named(coefficients),
            weighed_residual(regression_, coefficients)};
}

/// Returns the candidates that depend on the current model.
std::vector<CandidateEntry> Search::passing() const {
    std::vector<Candidate> found;
    const auto add = [&](std::vector<Candidate> more) {
        for (Candidate& candidate : more) {
            if (visible(signals_, candidate) &&
                std::ranges::find(found, candidate.key(), &Candidate::key) == found.end()) {
                found.push_back(std::move(candidate));
            }
        }
    };
    add(fitted_candidates(signals_, fitted_model(), options_.effects));
    for (std::size_t i = 0; i < at_.chosen.size(); ++i) {
        const Candidate& chosen = at_.candidates[at_.chosen[i].candidate];
        if (chosen.about) {
            const Eigen::Index first = at_.first_column(i);
            add({about(chosen, chosen.shapes[at_.chosen[i].shape],
                       at_.fit.coefficients.segment(first, at_.first_column(i + 1) - first))});
        } else if (has_trait(chosen.effect, &Effect::kept_while_chosen)) {
            add({chosen});
        }
    }
    const FittedResidual residual = fitted_residual();
    for (const auto& [effect, scan] : scans_) {
        std::vector<Candidate> more = scan->candidates(residual);
        for (Candidate& candidate : more) {
            candidate.effect = effect->name;
        }
        add(std::move(more));
        std::vector<Candidate*> own;
        for (Candidate& candidate : found) {
            if (candidate.effect == effect->name) {
                own.push_back(&candidate);
            }
        }
        scan->set_prices(own, residual);
    }
    std::vector<CandidateEntry> result;
    for (Candidate& candidate : found) {
        result.emplace_back(rows_, std::move(candidate));
    }
    return result;
}

/// Adds shapes near the chosen one to chosen candidates with a continuous shape.
void Search::refine() {
    for (ChosenShape& one : at_.chosen) {
        const Candidate& chosen = at_.candidates[one.candidate];
        if (chosen.at_value) {
            const auto entry =
                std::find_if(lasting_.begin(), lasting_.end(), [&](const CandidateEntry& candidate) {
                    return candidate.candidate.key() == chosen.key();
                });
            one.shape = entry->refine(one.shape, rows_);
        }
    }
}

/// Uses the first columns for the nuisance parameters.
void Search::place_nuisance() {
    at_.problem.nuisance.clear();
    for (std::size_t i = 0; i < nuisance_.size(); ++i) {
        at_.problem.nuisance.push_back({static_cast<Eigen::Index>(i), nuisance_deviation_[i]});
    }
}

/// Counts the candidates of each class: named and unnamed.
void Search::count_rivals() {
    const auto named = std::ranges::count_if(at_.candidates, &Candidate::named);
    const auto unnamed = std::ssize(at_.candidates) - named;
    for (std::size_t i = 0; i < at_.candidates.size(); ++i) {
        at_.problem.candidates[i].rivals = static_cast<double>(at_.candidates[i].named() ? named : unnamed);
    }
}

/// Builds the problem of all candidates with the current noise. Chosen candidates remain chosen if they still
/// exist.
void Search::gather(std::vector<CandidateEntry> passing) {
    struct Kept {
        std::string key;
        std::size_t shape;
        std::optional<std::size_t> columns; ///< of the shape, if shapes are made for each model
    };
    std::vector<Kept> chosen;
    for (const ChosenShape& one : at_.chosen) {
        const Candidate& candidate = at_.candidates[one.candidate];
        chosen.push_back({candidate.key(), one.shape, {}});
        if (candidate.about) {
            chosen.back().columns = candidate.shapes[one.shape].columns.size();
        }
    }
    std::vector<SpectralColumnPointer> columns = nuisance_;
    std::map<std::string, std::size_t> families{{"", 0}};
    at_.candidates.clear();
    at_.problem.candidates.clear();
    const auto add = [&](const CandidateEntry& entry) {
        SearchCandidate candidate;
        candidate.family = families.emplace(entry.candidate.family, families.size()).first->second;
        candidate.tried = entry.candidate.tried;
        candidate.extra_price = entry.candidate.extra_price;
        for (const EffectShape& shape : entry.candidate.shapes) {
            SearchCandidate::Shape one{{}, shape.allowed, shape.bounded, shape.nearest};
            for (const std::size_t column : shape.columns) {
                one.columns.push_back(static_cast<Eigen::Index>(columns.size() + column));
            }
            candidate.shapes.push_back(std::move(one));
        }
        columns.insert(columns.end(), entry.columns.begin(), entry.columns.end());
        at_.problem.candidates.push_back(std::move(candidate));
        at_.candidates.push_back(entry.candidate);
    };
    for (const CandidateEntry& entry : lasting_) {
        const std::string key = entry.candidate.key();
        if (std::ranges::none_of(passing,
                                 [&](const CandidateEntry& one) { return one.candidate.key() == key; })) {
            add(entry);
        }
    }
    std::ranges::for_each(passing, add);
    count_rivals();
    place_nuisance();
    regression_.set_columns(std::move(columns));
    at_.problem.sums = regression_.weighed_sums();
    at_.chosen.clear();
    for (const Kept& one : chosen) {
        const auto found = std::ranges::find(at_.candidates, one.key, &Candidate::key);
        if (found == at_.candidates.end()) {
            continue;
        }
        const auto as_many = [&](const EffectShape& shape) { return shape.columns.size() == one.columns; };
        const auto same = std::ranges::find_if(found->shapes, as_many);
        at_.chosen.push_back(
            {static_cast<std::size_t>(found - at_.candidates.begin()),
             one.columns ? static_cast<std::size_t>(same - found->shapes.begin()) : one.shape});
    }
}

Eigen::VectorXd Search::of_named(Eigen::VectorXd coefficients) const {
    for (const ChosenShape& one : at_.chosen) {
        if (!at_.candidates[one.candidate].named()) {
            coefficients(at_.problem.candidates[one.candidate].shapes[one.shape].columns).setZero();
        }
    }
    return coefficients;
}

void Search::estimate_noise(bool white) {
    const Eigen::VectorXd coefficients = at_.fit.of_all(regression_.columns());
    Eigen::MatrixXd noise(rows_.bins(), regression_.outputs());
    std::vector<Eigen::MatrixXd> unrest;
    for (Eigen::Index output = 0; output < noise.cols(); ++output) {
        const Eigen::MatrixXd left = regression_.residual(output, coefficients);
        const Eigen::RowVectorXd filled = rows_.filled(output).head(left.cols());
        noise.col(output) =
            noise_spectrum(left, filled, regression_.spent(output, at_.fit.columns, at_.fit.covariance));
        unrest.push_back(white ? Eigen::MatrixXd::Ones(left.rows(), left.cols()).eval()
                               : noise_unrest(left, filled, noise.col(output)));
    }
    if (white) {
        noise = noise.colwise().mean().replicate(noise.rows(), 1).eval();
    }
    regression_.set_noise(noise, unrest);
    at_.noise = std::move(noise);
}

/// Resets the evidence offsets of contacts and picked-up payloads. They were computed for white noise and are
/// computed again.
void Search::forget_prices() {
    for (const ChosenShape& one : at_.chosen) {
        at_.candidates[one.candidate].extra_price = 0;
    }
}

std::vector<std::string> Search::chosen_keys() const {
    std::vector<std::string> keys;
    for (const ChosenShape& one : at_.chosen) {
        keys.push_back(at_.candidates[one.candidate].key());
    }
    std::ranges::sort(keys);
    return keys;
}

} // namespace

Explanation explain(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                    const ExplanationOptions& options) {
    return Search(signals, measured, options).run();
}

} // namespace dfdyn::tools
