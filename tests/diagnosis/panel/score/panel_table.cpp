// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/panel_table.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>

namespace dfdyn::tests {

namespace {

using tools::ReportCell;
using tools::ReportTable;

constexpr double likely = 0.5;
constexpr double confident = 0.9;
constexpr double largest_harm = 0.005;
constexpr double nominal_strength = 0.75; ///< a strength of 1 is reached within 15 %

void add_effect(PanelSummary& summary, const EffectScore& effect) {
    if (effect.strength >= 2) {
        summary.found_at_3.add(effect.found());
    } else if (effect.strength >= nominal_strength) {
        summary.found_at_1.add(effect.found());
    } else {
        summary.found_at_03.add(effect.found());
        return;
    }
    if (effect.strength >= nominal_strength && (effect.alone || !effect.found())) {
        summary.exact_name.add(effect.named);
    }
    if (effect.strength >= nominal_strength && effect.relative_error) {
        summary.parameter_within_20.add(*effect.relative_error <= 0.2);
        summary.parameter_in_interval.add(effect.in_interval);
    }
}

double weakest(const CaseScore& score) {
    return std::ranges::min_element(score.effects, {}, &EffectScore::strength)->strength;
}

void add_named(PanelSummary& summary, const CaseScore& score) {
    for (const EffectScore& effect : score.effects) {
        add_effect(summary, effect);
    }
    const bool drift = std::ranges::any_of(score.effects, [](const EffectScore& effect) {
        // Always drawn together with its friction, so it is not a pair of independent effects.
        return effect.effect == "friction_drift";
    });
    if (score.effects.size() == 2 && !drift) {
        Rate& rate = weakest(score) >= nominal_strength ? summary.both_named : summary.both_named_with_weak;
        rate.add(score.effects[0].found() && score.effects[1].found());
    }
}

bool any_name(const CaseScore& score) {
    return std::ranges::any_of(score.findings, [](const FindingScore& finding) {
        return finding.confidence >= likely && !finding.ordinary;
    });
}

bool wrong_name(const CaseScore& score) {
    return std::ranges::any_of(score.findings, [](const FindingScore& finding) {
        return finding.confidence >= likely && !finding.right;
    });
}

/// A rate with its target and two limits. `floor` is the value on the fixed panel of short recordings minus a
/// margin for the rounding of other machines. `long_floor` is the value on a thousand long recordings minus a
/// margin for chance.
struct Line {
    const char* what;
    Rate rate;
    double target, floor, long_floor;
    bool at_least = true;

    bool within(double limit) const { return at_least ? rate.share() >= limit : rate.share() <= limit; }
};

std::vector<Line> lines_of(const PanelSummary& summary) {
    return {
        {"right name and place, or its class: strength 3 and more", summary.found_at_3, 0.97, 0.88, 0.95},
        {"the same at strength 1", summary.found_at_1, 0.92, 0.8, 0.9},
        {"the same at strength 0.3", summary.found_at_03, 0.75, 0.25, 0.65},
        {"exact name where nothing ties, strength 1 and more", summary.exact_name, 0.95, 0.9, 0.94},
        {"main parameter within 20 %, strength 1 and more", summary.parameter_within_20, 0.90, 0.85, 0.9},
        {"main parameter inside its 95 % interval", summary.parameter_in_interval, 0.90, 0.85, 0.87},
        {"torque constants that were not given, within 20 %", summary.constant_within_20, 0.90, 0.9, 0.97},
        {"torque constants that were not given, inside their 95 % interval", summary.constant_in_interval,
         0.90, 0.85, 0.93},
        {"recordings without any effect that have a finding at 0.5 or more", summary.null_with_finding, 0.05,
         0.05, 0.03, false},
        {"findings at 0.9 or more that are wrong", summary.confident_and_wrong, 0.05, 0.05, 0.05, false},
        {"recordings that are refused although the set-up is right", summary.refused, 0.02, 0.05, 0.02,
         false},
        {"two effects at once, both of strength 1 and more: both named", summary.both_named, 0.85, 0.6, 0.85},
        {"two effects at once, one or both at 0.3: both named", summary.both_named_with_weak, 0.85, 0, 0.5},
        {"effects outside the catalogue, strength 1 and more: no wrong name, right output and input",
         summary.outside_silent, 0.80, 0.8, 0.85},
        {"the same at strength 0.3", summary.outside_weak, 0.80, 0, 0.5}};
}

ReportTable target_table(const PanelSummary& summary) {
    ReportTable table{"Rates and targets", {"", "reached", "target", "met"}, {}, ""};
    for (const Line& line : lines_of(summary)) {
        std::array<char, 32> target{};
        std::snprintf(target.data(), target.size(), "%s %.0f %%", line.at_least ? "≥" : "≤",
                      100 * line.target);
        const char* met = line.rate.of == 0 ? "–" : line.within(line.target) ? "yes" : "no";
        table.rows.push_back(
            {std::string(line.what), percent(line.rate), std::string(target.data()), std::string(met)});
    }
    std::array<char, 64> harm{"–"};
    const char* met = "–";
    if (summary.exact > 0) {
        std::snprintf(harm.data(), harm.size(), "%+.2f %% (mean of %d)", 100 * summary.mean_harm,
                      summary.exact);
        met = summary.mean_harm <= largest_harm ? "yes" : "no";
    }
    table.rows.push_back({std::string("held-out error with the causes, in recordings with noise only"),
                          std::string(harm.data()), std::string("≤ 0.5 %"), std::string(met)});
    return table;
}

ReportTable effect_table(const std::vector<CaseScore>& scores) {
    std::map<std::string, std::array<Rate, 3>> effects;
    for (const CaseScore& score : scores) {
        for (const EffectScore& effect : score.effects) {
            if (!score.outside) {
                const std::size_t column = effect.strength >= 2                  ? 2
                                           : effect.strength >= nominal_strength ? 1
                                                                                 : 0;
                effects[effect.effect][column].add(effect.found());
            }
        }
    }
    ReportTable table{"Found, per effect and strength", {"effect", "0.3", "1", "3 and more"}, {}, ""};
    for (const auto& [effect, rates] : effects) {
        table.rows.push_back({effect, percent(rates[0]), percent(rates[1]), percent(rates[2])});
    }
    return table;
}

/// Detections by evidence, which bounds the detections of every method.
ReportTable evidence_table(const std::vector<CaseScore>& scores) {
    constexpr std::array edges{0.0, 3.0, 6.0, 10.0, 20.0, 50.0, 1e300};
    std::array<std::array<Rate, 3>, edges.size() - 1> found;
    for (const CaseScore& score : scores) {
        if (score.outside || score.effects.size() != 1) {
            continue;
        }
        const EffectScore& effect = score.effects.front();
        const auto band =
            static_cast<std::size_t>(std::ranges::upper_bound(edges, effect.evidence) - edges.begin()) - 1;
        const std::size_t column = effect.strength >= 2 ? 2 : effect.strength >= nominal_strength ? 1 : 0;
        found[std::min(band, found.size() - 1)][column].add(effect.found());
    }
    ReportTable table{"Found, by the available evidence", {"evidence", "0.3", "1", "3 and more"}, {}, ""};
    for (std::size_t band = 0; band < found.size(); ++band) {
        std::array<char, 48> range{};
        if (band + 1 < found.size()) {
            std::snprintf(range.data(), range.size(), "%.0f to %.0f", edges[band], edges[band + 1]);
        } else {
            std::snprintf(range.data(), range.size(), "above %.0f", edges[band]);
        }
        table.rows.push_back({std::string(range.data()), percent(found[band][0]), percent(found[band][1]),
                              percent(found[band][2])});
    }
    return table;
}

std::string kind_of(const std::string& name) { return name.substr(0, name.find('@')); }

ReportTable confusion_table(const std::vector<CaseScore>& scores) {
    std::map<std::pair<std::string, std::string>, int> confusions;
    for (const CaseScore& score : scores) {
        for (const EffectScore& effect : score.effects) {
            if (!effect.found() && effect.strength >= nominal_strength) {
                ++confusions[{effect.effect, kind_of(effect.named_as)}];
            }
        }
    }
    ReportTable table{"Wrong names instead of hidden effects, strength 1 and more",
                      {"hidden", "first finding", "recordings"},
                      {},
                      ""};
    for (const auto& [names, count] : confusions) {
        table.rows.push_back({names.first, names.second, static_cast<double>(count)});
    }
    return table;
}

std::vector<Judged> judged(const std::vector<CaseScore>& scores) {
    std::vector<Judged> result;
    for (const CaseScore& score : scores) {
        for (const FindingScore& finding : score.findings) {
            result.push_back({finding.confidence, finding.right});
        }
    }
    return result;
}

} // namespace

std::string percent(const Rate& rate) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.1f %% (%d of %d)", 100 * rate.share(), rate.count, rate.of);
    return rate.of == 0 ? "–" : text.data();
}

ReportTable reliability_table(const std::vector<Judged>& judged) {
    ReportTable table{"Right findings by confidence", {"confidence", "mean confidence", "right"}, {}, ""};
    constexpr std::array edges{0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.01};
    for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
        Rate right;
        double sum = 0;
        for (const Judged& one : judged) {
            if (one.confidence >= edges[bin] && one.confidence < edges[bin + 1]) {
                right.add(one.right);
                sum += one.confidence;
            }
        }
        std::array<char, 32> range{};
        std::snprintf(range.data(), range.size(), "%.2f to %.2f", edges[bin], std::min(edges[bin + 1], 1.0));
        const double mean = right.of == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / right.of;
        table.rows.push_back({std::string(range.data()), mean, percent(right)});
    }
    return table;
}

PanelSummary summarise(const std::vector<CaseScore>& scores) {
    PanelSummary summary;
    for (const CaseScore& score : scores) {
        if (score.harm) {
            ++summary.exact;
            summary.mean_harm += (*score.harm - summary.mean_harm) / summary.exact;
        }
        summary.refused.add(!score.refusals.empty());
        if (score.effects.empty()) {
            summary.null_with_finding.add(any_name(score));
        } else if (score.outside) {
            Rate& rate = weakest(score) >= nominal_strength ? summary.outside_silent : summary.outside_weak;
            rate.add(!wrong_name(score) && score.unexplained_right);
        } else {
            add_named(summary, score);
        }
        for (const ConstantScore& constant : score.constants) {
            summary.constant_within_20.add(constant.relative_error <= 0.2);
            summary.constant_in_interval.add(constant.in_interval);
        }
        for (const FindingScore& finding : score.findings) {
            if (finding.confidence >= confident) {
                summary.confident_and_wrong.add(!finding.right);
            }
        }
    }
    return summary;
}

std::vector<std::string> setbacks(const PanelSummary& summary, bool long_recordings) {
    std::vector<std::string> result;
    for (const Line& line : lines_of(summary)) {
        const double floor = long_recordings ? line.long_floor : line.floor;
        if (line.rate.of > 0 && !line.within(floor)) {
            std::array<char, 200> text{};
            std::snprintf(text.data(), text.size(), "%s: expected %s %.0f %%, found %s", line.what,
                          line.at_least ? "at least" : "at most", 100 * floor, percent(line.rate).c_str());
            result.emplace_back(text.data());
        }
    }
    if (summary.mean_harm > largest_harm) {
        result.emplace_back("causes of noise alone worsen held-out errors by more than 0.5 %");
    }
    return result;
}

std::string panel_tables(const std::vector<CaseScore>& scores) {
    std::string text;
    for (const ReportTable& table : {target_table(summarise(scores)), reliability_table(judged(scores)),
                                     evidence_table(scores), effect_table(scores), confusion_table(scores)}) {
        text += tools::table_markdown(table) + "\n";
    }
    return text;
}

} // namespace dfdyn::tests
