// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/description/dbc.hpp"

#include <array>
#include <filesystem>

namespace {

using namespace dfdyn::tools;
using Catch::Matchers::StartsWith;

double value_of(const Dbc& dbc, const char* message, const char* signal,
                const std::vector<std::uint8_t>& data) {
    const DbcMessage* const found = dbc.find(message);
    REQUIRE(found != nullptr);
    REQUIRE(static_cast<std::size_t>(found->length) == data.size());
    REQUIRE(found->find(signal) != nullptr);
    return found->find(signal)->signal.extract(data);
}

constexpr const char* example = R"(VERSION "1"

NS_ :
	SIG_VALTYPE_
	BO_TX_BU_

BU_: A B

BO_ 100 First: 8 A
 SG_ intel : 4|12@1+ (0.5,-10) [0|0] "rad" B
 SG_ motorola : 39|16@0- (0.01,0) [-100|100] "N m" B,A

BO_ 2566844926 Long: 8 A
 SG_ mode M : 0|8@1+ (1,0) [0|255] "" B
 SG_ a m0 : 8|16@1- (1,0) [0|0] "" B
 SG_ b m1 : 8|32@1- (1,0) [0|0] "" B

CM_ "a comment
BO_ 7 not a message: 8 A
of three lines";
BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
 SG_ lost : 0|64@1+ (1,0) [0|0] "" A
SIG_VALTYPE_ 2566844926 b : 1;
)";

} // namespace

TEST_CASE("a DBC file is parsed with byte order and sign and scale and unit and multiplexing and floats") {
    const Dbc dbc = parse_dbc(example, "x.dbc");
    REQUIRE(dbc.messages.size() == 2);
    // calculated by hand: bits 4 ... 15 of 0xAB 0xCD are 0xCDA = 3290; 0xFF38 is -200
    CHECK(value_of(dbc, "First", "intel", {0xAB, 0xCD, 0, 0, 0xFF, 0x38, 0, 0}) == 3290 * 0.5 - 10);
    CHECK(value_of(dbc, "First", "motorola", {0xAB, 0xCD, 0, 0, 0xFF, 0x38, 0, 0}) == Approx(-2));
    CHECK(dbc.find("First")->find("motorola")->unit == "N m");
    CHECK(dbc.find("First")->find("motorola")->lowest == -100);
    const DbcMessage& message = *dbc.find("Long");
    CHECK(message.extended);
    CHECK(message.id == 0x18FEF1FE);
    CHECK(message.multiplexor_of(*message.find("b")) == message.find("mode"));
    CHECK(message.find("b")->multiplex == 1U);
    CHECK_FALSE(message.find("mode")->multiplex);
    CHECK(value_of(dbc, "Long", "b", {1, 0, 0, 0x80, 0x3F, 0, 0, 0}) == 1);
}

TEST_CASE("the repository's own DBC files are parsed completely") {
    const std::string folder = DFDYN_TEST_DATA_DIR "/../../hal/dbc";
    int signals = 0;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
        CAPTURE(file.path());
        for (const DbcMessage& message : read_dbc(file.path()).messages) {
            signals += static_cast<int>(message.signals.size());
        }
    }
    CHECK(signals > 40);
    const Dbc odrive = read_dbc(folder + "/odrive.dbc");
    const Dbc strain = read_dbc(folder + "/icub_strain.dbc");
    CHECK(value_of(strain, "Force", "fz", {0, 0x80, 0, 0x80, 0, 0xC0}) == 1000);
    CHECK(odrive.messages.front().signals.front().signal.encoding == dfdyn::hal::Encoding::float32);
}

TEST_CASE("a quote in a comment of a DBC file does not affect the following statements") {
    const std::string before = "BO_ 1 A: 8 B\n SG_ a : 0|32@1- (1,0) [0|0] \"\" B\n";
    const std::string after = "\nSIG_VALTYPE_ 1 a : 1;\n";
    for (const std::string comment : {
             R"(CM_ SG_ 1 a "in \"turns\" of the motor";)",
             R"(CM_ SG_ 1 a "in \"turns";)",
             R"(CM_ SG_ 1 a "\"";)",
             R"(CM_ "from C:\arm\";)",
             "CM_ \"two lines,\n \\\"quoted\\\"\";",
             R"(VAL_ 1 a 0 "say \"no\"" 1 "yes" ;)",
         }) {
        CAPTURE(comment);
        const Dbc dbc = parse_dbc(before + comment + after, "x.dbc");
        CHECK(dbc.find("A")->find("a")->signal.encoding == dfdyn::hal::Encoding::float32);
    }
}

TEST_CASE("extended multiplexing of a DBC file is parsed") {
    const Dbc dbc = parse_dbc("NS_ :\n\tSG_MUL_VAL_\n"
                              "BO_ 1 A: 8 B\n"
                              " SG_ page M : 0|8@1+ (1,0) [0|0] \"\" B\n"
                              " SG_ axis m2M : 8|8@1+ (1,0) [0|0] \"\" B\n"
                              " SG_ q m1 : 16|16@1- (1,0) [0|0] \"\" B\n"
                              " SG_ t m3 : 16|16@1- (1,0) [0|0] \"\" B\n"
                              "SG_MUL_VAL_ 1 axis page 2-2;\n"
                              "SG_MUL_VAL_ 1 q axis 1-1, 4-6;\n",
                              "x.dbc");
    const DbcMessage& message = *dbc.find("A");
    CHECK(message.multiplexor_of(*message.find("q")) == message.find("axis"));
    CHECK(message.multiplexor_of(*message.find("axis")) == message.find("page"));
    REQUIRE(message.find("q")->multiplex_ranges.size() == 2);
    CHECK(message.find("q")->multiplex_ranges[1].first == 4);
    CHECK(message.find("q")->multiplex_ranges[1].last == 6);
    CHECK(message.multiplexor_of(*message.find("t")) == nullptr); // ambiguous: page or axis
}

TEST_CASE("errors in a DBC file are reported with line and column") {
    struct Wrong {
        const char* text;
        const char* message;
    };
    const auto [text, message] = GENERATE(values<Wrong>({
        {"BO_ x A: 8 B\n", R"(x.dbc:1:5: expected an identifier from 0 to 4294967295, found "x")"},
        {"\nBO_ 5000 A: 8 B\n",
         "x.dbc:2:5: expected an identifier of 11 bits, or of 29 with 2147483648 added"},
        {"BO_ 1 A: 65 B\n", R"(x.dbc:1:10: expected a number of bytes from 0 to 64, found "65")"},
        {"BO_ 1 A: 8 B\nBO_ 1 C: 8 B\n",
         "x.dbc:2:5: expected a message with an identifier and a name of its own"},
        {" SG_ a : 0|8@1+ (1,0) [0|0] \"\" B\n", "x.dbc:1:6: expected a message before its signals"},
        {"BO_ 1 A: 2 B\n SG_ a : 9|8@1+ (1,0) [0|0] \"\" B\n",
         "x.dbc:2:10: expected bits within the 2 bytes of the message"},
        {"BO_ 1 A: 2 B\n SG_ a : 0|8@1* (1,0) [0|0] \"\" B\n", R"(x.dbc:2:15: expected "+", found "*")"},
        {"BO_ 1 A: 2 B\n SG_ a : 0|8@1+ (0,0) [0|0] \"\" B\n", "x.dbc:2:18: expected a factor that is not 0"},
        {"BO_ 1 A: 2 B\n SG_ a : 0|8@1+ (1,0) [0|0] \"rad\n", "x.dbc:2:30: expected a text that ends with"},
        {"BO_ 1 A: 2 B\nCM_ \"a comment\nwithout end;\n",
         "x.dbc:2:5: expected a text that ends with \", found the end of the file"},
        {"BO_ 1 A: 2 B\n SG_ a m0 : 0|8@1+ (1,0) [0|0] \"\" B\nSG_MUL_VAL_ 1 a m 0;\n",
         R"(x.dbc:3:20: expected "-", found ";")"},
        {"BO_ 1 A: 2 B\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" B\nSIG_VALTYPE_ 1 a : 1;\n",
         "x.dbc:3:14: expected a signal of 32 bits, found 8"},
        {"SIG_VALTYPE_ 1 a : 1;\n", "x.dbc:1:14: expected a signal of a message above"},
    }));
    CAPTURE(text);
    CHECK_THROWS_WITH(parse_dbc(text, "x.dbc"), StartsWith(message));
}
