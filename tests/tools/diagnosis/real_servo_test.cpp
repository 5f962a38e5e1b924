// SPDX-License-Identifier: Apache-2.0
// A real servo that swings a pendulum, compared with the friction that others published for it.
// tests/data/xl330_bam/PROVENANCE.md lists the published values and the limits of this comparison.
#include "tests/support/catch.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/json_reader.hpp"
#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;

const std::filesystem::path folder = DFDYN_TEST_DATA_DIR "/xl330_bam";
constexpr double likely = 0.5;

/// Published parameters of the servo.
struct Published {
    nlohmann::json json;

    explicit Published(const char* name) : json(parse_json(read_file(folder / name), name)) {}

    double operator[](const char* name) const { return json.at(name).get<double>(); }
    double torque_per_volt() const { return (*this)["kt"] / (*this)["R"]; }
    double viscous_with_back_emf() const {
        return (*this)["kt"] * torque_per_volt() + (*this)["friction_viscous"];
    }
};

Recording all_runs() {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".csv") {
            paths.push_back(entry.path());
        }
    }
    std::ranges::sort(paths);
    REQUIRE(paths.size() == 12);
    return joined_recording(read_recordings(paths, {.joint_count = 1, .outputs = OutputKind::motor_current}));
}

DiagnosisOptions options_with(double torque_per_volt) {
    DiagnosisOptions how;
    how.outputs = OutputKind::motor_current;
    how.torque_constants = {torque_per_volt};
    return how;
}

Diagnosis diagnosis_with(const DiagnosisOptions& how) {
    ReadRobotOptions chain;
    chain.tip = "arm";
    return diagnose(read_robot(folder / "pendulum.urdf", chain), all_runs(), how).diagnosis;
}

const Finding& found(const Diagnosis& diagnosis, const std::string& effect) {
    const auto at = std::ranges::find(diagnosis.findings, effect, &Finding::effect);
    INFO(effect);
    REQUIRE(at != diagnosis.findings.end());
    return *at;
}

bool may_be(const FoundParameter& parameter, double value) {
    return parameter.low <= value && value <= parameter.high;
}

} // namespace

TEST_CASE("a real servo's viscous and load-dependent friction agree with the published values") {
    const Published m1("m1.json");
    const Published m6("m6.json");
    const Diagnosis diagnosis = diagnosis_with(options_with(m1.torque_per_volt()));
    CHECK(std::ranges::all_of(diagnosis.findings, [](const Finding& one) {
        return one.confidence < likely || one.effect == "viscous_friction" ||
               one.effect == "load_dependent_friction" || one.effect == "rotor_inertia";
    }));

    const Finding& viscous = found(diagnosis, "viscous_friction");
    CHECK(viscous.confidence >= likely);
    CHECK(may_be(viscous.parameters[0], m1.viscous_with_back_emf()));
    CHECK(std::abs(viscous.parameters[0].value - m1.viscous_with_back_emf()) <
          m6.viscous_with_back_emf() - m1.viscous_with_back_emf());

    const Finding& load = found(diagnosis, "load_dependent_friction");
    CHECK(load.confidence >= likely);
    const double of_motor = m6["load_friction_motor"];
    const double slowly = of_motor + m6["load_friction_external_stribeck"];
    CHECK(may_be(load.parameters[0], slowly / (1 - of_motor * of_motor))); // mean of lifting and lowering
    CHECK(load.parameters[0].value > of_motor / (1 + of_motor));           // lowering, fast
    CHECK(load.parameters[0].value < slowly / (1 - of_motor));             // lifting, slowly

    CHECK(diagnosis.extended.nrmse[0] < 0.7 * diagnosis.nominal.nrmse[0]);
}

TEST_CASE("a real servo's rotor inertia is the published one for either published torque per volt") {
    for (const char* const name : {"m1.json", "m6.json"}) {
        INFO(name);
        const Published published(name);
        const Diagnosis diagnosis = diagnosis_with(options_with(published.torque_per_volt()));
        const FoundParameter armature = found(diagnosis, "rotor_inertia").parameters[0];
        CHECK(may_be(armature, published["armature"]));
        CHECK(armature.high - armature.low < published["armature"]);
    }
}

TEST_CASE("without a held-out part the errors are those over the whole recording") {
    DiagnosisOptions how = options_with(Published("m1.json").torque_per_volt());
    const Diagnosis held_out = diagnosis_with(how);
    how.measure = false;
    const Diagnosis whole = diagnosis_with(how);
    CHECK(held_out.heldout_from_s < held_out.heldout_to_s);
    CHECK(whole.heldout_from_s == whole.heldout_to_s);
    CHECK(whole.nominal.rms[0] != Approx(held_out.nominal.rms[0]).epsilon(1e-3));
    CHECK(whole.extended.nrmse[0] < 0.7 * whole.nominal.nrmse[0]);
}
