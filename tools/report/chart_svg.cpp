// SPDX-License-Identifier: Apache-2.0
#include "tools/report/chart_svg.hpp"

#include "tools/report/page_text.hpp"

#include <array>
#include <charconv>

namespace dfdyn::tools::svg {

namespace {

constexpr int colours = 8;

std::string with_decimals(double value, int decimals) {
    std::array<char, 32> text{};
    return {
        text.data(),
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr};
}

} // namespace

std::string number(double value) { return with_decimals(value, 1); }

std::string fine_point(std::string_view command, double x, double y) {
    return joined({command, with_decimals(x, 2), " ", with_decimals(y, 2)});
}

std::string ends_of(double low, double high) {
    std::array<char, 64> text{};
    char* const middle = std::to_chars(text.data(), text.data() + 32, low).ptr;
    *middle = ' ';
    return {text.data(), std::to_chars(middle + 1, text.data() + text.size(), high).ptr};
}

std::string joined(std::initializer_list<std::string_view> parts) {
    std::string all;
    for (const std::string_view part : parts) {
        all += part;
    }
    return all;
}

std::string attribute(std::string_view name, double value) {
    return joined({" ", name, "=\"", number(value), "\""});
}

std::string line(std::string_view kind, double x1, double y1, double x2, double y2) {
    return joined({"<line class=\"", kind, "\"", attribute("x1", x1), attribute("y1", y1),
                   attribute("x2", x2), attribute("y2", y2), "/>\n"});
}

std::string text(std::string_view kind, double x, double y, std::string_view content) {
    return joined(
        {"<text class=\"", kind, "\"", attribute("x", x), attribute("y", y), ">", content, "</text>\n"});
}

std::string opening(const std::string& title, double width, double height) {
    return joined({R"(<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" viewBox="0 0 )",
                   number(width), " ", number(height), "\"", attribute("width", width),
                   attribute("height", height), " aria-label=\"", escape_html(title), "\">\n",
                   text("title", 6, 16, escape_html(title))});
}

std::string appearance(std::size_t index) {
    return joined({"c", std::to_string(index % colours), " dash", std::to_string(index / 4 % 3)});
}

std::size_t length_of(const std::string& utf8) {
    return static_cast<std::size_t>(
        std::ranges::count_if(utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string x_label(double middle, double y_bottom, const std::string& label) {
    return text("label", middle, y_bottom + 38, escape_html(label));
}

std::string y_label(double middle, const std::string& label) {
    return joined({"<text class=\"label\" transform=\"translate(14 ", number(middle), ") rotate(-90)\">",
                   escape_html(label), "</text>\n"});
}

} // namespace dfdyn::tools::svg
