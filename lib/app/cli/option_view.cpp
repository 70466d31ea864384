// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/option_view.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "app/cli/print.h"

namespace landfall::cli {
namespace {

constexpr std::size_t kNameWidth = 28;

/// CLI11 appends the checks of an option to its type name: "TEXT:{a,b}", "N:INT in [0 - 9]".
void split_type(const std::string& name, OptionView& view) {
  const std::size_t begin = name.find(":{");
  if (begin == std::string::npos || name.back() != '}') {
    view.type = name.substr(0, name.find(':'));
    return;
  }
  view.values = CLI::detail::split(name.substr(begin + 2, name.size() - begin - 3), ',');
}

std::string needs_text(const CLI::Option& option) {
  std::string text;
  for (const CLI::Option* const needed : option.get_needs())
    text += (text.empty() ? " (needs " : ", ") + needed->get_name();
  return text.empty() ? text : text + ")";
}

std::string wrapped(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::string result;
  std::size_t column = 0;
  for (std::string word; words >> word;) {
    const bool fits = column + 1 + word.size() <= width;
    if (column > 0) result += fits ? ' ' : '\n';
    column = column > 0 && fits ? column + 1 + word.size() : word.size();
    result += word;
  }
  return result;
}

class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat() { column_width(kNameWidth); }

  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    if (is_positional) return option->get_name(true);
    return CLI::detail::join(option_view(*option).names, ",");
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    const OptionView view = option_view(*option);
    std::string text;
    if (!view.type.empty()) text = " " + view.type;
    if (!view.values.empty()) text = " {" + CLI::detail::join(view.values, ",") + "}";
    return view.default_value.empty() ? text : text + " =" + view.default_value;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(option_view(*option).description, page_width() - kNameWidth);
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    return CLI::detail::find_and_replace(text, "\n\n\n", "\n\n");
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), page_width()) + "\n";
  }
};

}  // namespace

OptionView option_view(const CLI::Option& option) {
  OptionView view;
  view.positional = option.get_positional();
  if (view.positional) {
    view.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) view.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) view.names.push_back("--" + name);
  }
  view.takes_value = option.get_type_size() != 0 && option.get_expected_max() != 0;
  if (view.takes_value) {
    split_type(option.get_type_name(), view);
    view.default_value = option.get_default_str();
  }
  view.description = option.get_description() + needs_text(option);
  view.group = option.get_group();
  return view;
}

std::vector<OptionView> options_of(const CLI::App& app) {
  std::vector<OptionView> views;
  for (const std::string& group : app.get_groups())
    for (const CLI::Option* const option : app.get_options())
      if (!group.empty() && option->get_group() == group) views.push_back(option_view(*option));
  return views;
}

void set_help_format(CLI::App& app) { app.formatter(std::make_shared<HelpFormat>()); }

}  // namespace landfall::cli
