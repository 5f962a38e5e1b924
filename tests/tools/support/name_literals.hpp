// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/read_file.hpp"

#include "tests/tools/support/project.hpp"

#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

/// Where the product's sources have the names of a catalogue as string literals.
namespace dfdyn::tests {

inline bool is_word_character(char character) {
    return std::isalnum(static_cast<unsigned char>(character)) != 0 || character == '_';
}

/// The texts of the string literals in a C++ file; none of those in its comments.
inline std::vector<std::string> string_literals(const std::string& code) {
    std::vector<std::string> literals;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code.compare(i, 2, "//") == 0) {
            i = code.find('\n', i);
        } else if (code[i] == '\'' && !is_word_character(code[i - 1])) { // not in 1'000
            i = code.find('\'', code[i + 1] == '\\' ? i + 3 : i + 1);
        } else if (code[i] == '"') {
            std::string text;
            for (++i; i < code.size() && code[i] != '"'; ++i) {
                text += code[i] == '\\' ? code[++i] : code[i];
            }
            literals.push_back(text);
        }
        if (i == std::string::npos) {
            break;
        }
    }
    return literals;
}

/// A name of several words anywhere; one of a single word, which messages need, too, only alone.
inline bool has_name(const std::string& literal, const std::string& name) {
    if (name.find('_') == std::string::npos) {
        return literal == name;
    }
    for (std::size_t at = literal.find(name); at != std::string::npos; at = literal.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if ((at == 0 || !is_word_character(literal[at - 1])) &&
            (end == literal.size() || !is_word_character(literal[end]))) {
            return true;
        }
    }
    return false;
}

/// Files of the product in which a literal has one of the names: path from the project's folder, names.
inline std::map<std::string, std::set<std::string>> files_with_names(const std::set<std::string>& names) {
    std::map<std::string, std::set<std::string>> files;
    for (const char* const folder : {"tools", "hal", "firmware_lib/include"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(project / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".cpp" && extension != ".hpp") {
                continue;
            }
            for (const std::string& literal : string_literals(tools::read_file(entry.path()))) {
                for (const std::string& name : names) {
                    if (has_name(literal, name)) {
                        files[std::filesystem::relative(entry.path(), project).generic_string()].insert(name);
                    }
                }
            }
        }
    }
    return files;
}

} // namespace dfdyn::tests
