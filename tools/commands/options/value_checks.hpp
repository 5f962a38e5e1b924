// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Checks of an option's value, for `check` and `transform` of CLI11. A refused value gives the message
/// `--option: expected WHAT, found "VALUE"`. NaN and infinity are no numbers here.

/// Accepts numbers from `least` to `most`.
CLI::Validator number_in(double least, double most);

/// Accepts finite numbers above 0.
CLI::Validator positive_number();

/// Accepts finite numbers from 0.
CLI::Validator number_from_zero();

/// Accepts finite numbers.
CLI::Validator finite_number();

/// Accepts whole numbers from `least` to `most`.
CLI::Validator whole_number_in(std::int64_t least, std::int64_t most);

/// Accepts whole numbers from 0 to 2^64 − 1.
CLI::Validator seed_number();

/// Returns the names of a list that commas separate.
std::vector<std::string> words_of(const std::string& list);

/// Accepts one of `names`; suggests the nearest one otherwise.
CLI::Validator one_of(std::vector<std::string> names);

/// Accepts a number of bytes from 1, plain or followed by K or M (also KB, KiB, MB, MiB); replaces it by
/// the number of bytes.
CLI::Validator byte_count();

} // namespace dfdyn::tools
