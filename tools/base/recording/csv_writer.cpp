// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv_writer.hpp"

#include "tools/base/text/number.hpp"

#include <stdexcept>

namespace dfdyn::tools {

CsvWriter::CsvWriter(std::ostream& out, std::span<const std::string> columns)
    : out_(out), column_count_(columns.size()) {
    for (const std::string& column : columns) {
        name(column);
    }
    end_row();
}

CsvWriter& CsvWriter::field(double value) {
    append(number_text(value));
    return *this;
}

CsvWriter& CsvWriter::fields(std::span<const double> values) {
    for (const double value : values) {
        field(value);
    }
    return *this;
}

CsvWriter& CsvWriter::name(std::string_view text) {
    if (text.empty() || text.find_first_of(",\"\r\n") != std::string_view::npos) {
        throw std::logic_error("a CSV name must not be empty, nor hold a comma, a quote or a line end");
    }
    append(text);
    return *this;
}

void CsvWriter::end_row() {
    if (field_count_ != column_count_) {
        throw std::logic_error("a CSV row must have one field per column");
    }
    out_ << '\n';
    field_count_ = 0;
}

void CsvWriter::append(std::string_view text) {
    if (field_count_++ > 0) {
        out_ << ',';
    }
    out_ << text;
}

} // namespace dfdyn::tools
