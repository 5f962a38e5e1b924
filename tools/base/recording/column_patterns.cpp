// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/column_patterns.hpp"

#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace dfdyn::tools {
namespace {

using Names = std::vector<std::string>;

const Names quantities{"t", "q", "qd", "qdd", "tau", "i", "wrench"};

/// Columns that a pattern matches, in the order of the joints.
using Places = std::vector<std::size_t>;

/// A column that a pattern with `*` matches, and the text that `*` stands for.
struct Match {
    std::size_t column = 0;
    std::string text;
};

std::optional<std::size_t> whole_number(const std::string& text) {
    std::size_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, fault] = std::from_chars(text.data(), end, number);
    return stop == end && fault == std::errc{} ? std::optional(number) : std::nullopt;
}

Names texts_of(const std::vector<Match>& matches) {
    Names texts;
    for (const Match& match : matches) {
        texts.push_back(match.text);
    }
    return texts;
}

/// Finds the columns of one pattern.
class PatternSearch {
  public:
    PatternSearch(std::span<const std::string> columns, std::string quantity, std::string pattern,
                  const std::string& where)
        : columns_(columns), quantity_(std::move(quantity)), pattern_(std::move(pattern)),
          where_(where + ": --columns " + quantity_ + "=" + shown(pattern_) + ": ") {}

    Places find(std::span<const std::string> joint_names) const {
        const std::size_t star = pattern_.find('*');
        if (star == std::string::npos || pattern_.find('|') != std::string::npos) {
            return listed_columns();
        }
        const std::vector<Match> matches = matches_of(star);
        if (quantity_ == "wrench") {
            return named(matches, output_names(OutputKind::wrench, 0), "wrench component");
        }
        const Names texts = texts_of(matches);
        const auto is_joint = [&](const std::string& text) {
            return std::ranges::find(joint_names, text) != joint_names.end();
        };
        if (std::ranges::any_of(texts, is_joint)) {
            return named(matches, joint_names, "joint of the chain");
        }
        if (std::ranges::all_of(texts,
                                [](const std::string& text) { return whole_number(text).has_value(); })) {
            return numbered(matches);
        }
        if (!joint_names.empty()) {
            throw error("numbers or joints of the chain (" + listed(joint_names) + ") in place of *",
                        listed(texts));
        }
        Places places;
        for (const Match& match : matches) {
            places.push_back(match.column);
        }
        return places;
    }

  private:
    InputError error(const std::string& expected, const std::string& found) const {
        return InputError(where_ + "expected " + expected + ", found " + found);
    }

    std::size_t column_named(const std::string& name) const {
        const auto found = std::ranges::find(columns_, name);
        if (found == columns_.end()) {
            throw error("the column " + in_quotes(name),
                        "none" + suggestion(name, columns_) + "; the header has " + listed(columns_));
        }
        return static_cast<std::size_t>(found - columns_.begin());
    }

    Places listed_columns() const {
        Places places;
        std::size_t begin = 0;
        while (begin <= pattern_.size()) {
            const std::size_t end = std::min(pattern_.find('|', begin), pattern_.size());
            places.push_back(column_named(pattern_.substr(begin, end - begin)));
            begin = end + 1;
        }
        return places;
    }

    std::vector<Match> matches_of(std::size_t star) const {
        const std::string before = pattern_.substr(0, star);
        const std::string after = pattern_.substr(star + 1);
        std::vector<Match> matches;
        for (std::size_t column = 0; column < columns_.size(); ++column) {
            const std::string& name = columns_[column];
            if (name.size() > before.size() + after.size() && name.starts_with(before) &&
                name.ends_with(after)) {
                matches.push_back(
                    {column, name.substr(before.size(), name.size() - before.size() - after.size())});
            }
        }
        if (matches.empty()) {
            throw error("columns that match",
                        "none" + suggestion(pattern_, columns_) + "; the header has " + listed(columns_));
        }
        return matches;
    }

    Places named(const std::vector<Match>& matches, std::span<const std::string> names,
                 const std::string& what) const {
        const Names texts = texts_of(matches);
        Places places;
        for (const std::string& name : names) {
            const auto found = std::ranges::find(texts, name);
            if (found == texts.end()) {
                throw error("a column for each " + what + ", " + listed(names),
                            "none for " + name + suggestion(name, texts));
            }
            places.push_back(matches[static_cast<std::size_t>(found - texts.begin())].column);
        }
        return places;
    }

    Places numbered(std::vector<Match> matches) const {
        std::ranges::sort(matches, {}, [](const Match& match) { return *whole_number(match.text); });
        const std::size_t first = *whole_number(matches.front().text);
        Places places;
        for (const Match& match : matches) {
            const std::size_t number = *whole_number(match.text);
            if (number != first + places.size()) {
                throw error("numbers that follow each other in place of *",
                            match.text + " but no " + std::to_string(first + places.size()));
            }
            places.push_back(match.column);
        }
        return places;
    }

    std::span<const std::string> columns_;
    std::string quantity_, pattern_, where_;
};

/// Returns the names of the columns of a quantity, for `count` columns.
Names names_of(const std::string& quantity, std::size_t count) {
    if (quantity == "t") {
        return {"t"};
    }
    return quantity == "wrench" ? output_names(OutputKind::wrench, 0) : joint_names(quantity, count);
}

/// Returns whether `name` is a column of the quantity by the program's own names: `q` and a number.
bool is_own_name(const std::string& name, const std::string& quantity) {
    const Names own = names_of(quantity, 0);
    return std::ranges::find(own, name) != own.end() ||
           (own.empty() && name.starts_with(quantity) && whole_number(name.substr(quantity.size())));
}

void name_time(Names& roles) {
    if (std::ranges::find(roles, "t") != roles.end()) {
        return;
    }
    for (const char* const name : {"time", "stamp", "timestamp"}) {
        const auto found = std::ranges::find(roles, name);
        if (found != roles.end()) {
            *found = "t";
            return;
        }
    }
}

InputError bad_columns(std::string_view text, const std::string& expected) {
    return InputError("--columns: expected " + expected + ", found " + in_quotes(text));
}

} // namespace

ColumnPatterns parse_column_patterns(std::string_view text) {
    ColumnPatterns patterns;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string_view entry = text.substr(begin, end - begin);
        const std::size_t equals = entry.find('=');
        if (equals == std::string_view::npos || equals + 1 == entry.size()) {
            throw bad_columns(entry, "QUANTITY=PATTERN, such as q=position[*]");
        }
        const std::string quantity(trimmed(entry.substr(0, equals)));
        if (std::ranges::find(quantities, quantity) == quantities.end()) {
            throw bad_columns(quantity, "a quantity, one of " + listed(quantities));
        }
        const std::string_view pattern = trimmed(entry.substr(equals + 1));
        if (std::ranges::count(pattern, '*') > 1) {
            throw bad_columns(pattern, "one * in a pattern");
        }
        if (!patterns.emplace(quantity, pattern).second) {
            throw bad_columns(quantity, "each quantity once");
        }
        begin = end + 1;
    }
    return patterns;
}

std::vector<std::string> column_roles(std::span<const std::string> columns, const ColumnPatterns& patterns,
                                      std::span<const std::string> joint_names, const std::string& where) {
    Names roles(columns.begin(), columns.end());
    for (const auto& [quantity, pattern] : patterns) {
        for (std::string& role : roles) {
            role = is_own_name(role, quantity) ? "" : role;
        }
    }
    std::vector<std::string> quantity_of(columns.size());
    for (const auto& [quantity, pattern] : patterns) {
        const Places places = PatternSearch(columns, quantity, pattern, where).find(joint_names);
        const Names names = names_of(quantity, places.size());
        if (names.size() != places.size()) {
            throw InputError(where + ": --columns " + quantity + "=" + shown(pattern) + ": expected " +
                             std::to_string(names.size()) + " columns, found " +
                             std::to_string(places.size()));
        }
        for (std::size_t k = 0; k < places.size(); ++k) {
            const std::size_t column = places[k];
            if (!quantity_of[column].empty()) {
                throw InputError(where + ": --columns: expected one quantity for each column, found " +
                                 in_quotes(columns[column]) + " for " + quantity_of[column] + " and " +
                                 quantity);
            }
            quantity_of[column] = quantity;
            roles[column] = names[k];
        }
    }
    name_time(roles);
    return roles;
}

} // namespace dfdyn::tools
