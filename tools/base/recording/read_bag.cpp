// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/read_bag.hpp"

#include "tools/base/bag/bag.hpp"
#include "tools/base/recording/bag_content.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string>;

/// A longer step between two wrenches, in usual steps of the slower topic, is a gap.
constexpr double longest_wrench_step = 3;

/// Share of a sensor's steps up to the usual one. A sensor that sends in bursts of up to fifty wrenches has
/// short steps within them, and one long step from each burst to the next.
constexpr double usual_wrench_share = 0.98;

/// Returns the time (ns) between messages with different stamps that this share of the times does not exceed;
/// NaN if all stamps are equal.
template <class Message>
double message_step_ns(const std::vector<Stamped<Message>>& messages, double share) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < messages.size(); ++k) {
        if (messages[k].time_ns > messages[k - 1].time_ns) {
            steps.push_back(static_cast<double>(messages[k].time_ns - messages[k - 1].time_ns));
        }
    }
    if (steps.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::ranges::sort(steps);
    return steps[static_cast<std::size_t>(share * static_cast<double>(steps.size() - 1))];
}

/// Makes the rows of a recording from messages.
class BagRecording {
  public:
    BagRecording(const std::filesystem::path& path, const ReadOptions& options)
        : path_(path), name_(shown(path)), options_(options), content_(read_bag_content(path, options)) {
        recording_.source = path.string();
    }

    Recording make() {
        choose_joints();
        const std::size_t other_joints = drop_other_joints();
        name_columns();
        if (content_.outputs == OutputKind::wrench) {
            longest_wrench_step_ns_ =
                longest_wrench_step * std::max(message_step_ns(content_.wrenches, usual_wrench_share),
                                               message_step_ns(content_.joints, 0.5));
        }
        for (const auto& joints : content_.joints) {
            find_places(joints.message);
            if (has_output(joints.time_ns) && wanted(row_++)) {
                take(joints);
            }
        }
        note("joint states before the first or after the last wrench", outside_wrenches_);
        note("joint states between wrenches more than " + rounded_text(longest_wrench_step_ns_ / 1e6) +
                 " ms apart",
             in_wrench_gaps_);
        note("messages without all of " + listed(names_), other_joints);
        require_rows();
        return std::move(recording_);
    }

  private:
    void choose_joints() {
        names_ = options_.joint_names;
        Names known;
        for (const auto& joints : content_.joints) {
            for (const std::string& name : joints.message.names) {
                if (std::ranges::find(known, name) == known.end()) {
                    known.push_back(name);
                }
            }
        }
        if (names_.empty()) {
            names_ = content_.joints.front().message.names;
            recording_.notes.push_back("joints in the order of the bag: " + listed(names_) +
                                       " (--robot and --tip choose another order)");
        }
        for (const std::string& name : names_) {
            if (std::ranges::find(known, name) == known.end()) {
                throw InputError(name_ + ": expected the joints of the chain, " + listed(names_) +
                                 ", found no " + name + suggestion(name, known) + "; the bag has " +
                                 listed(known));
            }
        }
        if (names_.empty() || (options_.joint_count != 0 && names_.size() != options_.joint_count)) {
            throw InputError(name_ + ": expected " +
                             std::to_string(std::max<std::size_t>(options_.joint_count, 1)) +
                             " joints, found " + std::to_string(names_.size()) + ": " + listed(names_));
        }
    }

    /// Removes the messages of other publishers, such as a gripper's. Returns their number.
    std::size_t drop_other_joints() {
        const std::size_t dropped = std::erase_if(
            content_.joints, [this](const auto& joints) { return !has_joints(joints.message, names_); });
        if (content_.joints.empty()) {
            throw InputError(name_ + ": expected messages with all of " + listed(names_) + ", found none");
        }
        return dropped;
    }

    void note(const std::string& what, std::size_t count) {
        if (count > 0) {
            recording_.notes.push_back(std::to_string(count) + " " + what + " are not used");
        }
    }

    void name_columns() {
        const std::size_t count = names_.size();
        const JointStateMessage& first = content_.joints.front().message;
        recording_.position.names = joint_names("q", count);
        if (options_.velocity && !first.velocity.empty()) {
            recording_.velocity.names = joint_names("qd", count);
        }
        if (content_.outputs) {
            recording_.output.names = output_names(*content_.outputs, count);
        }
    }

    /// Sets the places of the joints in the message, which has all of them.
    void find_places(const JointStateMessage& message) {
        places_.clear();
        for (const std::string& name : names_) {
            const auto found = std::ranges::find(message.names, name);
            places_.push_back(static_cast<std::size_t>(found - message.names.begin()));
        }
    }

    bool wanted(std::size_t row) const { return options_.rows.has(row); }

    /// Appends values of the message in the order of the joints. Returns a fault, or "".
    std::string append(Columns& columns, const std::vector<double>& values, const std::string& quantity,
                       const char* field) {
        if (values.empty()) {
            return std::string("expected ") + field + " of each joint, found none";
        }
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const double value = values[places_[k]];
            if (!std::isfinite(value)) {
                return std::string(field) + " of " + names_[k] + ": expected a finite number, found " +
                       number_text(value);
            }
            columns.values.push_back(value * unit_factor(options_.units, quantity, k, places_.size()));
        }
        return "";
    }

    /// Returns false, and counts it, for a time without a wrench to interpolate.
    bool has_output(std::int64_t time_ns) {
        if (content_.outputs != OutputKind::wrench) {
            return true;
        }
        if (time_ns < content_.wrenches.front().time_ns || time_ns > content_.wrenches.back().time_ns) {
            ++outside_wrenches_;
            return false;
        }
        if (wrenches_around(time_ns).span_ns() > longest_wrench_step_ns_) {
            ++in_wrench_gaps_;
            gap_ = true;
            return false;
        }
        return true;
    }

    /// Two wrenches, or one twice.
    struct WrenchPair {
        const Stamped<WrenchMessage>& before;
        const Stamped<WrenchMessage>& after;

        double span_ns() const { return static_cast<double>(after.time_ns - before.time_ns); }
    };

    /// Returns the wrench at `time_ns`, or the last one before and the first one after it. Both exist.
    WrenchPair wrenches_around(std::int64_t time_ns) const {
        const auto after =
            std::ranges::lower_bound(content_.wrenches, time_ns, {}, &Stamped<WrenchMessage>::time_ns);
        return {*(after->time_ns == time_ns ? after : after - 1), *after};
    }

    /// Appends the wrench at this time, interpolated between two messages. Returns a fault, or "".
    std::string append_wrench(std::int64_t time_ns) {
        const WrenchPair wrenches = wrenches_around(time_ns);
        const double span = wrenches.span_ns();
        const double share = span > 0 ? static_cast<double>(time_ns - wrenches.before.time_ns) / span : 0;
        for (std::size_t k = 0; k < 6; ++k) {
            const double from = wrenches.before.message.wrench[k];
            const double value = from + share * (wrenches.after.message.wrench[k] - from);
            if (!std::isfinite(value)) {
                return "wrench: expected finite numbers, found " + number_text(value);
            }
            recording_.output.values.push_back(value * unit_factor(options_.units, "wrench", k, 6));
        }
        return "";
    }

    std::string append_values(const Stamped<JointStateMessage>& joints) {
        const JointStateMessage& message = joints.message;
        std::string fault = append(recording_.position, message.position, "q", "position");
        if (fault.empty() && recording_.velocity.present()) {
            fault = append(recording_.velocity, message.velocity, "qd", "velocity");
        }
        if (fault.empty() && content_.outputs == OutputKind::wrench) {
            fault = append_wrench(joints.time_ns);
        } else if (fault.empty() && content_.outputs) {
            fault = append(recording_.output, message.effort,
                           *content_.outputs == OutputKind::joint_torque ? "tau" : "i", "effort");
        }
        return fault;
    }

    void take(const Stamped<JointStateMessage>& joints) {
        const std::array<std::size_t, 3> sizes{recording_.position.values.size(),
                                               recording_.velocity.values.size(),
                                               recording_.output.values.size()};
        const bool increasing = recording_.row_count() == 0 || joints.time_ns > recording_.time_ns.back();
        const std::string fault =
            increasing
                ? append_values(joints)
                : "expected a time after that of the message before, found the same time" + bags_note();
        if (fault.empty()) {
            recording_.time_ns.push_back(joints.time_ns);
            recording_.time_s.push_back(static_cast<double>(joints.time_ns) / 1e9);
            recording_.gap_before.push_back(std::exchange(gap_, false) ? 1 : 0);
            return;
        }
        if (!options_.skip_bad_rows) {
            throw InputError(name_ + ": row " + std::to_string(row_ - 1) + ": " + fault);
        }
        recording_.position.values.resize(sizes[0]);
        recording_.velocity.values.resize(sizes[1]);
        recording_.output.values.resize(sizes[2]);
        ++(increasing ? recording_.skipped.not_a_number : recording_.skipped.time_not_increasing);
        gap_ = true;
    }

    /// Returns a note that several bags are read as one recording; empty for a single file.
    std::string bags_note() const {
        Names files;
        for (const std::filesystem::path& file : bag_files(path_)) {
            files.push_back(file.filename().string());
        }
        return files.size() < 2 ? "" : " (the bags of this folder are one recording: " + listed(files) + ")";
    }

    void require_rows() const {
        const std::size_t needed = options_.rows.last.value_or(options_.rows.first + 1);
        if (row_ < needed) {
            throw InputError(name_ + ": --rows: expected at least " + std::to_string(needed) +
                             " rows in the recording, found " + std::to_string(row_));
        }
        if (recording_.row_count() == 0) {
            throw InputError(name_ + ": expected a usable row, found none: " + describe(recording_.skipped));
        }
    }

    std::filesystem::path path_;
    std::string name_;
    const ReadOptions& options_;
    BagContent content_;
    Recording recording_;
    Names names_;                     ///< of the joints, in the order of the chain
    std::vector<std::size_t> places_; ///< of the joints in the current message
    double longest_wrench_step_ns_ = 0;
    std::size_t outside_wrenches_ = 0; ///< joint states before the first or after the last wrench
    std::size_t in_wrench_gaps_ = 0;   ///< joint states
    std::size_t row_ = 0;
    bool gap_ = true;
};

} // namespace

Recording read_bag_recording(const std::filesystem::path& path, const ReadOptions& options) {
    return BagRecording(path, options).make();
}

} // namespace dfdyn::tools
