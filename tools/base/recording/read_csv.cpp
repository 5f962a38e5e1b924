// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/header.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/line_reader.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cmath>
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
        : path_(path), options_(options), lines_(path) {}

    Recording read() {
        read_header();
        read_rows();
        require_rows();
        return std::move(recording_);
    }

  private:
    std::string where(std::size_t line_number) const {
        return shown(path_) + ":" + std::to_string(line_number);
    }

    void read_header() {
        const auto line = lines_.next();
        if (!line) {
            throw InputError(shown(path_) + ": expected a header of column names, found an empty file");
        }
        header_ = parse_header(*line, where(1), options_);
        values_.resize(header_.value_count());
        recording_.source = path_.string();
        recording_.position.names = header_.position;
        recording_.velocity.names = header_.velocity;
        recording_.acceleration.names = header_.acceleration;
        recording_.output.names = header_.output;
        recording_.ignored_columns = header_.ignored_columns();
    }

    void read_rows() {
        std::size_t empty_lines = 0; // delayed, because empty lines at the end of the file are no rows
        while (!options_.rows.last || row_ < *options_.rows.last) {
            const auto line = lines_.next();
            if (!line) {
                break;
            }
            if (trimmed(*line).empty()) {
                ++empty_lines;
                continue;
            }
            for (; empty_lines > 0; --empty_lines) {
                take_row({}, lines_.line_number() - empty_lines);
            }
            take_row(*line, lines_.line_number());
        }
    }

    void take_row(std::string_view line, std::size_t line_number) {
        const std::size_t row = row_++;
        if (row < options_.rows.first || (options_.rows.last && row >= *options_.rows.last)) {
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
        if (auto fault = check_field_count(line)) {
            return fault;
        }
        std::size_t begin = 0;
        for (std::size_t column = 0; column < header_.columns.size(); ++column) {
            const std::size_t end = std::min(line.find(',', begin), line.size());
            if (header_.slot[column]) {
                if (auto fault = parse_field(line.substr(begin, end - begin), column)) {
                    return fault;
                }
            }
            begin = end + 1;
        }
        return check_time();
    }

    std::optional<RowFault> check_field_count(std::string_view line) const {
        const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
        if (commas + 1 == header_.columns.size()) {
            return std::nullopt;
        }
        const std::string found = line.empty() ? "an empty line" : std::to_string(commas + 1);
        return RowFault{&SkippedRows::ragged,
                        "expected " + std::to_string(header_.columns.size()) + " fields, found " + found};
    }

    std::optional<RowFault> parse_field(std::string_view field, std::size_t column) {
        const std::string_view text = trimmed(field);
        const ParsedNumber number = parse_number(text);
        if (number.fault == NumberFault::none) {
            values_[*header_.slot[column]] = number.value;
            return std::nullopt;
        }
        const bool range = number.fault == NumberFault::out_of_range;
        return RowFault{range ? &SkippedRows::out_of_range : &SkippedRows::not_a_number,
                        "column " + header_.columns[column] + ": expected a " +
                            (range ? "finite number in the range of a double" : "number") + ", found " +
                            (text.empty() ? "an empty field" : in_quotes(text))};
    }

    std::optional<RowFault> check_time() {
        constexpr double longest_s = 9.2e9; // int64 nanoseconds end at 9.223e9 s
        const double time_s = values_[0];
        if (std::abs(time_s) > longest_s) {
            return RowFault{&SkippedRows::out_of_range,
                            "column t: expected a time within 9.2e9 s of 0, found " + number_text(time_s) +
                                " (nanoseconds? divide by 1e9)"};
        }
        time_ns_ = std::llround(time_s * 1e9);
        if (recording_.row_count() > 0 && time_ns_ <= recording_.time_ns.back()) {
            return RowFault{&SkippedRows::time_not_increasing,
                            "column t: expected a time after that of the row before, " +
                                number_text(recording_.time_s.back()) + ", found " + number_text(time_s)};
        }
        return std::nullopt;
    }

    void keep_row() {
        recording_.time_s.push_back(values_[0]);
        recording_.time_ns.push_back(time_ns_);
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
            throw InputError(shown(path_) + ": expected rows below the header, found none");
        }
        if (row_ < needed) {
            throw InputError(shown(path_) + ": --rows: expected at least " + std::to_string(needed) +
                             " rows in the recording, found " + std::to_string(row_));
        }
        if (recording_.row_count() == 0) {
            throw InputError(shown(path_) +
                             ": expected a usable row, found none: " + describe(recording_.skipped));
        }
    }

    const std::filesystem::path& path_;
    const ReadOptions& options_;
    LineReader lines_;
    Header header_;
    Recording recording_;
    std::vector<double> values_; ///< of the current row, in the places of the header
    std::int64_t time_ns_ = 0;   ///< of the current row
    std::size_t row_ = 0;        ///< rows so far, including bad and unwanted ones
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
    }
    return recordings;
}

} // namespace dfdyn::tools
