// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/urdf/urdf_file.hpp"

#include "tools/base/system/line_reader.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <set>
#include <string_view>

namespace dfdyn::tools {

namespace {

/// Collects urdfdom's messages during its lifetime instead of printing them.
class KeptMessages : public console_bridge::OutputHandler {
  public:
    KeptMessages() { console_bridge::useOutputHandler(this); }
    ~KeptMessages() override { console_bridge::restorePreviousOutputHandler(); }
    KeptMessages(const KeptMessages&) = delete;
    KeptMessages& operator=(const KeptMessages&) = delete;

    void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
             int /*line*/) override {
        if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_error_.empty()) {
            first_error_ = text;
        }
    }

    const std::string& first_error() const { return first_error_; }

  private:
    std::string first_error_;
};

std::string content_of(const std::filesystem::path& path) {
    LineReader lines(path);
    std::string content;
    while (const auto line = lines.next()) {
        content.append(*line).append("\n");
    }
    return content;
}

/// Returns text from the file, which may contain any characters, on one line.
std::string one_line(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return text;
}

void parse_xml(const std::string& content, const std::string& file, tinyxml2::XMLDocument& document) {
    if (document.Parse(content.data(), content.size()) != tinyxml2::XML_SUCCESS) {
        const std::size_t begin = content.find_first_not_of(" \t\r\n");
        if (begin == std::string::npos || content[begin] != '<') {
            throw InputError(
                file + ": expected a URDF, which begins with <, found " +
                (begin == std::string::npos
                     ? "an empty file"
                     : in_quotes(one_line(content.substr(begin, content.find('\n', begin) - begin)))));
        }
        throw InputError(file + ":" + std::to_string(std::max(1, document.ErrorLineNum())) +
                         ": expected XML, found a fault that tinyxml2 calls " +
                         tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()));
    }
    if (document.FirstChildElement("robot") == nullptr) {
        throw InputError(file + ": expected a URDF with an element <robot>, found none");
    }
}

urdf::ModelInterfaceSharedPtr parse_model(const std::string& content, const std::string& file) {
    const KeptMessages messages;
    urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(content);
    if (model == nullptr) {
        throw InputError(
            file + ": expected a URDF, found what urdfdom refuses: " + one_line(messages.first_error()));
    }
    return model;
}

/// Rejects a link that is the child of several joints, and loops of links, which urdfdom accepts.
void check_tree(const urdf::ModelInterface& model, const std::string& file) {
    std::set<std::string> children;
    for (const auto& [name, joint] : model.joints_) {
        if (!children.insert(joint->child_link_name).second) {
            throw InputError(file + ": expected a tree, found that link " +
                             in_quotes(joint->child_link_name) + " is the child of joint " + in_quotes(name) +
                             " and of another");
        }
    }
    std::set<std::string> reached;
    std::vector<const urdf::Link*> open{model.getRoot().get()};
    while (!open.empty()) {
        const urdf::Link* const at = open.back();
        open.pop_back();
        reached.insert(at->name);
        for (const urdf::LinkSharedPtr& child : at->child_links) {
            open.push_back(child.get());
        }
    }
    for (const auto& [name, link] : model.links_) {
        if (!reached.contains(name)) {
            throw InputError(file + ": expected a tree, found that link " + in_quotes(name) +
                             " is in a loop, or attached to one");
        }
    }
}

std::string text_of(const tinyxml2::XMLElement* parent, const char* name) {
    const tinyxml2::XMLElement* const element = parent == nullptr ? nullptr : parent->FirstChildElement(name);
    const char* const text = element == nullptr ? nullptr : element->GetText();
    return std::string(trimmed(text == nullptr ? "" : text));
}

bool is_parent_to_child(const std::string& direction, const std::string& where) {
    if (direction == "parent_to_child") {
        return true;
    }
    if (direction.empty() || direction == "child_to_parent") {
        return false;
    }
    throw InputError(where + ": expected measure_direction child_to_parent or parent_to_child, found " +
                     in_quotes(direction));
}

void add_sensor(const tinyxml2::XMLElement& sensor, const char* joint, const std::string& file,
                std::vector<DeclaredSensor>& sensors) {
    const char* const type = sensor.Attribute("type");
    if (joint == nullptr || type == nullptr || std::string_view(type) != "force_torque" ||
        std::ranges::find(sensors, joint, &DeclaredSensor::joint) != sensors.end()) {
        return;
    }
    const tinyxml2::XMLElement* const details = sensor.FirstChildElement("force_torque");
    const std::string where =
        file + ":" + std::to_string(sensor.GetLineNum()) + ": sensor at joint " + in_quotes(joint);
    sensors.push_back(
        {joint, is_parent_to_child(text_of(details, "measure_direction"), where), text_of(details, "frame")});
}

std::vector<DeclaredSensor> declared_sensors(const tinyxml2::XMLElement& robot, const std::string& file) {
    std::vector<DeclaredSensor> sensors;
    for (auto* gazebo = robot.FirstChildElement("gazebo"); gazebo != nullptr;
         gazebo = gazebo->NextSiblingElement("gazebo")) {
        for (auto* sensor = gazebo->FirstChildElement("sensor"); sensor != nullptr;
             sensor = sensor->NextSiblingElement("sensor")) {
            add_sensor(*sensor, gazebo->Attribute("reference"), file, sensors);
        }
    }
    for (auto* sensor = robot.FirstChildElement("sensor"); sensor != nullptr;
         sensor = sensor->NextSiblingElement("sensor")) {
        const tinyxml2::XMLElement* const parent = sensor->FirstChildElement("parent");
        add_sensor(*sensor, parent == nullptr ? nullptr : parent->Attribute("joint"), file, sensors);
    }
    return sensors;
}

} // namespace

UrdfFile read_urdf_file(const std::filesystem::path& path) {
    const std::string file = shown(path);
    const std::string content = content_of(path);
    tinyxml2::XMLDocument document;
    parse_xml(content, file, document);
    UrdfFile result{parse_model(content, file), {}};
    check_tree(*result.model, file);
    result.sensors = declared_sensors(*document.FirstChildElement("robot"), file);
    return result;
}

} // namespace dfdyn::tools
