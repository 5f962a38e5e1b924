// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv_writer.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/system/atomic_file.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;
using Names = std::vector<std::string>;

/// Fills `columns` with values of all magnitudes.
void fill(Columns& columns, Names names, std::size_t row_count, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::uniform_int_distribution<int> exponent(-300, 300);
    columns.names = std::move(names);
    for (std::size_t count = 0; count < row_count * columns.names.size(); ++count) {
        columns.values.push_back(std::ldexp(mantissa(engine), exponent(engine)));
    }
}

Recording random_recording(std::mt19937_64& engine) {
    const std::size_t joint_count = 1 + engine() % 12;
    const std::size_t row_count = 1 + engine() % 40;
    Recording recording;
    fill(recording.position, joint_names("q", joint_count), row_count, engine);
    fill(recording.velocity, joint_names("qd", joint_count), row_count, engine);
    fill(recording.acceleration, joint_names("qdd", joint_count), row_count, engine);
    fill(recording.output, output_names(OutputKind::motor_current, joint_count), row_count, engine);
    std::uniform_real_distribution<double> step(1e-6, 10);
    double time_s = -100;
    for (std::size_t row = 0; row < row_count; ++row) {
        recording.time_s.push_back(time_s += step(engine));
        recording.time_ns.push_back(std::llround(recording.time_s.back() * 1e9));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
    }
    return recording;
}

void write(const std::filesystem::path& path, const Recording& recording) {
    const std::array<const Columns*, 4> parts{&recording.output, &recording.velocity, &recording.acceleration,
                                              &recording.position};
    Names names{"t"};
    for (const Columns* const part : parts) {
        names.insert(names.end(), part->names.begin(), part->names.end());
    }
    AtomicFile file(path);
    CsvWriter writer(file.stream(), names);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        writer.field(recording.time_s[row]);
        for (const Columns* const part : parts) {
            writer.fields(part->row(row));
        }
        writer.end_row();
    }
    file.commit();
}

void check_equal(const Columns& one, const Columns& other) {
    CHECK(one.names == other.names);
    CHECK(one.values == other.values);
}

} // namespace

TEST_CASE("a recording that was written reads back bit by bit") {
    DFDYN_SEEDED_ENGINE(engine);
    const TemporaryDirectory directory;
    for (int count = 0; count < 100; ++count) {
        const Recording written = random_recording(engine);
        write(directory.path() / "log.csv", written);
        const Recording read =
            read_recording(directory.path() / "log.csv",
                           {.outputs = OutputKind::motor_current, .velocity = true, .acceleration = true});
        check_equal(read.position, written.position);
        check_equal(read.velocity, written.velocity);
        check_equal(read.acceleration, written.acceleration);
        check_equal(read.output, written.output);
        CHECK(read.time_s == written.time_s);
        CHECK(read.time_ns == written.time_ns);
        CHECK(read.gap_before == written.gap_before);
        CHECK(read.ignored_columns.empty());
        CHECK(read.skipped.total() == 0);
    }
}

TEST_CASE("CsvWriter writes numbers and names separated by commas") {
    std::ostringstream out;
    CsvWriter writer(out, Names{"t", "tau1_pred", "tau1_std", "status"});
    writer.field(0.008).fields(std::vector<double>{-1.5, std::numeric_limits<double>::quiet_NaN()});
    writer.name("ok").end_row();
    CHECK(out.str() == "t,tau1_pred,tau1_std,status\n0.008,-1.5,nan,ok\n");
}

TEST_CASE("CsvWriter rejects incomplete rows and names that would break the table") {
    std::ostringstream out;
    CsvWriter writer(out, Names{"t", "q1"});
    writer.field(1);
    CHECK_THROWS_AS(writer.end_row(), std::logic_error);
    writer.field(2);
    for (const std::string name : {"", "a,b", "a\"", "a\n", "a\r"}) {
        CHECK_THROWS_AS(writer.name(name), std::logic_error);
    }
    writer.end_row();
    CHECK(out.str() == "t,q1\n1,2\n");
}
