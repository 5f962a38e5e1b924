// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_set.hpp"
#include "tools/model/model.hpp"
#include "tools/replay/contacts/contact_list.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace dfdyn::tools {

/// Adds the option --contact-rate. `of`: the option that it belongs to.
void add_contact_rate(CLI::App& command, std::optional<double>& rate_per_hour, const std::string& of);

/// The options of a replay with contact detection.
struct ContactOptions {
    bool chosen = false;
    std::filesystem::path file;          ///< contacts.json; empty: none
    std::optional<double> rate_per_hour; ///< of false contacts

    bool wanted() const { return chosen || !file.empty(); }

    void add_to(CLI::App& command);

    /// Returns the limits of the first model for the chosen rate of false contacts. Throws InputError, naming
    /// `source`, if it has none.
    ContactModel limits(const TrainedModel& model, const std::string& source) const;

    /// Prints the contacts.
    void show(std::span<const RecordedContacts> contacts, std::span<const std::string> outputs) const;
    /// Adds the file of the contacts if one was requested.
    void add_file(std::span<const RecordedContacts> contacts, std::span<const std::string> outputs,
                  FileSet& files) const;
};

} // namespace dfdyn::tools
