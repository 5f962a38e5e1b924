// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv/header.hpp"

#include "tools/base/recording/csv/csv_line.hpp"
#include "tools/base/recording/csv/header_line.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <system_error>
#include <unordered_map>

namespace dfdyn::tools {
namespace {

using Names = std::vector<std::string>;

constexpr std::array<OutputKind, 3> output_kinds{OutputKind::joint_torque, OutputKind::motor_current,
                                                 OutputKind::wrench};

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
/// `assigned`: --columns names columns.
std::size_t count_joints(const Names& columns, const std::string& where, bool assigned) {
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
                             (number == 0 && !assigned ? from_zero(columns)
                              : number == 0            ? ""
                                                       : " but no q" + std::to_string(expected)) +
                             (assigned ? ", as --columns assigns them" : ""));
        }
        ++expected;
    }
    return numbers.size();
}

std::string without_number(const std::string& name) {
    return name.substr(0, name.find_last_not_of("0123456789") + 1);
}

/// Returns whether a column of this name is no misspelling: it is a quantity that the program knows, or
/// (taur1) the torque of the controller's own model.
bool has_own_meaning(const std::string& name) {
    const Names wrench = output_names(OutputKind::wrench, 1);
    const Names numbered{"q", "qd", "qdd", "tau", "taur", "i"};
    const std::string quantity = without_number(name);
    return name == "t" || std::ranges::find(wrench, name) != wrench.end() ||
           (quantity != name && std::ranges::find(numbered, quantity) != numbered.end());
}

/// Returns the quantity of outputs of this kind in `--units` and `--outputs`.
std::string quantity_of(OutputKind kind) {
    switch (kind) {
    case OutputKind::joint_torque:
        return "tau";
    case OutputKind::motor_current:
        return "i";
    case OutputKind::wrench:
        return "wrench";
    }
    return "";
}

class Builder {
  public:
    /// `roles`: the program's names of the columns, which --columns may have changed.
    Builder(Header& header, const Names& roles, std::string where)
        : header_(header), roles_(roles), where_(std::move(where)), index_(index_columns(roles, where_)) {}

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
            const std::string assigned = assigned_elsewhere(missing);
            throw MissingColumns(where_ + ": expected columns " + listed(names) + ", found no " +
                                 listed(missing) + other_outputs(missing) + nearest(missing, names) +
                                 "; the header has " + listed(labels(header_.columns)) +
                                 (assigned.empty() ? " (--columns assigns columns to quantities)"
                                                   : "; --columns has assigned " + assigned));
        }
    }

  private:
    /// Returns `q1 to i1` for the first of the names that the header has, but as another quantity.
    std::string assigned_elsewhere(const Names& missing) const {
        for (const std::string& name : missing) {
            const auto column = std::ranges::find(header_.columns, name);
            if (column != header_.columns.end()) {
                const std::string& role = roles_[static_cast<std::size_t>(column - header_.columns.begin())];
                return name + " to " + (role.empty() ? "nothing" : role);
            }
        }
        return "";
    }

    /// Returns `, but those of --outputs i` if torques are missing and the header has motor currents, or the
    /// like for other outputs.
    std::string other_outputs(const Names& missing) const {
        const auto has = [this](const std::string& name) { return index_.contains(name); };
        for (const OutputKind wanted : output_kinds) {
            const auto count = std::ranges::count(missing, quantity_of(wanted), without_number);
            const Names all =
                output_names(wanted, static_cast<std::size_t>(std::max<std::ptrdiff_t>(count, 1)));
            if (std::search(missing.begin(), missing.end(), all.begin(), all.end()) == missing.end()) {
                continue;
            }
            for (const OutputKind other : output_kinds) {
                if (std::ranges::all_of(output_names(other, all.size()), has)) {
                    return ", but those of --outputs " + quantity_of(other);
                }
            }
        }
        return "";
    }

    /// Returns the column that is `name` with a unit after it, as `t [s]`, or else the nearest one.
    static std::optional<std::string> column_like(const std::string& name, const Names& unused) {
        const auto has_unit = [&](const std::string& column) {
            const std::size_t bracket = column.find_first_of("[(");
            return bracket != std::string::npos &&
                   trimmed(std::string_view(column).substr(0, bracket)) == name;
        };
        const auto found = std::ranges::find_if(unused, has_unit);
        return found != unused.end() ? *found : nearest_name(name, unused);
    }

    /// Returns ` (did you mean "Q1" for q1: --columns q=Q*?)` for the first missing name of each quantity
    /// with a close one in the header.
    std::string nearest(const Names& missing, const Names& names) const {
        Names unused;
        for (std::size_t column = 0; column < header_.columns.size(); ++column) {
            const std::string& name = header_.columns[column];
            if (!header_.slot[column] && !has_own_meaning(name) &&
                std::ranges::find(names, name) == names.end()) {
                unused.push_back(name);
            }
        }
        std::map<std::string, std::string> patterns; // by quantity
        std::string pairs;
        for (const std::string& name : missing) {
            const auto found = column_like(name, unused);
            if (found && patterns.emplace(without_number(name), pattern_of(*found, name)).second) {
                pairs += (pairs.empty() ? "" : ", ") + in_quotes(*found) + " for " + name;
            }
        }
        std::string columns;
        for (const auto& [quantity, pattern] : patterns) {
            if (std::ranges::count(missing, quantity, without_number) ==
                std::ranges::count(names, quantity, without_number)) { // else a single column is misspelt
                columns += (columns.empty() ? "" : ",") + quantity + "=" + listed(Names{pattern});
            }
        }
        if (columns.find(' ') != std::string::npos) {
            columns = '"' + columns + '"'; // for the shell
        }
        columns = (columns.empty() ? "" : ": --columns ") + columns;
        return pairs.empty() ? "" : " (did you mean " + pairs + columns + "?)";
    }

    /// Returns the pattern of the columns like `column`, which may be meant for `name`: `Q*` for Q1 and q1.
    static std::string pattern_of(const std::string& column, const std::string& name) {
        const std::string number = name.substr(without_number(name).size());
        const std::size_t at = number.empty() ? std::string::npos : column.rfind(number);
        return at == std::string::npos ? column : std::string(column).replace(at, number.size(), "*");
    }

    Header& header_;
    const Names& roles_;
    std::string where_;
    std::unordered_map<std::string, std::size_t> index_;
    std::size_t next_ = 0;
};

/// Returns the outputs to read of a header whose columns have these roles.
std::optional<OutputKind> chosen_outputs(const Names& roles, std::size_t joint_count,
                                         const ReadOptions& options) {
    if (options.outputs || options.output_choices.empty()) {
        return options.outputs;
    }
    const auto has = [&](const std::string& name) { return std::ranges::find(roles, name) != roles.end(); };
    const auto found = std::ranges::find_if(options.output_choices, [&](OutputKind kind) {
        return std::ranges::all_of(output_names(kind, joint_count), has);
    });
    return found == options.output_choices.end() ? options.output_choices.front() : *found;
}

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

void set_factors(Header& header, const ReadOptions& options) {
    header.factor = {1}; // the time has its unit from the first row, or from the options
    const auto append = [&](const Names& names, const std::string& quantity) {
        for (std::size_t k = 0; k < names.size(); ++k) {
            header.factor.push_back(unit_factor(options.units, quantity, k, names.size()));
        }
    };
    append(header.position, "q");
    append(header.velocity, "qd");
    append(header.acceleration, "qdd");
    append(header.output, options.outputs ? quantity_of(*options.outputs) : "");
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

const std::string& Header::time_column() const {
    return columns[static_cast<std::size_t>(std::ranges::find(slot, std::optional<std::size_t>(0)) -
                                            slot.begin())];
}

void require_joint_count(std::size_t joint_count, const std::string& where) {
    if (joint_count > largest_recorded_joint_count) {
        throw InputError(where + ": expected at most " + std::to_string(largest_recorded_joint_count) +
                         " joints, found " + std::to_string(joint_count));
    }
}

Header parse_header(std::string_view line, const std::string& where, ReadOptions options) {
    Header header;
    header.separator = separator_of(line);
    header.columns = header_names(line, header.separator, where);
    header.slot.resize(header.columns.size());
    index_columns(header.columns, where);
    const Names roles = column_roles(header.columns, options.columns, options.joint_names, where);
    Builder builder(header, roles, where);
    const std::size_t found = count_joints(roles, where, !options.columns.empty());
    require_chain(found, where, options);
    require_joint_count(found, where);
    const std::size_t joint_count = std::max({found, options.joint_count, std::size_t{1}});
    options.outputs = chosen_outputs(roles, joint_count, options);
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
    set_factors(header, options);
    return header;
}

} // namespace dfdyn::tools
