// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/fitted_effects.hpp"

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/dependence_candidates.hpp"
#include "tools/diagnosis/candidates/weighted_residual.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/search/candidate_choice.hpp"
#include "tools/diagnosis/search/candidate_entry.hpp"
#include "tools/diagnosis/search/nuisance_parameters.hpp"
#include "tools/diagnosis/search/prune_effects.hpp"
#include "tools/diagnosis/search/robust_values.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr int most_rounds = 10;
constexpr int white_rounds = 3;

class Search {
  public:
    Search(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured, const FitOptions& options,
           bool with_yielding)
        : signals_(signals), options_(options), rows_(signals.measured),
          regression_(rows_, measured - signals.nominal, rows_.frames_within(options.fitted_share)),
          result_(model_without_effects(signals, options.gains_known)), nuisance_(signals, rows_, result_) {
        for (Candidate& candidate : static_candidates(signals_, options_.effects)) {
            if (visible(signals_, candidate) && (with_yielding || !yields(candidate))) {
                static_.emplace_back(rows_, std::move(candidate));
            }
        }
        for (const Effect& effect : options_.effects) {
            if (effect.scan != nullptr) {
                scans_.push_back({&effect, effect.scan(signals_, rows_)});
            }
        }
        for (Candidate& candidate : dependence_candidates(signals_, measured - signals.nominal)) {
            static_.emplace_back(rows_, std::move(candidate));
        }
        gather({});
        result_.fit = fit_effects(result_.problem, {});
        estimate_noise(true);
    }

    FittedEffects run() {
        search_in_rounds();
        prune(result_, regression_);
        make_robust(result_, regression_);
        weigh_with_lags();
        return std::move(result_);
    }

    /// Returns whether a candidate that yields was chosen at the end of any round: it may have changed the
    /// choice of others.
    bool chose_yielding() const { return chose_yielding_; }

  private:
    void search_in_rounds();
    FittedModel fitted_model(bool gains_may_err) const;
    FittedResidual fitted_residual() const;
    void add(std::vector<Candidate>& found, std::vector<Candidate> more) const;
    void add_scanned(std::vector<Candidate>& found, const Effect& effect, const EffectScan& scan,
                     const FittedResidual& residual) const;
    std::vector<CandidateEntry> model_dependent(bool gains_may_err) const;
    void refine();
    void set_candidates(const std::vector<const CandidateEntry*>& entries);
    void gather(const std::vector<CandidateEntry>& model_dependent);
    void estimate_noise(bool white);
    void reset_event_thresholds();
    void weigh_with_lags();
    Eigen::VectorXd of_named(Eigen::VectorXd coefficients) const;

    const DiagnosisSignals& signals_;
    const FitOptions& options_;
    SpectralRows rows_;
    struct Scan {
        const Effect* effect;
        std::unique_ptr<EffectScan> scan;
    };
    std::vector<Scan> scans_;
    EffectRegression regression_;
    std::vector<CandidateEntry> static_; ///< candidates that do not depend on the current model
    bool chose_yielding_ = false;
    FittedEffects result_;
    NuisanceParameters nuisance_;
};

/// Searches in rounds until nothing changes.
void Search::search_in_rounds() {
    std::vector<std::string> last;
    for (int round = 0; round < most_rounds; ++round) {
        if (options_.progress) {
            options_.progress(round);
        }
        // A gain multiplies the whole output: it would grow together with friction and masses that are not
        // found yet. Given gains are therefore doubted only after a search for the other causes.
        const bool gains_may_err = options_.gains_known && round >= white_rounds;
        const std::vector<CandidateEntry> dependent = model_dependent(gains_may_err);
        refine();
        gather(dependent);
        result_.chosen = search_effects(result_.problem, result_.chosen);
        result_.fit = fit_effects(result_.problem, result_.chosen);
        chose_yielding_ = chose_yielding_ || has_yielding(result_);
        // with the spectrum of a residual that still contains effects, these effects would be taken for noise
        estimate_noise(round + 1 < white_rounds);
        if (round + 1 == white_rounds) {
            reset_event_thresholds();
        }
        std::vector<std::string> keys = chosen_keys(result_);
        if (keys == last && round > white_rounds) {
            break;
        }
        last = std::move(keys);
    }
}

FittedModel Search::fitted_model(bool gains_may_err) const {
    const auto of = [&](bool Effect::*trait, bool value) {
        return result_.contribution_of(signals_, [trait, value](const Candidate& candidate) {
            return has_trait(candidate.effect, trait) == value;
        });
    };
    FittedModel model{signals_.nominal + of(&Effect::beyond_arm, false),
                      signals_.wrench() ? Eigen::MatrixXd() : of(&Effect::friction, true),
                      Eigen::VectorXd::Zero(signals_.outputs()), gains_may_err};
    for (std::size_t i = 0; i < result_.chosen.size(); ++i) {
        const Candidate& candidate = result_.candidates[result_.chosen[i].candidate];
        if (has_trait(candidate.effect, &Effect::delays_output)) {
            for (const EffectColumn::Part& part : candidate.columns.front().parts) {
                model.delay_s[part.output] = result_.fit.coefficients[result_.first_column(i)];
            }
        }
        if (has_trait(candidate.effect, &Effect::turns_sensor)) {
            Eigen::Index coefficient = result_.first_column(i);
            for (const std::size_t axis : candidate.shapes[result_.chosen[i].shape].columns) {
                model.sensor_angles[static_cast<Eigen::Index>(axis)] =
                    result_.fit.coefficients[coefficient++];
            }
        }
    }
    return model;
}

FittedResidual Search::fitted_residual() const {
    const Eigen::VectorXd coefficients = result_.fit.of_all(regression_.columns());
    return {signals_, regression_, coefficients, of_named(coefficients),
            weighted_residual(regression_, coefficients)};
}

/// Adds visible candidates, each once.
void Search::add(std::vector<Candidate>& found, std::vector<Candidate> more) const {
    for (Candidate& candidate : more) {
        if (visible(signals_, candidate) &&
            std::ranges::find(found, candidate.key(), &Candidate::key) == found.end()) {
            found.push_back(std::move(candidate));
        }
    }
}

/// Adds what a scan finds in the residual, and sets the evidence offsets of its effect.
void Search::add_scanned(std::vector<Candidate>& found, const Effect& effect, const EffectScan& scan,
                         const FittedResidual& residual) const {
    std::vector<Candidate> more = scan.candidates(residual);
    for (Candidate& candidate : more) {
        candidate.effect = effect.name;
    }
    add(found, std::move(more));
    std::vector<Candidate*> own;
    for (Candidate& candidate : found) {
        if (candidate.effect == effect.name) {
            own.push_back(&candidate);
        }
    }
    scan.set_evidence_offsets(own, residual);
}

/// Returns the candidates that depend on the current model.
std::vector<CandidateEntry> Search::model_dependent(bool gains_may_err) const {
    std::vector<Candidate> found;
    add(found, fitted_candidates(signals_, fitted_model(gains_may_err), options_.effects));
    add(found, relinearized_always(result_));
    for (std::size_t i = 0; i < result_.chosen.size(); ++i) {
        const Candidate& chosen = result_.candidates[result_.chosen[i].candidate];
        if (chosen.relinearized_at && !chosen.always_relinearized) {
            const Eigen::Index first = result_.first_column(i);
            add(found,
                {relinearized(chosen, chosen.shapes[result_.chosen[i].shape],
                              result_.fit.coefficients.segment(first, result_.first_column(i + 1) - first))});
        } else if (has_trait(chosen.effect, &Effect::kept_while_chosen)) {
            add(found, {chosen});
        }
    }
    const FittedResidual residual = fitted_residual();
    for (const auto& [effect, scan] : scans_) {
        add_scanned(found, *effect, *scan, residual);
    }
    std::vector<CandidateEntry> result;
    for (Candidate& candidate : found) {
        result.emplace_back(rows_, std::move(candidate));
    }
    return result;
}

/// Adds shapes near the chosen one to chosen candidates with a continuous shape.
void Search::refine() {
    for (ChosenShape& one : result_.chosen) {
        const Candidate& chosen = result_.candidates[one.candidate];
        if (chosen.at_value) {
            const auto entry =
                std::find_if(static_.begin(), static_.end(), [&](const CandidateEntry& candidate) {
                    return candidate.candidate.key() == chosen.key();
                });
            one.shape = entry->refine(one.shape, rows_);
        }
    }
}

/// Replaces the candidates of the problem. Their columns follow the nuisance parameters'.
void Search::set_candidates(const std::vector<const CandidateEntry*>& entries) {
    std::vector<SpectralColumnPointer> columns = nuisance_.columns();
    std::map<std::string, std::size_t> families{{"", 0}};
    result_.candidates.clear();
    result_.problem.candidates.clear();
    for (const CandidateEntry* const entry : entries) {
        SearchCandidate candidate;
        candidate.family = families.emplace(entry->candidate.family, families.size()).first->second;
        candidate.prior_trials = entry->candidate.prior_trials;
        candidate.evidence_offset = entry->candidate.evidence_offset;
        candidate.may_be_half = yields(entry->candidate) || entry->candidate.always_relinearized;
        for (const EffectShape& shape : entry->candidate.shapes) {
            SearchCandidate::Shape one{{}, shape.allowed, shape.bounded_count, shape.nearest};
            for (const std::size_t column : shape.columns) {
                one.columns.push_back(static_cast<Eigen::Index>(columns.size() + column));
            }
            candidate.shapes.push_back(std::move(one));
        }
        columns.insert(columns.end(), entry->columns.begin(), entry->columns.end());
        result_.problem.candidates.push_back(std::move(candidate));
        result_.candidates.push_back(entry->candidate);
    }
    regression_.set_columns(std::move(columns));
}

/// Builds the problem of all candidates with the current noise. Chosen candidates remain chosen if they still
/// exist.
void Search::gather(const std::vector<CandidateEntry>& model_dependent) {
    const std::vector<KeptChoice> chosen = kept_choices(result_);
    std::vector<const CandidateEntry*> entries;
    for (const CandidateEntry& entry : static_) {
        const std::string key = entry.candidate.key();
        if (std::ranges::none_of(model_dependent,
                                 [&](const CandidateEntry& one) { return one.candidate.key() == key; })) {
            entries.push_back(&entry);
        }
    }
    for (const CandidateEntry& entry : model_dependent) {
        entries.push_back(&entry);
    }
    set_candidates(entries);
    set_classes(result_);
    result_.problem.nuisance = nuisance_.priors();
    result_.problem.sums = regression_.weighted_sums();
    choose_again(result_, chosen);
}

Eigen::VectorXd Search::of_named(Eigen::VectorXd coefficients) const {
    for (const ChosenShape& one : result_.chosen) {
        if (!result_.candidates[one.candidate].named()) {
            coefficients(result_.problem.candidates[one.candidate].shapes[one.shape].columns).setZero();
        }
    }
    return coefficients;
}

void Search::estimate_noise(bool white) {
    const Eigen::VectorXd coefficients = result_.fit.of_all(regression_.columns());
    Eigen::MatrixXd noise(rows_.bins(), regression_.outputs());
    std::vector<Eigen::MatrixXd> noise_scale;
    for (Eigen::Index output = 0; output < noise.cols(); ++output) {
        const Eigen::MatrixXd left = regression_.residual(output, coefficients);
        const Eigen::RowVectorXd filled = rows_.filled(output).head(left.cols());
        noise.col(output) = noise_spectrum(
            left, filled, regression_.spent(output, result_.fit.columns, result_.fit.covariance));
        noise_scale.push_back(white ? Eigen::MatrixXd::Ones(left.rows(), left.cols()).eval()
                                    : local_noise_scale(left, filled, noise.col(output)));
    }
    if (white) {
        noise = noise.colwise().mean().replicate(noise.rows(), 1).eval();
    }
    regression_.set_noise(noise, noise_scale);
    result_.noise = std::move(noise);
}

/// Resets the evidence offsets of contacts and picked-up payloads. They were computed for white noise and are
/// computed again.
void Search::reset_event_thresholds() {
    for (const ChosenShape& one : result_.chosen) {
        result_.candidates[one.candidate].evidence_offset = 0;
    }
}

/// Sets `margin_with_lags`.
void Search::weigh_with_lags() {
    const std::vector<NuisanceColumn> exact = result_.problem.nuisance;
    std::ranges::copy(nuisance_.lags(signals_, result_), std::back_inserter(result_.problem.nuisance));
    const Neighbours near(result_.problem, result_.chosen);
    for (std::size_t i = 0; i < result_.chosen.size(); ++i) {
        result_.margin_with_lags.push_back(near.score() - near.score_without(i));
    }
    result_.problem.nuisance = exact;
}

} // namespace

FittedEffects find_effects(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                           const FitOptions& options) {
    {
        Search all(signals, measured, options, true);
        FittedEffects effects = all.run();
        if (!all.chose_yielding() || has_yielding(effects)) {
            return effects;
        }
    } // the second search needs its memory
    return Search(signals, measured, options, false).run();
}

} // namespace dfdyn::tools
