// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/push_panel.hpp"

#include "tests/diagnosis/panel_table.hpp"
#include "tools/common/number.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

double value_of(const Finding& finding, const char* name) {
    const auto found = std::ranges::find(finding.parameters, name, &FoundParameter::name);
    return found == finding.parameters.end() ? 0 : found->value;
}

bool is_of(const Finding& contact, const HiddenPush& push) {
    return contact.where == "joint" + std::to_string(push.joint + 1) &&
           value_of(contact, "start") < push.end_s && push.start_s < value_of(contact, "end");
}

bool has_peak(const Finding& contact, double peak) {
    const auto found = std::ranges::find(contact.parameters, "peak", &FoundParameter::name);
    return found != contact.parameters.end() && found->low <= peak && peak <= found->high;
}

PushScore run_push_case(std::uint64_t seed) {
    PushCase one = make_push_case(seed);
    DiagnosisOptions options;
    options.outputs = one.setup.kind.outputs;
    options.measure = false;
    const Diagnosis diagnosis = diagnose(one.setup.nominal, one.recording, options).diagnosis;
    PushScore score{seed,
                    one.setup.kind.name,
                    one.setup.kind.outputs != OutputKind::motor_current,
                    std::move(one.pushes),
                    {},
                    {}};
    score.found.assign(score.pushes.size(), 0);
    for (const Finding& finding : diagnosis.findings) {
        if (finding.effect != "external_contact") {
            continue;
        }
        PushScore::Named named{finding.confidence, false, false, 0};
        for (std::size_t i = 0; i < score.pushes.size(); ++i) {
            if (is_of(finding, score.pushes[i])) {
                named.right = true;
                named.in_interval = has_peak(finding, score.pushes[i].peak);
                named.peak_over_true = value_of(finding, "peak") / score.pushes[i].peak;
                score.found[i] = std::max(score.found[i], finding.confidence);
            }
        }
        score.named.push_back(named);
    }
    return score;
}

std::string share(const Rate& rate) {
    return rate.of == 0 ? "–"
                        : formatted("%.0f %% (", 100 * rate.share()) + std::to_string(rate.count) + " of " +
                              std::to_string(rate.of) + ")";
}

std::string size_table(const std::vector<PushScore>& scores) {
    constexpr std::array edges{0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 4.0};
    std::string table =
        "| peak, of what friction can change by | named | with 0.5 and more |\n| --- | --- | --- |\n";
    for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
        Rate named;
        Rate at_half;
        for (const PushScore& score : scores) {
            for (std::size_t i = 0; i < score.pushes.size(); ++i) {
                const double size = std::abs(score.pushes[i].peak) / score.pushes[i].held;
                if (size >= edges[bin] && size < edges[bin + 1]) {
                    named.add(score.found[i] > 0);
                    at_half.add(score.found[i] >= 0.5);
                }
            }
        }
        table += formatted("| %.1f to ", edges[bin]) + formatted("%.1f | ", edges[bin + 1]) + share(named) +
                 " | " + share(at_half) + " |\n";
    }
    return table;
}

std::string reliability_table(const std::vector<PushScore>& scores) {
    constexpr std::array edges{0.0, 0.2, 0.5, 0.8, 0.93, 1.0};
    std::string table = "\n| confidence | mean | right |\n| --- | ---: | --- |\n";
    for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
        Rate right;
        double sum = 0;
        for (const PushScore& score : scores) {
            for (const PushScore::Named& named : score.named) {
                if (named.confidence >= edges[bin] && named.confidence < edges[bin + 1]) {
                    right.add(named.right);
                    sum += named.confidence;
                }
            }
        }
        table += formatted("| %.2f to ", edges[bin]) + formatted("%.2f | ", edges[bin + 1]) +
                 (right.of == 0 ? "–" : formatted("%.2f", sum / right.of)) + " | " + share(right) + " |\n";
    }
    return table;
}

} // namespace

std::vector<PushScore> run_push_panel(std::uint64_t seed, int cases,
                                      const std::function<void(const PushScore&)>& done) {
    std::vector<PushScore> scores;
    for (int number = 0; number < cases; ++number) {
        scores.push_back(run_push_case(seed + static_cast<std::uint64_t>(number)));
        done(scores.back());
    }
    return scores;
}

std::string describe(const PushScore& score) {
    std::string text = "seed " + std::to_string(score.seed) + " " + score.robot + ":";
    for (std::size_t i = 0; i < score.pushes.size(); ++i) {
        const HiddenPush& push = score.pushes[i];
        text += formatted(" %.1f s", push.start_s) + " joint" + std::to_string(push.joint + 1) +
                formatted(" x%.2f", std::abs(push.peak) / push.held) +
                (score.found[i] > 0 ? formatted(" FOUND %.2f;", score.found[i]) : " missed;");
    }
    for (const PushScore::Named& named : score.named) {
        text += named.right ? formatted(" %.2f", named.peak_over_true) + (named.in_interval ? "" : "(out)")
                            : formatted(" !%.2f", named.confidence);
    }
    return text;
}

std::string push_tables(const std::vector<PushScore>& scores) {
    Rate silent;
    Rate in_interval;
    for (const PushScore& score : scores) {
        for (const PushScore::Named& named : score.named) {
            if (score.constants_known && named.right && named.confidence >= 0.5) {
                in_interval.add(named.in_interval);
            }
        }
        if (score.pushes.empty()) {
            silent.add(
                std::ranges::any_of(score.named, [](const auto& one) { return one.confidence >= 0.5; }));
        }
    }
    return size_table(scores) + reliability_table(scores) +
           "\nRecordings without a push that have a likely one: " + share(silent) +
           ".\n\nPeaks of right and likely pushes inside their 95 % interval, where torques were measured: " +
           share(in_interval) + ".\n";
}

} // namespace dfdyn::tests
