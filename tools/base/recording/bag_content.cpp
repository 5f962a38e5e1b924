// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/bag_content.hpp"

#include "tools/base/bag/bag.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string>;

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
        std::ranges::stable_sort(content_.joints, {}, &Stamped<JointStateMessage>::time_ns);
        std::ranges::stable_sort(content_.wrenches, {}, &Stamped<WrenchMessage>::time_ns);
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
                            !content_.wrenches.empty() && !has_efforts();
        return wrench ? OutputKind::wrench : choices.front();
    }

    /// Returns whether the first message with the chain's joints has efforts.
    bool has_efforts() const {
        const auto first = std::ranges::find_if(content_.joints, [this](const auto& joints) {
            return has_joints(joints.message, options_.joint_names);
        });
        return first != content_.joints.end() && !first->message.effort.empty();
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

} // namespace

bool has_joints(const JointStateMessage& message, std::span<const std::string> names) {
    return std::ranges::all_of(names, [&message](const std::string& name) {
        return std::ranges::find(message.names, name) != message.names.end();
    });
}

BagContent read_bag_content(const std::filesystem::path& path, const ReadOptions& options) {
    return ContentReader(path, options).read();
}

} // namespace dfdyn::tools
