// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/broken_effect.hpp"

#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tests {

using namespace tools;

namespace {

/// The broken effect and its fault. Effects have plain functions, which find their original here.
struct BrokenEffect {
    const Effect* original = nullptr;
    ColumnFault fault = ColumnFault::zero;
    Eigen::Index outputs = 1;
    bool changed = false;
};

BrokenEffect& broken() {
    static BrokenEffect state;
    return state;
}

EffectColumn with_fault(EffectColumn column) {
    BrokenEffect& state = broken();
    for (EffectColumn::Part& part : column.parts) {
        const Eigen::VectorXd before = part.series;
        const Eigen::Index output = part.output;
        switch (state.fault) {
        case ColumnFault::sign:
            part.series = -part.series;
            break;
        case ColumnFault::absolute_value:
            part.series = part.series.cwiseAbs().eval();
            break;
        case ColumnFault::other_output:
            part.output = (part.output + 1) % state.outputs;
            break;
        case ColumnFault::zero:
            part.series.setZero();
            break;
        }
        state.changed = state.changed || part.series != before || part.output != output;
    }
    return column;
}

Candidate with_fault(Candidate candidate) {
    for (EffectColumn& column : candidate.columns) {
        column = with_fault(std::move(column));
    }
    if (candidate.at_value) {
        candidate.at_value = [right = candidate.at_value](const EffectShape& shape, double value) {
            return with_fault(right(shape, value));
        };
    }
    if (candidate.relinearized_at) {
        candidate.relinearized_at = [right = candidate.relinearized_at](const EffectShape& shape,
                                                                        const Eigen::VectorXd& coefficients) {
            return with_fault(right(shape, coefficients));
        };
    }
    return candidate;
}

std::vector<Candidate> with_fault(std::vector<Candidate> candidates) {
    for (Candidate& candidate : candidates) {
        candidate = with_fault(std::move(candidate));
    }
    return candidates;
}

class BrokenScan : public EffectScan {
  public:
    explicit BrokenScan(std::unique_ptr<EffectScan> right) : right_(std::move(right)) {}

    std::vector<Candidate> candidates(const FittedResidual& residual) const override {
        return with_fault(right_->candidates(residual));
    }
    void set_evidence_offsets(const std::vector<Candidate*>& own,
                              const FittedResidual& residual) const override {
        right_->set_evidence_offsets(own, residual);
    }

  private:
    std::unique_ptr<EffectScan> right_;
};

} // namespace

const char* name_of(ColumnFault fault) {
    constexpr std::array names{"sign", "absolute value", "other output", "zero"};
    return names[static_cast<std::size_t>(fault)];
}

std::vector<Effect> catalogue_with_fault(const std::string& name, ColumnFault fault, Eigen::Index outputs) {
    broken() = {&effect_named(name), fault, outputs, false};
    std::vector<Effect> effects = effect_catalogue();
    Effect& effect = *std::ranges::find_if(effects, [&](const Effect& one) { return name == one.name; });
    if (effect.candidates != nullptr) {
        effect.candidates = [](const DiagnosisSignals& signals, std::size_t number) {
            return with_fault(broken().original->candidates(signals, number));
        };
    }
    if (effect.fitted_candidates != nullptr) {
        effect.fitted_candidates = [](const DiagnosisSignals& signals, const FittedModel& model,
                                      std::size_t number) {
            return with_fault(broken().original->fitted_candidates(signals, model, number));
        };
    }
    if (effect.scan != nullptr) {
        effect.scan = [](const DiagnosisSignals& signals,
                         const SpectralRows& rows) -> std::unique_ptr<EffectScan> {
            return std::make_unique<BrokenScan>(broken().original->scan(signals, rows));
        };
    }
    return effects;
}

bool fault_changed_columns() { return broken().changed; }

} // namespace dfdyn::tests
