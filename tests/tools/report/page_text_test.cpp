// SPDX-License-Identifier: Apache-2.0
#include "tools/report/page_text.hpp"

#include "tests/support/catch.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tools = dfdyn::tools;

TEST_CASE("escape_html escapes only characters with a meaning in HTML") {
    CHECK(tools::escape_html("</script>\"a' & b") == "&lt;/script&gt;&quot;a&#39; &amp; b");
    CHECK(tools::escape_html("&amp;&&") == "&amp;amp;&amp;&amp;");
    CHECK(tools::escape_html("±2σ N·m") == "±2σ N·m");
}

TEST_CASE("script_json cannot end a script element and is still the same JSON") {
    const nlohmann::json data = {{"</script><!--", "a & b > c \"quoted\" \\ \n"}};
    const std::string text = tools::script_json(data);
    CAPTURE(text);
    CHECK(text.find_first_of("<>&\n") == std::string::npos);
    CHECK(nlohmann::json::parse(text) == data);
}

TEST_CASE("script_json replaces bytes that are not UTF-8") {
    const std::string text = tools::script_json({{"name", "log_\xff.csv"}});
    CHECK(nlohmann::json::parse(text)["name"] == "log_\uFFFD.csv");
}

TEST_CASE("base64 encodes the little-endian bytes with padding") {
    CHECK(tools::base64_floats({}).empty());
    CHECK(tools::base64_floats(std::array{1.0F}) == "AACAPw==");
    CHECK(tools::base64_floats(std::array{1.0F, -2.5F}) == "AACAPwAAIMA=");
    CHECK(tools::base64_floats(std::array{1.0F, -2.5F, 3.14F}) == "AACAPwAAIMDD9UhA");
    CHECK(tools::base64_floats(std::array{std::numeric_limits<float>::infinity()}) == "AACAfw==");
    CHECK(tools::base64_doubles(std::array{1.0}) == "AAAAAAAA8D8=");
}

TEST_CASE("fill_page fills every place once and does not search the inserted text") {
    CHECK(tools::fill_page("<{{a}}|{{b}}|{{a}}>", {{"a", "{{b}}"}, {"b", "}}{{"}}) == "<{{b}}|}}{{|{{b}}>");
    CHECK(tools::fill_page("plain", {}) == "plain");
}

TEST_CASE("fill_page rejects a name without a text") {
    CHECK_THROWS_AS(tools::fill_page("{{unknown}}", {{"a", "b"}}), std::out_of_range);
}
