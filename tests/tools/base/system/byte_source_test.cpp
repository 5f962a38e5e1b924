// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/byte_source.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

namespace byte_source_test {

using dfdyn::tests::file_content;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::ByteSource;
using dfdyn::tools::InputError;

std::string read_all(const std::filesystem::path& path, std::size_t piece) {
    ByteSource source(path);
    std::string content;
    std::string buffer(piece, '\0');
    while (const std::size_t count = source.read(buffer)) {
        content.append(buffer, 0, count);
    }
    CHECK(source.read(buffer) == 0);
    return content;
}

/// Compresses the file `name` of the directory with the program gzip.
std::filesystem::path compressed(const TemporaryDirectory& directory, const std::string& name) {
    const std::filesystem::path file = directory.path() / name;
    REQUIRE(std::system(("gzip -kf " + file.string()).c_str()) == 0);
    return file.string() + ".gz";
}

TEST_CASE("files that gzip wrote are read as what they contain, in pieces of any size") {
    DFDYN_SEEDED_ENGINE(engine);
    std::string content;
    for (std::size_t k = 0; k < 200'000; ++k) {
        content += static_cast<char>('a' + engine() % 7);
    }
    const TemporaryDirectory directory;
    for (const std::size_t length : {std::size_t{0}, std::size_t{1}, content.size()}) {
        directory.write("log", std::string_view(content).substr(0, length));
        const std::filesystem::path file = compressed(directory, "log");
        CHECK(read_all(file, 1 + engine() % 100'000) == content.substr(0, length));
        CHECK(read_all(directory.path() / "log", 1 + engine() % 100'000) == content.substr(0, length));
    }
}

TEST_CASE("a file with several compressed members is read as one") {
    const TemporaryDirectory directory;
    directory.write("a", "t,q1\n0,1\n");
    directory.write("b", "1,2\n");
    const std::string both =
        file_content(compressed(directory, "a")) + file_content(compressed(directory, "b"));
    CHECK(read_all(directory.write("both.csv.gz", both), 3) == "t,q1\n0,1\n1,2\n");
    CHECK(dfdyn::tools::read_recording(directory.path() / "both.csv.gz", {}).position.values ==
          std::vector<double>{1, 2});
}

TEST_CASE("every prefix of a compressed file, and every changed byte, is read or rejected with its name") {
    DFDYN_SEEDED_ENGINE(engine);
    const TemporaryDirectory directory;
    directory.write("log", "t,q1\n0,1\n1,2\n");
    const std::string whole = file_content(compressed(directory, "log"));
    for (std::size_t length = 2; length < whole.size(); ++length) {
        const std::string path = directory.write("part.gz", std::string_view(whole).substr(0, length));
        CHECK_THROWS_MATCHES(
            read_all(path, 64), InputError,
            Catch::Matchers::Message(path +
                                     ": expected complete gzip data, found the end of the file within it"));
    }
    for (std::size_t place = 2; place < whole.size(); ++place) {
        std::string damaged = whole;
        damaged[place] = static_cast<char>(damaged[place] + 1 + static_cast<char>(engine() % 254));
        const std::string path = directory.write("damaged.gz", damaged);
        try {
            read_all(path, 64);
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), Catch::Matchers::StartsWith(path + ": expected"));
        }
    }
}

} // namespace byte_source_test
