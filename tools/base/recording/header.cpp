// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/header.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <system_error>
#include <unordered_map>

namespace dfdyn::tools {
namespace {

using Names = std::vector<std::string>;

std::string column_label(const Names& columns, std::size_t index) {
    return columns[index].empty() ? "column " + std::to_string(index + 1) + " (unnamed)" : columns[index];
}

Names labels(const Names& columns) {
    Names out;
    for (std::size_t index = 0; index < columns.size(); ++index) {
        out.push_back(column_label(columns, index));
    }
    return out;
}

void require_text(std::string_view line, const std::string& where) {
    const auto is_control = [](char character) {
        const auto byte = static_cast<unsigned char>(character);
        return (byte < 0x20 && byte != '\t') || byte == 0x7f;
    };
    if (std::any_of(line.begin(), line.end(), is_control)) {
        throw InputError(where + ": expected a header of column names, found no text: " + in_quotes(line));
    }
}

/// Returns a name from the header, without the double quotes that some programs write around names.
std::string plain_name(std::string_view field, const std::string& where) {
    std::string_view name = trimmed(field);
    if (name.size() >= 2 && name.starts_with('"') && name.ends_with('"')) {
        name = trimmed(name.substr(1, name.size() - 2));
    }
    if (name.find('"') != std::string_view::npos) {
        throw InputError(where + ": expected a column name, found " + in_quotes(field) +
                         " (a quoted name may hold no comma and no quote)");
    }
    return std::string(name);
}

Names split(std::string_view line, const std::string& where) {
    Names columns;
    std::size_t begin = 0;
    while (begin <= line.size()) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        columns.push_back(plain_name(line.substr(begin, end - begin), where));
        begin = end + 1;
    }
    return columns;
}

void require_commas(const Names& columns, const std::string& where) {
    if (columns.size() > 1) {
        return;
    }
    for (const std::string_view separator : {";", "\t", " "}) {
        if (columns.front().find(separator) != std::string::npos) {
            throw InputError(where + ": expected column names separated by commas, found " +
                             in_quotes(separator) + " between them");
        }
    }
}

/// Returns the index of each named column. Unnamed columns are left out: programs write them for an index, or
/// after a comma at the end.
std::unordered_map<std::string, std::size_t> index_columns(const Names& columns, const std::string& where) {
    std::unordered_map<std::string, std::size_t> index;
    for (std::size_t column = 0; column < columns.size(); ++column) {
        if (!columns[column].empty() && !index.emplace(columns[column], column).second) {
            throw InputError(where + ": expected each column once, found " + in_quotes(columns[column]) +
                             " twice");
        }
    }
    return index;
}

/// Returns K if `name` is `qK`.
std::optional<std::size_t> joint_number(const std::string& name) {
    std::size_t number = 0;
    const char* const end = name.data() + name.size();
    if (!name.starts_with('q') || (name.starts_with("q0") && name != "q0")) {
        return std::nullopt;
    }
    const auto [stop, fault] = std::from_chars(name.data() + 1, end, number);
    return stop == end && fault == std::errc{} ? std::optional(number) : std::nullopt;
}

/// Returns N if the joint positions are q1..qN; 0 if there are none.
std::size_t count_joints(const Names& columns, const std::string& where) {
    std::set<std::size_t> numbers;
    for (const std::string& name : columns) {
        if (const auto number = joint_number(name)) {
            numbers.insert(*number);
        }
    }
    std::size_t expected = 1;
    for (const std::size_t number : numbers) {
        if (number != expected) {
            throw InputError(where + ": expected joint positions q1, q2, ... without a hole, found q" +
                             std::to_string(number) +
                             (number == 0 ? "" : " but no q" + std::to_string(expected)));
        }
        ++expected;
    }
    return numbers.size();
}

class Builder {
  public:
    Builder(Header& header, std::string where, std::unordered_map<std::string, std::size_t> index)
        : header_(header), where_(std::move(where)), index_(std::move(index)) {}

    /// Assigns the next places to the columns `names`, in their order.
    Names place(Names names) {
        for (const std::string& name : names) {
            header_.slot[index_.at(name)] = next_++;
        }
        return names;
    }

    /// Assigns places if the header has any of the columns; it must then have all of them.
    Names place_if_any(Names names) {
        const auto has = [this](const std::string& name) { return index_.contains(name); };
        if (std::none_of(names.begin(), names.end(), has)) {
            return {};
        }
        require(names);
        return place(std::move(names));
    }

    void require(const Names& names) const {
        Names missing;
        std::copy_if(names.begin(), names.end(), std::back_inserter(missing),
                     [this](const std::string& name) { return !index_.contains(name); });
        if (!missing.empty()) {
            throw InputError(where_ + ": expected columns " + listed(names) + ", found no " +
                             listed(missing) + "; the header has " + listed(labels(header_.columns)));
        }
    }

  private:
    Header& header_;
    std::string where_;
    std::unordered_map<std::string, std::size_t> index_;
    std::size_t next_ = 0;
};

Names needed_columns(std::size_t joint_count, const ReadOptions& options) {
    Names needed = joint_names("q", joint_count);
    needed.insert(needed.begin(), "t");
    if (options.outputs) {
        const Names outputs = output_names(*options.outputs, joint_count);
        needed.insert(needed.end(), outputs.begin(), outputs.end());
    }
    return needed;
}

void require_chain(std::size_t joint_count, const std::string& where, const ReadOptions& options) {
    if (options.joint_count != 0 && joint_count > options.joint_count) {
        throw InputError(where + ": expected " + std::to_string(options.joint_count) +
                         " joint positions, as the chain has joints, found " + std::to_string(joint_count));
    }
}

} // namespace

std::vector<std::string> Header::ignored_columns() const {
    Names ignored;
    for (std::size_t column = 0; column < columns.size(); ++column) {
        if (!slot[column]) {
            ignored.push_back(column_label(columns, column));
        }
    }
    return ignored;
}

Header parse_header(std::string_view line, const std::string& where, const ReadOptions& options) {
    require_text(line, where);
    Header header;
    header.columns = split(line, where);
    header.slot.resize(header.columns.size());
    require_commas(header.columns, where);
    Builder builder(header, where, index_columns(header.columns, where));
    const std::size_t found = count_joints(header.columns, where);
    require_chain(found, where, options);
    const std::size_t joint_count = std::max({found, options.joint_count, std::size_t{1}});
    builder.require(needed_columns(joint_count, options));
    builder.place({"t"});
    header.position = builder.place(joint_names("q", joint_count));
    if (options.velocity) {
        header.velocity = builder.place_if_any(joint_names("qd", joint_count));
    }
    if (options.acceleration) {
        header.acceleration = builder.place_if_any(joint_names("qdd", joint_count));
    }
    if (options.outputs) {
        header.output = builder.place(output_names(*options.outputs, joint_count));
    }
    return header;
}

} // namespace dfdyn::tools
