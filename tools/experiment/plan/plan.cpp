// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan.hpp"

#include "tools/base/system/read_file.hpp"
#include "tools/base/text/json_reader.hpp"
#include "tools/base/text/text.hpp"
#include "tools/experiment/plan/plan_cases.hpp"
#include "tools/experiment/plan/plan_claims.hpp"
#include "tools/experiment/plan/plan_names.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <system_error>

namespace dfdyn::tools {

namespace {

namespace fs = std::filesystem;

constexpr const char* plan_schema = "dfdyn.plan/1";
constexpr int most_rows = 100'000'000;
constexpr int most_in_list = 1000;

constexpr std::array<std::string_view, 16> plan_names{
    "schema", "name",           "title",       "robot", "outputs", "training", "tests", "horizon",
    "seeds",  "steady_after_s", "error_scale", "draws", "groups",  "defaults", "cases", "figures"};
constexpr std::array<std::string_view, 6> later_names{"comparisons", "findings",      "like",
                                                      "more_cases",  "more_findings", "more_figures"};
constexpr std::array<std::string_view, 7> robot_names{
    "urdf", "base", "tip", "ft_joint", "gravity", "sign_velocity", "torque_constants"};
constexpr std::array<std::string_view, 3> training_names{"log", "start_rows", "rows"};
constexpr std::array<std::string_view, 4> test_names{"log", "first", "rows", "count"};
constexpr std::array<std::string_view, 2> group_names{"name", "outputs"};

std::string text_or(const JsonReader& reader, const std::string& name, const std::string& fallback) {
    return reader.has(name) ? reader.text(name) : fallback;
}

std::size_t count_of(const JsonReader& reader, const std::string& name, int low) {
    return static_cast<std::size_t>(reader.whole_number(name, low, most_rows));
}

/// Reads the parts of a plan that refer to each other.
class PlanReader {
  public:
    PlanReader(const JsonReader& json, fs::path folder) : json_(json), folder_(std::move(folder)) {}

    Plan read() {
        check_fields();
        read_protocol();
        read_groups();
        read_cases();
        check_subsets();
        read_claims(json_, plan_);
        return std::move(plan_);
    }

  private:
    void check_fields() const {
        if (json_.text("schema") != plan_schema) {
            throw json_.error("schema", in_quotes(plan_schema), in_quotes(json_.text("schema")));
        }
        std::vector<std::string_view> names(plan_names.begin(), plan_names.end());
        names.insert(names.end(), later_names.begin(), later_names.end());
        json_.allow_only(names);
    }

    fs::path path_in(const JsonReader& reader, const std::string& name) const {
        return folder_ / reader.text(name);
    }

    void read_protocol() {
        plan_.name = plain_name(json_, "name");
        plan_.title = json_.text("title");
        plan_.outputs = output_kind();
        read_robot();
        const JsonReader training = json_.object("training");
        training.allow_only(training_names);
        plan_.training_log = path_in(training, "log");
        plan_.start_rows = count_of(training, "start_rows", 20);
        if (training.has("rows")) {
            plan_.training_rows = count_of(training, "rows", static_cast<int>(plan_.start_rows) + 1);
        }
        for (const JsonReader& test : json_.objects("tests", 1, most_entries)) {
            plan_.tests.push_back(test_log(test));
            check_unseen(test, plan_.tests.back());
        }
        plan_.horizon = json_.has("horizon") ? count_of(json_, "horizon", 1) : plan_.horizon;
        if (json_.has("steady_after_s")) {
            plan_.steady_after_s = json_.positive_number("steady_after_s");
        }
        plan_.error_scale = error_scale();
        read_seeds();
    }

    OutputKind output_kind() const {
        try {
            return parse_output_kind(json_.text("outputs"));
        } catch (const InputError&) {
            throw json_.error("outputs", "tau, i or wrench", in_quotes(json_.text("outputs")));
        }
    }

    void read_robot() {
        if (!json_.has("robot")) {
            return;
        }
        const JsonReader robot = json_.object("robot");
        robot.allow_only(robot_names);
        plan_.robot.urdf = path_in(robot, "urdf");
        plan_.robot.base = text_or(robot, "base", "");
        plan_.robot.tip = text_or(robot, "tip", "");
        plan_.robot.ft_joint = text_or(robot, "ft_joint", "");
        if (robot.has("gravity")) {
            std::ranges::copy(robot.numbers("gravity", 3), plan_.robot.gravity.begin());
        }
        if (robot.has("sign_velocity")) {
            plan_.robot.sign_velocity = robot.positive_number("sign_velocity");
        }
        if (robot.has("torque_constants")) {
            const auto joints = static_cast<int>(robot.numbers("torque_constants").size());
            plan_.robot.torque_constants = robot.positive_numbers("torque_constants", joints);
        }
    }

    TestLog test_log(const JsonReader& test) const {
        test.allow_only(test_names);
        return {path_in(test, "log"), test.has("first") ? count_of(test, "first", 0) : 0,
                count_of(test, "rows", 2), test.has("count") ? count_of(test, "count", 1) : 1};
    }

    /// Refuses rows that are training data: errors on them say nothing about other motions.
    void check_unseen(const JsonReader& reader, const TestLog& test) const {
        std::error_code missing; // reported when the file is read
        if (!fs::equivalent(test.log, plan_.training_log, missing)) {
            return;
        }
        if (!plan_.training_rows) {
            throw reader.error("log", "a log other than the training's, of which training uses all rows",
                               in_quotes(reader.text("log")));
        }
        if (test.first < *plan_.training_rows) {
            throw reader.error("first",
                               "a row from " + std::to_string(*plan_.training_rows) +
                                   " on, after the training's rows of the same log",
                               std::to_string(test.first));
        }
    }

    /// Refuses subsets in which no tick has both a full window of every case and a whole horizon.
    void check_subsets() const {
        int lags = 0;
        for (const Case& one : plan_.cases) {
            lags = std::max(lags, one.lags);
        }
        const std::size_t unscored = plan_.horizon + static_cast<std::size_t>(lags);
        for (std::size_t test = 0; test < plan_.tests.size(); ++test) {
            if (plan_.tests[test].rows <= unscored) {
                throw json_.error("tests[" + std::to_string(test) + "].rows",
                                  "more than " + std::to_string(unscored) +
                                      ", the horizon and the largest lags of a case together",
                                  std::to_string(plan_.tests[test].rows));
            }
        }
    }

    ErrorScale error_scale() const {
        const std::string text = text_or(json_, "error_scale", "horizon");
        for (const ErrorScale scale : {ErrorScale::horizon, ErrorScale::variance}) {
            if (text == to_string(scale)) {
                return scale;
            }
        }
        throw json_.error("error_scale", "horizon or variance", in_quotes(text));
    }

    /// Reads either "draws": N, which means the seeds 1 … N, or "seeds": [...].
    void read_seeds() {
        if (json_.has("seeds")) {
            for (const int seed : json_.whole_numbers("seeds", 0, most_rows)) {
                plan_.seeds.push_back(static_cast<std::uint64_t>(seed));
            }
        } else {
            const int draws = json_.has("draws") ? json_.whole_number("draws", 1, most_in_list) : 1;
            for (int seed = 1; seed <= draws; ++seed) {
                plan_.seeds.push_back(static_cast<std::uint64_t>(seed));
            }
        }
        const std::set<std::uint64_t> distinct(plan_.seeds.begin(), plan_.seeds.end());
        if (plan_.seeds.empty() || distinct.size() != plan_.seeds.size()) {
            throw json_.error("seeds", "at least one, each once", std::to_string(plan_.seeds.size()));
        }
    }

    static std::vector<std::string> outputs_of(const JsonReader& group) {
        std::vector<std::string> outputs = group.texts("outputs", most_in_list);
        for (const std::string& output : outputs) {
            if (std::ranges::count(outputs, output) > 1) {
                throw group.error("outputs", "names that are there once", in_quotes(output) + " twice");
            }
        }
        return outputs;
    }

    void read_groups() {
        for (const JsonReader& group : json_.objects("groups", 1, most_entries)) {
            group.allow_only(group_names);
            plan_.groups.push_back({plain_name(group, "name"), outputs_of(group)});
            refuse_twice(json_, "groups", plan_.groups);
        }
    }

    void read_cases() {
        const Case defaults = json_.has("defaults") ? read_defaults(json_.object("defaults")) : Case{};
        add_cases("cases", defaults);
        if (json_.has("more_cases")) {
            add_cases("more_cases", defaults);
        }
        for (const Case& one : plan_.cases) {
            check_members(one);
        }
    }

    void check_members(const Case& one) const {
        for (const std::string& name : one.members) {
            const auto member = std::ranges::find(plan_.cases, name, &Case::name);
            if (member == plan_.cases.end() || !member->members.empty()) {
                throw json_.error("cases: " + in_quotes(one.name) + ": combine",
                                  "names of cases that are no combinations", in_quotes(name));
            }
        }
    }

    void add_cases(const std::string& field, const Case& defaults) {
        for (const JsonReader& entry : json_.objects(field, 1, most_entries)) {
            for (const Case& one : expand_cases(entry, defaults)) {
                plan_.cases.push_back(one);
                refuse_twice(json_, field, plan_.cases);
            }
        }
    }

    const JsonReader& json_;
    fs::path folder_;
    Plan plan_;
};

} // namespace

std::string to_string(Phase phase) { return phase == Phase::transient ? "transient" : "steady"; }

std::string to_string(ErrorScale scale) { return scale == ErrorScale::horizon ? "horizon" : "variance"; }

Plan read_plan(const fs::path& path) {
    nlohmann::json json = parse_json(read_file(path), shown(path));
    const JsonReader own(json, shown(path));
    const fs::path folder = path.parent_path();
    if (own.has("like")) {
        const fs::path other = folder / own.text("like");
        const nlohmann::json fields = parse_json(read_file(other), shown(other));
        const JsonReader must_be_an_object(fields, shown(other));
        json.insert(fields.begin(), fields.end()); // keeps existing fields
    }
    return PlanReader(JsonReader(json, shown(path)), folder).read();
}

const Case& case_named(const Plan& plan, const std::string& name) {
    return *std::ranges::find(plan.cases, name, &Case::name);
}

Plan quick_plan(Plan plan) {
    constexpr std::size_t most_rows_used = 400;
    plan.seeds.resize(1);
    plan.start_rows = std::min(plan.start_rows, most_rows_used);
    plan.most_online_rows = most_rows_used;
    plan.tests.resize(1);
    plan.tests.front().rows = std::min(plan.tests.front().rows, most_rows_used);
    plan.tests.front().count = 1;
    plan.horizon = std::min<std::size_t>(plan.horizon, 25);
    plan.steady_after_s /= 10;
    for (Case& one : plan.cases) {
        one.feature_count = std::min(one.feature_count, 30);
        one.likelihood_rows = std::min(one.likelihood_rows, 60);
        one.starts = 1;
    }
    return plan;
}

} // namespace dfdyn::tools
