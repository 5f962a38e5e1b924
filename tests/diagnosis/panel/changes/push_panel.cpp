// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/changes/push_panel.hpp"

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

const FoundParameter& parameter_of(const Finding& contact, const char* name) {
    return *std::ranges::find(contact.parameters, name, &FoundParameter::name);
}

bool is_of(const Finding& contact, const HiddenPush& push) {
    return contact.where == "joint" + std::to_string(push.joint + 1) &&
           parameter_of(contact, "start").value < push.end_s &&
           push.start_s < parameter_of(contact, "end").value;
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
        PushScore::Named named{{finding.confidence, false}, false, 0};
        for (std::size_t i = 0; i < score.pushes.size(); ++i) {
            if (is_of(finding, score.pushes[i])) {
                named.right = true;
                const FoundParameter& found = parameter_of(finding, "peak");
                const double peak = score.pushes[i].peak;
                named.in_interval = found.low <= peak && peak <= found.high;
                named.peak_over_true = found.value / peak;
                score.found[i] = std::max(score.found[i], finding.confidence);
            }
        }
        score.named.push_back(named);
    }
    return score;
}

ReportTable size_table(const std::vector<PushScore>& scores) {
    constexpr std::array edges{0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 4.0};
    ReportTable table{"Found, by the ratio of the push's peak to the possible change of static friction",
                      {"peak", "named", "with 0.5 and more"},
                      {},
                      ""};
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
        table.rows.push_back({formatted("%.1f to ", edges[bin]) + formatted("%.1f", edges[bin + 1]),
                              percent(named), percent(at_half)});
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
    std::vector<Judged> judged;
    for (const PushScore& score : scores) {
        judged.insert(judged.end(), score.named.begin(), score.named.end());
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
    return table_markdown(size_table(scores)) + "\n" + table_markdown(reliability_table(judged)) +
           "\nRecordings without a push that have a likely one: " + percent(silent) +
           ".\n\nPeaks of right and likely pushes inside their 95 % interval, where torques were measured: " +
           percent(in_interval) + ".\n";
}

} // namespace dfdyn::tests
