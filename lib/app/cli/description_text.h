// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// The result of describe_file() as aligned lines of text. On a terminal, lines of text are shortened to its
/// columns; in a file or a pipe nothing is cut. Tables have at most 80 columns.
/// Throws FormatError if metrics or plan of the file are incomplete.
[[nodiscard]] std::string description_text(const nlohmann::ordered_json& description);

/// The complete configuration of the result of describe_file(), JSON that the tool's -c reads. Throws
/// FormatError if the file has none.
[[nodiscard]] std::string config_text(const nlohmann::ordered_json& description);

}  // namespace landfall::cli
