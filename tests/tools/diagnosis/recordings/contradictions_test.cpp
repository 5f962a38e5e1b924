// SPDX-License-Identifier: Apache-2.0
// A cause of known size in each of three recordings; its size in the joined one is fitted by least squares.
#include "tools/diagnosis/recordings/consistency.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace contradictions_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::VectorXd;

using ByRecording = std::array<double, 3>;
constexpr std::array<Index, 3> rows{500, 900, 600};
constexpr double confidence = 0.9;

/// Three joined recordings of an arm, in which causes may act.
class Arm {
  public:
    explicit Arm(std::mt19937_64& engine) : engine_(engine) {
        MeasuredMotion motion = swing(2);
        motion.stretches.clear();
        Index first = 0;
        for (const Index count : rows) {
            if (first > 0) {
                motion.time_s.tail(motion.time_s.size() - first).array() += 2;
            }
            motion.stretches.push_back({first, count});
            first += count;
            ends_s_.push_back(motion.time_s[first - 1]);
        }
        REQUIRE(first == motion.time_s.size());
        work_.signals = std::make_shared<const DiagnosisSignals>(
            diagnosis_signals(planar_arm(9.81), OutputKind::joint_torque, motion));
    }

    /// Adds a cause with these sizes on the second output, in noise of standard deviation 1.
    Finding& add(const std::string& effect, const ByRecording& sizes) {
        const VectorXd column = random(), noise = random();
        VectorXd torque = noise;
        Index first = 0;
        for (std::size_t r = 0; r < rows.size(); ++r) {
            torque.segment(first, rows[r]) += sizes[r] * column.segment(first, rows[r]);
            first += rows[r];
        }
        Finding finding;
        finding.effect = effect;
        finding.where = "joint2";
        finding.output = 1;
        finding.confidence = confidence;
        finding.evidence = "evidence";
        finding.share = column.dot(torque) / column.squaredNorm() * column;
        finding.rest = torque - finding.share;
        return work_.diagnosis.findings.emplace_back(std::move(finding));
    }

    Finding judged() {
        doubt_contradicted_findings(work_, ends_s_);
        REQUIRE(work_.diagnosis.findings.size() == 1);
        return work_.diagnosis.findings.front();
    }

  private:
    VectorXd random() {
        std::normal_distribution<double> normal;
        return VectorXd::NullaryExpr(rows[0] + rows[1] + rows[2], [&] { return normal(engine_); });
    }

    std::mt19937_64& engine_;
    DiagnosisWork work_;
    std::vector<double> ends_s_;
};

/// The numbers of a text that ends with "is 0.01, 2.99, 0.02)".
std::vector<double> factors_in(const std::string& evidence) {
    const std::size_t at = evidence.rfind(" is ");
    REQUIRE(at != std::string::npos);
    std::istringstream text(evidence.substr(at + 4));
    std::vector<double> factors;
    for (double factor = 0; text >> factor;) {
        factors.push_back(factor);
        text.ignore(1);
    }
    return factors;
}

void check_kept(const Finding& finding) {
    CHECK(finding.confidence == confidence);
    CHECK(finding.evidence == "evidence");
}

TEST_CASE("a cause that acts in only one of three recordings has a low confidence and its size in each") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::size_t acting : {0U, 1U, 2U}) {
        CAPTURE(acting);
        Arm arm(engine);
        ByRecording sizes{};
        sizes.at(acting) = 3;
        arm.add("torque_ripple", sizes);
        const Finding finding = arm.judged();
        CHECK(finding.confidence < 0.5);
        CHECK_THAT(finding.evidence, Catch::Matchers::StartsWith("evidence (the recordings contradict it"));
        // In the joined recording its size is the rows' share.
        const double factor = 2000.0 / static_cast<double>(rows.at(acting));
        const std::vector<double> factors = factors_in(finding.evidence);
        REQUIRE(factors.size() == 3);
        for (std::size_t r = 0; r < 3; ++r) {
            CHECK(factors[r] == Approx(r == acting ? factor : 0).margin(0.1 * factor));
        }
    }
}

TEST_CASE(
    "a cause with opposite signs has a low confidence, one with equal size in all recordings keeps its own") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm opposite(engine);
    opposite.add("torque_ripple", {-2, 3, -2});
    CHECK(opposite.judged().confidence < 0.5);
    for (const ByRecording& sizes : {ByRecording{3, 3, 3}, ByRecording{2, 3, 2.5}, ByRecording{-3, -3, -3}}) {
        Arm arm(engine);
        arm.add("torque_ripple", sizes);
        check_kept(arm.judged());
    }
}

TEST_CASE("contacts, loads of one recording and values of each recording are exempt from contradiction") {
    DFDYN_SEEDED_ENGINE(engine);
    const ByRecording sizes{0, 3, 0};
    Arm contact(engine);
    contact.add("external_contact", sizes);
    check_kept(contact.judged());
    Arm load(engine);
    load.add("payload", sizes).only_in = "b.csv";
    check_kept(load.judged());
    Arm friction(engine);
    friction.add("viscous_friction", sizes).by_recording = {{"a.csv", 1, 0, 2}};
    check_kept(friction.judged());
}

TEST_CASE("a recording with almost no contribution of a cause does not contradict it") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    Finding& finding = arm.add("torque_ripple", {3, -0.5, -0.5});
    finding.share.tail(rows[1] + rows[2]) *= 0.02; // a shape that only the first motion excites
    check_kept(arm.judged());
}

} // namespace contradictions_test
