// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_list.hpp"

#include "tools/base/text/number.hpp"
#include "tools/monitor/recorded_time.hpp"

#include <nlohmann/json.hpp>

#include <ostream>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

const std::string& output_of(const DetectedContact& contact, std::span<const std::string> outputs) {
    return outputs[static_cast<std::size_t>(contact.joint)];
}

ordered_json contact_json(const RecordedContacts& recorded, const DetectedContact& contact,
                          std::span<const std::string> outputs) {
    ordered_json result{{"start", recorded_time_s(recorded.origin_s, contact.start_ns)},
                        {"end", nullptr},
                        {"joint", contact.joint + 1},
                        {"output", output_of(contact, outputs)},
                        {"peak", contact.peak},
                        {"persistent", contact.persistent}};
    if (contact.end_ns != 0) {
        result["end"] = recorded_time_s(recorded.origin_s, contact.end_ns);
    }
    return result;
}

} // namespace

void print_contacts(std::ostream& out, const RecordedContacts& recorded,
                    std::span<const std::string> outputs) {
    for (const DetectedContact& contact : recorded.contacts) {
        out << recorded.recording << ": contact at joint " << contact.joint + 1 << " from "
            << formatted("%.2f", recorded_time_s(recorded.origin_s, contact.start_ns));
        if (contact.end_ns != 0) {
            out << " to " << formatted("%.2f", recorded_time_s(recorded.origin_s, contact.end_ns));
        }
        out << " s, " << output_of(contact, outputs) << " deviates by " << rounded_text(contact.peak)
            << (contact.persistent ? "; it did not end: a change of the arm" : "") << '\n';
    }
}

ordered_json contacts_json(std::span<const RecordedContacts> recordings,
                           std::span<const std::string> outputs) {
    ordered_json list = ordered_json::array();
    for (const RecordedContacts& recorded : recordings) {
        ordered_json contacts = ordered_json::array();
        for (const DetectedContact& contact : recorded.contacts) {
            contacts.push_back(contact_json(recorded, contact, outputs));
        }
        list.push_back({{"recording", recorded.recording}, {"contacts", contacts}});
    }
    return {{"schema", "dfdyn.contacts/1"}, {"recordings", list}};
}

} // namespace dfdyn::tools
