// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/contact_options.hpp"

#include "tools/base/text/error.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"

#include <nlohmann/json.hpp>

#include <iostream>

namespace dfdyn::tools {

void ContactOptions::add_to(CLI::App& command) {
    command.add_flag("--contacts", chosen,
                     "Detect contacts from the errors of joint torques or currents, within some 0.1 s "
                     "(docs/guide/contacts.md); not a safety function");
    command.add_option("--contact-list", file, "Likewise, and write the contacts here")
        ->type_name("CONTACTS.json");
    command
        .add_option(
            "--contact-rate", rate_per_hour,
            "Of --contacts: false contacts per hour, on motions like those of the training; default: 0.1. A "
            "higher rate detects smaller contacts, sooner")
        ->check(number_in(0.001, 100))
        ->type_name("PER_HOUR");
}

ContactModel ContactOptions::limits(const TrainedModel& model, const std::string& source) const {
    if (model.contact.limit.empty()) {
        throw InputError(source + ": contact detection: expected a model with limits of contacts (field " +
                         "contact, which `dfdyn train` writes for --outputs tau and i), found none");
    }
    if (!rate_per_hour) {
        return model.contact;
    }
    if (model.contact.rate_slope == 0) {
        throw InputError(source + ": --contact-rate: expected a model with field contact.rate_slope, which " +
                         "`dfdyn train` writes, found a model of an older version");
    }
    return contact_at_rate(model.contact, *rate_per_hour);
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
        files.add(file, contacts_json(contacts, outputs).dump(2) + '\n');
    }
}

} // namespace dfdyn::tools
