// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <regex>
#include <string>

namespace recording_options_test {

using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string log_file = DFDYN_TEST_DATA_DIR "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv";
const std::string quick = " --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 --rows 0:600 ";

/// The recording with columns named like `/js/3/position`, in reversed order, compressed with gzip.
std::string renamed_recording(const TemporaryDirectory& directory) {
    const std::string folder = directory.path().string();
    const std::string program =
        "awk -F, 'NR == 1 {for (k = 1; k <= NF; ++k) {name = $k; if (name == \"t\") name = \"stamp\";"
        " if (name ~ /^q[0-9]/) name = \"/js/\" substr(name, 2) \"/position\";"
        " if (name ~ /^i[0-9]/) name = \"/js/\" substr(name, 2) \"/effort\"; $k = name}}"
        " {line = $NF; for (k = NF - 1; k >= 1; --k) line = line \";\" $k; print line}' ";
    const std::string file = folder + "/renamed.csv.gz";
    REQUIRE(std::system((program + log_file + " | gzip > " + file).c_str()) == 0);
    return file;
}

/// Returns a model's header without the names of the recordings and the checksum that includes them.
std::string numbers_of(const std::string& header) {
    return std::regex_replace(header.substr(header.find("#pragma once")), std::regex(R"(\.identity = \d+U)"),
                              "");
}

TEST_CASE(
    "a renamed, compressed recording from standard input trains the same model, and replay reads it alike") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string renamed = renamed_recording(directory);
    REQUIRE(run_program(directory,
                        "train --log " + log_file + quick + "-o " + in + "/a.json --header " + in + "/m.hpp")
                .status == 0);
    const std::string header = numbers_of(file_content(directory.path() / "m.hpp"));
    const Outcome trained =
        run_program(directory, "train --log - --columns 'q=/js/*/position,i=/js/*/effort'" + quick + "-o " +
                                   in + "/b.json --header " + in + "/m.hpp < " + renamed);
    CAPTURE(trained.error);
    REQUIRE(trained.status == 0);
    CHECK(numbers_of(file_content(directory.path() / "m.hpp")) == header);

    const std::string replay = " -o " + in + "/out.csv --rows 600:900";
    REQUIRE(run_program(directory, "replay --model " + in + "/a.json --log " + log_file + replay).status ==
            0);
    const std::string expected = file_content(directory.path() / "out.csv");
    REQUIRE(run_program(directory, "replay --model " + in + "/b.json --log " + renamed + replay).status == 0);
    CHECK(file_content(directory.path() / "out.csv") == expected);
}

TEST_CASE("a misspelt subcommand, option or column gets the nearest known one suggested") {
    const TemporaryDirectory directory;
    const auto error = [&](const std::string& arguments) {
        const Outcome outcome = run_program(directory, arguments);
        CHECK(outcome.status == 2);
        return outcome.error;
    };
    CHECK_THAT(error("trian --log x.csv"),
               Catch::Matchers::ContainsSubstring("found \"trian\" (did you mean \"train\"?)"));
    CHECK_THAT(error("replay --modle a.json"),
               Catch::Matchers::ContainsSubstring("found \"--modle\" (did you mean \"--model\"?)"));
    CHECK_THAT(error("train --log " + log_file + quick + "--columns q=Q* -o " + directory.path().string() +
                     "/x.json"),
               Catch::Matchers::ContainsSubstring("--columns q=Q*: expected columns that match, found none"));
}

TEST_CASE("footprint prints the needs of a model, as JSON too, and compares them with a budget") {
    const TemporaryDirectory directory;
    const std::string model = directory.path().string() + "/m.json";
    const Outcome trained = run_program(directory, "train --log " + log_file + quick + "-o " + model);
    REQUIRE(trained.status == 0);
    const Outcome printed = run_program(directory, "footprint --model " + model);
    CHECK(printed.status == 0);
    CHECK_THAT(printed.out, Catch::Matchers::StartsWith("on cortex-m7: flash at most "));
    CHECK_THAT(trained.out, Catch::Matchers::EndsWith(printed.out)); // train prints the same

    const Outcome json = run_program(directory, "footprint --model " + model + " --json --target cortex-m4f");
    REQUIRE(json.status == 0);
    const auto figures = nlohmann::json::parse(json.out);
    CHECK(figures.at("target") == "cortex-m4f");
    const auto flash = figures.at("flash_bytes").get<long>();
    const std::string budget = "footprint --model " + model + " --flash ";
    CHECK(run_program(directory, budget + std::to_string(flash)).status == 0);
    CHECK(run_program(directory, budget + std::to_string(flash - 1)).status == 1);
    CHECK(run_program(directory, "footprint --model " + model + " --target z80").status == 2);
}

} // namespace recording_options_test
