// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/line_reader.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace {

using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::InputError;
using dfdyn::tools::LineReader;
using Lines = std::vector<std::string>;

Lines read_all(const std::filesystem::path& path) {
    LineReader reader(path);
    Lines lines;
    while (const auto line = reader.next()) {
        lines.emplace_back(*line);
        REQUIRE(reader.line_number() == lines.size());
    }
    REQUIRE_FALSE(reader.next());
    return lines;
}

} // namespace

TEST_CASE("LineReader accepts LF and CRLF and a last line without either and drops a byte order mark") {
    const auto [content, lines] = GENERATE(table<std::string, Lines>({
        {"", {}},
        {"a", {"a"}},
        {"a\n", {"a"}},
        {"a\nb", {"a", "b"}},
        {"a\r\nb\r\n", {"a", "b"}},
        {"\n\n", {"", ""}},
        {"a\r\r\nb\rc\n", {"a\r", "b\rc"}},
        {"\xef\xbb\xbft,q1\n\xef\xbb\xbf", {"t,q1", "\xef\xbb\xbf"}},
        {std::string("a\0b\n", 4), {std::string("a\0b", 3)}},
    }));
    CAPTURE(content);
    const TemporaryDirectory directory;
    CHECK(read_all(directory.write("text", content)) == lines);
}

TEST_CASE("LineReader returns random lines of any length") {
    DFDYN_SEEDED_ENGINE(engine);
    std::geometric_distribution<std::size_t> short_length(0.05);
    std::uniform_int_distribution<std::size_t> long_length(60'000, 200'000);
    Lines lines;
    std::string content;
    for (int count = 0; count < 500; ++count) {
        const std::size_t length = count % 50 == 49 ? long_length(engine) : short_length(engine);
        lines.emplace_back(length, static_cast<char>('a' + count % 26));
        content += lines.back() + '\n';
    }
    const TemporaryDirectory directory;
    CHECK(read_all(directory.write("text", content)) == lines);
}

TEST_CASE("LineReader limits the length of a line but not of the file") {
    const TemporaryDirectory directory;
    const std::string longest(LineReader::longest_line, 'x');
    CHECK(read_all(directory.write("text", longest + "\r\n" + longest)) == Lines{longest, longest});
    // With 65534 bytes the reader has read the CR of the second line but not its LF when it checks the
    // length.
    const std::string shifted(65534, 'a');
    CHECK(read_all(directory.write("text", shifted + "\n" + longest + "\r\n")) == Lines{shifted, longest});
    const auto path = directory.write("text", "a\n" + longest + "x\n");
    CHECK_THROWS_MATCHES(
        read_all(path), InputError,
        Catch::Matchers::Message(path.string() +
                                 ":2: expected a line of at most 1048576 bytes, found a longer one"));
    CHECK_THROWS_MATCHES(read_all("/dev/zero"), InputError,
                         Catch::Matchers::Message(
                             "/dev/zero:1: expected a line of at most 1048576 bytes, found a longer one"));
}

TEST_CASE("LineReader reports the reason of the system") {
    const TemporaryDirectory directory;
    const std::string path = directory.path().string();
    CHECK_THROWS_MATCHES(read_all(path + "/none"), InputError,
                         Catch::Matchers::Message(path + "/none: cannot open: No such file or directory"));
    CHECK_THROWS_MATCHES(read_all(path), InputError,
                         Catch::Matchers::Message(path + ": cannot read: Is a directory"));
}
