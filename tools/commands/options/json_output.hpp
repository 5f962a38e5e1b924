// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <ostream>
#include <streambuf>

namespace dfdyn::tools {

/// Adds the option --json to a command that prints figures.
void add_json_option(CLI::App& command, bool& chosen);

/// Writes what is buffered of standard output. Throws InputError if the system refuses.
void flush_standard_output(std::ostream& output);

/// With --json, keeps text off standard output during the object's lifetime, and prints one JSON object.
class JsonOutput {
  public:
    explicit JsonOutput(bool chosen);
    ~JsonOutput();
    JsonOutput(const JsonOutput&) = delete;
    JsonOutput& operator=(const JsonOutput&) = delete;

    /// Prints `figures` (NaN as null) if --json was chosen. Throws InputError if the system refuses.
    void print(const nlohmann::ordered_json& figures) const;

  private:
    /// Accepts characters and drops them.
    class Sink : public std::streambuf {
      protected:
        int_type overflow(int_type character) override { return traits_type::not_eof(character); }
    };

    Sink sink_;
    std::streambuf* output_; ///< of standard output; null without --json
};

} // namespace dfdyn::tools
