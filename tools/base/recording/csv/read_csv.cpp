// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/bag.hpp"
#include "tools/base/recording/csv/csv_line.hpp"
#include "tools/base/recording/csv/header.hpp"
#include "tools/base/recording/read_bag.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/system/line_reader.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {
namespace {

/// Reason to reject a row: its counter, and the message after `FILE:LINE: `.
struct RowFault {
    std::size_t SkippedRows::*counter;
    std::string message;
};

class Reader {
  public:
    Reader(const std::filesystem::path& path, const ReadOptions& options)
        : name_(shown_input(path)), options_(options), lines_(path) {
        recording_.source = path == "-" ? name_ : path.string();
    }

    Recording read() {
        read_header();
        read_rows();
        require_rows();
        return std::move(recording_);
    }

  private:
    std::string where(std::size_t line_number) const { return name_ + ":" + std::to_string(line_number); }

    /// Reads the header, and the first row if the header is the comment before it.
    void read_header() {
        std::optional<std::string> comment;
        std::size_t comment_number = 0;
        std::optional<std::string> first;
        while (const auto line = lines_.next()) {
            if (!is_comment(*line)) {
                first = std::string(*line);
                break;
            }
            comment = std::string(trimmed(*line).substr(1));
            comment_number = lines_.line_number();
        }
        if (!first && !comment) {
            throw InputError(name_ + ": expected a header of column names, found an empty file");
        }
        if (comment && (!first || is_row_under(*comment, *first))) {
            header_ = parse_header(*comment, where(comment_number), options_);
            first_row_ = first;
        } else {
            header_ = parse_header(*first, where(lines_.line_number()), options_);
        }
        values_.resize(header_.value_count());
        recording_.position.names = header_.position;
        recording_.velocity.names = header_.velocity;
        recording_.acceleration.names = header_.acceleration;
        recording_.output.names = header_.output;
        recording_.ignored_columns = header_.ignored_columns();
    }

    /// Returns whether `line` has only numbers, as many as `header` has fields.
    static bool is_row_under(std::string_view header, std::string_view line) {
        std::vector<std::string_view> names;
        std::vector<std::string_view> fields;
        split_fields(header, separator_of(header), names);
        split_fields(line, separator_of(header), fields);
        std::string buffer;
        const auto is_number = [&](std::string_view field) {
            return tools::parse_field(field, separator_of(header), buffer).fault != NumberFault::not_a_number;
        };
        return names.size() == fields.size() && std::ranges::all_of(fields, is_number);
    }

    std::optional<std::string_view> next_row() {
        if (first_row_) {
            row_text_ = std::exchange(first_row_, std::nullopt).value();
            return row_text_;
        }
        return lines_.next();
    }

    void read_rows() {
        std::vector<std::size_t>
            empty_lines; // delayed, because empty lines at the end of the file are no rows
        while (!options_.rows.last || row_ < *options_.rows.last) {
            const auto line = next_row();
            if (!line) {
                break;
            }
            if (is_comment(*line)) {
                continue;
            }
            if (trimmed(*line).empty()) {
                empty_lines.push_back(lines_.line_number());
                continue;
            }
            for (const std::size_t empty_line : std::exchange(empty_lines, {})) {
                take_row({}, empty_line);
            }
            take_row(*line, lines_.line_number());
        }
    }

    void take_row(std::string_view line, std::size_t line_number) {
        const std::size_t row = row_++;
        if (!options_.rows.has(row)) {
            return;
        }
        if (const auto fault = parse_row(line)) {
            refuse(*fault, line_number);
        } else {
            keep_row();
        }
    }

    void refuse(const RowFault& fault, std::size_t line_number) {
        if (!options_.skip_bad_rows) {
            throw InputError(where(line_number) + ": " + fault.message);
        }
        ++(recording_.skipped.*fault.counter);
        gap_ = true;
    }

    std::optional<RowFault> parse_row(std::string_view line) {
        split_fields(line, header_.separator, fields_);
        if (fields_.size() != header_.columns.size()) {
            const std::string found = line.empty() ? "an empty line" : std::to_string(fields_.size());
            return RowFault{&SkippedRows::ragged,
                            "expected " + std::to_string(header_.columns.size()) + " fields, found " + found};
        }
        for (std::size_t column = 0; column < fields_.size(); ++column) {
            if (header_.slot[column]) {
                if (auto fault = parse_field(fields_[column], column)) {
                    return fault;
                }
            }
        }
        return check_time();
    }

    std::optional<RowFault> parse_field(std::string_view text, std::size_t column) {
        const std::size_t slot = *header_.slot[column];
        const ParsedNumber number = tools::parse_field(text, header_.separator, point_text_);
        if (number.fault == NumberFault::none) {
            values_[slot] = number.value * header_.factor[slot];
            time_text_ = slot == 0 ? text : time_text_;
            return std::nullopt;
        }
        const bool range = number.fault == NumberFault::out_of_range;
        return RowFault{range ? &SkippedRows::out_of_range : &SkippedRows::not_a_number,
                        "column " + header_.columns[column] + ": expected a " +
                            (range ? "finite number in the range of a double" : "number") + ", found " +
                            (text.empty() ? "an empty field" : in_quotes(text))};
    }

    std::optional<RowFault> check_time() {
        if (time_unit_s_ == 0) {
            set_time_unit();
        }
        const auto time = time_value(values_[0], time_text_, time_unit_s_);
        const std::string column = "column " + header_.time_column();
        if (!time) {
            return RowFault{&SkippedRows::out_of_range,
                            column + ": expected a time within 9.2e9 s of 0, found " +
                                number_text(values_[0]) + " (--units t=ns if they are nanoseconds)"};
        }
        if (recording_.row_count() > 0 && time->nanoseconds <= recording_.time_ns.back()) {
            return RowFault{&SkippedRows::time_not_increasing,
                            column + ": expected a time after that of the row before, " +
                                number_text(recording_.time_s.back()) + ", found " +
                                number_text(time->seconds)};
        }
        time_ = *time;
        return std::nullopt;
    }

    /// Sets the unit of the times: as given, or from the first time.
    void set_time_unit() {
        if (options_.units.contains("t")) {
            time_unit_s_ = unit_factor(options_.units, "t", 0, 1);
            return;
        }
        time_unit_s_ = likely_time_unit(values_[0]);
        if (time_unit_s_ < 1) {
            recording_.notes.push_back("column " + header_.time_column() +
                                       ": times from 1970 on, in units of " + number_text(time_unit_s_) +
                                       " s (--units t=s keeps them)");
        }
    }

    void keep_row() {
        recording_.time_s.push_back(time_.seconds);
        recording_.time_ns.push_back(time_.nanoseconds);
        recording_.gap_before.push_back(std::exchange(gap_, false) ? 1 : 0);
        std::size_t place = 1;
        for (Columns* const columns :
             {&recording_.position, &recording_.velocity, &recording_.acceleration, &recording_.output}) {
            const auto from = values_.begin() + static_cast<std::ptrdiff_t>(place);
            columns->values.insert(columns->values.end(), from,
                                   from + static_cast<std::ptrdiff_t>(columns->names.size()));
            place += columns->names.size();
        }
    }

    void require_rows() const {
        const std::size_t needed = options_.rows.last.value_or(options_.rows.first + 1);
        if (row_ == 0) {
            throw InputError(name_ + ": expected rows below the header, found none");
        }
        if (row_ < needed) {
            throw InputError(name_ + ": --rows: expected at least " + std::to_string(needed) +
                             " rows in the recording, found " + std::to_string(row_));
        }
        if (recording_.row_count() == 0) {
            throw InputError(name_ + ": expected a usable row, found none: " + describe(recording_.skipped));
        }
    }

    std::string name_; ///< of the file, for messages
    const ReadOptions& options_;
    LineReader lines_;
    Header header_;
    Recording recording_;
    std::vector<double> values_;           ///< of the current row, in the places of the header
    std::vector<std::string_view> fields_; ///< of the current row
    std::string_view time_text_;           ///< of the current row
    std::string point_text_;               ///< a number with a decimal point for a comma
    TimeValue time_;                       ///< of the current row
    double time_unit_s_ = 0;               ///< 0: not known yet
    std::optional<std::string> first_row_; ///< already read, under a header in a comment
    std::string row_text_;                 ///< of that row
    std::size_t row_ = 0;                  ///< rows so far, including bad and unwanted ones
    bool gap_ = true;
};

void require_same(const Columns& first, const Columns& other, const Recording& a, const Recording& b) {
    if (first.names != other.names) {
        const auto have = [](const Columns& columns) {
            return columns.present() ? listed(columns.names) : "none";
        };
        throw InputError(shown(b.source) + ": expected the columns of " + shown(a.source) + ", " +
                         have(first) + ", found " + have(other));
    }
}

} // namespace

Recording read_recording(const std::filesystem::path& path, const ReadOptions& options) {
    if (is_bag(path)) {
        if (!options.columns.empty()) {
            throw InputError(shown(path) +
                             ": --columns: expected a CSV recording, found a ROS 2 bag (--topic)");
        }
        Recording recording = read_bag_recording(path, options);
        require_joint_count(recording.joint_count(), shown(path));
        return recording;
    }
    if (!options.topics.empty()) {
        throw InputError(shown_input(path) +
                         ": --topic: expected a ROS 2 bag, MCAP or SQLite, found another file");
    }
    return Reader(path, options).read();
}

std::vector<Recording> read_recordings(std::span<const std::filesystem::path> paths,
                                       const ReadOptions& options) {
    std::vector<Recording> recordings;
    for (const std::filesystem::path& path : paths) {
        recordings.push_back(read_recording(path, options));
        const Recording& first = recordings.front();
        const Recording& last = recordings.back();
        require_same(first.position, last.position, first, last);
        require_same(first.velocity, last.velocity, first, last);
        require_same(first.acceleration, last.acceleration, first, last);
        if (first.output.present() && last.output.present()) {
            require_same(first.output, last.output, first, last);
        }
    }
    return recordings;
}

} // namespace dfdyn::tools
