// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/changes/change_panel.hpp"

#include "dfdyn/hal/motion/encoder_reading.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double settled_s = 20;
constexpr double latest_s = 10; ///< an alarm belongs to a change for this time after it

constexpr std::array causes{Cause::payload, Cause::friction, Cause::bias, Cause::contact, Cause::frozen};

ChangeScore score_of(ChangeCase&& change, std::vector<NamedChange> found) {
    ChangeScore score;
    score.change = std::move(change);
    score.found = std::move(found);
    const double until = score.change.cause ? score.change.time_s : score.change.end_s;
    score.watched_s = until - settled_s;
    for (const NamedChange& one : score.found) {
        const double alarm_s = hal::seconds_of(one.alarm_ns);
        if (alarm_s < until) {
            ++score.false_alarms;
        } else if (score.hit == nullptr && alarm_s < until + latest_s) {
            score.hit = &one;
            score.delay_s = alarm_s - until;
        }
    }
    return score;
}

ChangeScore run_case(std::uint64_t seed, const ChangeMix& mix) {
    ChangeCase change = make_change_case(seed, mix);
    const ChangeModel trained = train_change_model(change);
    const auto estimator = monitored(make_estimator(trained.model, false), trained.monitor);
    replay(*estimator, std::span(&trained.model, 1), change.recording, 0, [](std::size_t) {});
    change.recording = {};
    return score_of(std::move(change), estimator->take_changes());
}

std::string share(std::size_t part, std::size_t whole) {
    return whole == 0 ? "–" : std::to_string(part) + " of " + std::to_string(whole);
}

void add_row(std::string& table, const std::string& label, const std::vector<const ChangeScore*>& scores) {
    std::vector<double> delays;
    std::size_t right = 0;
    std::size_t place = 0;
    for (const ChangeScore* score : scores) {
        if (score->hit != nullptr) {
            delays.push_back(score->delay_s);
        }
        right += score->right_cause() ? 1 : 0;
        place += score->right_place() ? 1 : 0;
    }
    const auto quantile = [&](double q) {
        return delays.empty() ? std::string("–") : formatted("%.1f", tools::quantile(delays, q));
    };
    table += "| " + label + " | " + share(delays.size(), scores.size()) + " | " + quantile(0.5) + " | " +
             quantile(0.9) + " | " + share(right, scores.size()) + " | " + share(place, scores.size()) +
             " |\n";
}

std::string causes_table(const std::vector<ChangeScore>& scores) {
    std::string table = "| arm, change | detected | delay (s), median | 90 % | right cause | and place |\n"
                        "| --- | --- | --- | --- | --- | --- |\n";
    for (const std::string& robot : change_robot_names()) {
        for (const Cause cause : causes) {
            std::vector<const ChangeScore*> of;
            for (const ChangeScore& score : scores) {
                if (score.change.robot_name == robot && score.change.cause == cause) {
                    of.push_back(&score);
                }
            }
            if (!of.empty()) {
                add_row(table, robot + ", " + name(cause), of);
            }
        }
    }
    return table;
}

std::string confusion_table(const std::vector<ChangeScore>& scores) {
    std::map<std::pair<Cause, std::string>, int> counts;
    for (const ChangeScore& score : scores) {
        if (score.change.cause) {
            ++counts[{*score.change.cause, score.hit == nullptr ? "nothing" : name(score.hit->cause)}];
        }
    }
    std::string table =
        "\n| changed, named | payload | friction | bias | contact | frozen | unknown | nothing "
        "|\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const Cause changed : causes) {
        table += std::string("| ") + name(changed);
        for (const Cause named : causes) {
            table += " | " + std::to_string(counts[{changed, name(named)}]);
        }
        table += " | " + std::to_string(counts[{changed, name(Cause::unknown)}]) + " | " +
                 std::to_string(counts[{changed, "nothing"}]) + " |\n";
    }
    return table;
}

std::string confidence_table(const std::vector<ChangeScore>& scores) {
    constexpr std::array edges{0.0, 0.5, 0.8, 0.95, 1.01};
    std::string table = "\n| confidence | mean | right cause |\n| --- | --- | --- |\n";
    for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
        std::size_t count = 0;
        std::size_t right = 0;
        double sum = 0;
        for (const ChangeScore& score : scores) {
            if (score.hit != nullptr && score.hit->confidence >= edges[bin] &&
                score.hit->confidence < edges[bin + 1]) {
                ++count;
                sum += score.hit->confidence;
                right += score.right_cause() ? 1 : 0;
            }
        }
        if (count > 0) {
            table += formatted("| %.2f to ", edges[bin]) + formatted("%.2f", std::min(edges[bin + 1], 1.0)) +
                     formatted(" | %.2f | ", sum / static_cast<double>(count)) + share(right, count) + " |\n";
        }
    }
    return table;
}

} // namespace

std::vector<ChangeScore> run_change_panel(std::uint64_t seed, int cases, const ChangeMix& mix,
                                          const std::function<void(const ChangeScore&)>& done) {
    std::vector<ChangeScore> scores;
    scores.reserve(static_cast<std::size_t>(cases));
    for (int number = 0; number < cases; ++number) {
        scores.push_back(run_case(seed + static_cast<std::uint64_t>(number), mix));
        done(scores.back());
    }
    return scores;
}

std::string describe(const ChangeScore& score) {
    const ChangeCase& change = score.change;
    std::string text = "seed " + std::to_string(change.seed) + " " + change.robot_name + ": ";
    if (change.cause) {
        text += std::string(name(*change.cause)) + " " + change.where + " " + change.size + " at " +
                formatted("%.1f s", change.time_s);
    } else {
        text += "nothing";
    }
    for (const NamedChange& found : score.found) {
        text += &found == score.hit ? "; FOUND " : "; ";
        text += formatted("%.1f s ", hal::seconds_of(found.alarm_ns)) + name(found.cause) + " " +
                found.where + formatted(" %.2f", found.confidence) + " by " + found.shown_by + " else " +
                name(found.runner_up);
        for (const ChangeParameter& parameter : found.parameters) {
            text += " " + parameter.name + formatted(" %.3g", parameter.value);
        }
    }
    return text;
}

std::string change_tables(const std::vector<ChangeScore>& scores) {
    double watched_s = 0;
    int false_alarms = 0;
    for (const ChangeScore& score : scores) {
        watched_s += score.watched_s;
        false_alarms += score.false_alarms;
    }
    const bool changes =
        std::ranges::any_of(scores, [](const ChangeScore& one) { return one.change.cause.has_value(); });
    const std::string tables =
        changes ? causes_table(scores) + confusion_table(scores) + confidence_table(scores) : "";
    return tables + "\nFalse alarms: " + std::to_string(false_alarms) +
           formatted(" in %.2f h.\n", watched_s / 3600);
}

} // namespace dfdyn::tests
