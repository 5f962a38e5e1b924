// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/read_bag.hpp"

#include "tools/base/bag/bag.hpp"
#include "tools/base/bag/ros_message.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string>;

/// A message with its time.
template <class Message>
struct Stamped {
    std::int64_t time_ns = 0;
    Message message;
};

/// Messages of a bag from which a recording is made.
struct BagContent {
    std::vector<Stamped<JointStateMessage>> joints;
    std::vector<Stamped<WrenchMessage>> wrenches;
    std::optional<OutputKind> outputs; ///< to read
};

/// Reads the messages of the requested topics, or of the only topic of each type.
class ContentReader {
  public:
    ContentReader(const std::filesystem::path& path, const ReadOptions& options)
        : path_(path), name_(shown(path)), options_(options) {}

    BagContent read() {
        visit_bag(path_, [this](const BagMessage& message) { take(message); });
        const Names unknown = unknown_topics();
        if (!unknown.empty()) {
            throw InputError(name_ + ": --topic: expected topics of the bag, found " +
                             in_quotes(unknown.front()) + suggestion(unknown.front(), all_topics()) +
                             "; the bag has " + listed(described_topics()));
        }
        require_one(joint_state_type);
        content_.outputs = outputs();
        if (content_.outputs == OutputKind::wrench) {
            require_one(wrench_type);
        }
        return std::move(content_);
    }

  private:
    /// Returns the outputs to read: without efforts a wrench, if that is one of the choices.
    std::optional<OutputKind> outputs() const {
        const std::vector<OutputKind>& choices = options_.output_choices;
        if (options_.outputs || choices.empty()) {
            return options_.outputs;
        }
        const bool wrench = std::ranges::find(choices, OutputKind::wrench) != choices.end() &&
                            !content_.wrenches.empty() && content_.joints.front().message.effort.empty();
        return wrench ? OutputKind::wrench : choices.front();
    }

    void take(const BagMessage& message) {
        types_[message.topic.name] = message.topic.type;
        if (!options_.topics.empty() &&
            std::ranges::find(options_.topics, message.topic.name) == options_.topics.end()) {
            return;
        }
        const std::string what = name_ + ": message of " + message.topic.name;
        const auto time = [&](std::int64_t stamp_ns) {
            return stamp_ns != 0 ? stamp_ns : message.log_time_ns;
        };
        if (message.topic.type == joint_state_type) {
            JointStateMessage joints = decode_joint_state(message.bytes, what);
            chosen_[joint_state_type].insert(message.topic.name);
            const std::int64_t time_ns = time(joints.stamp_ns);
            content_.joints.push_back({time_ns, std::move(joints)});
        } else if (message.topic.type == wrench_type) {
            const WrenchMessage wrench = decode_wrench(message.bytes, what);
            chosen_[wrench_type].insert(message.topic.name);
            content_.wrenches.push_back({time(wrench.stamp_ns), wrench});
        }
    }

    Names all_topics() const {
        Names names;
        for (const auto& [topic, type] : types_) {
            names.push_back(topic);
        }
        return names;
    }

    Names described_topics() const {
        Names names;
        for (const auto& [topic, type] : types_) {
            names.push_back(topic + " " + type.substr(type.rfind('/') + 1));
        }
        return names;
    }

    Names unknown_topics() const {
        Names unknown;
        std::ranges::copy_if(options_.topics, std::back_inserter(unknown),
                             [this](const std::string& topic) { return !types_.contains(topic); });
        return unknown;
    }

    void require_one(const char* type) {
        const std::set<std::string>& topics = chosen_[type];
        if (topics.size() != 1) {
            const Names found(topics.begin(), topics.end());
            throw InputError(
                name_ + ": expected one topic of type " + type +
                (topics.size() > 1 ? " (--topic chooses it)" : "") + ", found " +
                (found.empty() ? "none; the bag has " + listed(described_topics()) : listed(found)));
        }
    }

    const std::filesystem::path& path_;
    std::string name_;
    const ReadOptions& options_;
    BagContent content_;
    std::map<std::string, std::string> types_;            ///< of all topics
    std::map<std::string, std::set<std::string>> chosen_; ///< topics of each type
};

/// Makes the rows of a recording from messages.
class BagRecording {
  public:
    BagRecording(const std::filesystem::path& path, const ReadOptions& options)
        : path_(path), name_(shown(path)), options_(options), content_(ContentReader(path, options).read()) {
        recording_.source = path.string();
    }

    Recording make() {
        std::ranges::stable_sort(content_.joints, {}, &Stamped<JointStateMessage>::time_ns);
        std::ranges::stable_sort(content_.wrenches, {}, &Stamped<WrenchMessage>::time_ns);
        choose_joints();
        name_columns();
        std::size_t other_joints = 0;
        std::size_t without_wrench = 0;
        for (const auto& joints : content_.joints) {
            if (!find_places(joints.message)) {
                ++other_joints;
            } else if (!has_output(joints.time_ns)) {
                ++without_wrench;
            } else if (wanted(row_++)) {
                take(joints);
            }
        }
        if (without_wrench > 0) {
            recording_.notes.push_back(
                std::to_string(without_wrench) +
                " joint states before the first or after the last wrench are not used");
        }
        if (other_joints > 0) {
            recording_.notes.push_back(std::to_string(other_joints) + " messages without all of " +
                                       listed(names_) + " are not used");
        }
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

    /// Sets the places of the joints in the message. Returns false if it lacks one of them.
    bool find_places(const JointStateMessage& message) {
        places_.clear();
        for (const std::string& name : names_) {
            const auto found = std::ranges::find(message.names, name);
            if (found == message.names.end()) {
                return false;
            }
            places_.push_back(static_cast<std::size_t>(found - message.names.begin()));
        }
        return true;
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

    bool has_output(std::int64_t time_ns) const {
        return content_.outputs != OutputKind::wrench ||
               (time_ns >= content_.wrenches.front().time_ns && time_ns <= content_.wrenches.back().time_ns);
    }

    /// Appends the wrench at this time, interpolated between two messages. Returns a fault, or "".
    std::string append_wrench(std::int64_t time_ns) {
        const auto after =
            std::ranges::lower_bound(content_.wrenches, time_ns, {}, &Stamped<WrenchMessage>::time_ns);
        const auto before = after->time_ns == time_ns ? after : after - 1;
        const double span = static_cast<double>(after->time_ns - before->time_ns);
        const double share = span > 0 ? static_cast<double>(time_ns - before->time_ns) / span : 0;
        for (std::size_t k = 0; k < 6; ++k) {
            const double from = before->message.wrench[k];
            const double value = from + share * (after->message.wrench[k] - from);
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
    std::size_t row_ = 0;
    bool gap_ = true;
};

} // namespace

Recording read_bag_recording(const std::filesystem::path& path, const ReadOptions& options) {
    return BagRecording(path, options).make();
}

} // namespace dfdyn::tools
