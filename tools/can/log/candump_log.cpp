// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/candump_log.hpp"

#include "dfdyn/hal/candump.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <iostream>
#include <utility>

namespace dfdyn::tools {
namespace {

std::string found_text(std::string_view found) {
    return found.empty() ? "the end of the line" : in_quotes(found);
}

} // namespace

CandumpLog::CandumpLog(const std::filesystem::path& path, std::string interface)
    : path_(path), interface_(std::move(interface)), is_only_one_(interface_.empty()), lines_(path) {}

bool CandumpLog::next(hal::ReplayEntry& entry) noexcept {
    entry = {};
    try {
        return fault_ == nullptr && read(entry);
    } catch (...) {
        fault_ = std::current_exception();
        return false;
    }
}

void CandumpLog::check() const {
    if (fault_ != nullptr) {
        std::rethrow_exception(fault_);
    }
}

bool CandumpLog::read(hal::ReplayEntry& entry) {
    using Kind = hal::CandumpLine::Kind;
    while (const auto text = lines_.next()) {
        const hal::CandumpLine line = hal::parse_candump_line(*text);
        if (line.kind == Kind::malformed) {
            const std::string fault = place() + ":" + std::to_string(line.column) + ": expected " +
                                      std::string(hal::expected(line.fault)) + ", found " +
                                      found_text(line.found);
            if (lines_.terminated()) {
                throw InputError(fault);
            }
            torn_line_ = fault + "; the last line is torn and left out";
            return false;
        }
        if (line.kind == Kind::nothing || !is_chosen(line.interface)) {
            continue;
        }
        entry.dropped_before += line.dropped;
        if (line.kind == Kind::frame) {
            entry.frame = line.frame;
            return true;
        }
    }
    return false;
}

bool CandumpLog::is_chosen(std::string_view interface) {
    if (is_only_one_ && interface_.empty()) {
        interface_ = interface;
    }
    if (is_only_one_ && interface != interface_) {
        throw InputError(place() + ": expected frames of one interface, or one of them to be chosen, found " +
                         in_quotes(interface) + " after " + in_quotes(interface_));
    }
    return interface == interface_;
}

std::string CandumpLog::place() const { return shown(path_) + ":" + std::to_string(lines_.line_number()); }

void warn_of_torn_line(const CandumpLog& log) {
    if (!log.torn_line().empty()) {
        std::cerr << "warning: " << log.torn_line() << '\n';
    }
}

} // namespace dfdyn::tools
