// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/contacts/contact_estimator.hpp"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The contacts of one recording. Its own times are those of the samples' clock plus `origin_s`.
struct RecordedContacts {
    std::string recording;
    double origin_s = 0;
    std::vector<DetectedContact> contacts;
};

/// Prints a line for each contact. `outputs`: names, one per joint.
void print_contacts(std::ostream& out, const RecordedContacts& recorded,
                    std::span<const std::string> outputs);

/// Returns the content of contacts.json (schema dfdyn.contacts/1, docs/guide/contacts.md).
nlohmann::ordered_json contacts_json(std::span<const RecordedContacts> recordings,
                                     std::span<const std::string> outputs);

} // namespace dfdyn::tools
