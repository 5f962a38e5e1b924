// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/evaluation_page.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/experiment/synthetic_jobs.hpp"
#include "tests/tools/support/balanced_markup.hpp"

#include <algorithm>
#include <limits>

namespace evaluation_page_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::job_at;
using dfdyn::tests::markup_fault;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::two_case_plan;

struct Evaluation {
    Plan plan = two_case_plan(6);
    PlanData data;
    EvaluationResults results;
};

/// An evaluation in which A's errors are half of B's in six draws.
Evaluation evaluation() {
    std::mt19937_64 engine(1);
    Evaluation one;
    one.data.start.output.names = {"fx", "mx"};
    one.data.subsets.resize(3);
    for (const std::uint64_t seed : one.plan.seeds) {
        one.results.jobs.push_back(job_at("A", seed, 0.5, engine));
        one.results.jobs.push_back(job_at("B", seed, 1, engine));
    }
    one.plan.findings = {
        {"A wins", "A errs less.", "Because of that.", {{"A", "B", "force", Phase::steady, 0}}},
        {"B wins", "B errs less.", "Because of this.", {{"B", "A", "force", Phase::steady, 0}}}};
    one.plan.comparisons = {{"A", "B", "torque", Phase::transient, 0.3}};
    return one;
}

void write(const TemporaryDirectory& directory, const Evaluation& one) {
    write_evaluation(directory.path(), one.plan, one.data, one.results);
}

TEST_CASE("an evaluation writes page and tables and findings and figures and pictures") {
    const TemporaryDirectory directory;
    write(directory, evaluation());
    const std::string html = file_content(directory.path() / "report.html");
    const std::string markdown = file_content(directory.path() / "findings.md");
    CHECK(markup_fault(html).empty());
    for (const std::string& text : {html, markdown}) {
        CHECK_THAT(text, ContainsSubstring("A wins: reproduced"));
        CHECK_THAT(text, ContainsSubstring("B wins: not reproduced"));
        CHECK_THAT(text, ContainsSubstring("Why it is not reproduced: Because of this."));
        CHECK_THAT(text, !ContainsSubstring("Because of that."));
        CHECK_THAT(text, ContainsSubstring("at least 30 % less, transient"));
    }
    const std::string verdicts = file_content(directory.path() / "verdicts.md");
    CHECK_THAT(verdicts, ContainsSubstring("| A wins | 1 | 0 | 0 | reproduced |"));
    CHECK_THAT(verdicts, ContainsSubstring("B wins (not reproduced): Because of this."));
    CHECK_THAT(verdicts, !ContainsSubstring("Because of that."));
    CHECK_THAT(file_content(directory.path() / "tables.md"), ContainsSubstring("| A | 0.05"));
    for (const std::string name : {"plan_1_force_curves", "plan_1_torque_boxes"}) {
        CHECK_THAT(markdown, ContainsSubstring("(pictures/" + name + ".svg)"));
        const std::string svg = file_content(directory.path() / "pictures" / (name + ".svg"));
        CHECK(markup_fault(svg).empty());
        CHECK_THAT(svg, ContainsSubstring("<title>A</title>"));
        CHECK_THAT(svg, ContainsSubstring("<title>B</title>"));
    }
}

TEST_CASE("the verdicts have a heading for reasons only if there is a reason") {
    const TemporaryDirectory directory;
    Evaluation one = evaluation();
    write(directory, one);
    const std::string heading = "Why not all are reproduced";
    CHECK_THAT(file_content(directory.path() / "verdicts.md"), ContainsSubstring(heading));
    one.plan.findings.pop_back(); // the other one is reproduced
    write(directory, one);
    CHECK_THAT(file_content(directory.path() / "verdicts.md"), !ContainsSubstring(heading));
    CHECK_THAT(file_content(directory.path() / "verdicts.md"), ContainsSubstring("A wins"));
}

TEST_CASE("the page of an evaluation needs no network") {
    const TemporaryDirectory directory;
    write(directory, evaluation());
    const std::string html = file_content(directory.path() / "report.html");
    for (const std::string load :
         {"src=", "href=", "@import", "url(", "<link", "<img", "<iframe", "https://"}) {
        CAPTURE(load);
        CHECK(html.find(load) == std::string::npos);
    }
}

TEST_CASE("the results have one row per case and draw and group") {
    const TemporaryDirectory directory;
    write(directory, evaluation());
    const std::string csv = file_content(directory.path() / "results.csv");
    CHECK(std::ranges::count(csv, '\n') == 1 + 2 * 6 * 2);
    const auto commas = std::ranges::count(csv.substr(0, csv.find('\n')), ',');
    CHECK(std::ranges::count(csv, ',') == commas * 25);
    CHECK_THAT(csv, ContainsSubstring("case,seed,group,transient_mean,"));
    CHECK_THAT(csv, ContainsSubstring(",nrmse_fx,nrmse_mx,lost,median_us,operations,state_bytes,columns\n"));
    CHECK_THAT(csv, ContainsSubstring("\nB,6,torque,"));
}

TEST_CASE("opponents follow the cases in the table and in the results") {
    Evaluation one = evaluation();
    const TemporaryDirectory directory;
    write(directory, one);
    CHECK_THAT(file_content(directory.path() / "tables.md"), !ContainsSubstring("Persistence"));
    const double none = std::numeric_limits<double>::quiet_NaN();
    one.results.opponents = {{{"persistence", {0.25, 0.5}}, {"identified rigid body", {none, none}}},
                             "the plan has no robot"};
    write(directory, one);
    const std::string tables = file_content(directory.path() / "tables.md");
    CHECK_THAT(tables, ContainsSubstring("| persistence | 0.25"));
    CHECK_THAT(tables, ContainsSubstring("| identified rigid body | – | – |"));
    CHECK(tables.find("No rigid body: the plan has no robot.") == tables.rfind("No rigid body"));
    const std::string csv = file_content(directory.path() / "results.csv");
    CHECK(std::ranges::count(csv, '\n') == 1 + 2 * 6 * 2 + 2);
    const auto commas = std::ranges::count(csv.substr(0, csv.find('\n')), ',');
    CHECK(std::ranges::count(csv, ',') == commas * 27);
    CHECK_THAT(csv, ContainsSubstring("\npersistence,0,,nan,"));
    CHECK_THAT(csv, ContainsSubstring(",nan,0.25,0.5,nan,"));
}

TEST_CASE("lost ticks and cases without draws are mentioned with the table") {
    Evaluation one = evaluation();
    const TemporaryDirectory directory;
    write(directory, one);
    CHECK_THAT(file_content(directory.path() / "tables.md"), !ContainsSubstring("Lost"));
    for (JobResult& job : one.results.jobs) {
        if (job.case_name == "B") {
            job.error[1][2][50] = std::numeric_limits<double>::infinity();
        }
    }
    one.plan.cases[0].model = std::string("P");
    write(directory, one);
    const std::string tables = file_content(directory.path() / "tables.md");
    CHECK_THAT(tables, ContainsSubstring("counted as infinite: B 0.556 %")); // 1 of 180
    CHECK_THAT(tables, ContainsSubstring("all draws are the same: A."));
    CHECK_THAT(tables, ContainsSubstring("∞"));
    CHECK_THAT(tables, !ContainsSubstring("A 0"));
}

TEST_CASE("the tables show the spread over the draws") {
    Evaluation one;
    std::mt19937_64 engine(1);
    one.plan.seeds = {1, 2, 3};
    one.data.start.output.names = {"fx", "mx"};
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        one.results.jobs.push_back(job_at("A", seed, 1, engine));
        for (auto& group : one.results.jobs.back().error) {
            for (std::vector<double>& subset : group) {
                std::ranges::fill(subset, static_cast<double>(seed));
            }
        }
    }
    const TemporaryDirectory directory;
    write(directory, one);
    // The mean and the median over all draws 1, 2 and 3 are 2.
    CHECK_THAT(file_content(directory.path() / "tables.md"),
               ContainsSubstring("| A | 2 | 1.5–2.5 | 2 | 2 | 2 | 1.5–2.5 | 1 | 3 | 1 | 3 |"));
}

TEST_CASE("failed cases are reported and the others are shown") {
    Evaluation one = evaluation();
    std::erase_if(one.results.jobs, [](const JobResult& job) { return job.case_name == "B"; });
    one.results.failed = {{"B", 1, "training: <no> likelihood"}};
    const TemporaryDirectory directory;
    write(directory, one);
    const std::string html = file_content(directory.path() / "report.html");
    CHECK(markup_fault(html).empty());
    CHECK_THAT(html, ContainsSubstring("B, draw 1: training: &lt;no&gt; likelihood"));
    CHECK_THAT(html, ContainsSubstring("A wins: undecided"));
}

TEST_CASE("texts of a plan are escaped in the page") {
    const std::string hostile = "</title><script>alert(\"'&{{facts}}\")</script>";
    Evaluation one = evaluation();
    one.plan.title = one.plan.figures[0].title = one.plan.findings[0].statement = hostile;
    const TemporaryDirectory directory;
    write(directory, one);
    const std::string html = file_content(directory.path() / "report.html");
    CHECK(html.find("alert(\"") == std::string::npos);
    CHECK(html.find("<script") == html.rfind("<script")); // the page's own
    CHECK(markup_fault(html).empty());
}

} // namespace evaluation_page_test
