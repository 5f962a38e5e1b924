// SPDX-License-Identifier: Apache-2.0
// An arm on a CAN bus from the command line with simulate, convert, train and replay.
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <string>

namespace bus_commands_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

/// Two drives, the second with node number `second`.
std::string drives(int second) {
    return R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 100, "trigger": {"on": "sync"},
 "joints": {"family": "cia402", "position": {"pdo": "0x280", "length": 6, "start_bit": 0, "bits": 32},
  "effort": {"pdo": "0x280", "length": 6, "start_bit": 32, "bits": 16},
  "boards": [{"node": 1, "joint": 1, "counts_per_turn": 1048576, "effort_per_count": 0.001},
             {"node": )" +
           std::to_string(second) + R"(, "joint": 2, "counts_per_turn": 1048576, "effort_per_count": 0.001}]},
 "output": {"family": "efforts", "quantity": "tau"}})";
}

/// A recording of the small arm, the frames of its drives, and a model.
class Bench {
  public:
    Bench() {
        directory_.write("bus.json", drives(2));
        directory_.write("other.json", drives(3));
        REQUIRE(call("simulate --robot " DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf"
                     " --scenario " DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json -o " +
                     path("run.csv") + " --candump " + path("run.log") + bus())
                    .status == 0);
    }

    std::string path(const std::string& name) const { return directory_.path() / name; }
    std::string bus(const std::string& name = "bus.json") const { return " --bus " + path(name); }
    Outcome call(const std::string& arguments) const { return run_program(directory_, arguments); }

    void train() const {
        REQUIRE(call("train --outputs tau --features 12 --starts 1 --likelihood-rows 60 --refinement 0 "
                     "--rows :300 --log " +
                     path("run.csv") + " -o " + path("model.json"))
                    .status == 0);
    }
    Outcome replay(const std::string& arguments) const {
        return call("replay --model " + path("model.json") + arguments);
    }

  private:
    TemporaryDirectory directory_;
};

TEST_CASE("the frames of simulated drives equal those converted from the recording byte for byte") {
    const Bench bench;
    const Outcome converted =
        bench.call("convert --log " + bench.path("run.csv") + bench.bus() + " -o " + bench.path("again.log"));
    CAPTURE(converted.error);
    REQUIRE(converted.status == 0);
    CHECK_THAT(converted.out, Catch::Matchers::StartsWith("bus load: "));
    CHECK(file_content(bench.path("again.log")) == file_content(bench.path("run.log")));
}

TEST_CASE("frames become predictions and frames of another arm are reported") {
    const Bench bench;
    bench.train();
    const std::string log = " --log " + bench.path("run.log");
    const Outcome replayed = bench.replay(log + bench.bus() + " -o " + bench.path("out.csv"));
    CAPTURE(replayed.error);
    CHECK(replayed.status == 0);
    // 3 frames for each of 450 rows, and 2 heartbeats at 0, 0.1, ... 4.5 s, when the last row is sent.
    CHECK_THAT(replayed.out, ContainsSubstring("bus: 1442 frames\n"));
    CHECK_THAT(file_content(bench.path("out.csv")), ContainsSubstring(",1,ok\n"));

    const Outcome other = bench.replay(log + bench.bus("other.json"));
    CHECK(other.status == 1);
    CHECK_THAT(other.out, ContainsSubstring(
                              "x frames with identifiers that the description does not have: first 0x702"));
}

TEST_CASE("bus options without a bus are rejected") {
    const Bench bench;
    bench.train();
    const std::string csv = " --log " + bench.path("run.csv");
    CHECK(bench.replay(" --can vcan0").status == 2);
    CHECK(bench.replay("").status == 2);
    CHECK(bench.replay(csv + " --from can0").status == 2);
    CHECK(bench.replay(csv + " --duration 1").status == 2);
    CHECK(bench.replay(csv + bench.bus() + " --rows :10").status == 2);
    CHECK(bench.call("convert" + csv + bench.bus("none.json") + " -o " + bench.path("no.log")).status == 2);
    CHECK_FALSE(std::filesystem::exists(bench.path("no.log")));
}

TEST_CASE("buscheck reports that it found no fault, or each fault with its source") {
    const Bench bench;
    const std::string log = " --log " + bench.path("run.log");
    const Outcome well = bench.call("buscheck" + log + bench.bus());
    CAPTURE(well.out, well.error);
    CHECK(well.status == 0);
    CHECK_THAT(well.out, ContainsSubstring("no fault found\n"));
    CHECK_THAT(well.out, ContainsSubstring("0x282"));

    const Outcome other = bench.call("buscheck" + log + bench.bus("other.json"));
    CHECK(other.status == 1);
    CHECK_THAT(other.out, ContainsSubstring("wrong_identifier: 0x283 (joint 2) is not sent") &&
                              ContainsSubstring("inferred from: 0x282") && ContainsSubstring("to fix:"));
    CHECK(bench.call("buscheck" + bench.bus()).status == 2);
    CHECK(bench.call("buscheck" + log + bench.bus() + " --can can0").status == 2);
    CHECK(bench.call("buscheck --log " + bench.path("none.log") + bench.bus()).status == 2);
}

} // namespace bus_commands_test
