// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/contact_options.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"

#include <nlohmann/json.hpp>

#include <iostream>

namespace dfdyn::tools {

void add_contact_rate(CLI::App& command, std::optional<double>& rate_per_hour, const std::string& of) {
    command
        .add_option("--contact-rate", rate_per_hour,
                    of + ": false contacts per hour, on motions like those of the training; default: 0.1. A "
                         "higher rate detects smaller contacts, sooner")
        ->check(number_in(0.001, 100))
        ->type_name("PER_HOUR");
}

void ContactOptions::add_to(CLI::App& command) {
    command.add_flag("--contacts", chosen,
                     "Detect contacts from the errors of joint torques or currents, within some 0.1 s "
                     "(docs/guide/contacts.md); not a safety function");
    command.add_option("--contact-list", file, "Write the contacts here; implies --contacts")
        ->type_name("CONTACTS.json");
    add_contact_rate(command, rate_per_hour, "With --contacts");
}

ContactModel ContactOptions::limits(const TrainedModel& model, const std::string& source) const {
    return contact_limits(model, rate_per_hour, source);
}

void ContactOptions::show(std::span<const RecordedContacts> contacts,
                          std::span<const std::string> outputs) const {
    std::size_t count = 0;
    for (const RecordedContacts& recorded : contacts) {
        print_contacts(std::cout, recorded, outputs);
        count += recorded.contacts.size();
    }
    std::cout << "contacts: " << count << '\n';
}

void ContactOptions::add_file(std::span<const RecordedContacts> contacts,
                              std::span<const std::string> outputs, FileSet& files) const {
    if (!file.empty()) {
        files.add(file, json_text(contacts_json(contacts, outputs)) + '\n');
    }
}

} // namespace dfdyn::tools
