// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace landfall::cli {

/// An option as shown in help, man page and completion.
struct OptionView {
  std::vector<std::string> names;  ///< "-c", "--config"; for a positional argument, its name
  bool positional = false;
  bool takes_value = false;
  std::string type;                 ///< "FILE", "N"; empty for flags and for options with `values`
  std::vector<std::string> values;  ///< the only values allowed
  std::string default_value;
  std::string description;  ///< including the options that it needs
  std::string group;
};

[[nodiscard]] OptionView option_view(const CLI::Option& option);

/// All options that help shows, in the order of their groups and declarations.
[[nodiscard]] std::vector<OptionView> options_of(const CLI::App& app);

/// Makes --help wrap its lines at 100 columns, and print each option's values and default in short form.
void set_help_format(CLI::App& app);

}  // namespace landfall::cli
