// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace landfall::cli {

/// An option as help, man page and completion show it.
struct OptionView {
  std::vector<std::string> names;  ///< "-c", "--config"; of a positional its name
  bool positional = false;
  bool takes_value = false;
  std::string type;                 ///< "FILE", "N"; empty for flags and where `values` are the only ones
  std::vector<std::string> values;  ///< the only ones allowed
  std::string default_value;
  std::string description;  ///< with what it needs
  std::string group;
};

[[nodiscard]] OptionView option_view(const CLI::Option& option);

/// All that help shows, in the order of their groups and declarations.
[[nodiscard]] std::vector<OptionView> options_of(const CLI::App& app);

/// Makes --help wrap its lines at 100 columns, and show each option's values and default in short.
void set_help_format(CLI::App& app);

}  // namespace landfall::cli
