// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/contact_options.hpp"

#include "tools/base/text/error.hpp"

#include <nlohmann/json.hpp>

#include <iostream>

namespace dfdyn::tools {

void ContactOptions::add_to(CLI::App& command) {
    command.add_flag("--contacts", chosen,
                     "Detect contacts from the errors of joint torques or currents, within some 0.1 s "
                     "(docs/guide/contacts.md); not a safety function");
    command.add_option("--contact-list", file, "Likewise, and write the contacts here")
        ->type_name("CONTACTS.json");
}

const ContactModel& ContactOptions::limits(const TrainedModel& model, const std::string& source) {
    if (model.contact.limit.empty()) {
        throw InputError(source + ": contact detection: expected a model with limits of contacts (field " +
                         "contact, which `dfdyn train` writes for --outputs tau and i), found none");
    }
    return model.contact;
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
