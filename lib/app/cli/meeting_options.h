// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "store/files/meeting.h"

namespace landfall::cli {

/// Declares --same-frame and --vertical-datum for a tool in which files meet (docs/reference/places.md).
/// `old_name`: an earlier name of --same-frame, which stays.
inline void bind_meeting_options(CLI::App& app, MeetingRules& rules, const std::string& old_name = "") {
  app.add_flag("--same-frame" + (old_name.empty() ? "" : "," + old_name), rules.same_frame,
               "Take files that meet as one frame, whatever their CRSs and centres are");
  app.add_option_function<std::string>(
         "--vertical-datum", [&rules](const std::string&) { rules.vertical_as_is = true; },
         "as-is: compare heights on different or unknown vertical datums as they are")
      ->type_name("as-is")
      ->check(CLI::IsMember({"as-is"}));
}

/// Adds the rules to the options that change the content of an output; none of them adds nothing.
inline void add_meeting_options(nlohmann::json& options, const MeetingRules& rules) {
  if (rules.same_frame) options["same_frame"] = true;
  if (rules.vertical_as_is) options["vertical_datum"] = "as-is";
}

/// The same as words of a command line.
[[nodiscard]] inline std::vector<std::string> meeting_words(const MeetingRules& rules) {
  std::vector<std::string> words;
  if (rules.same_frame) words.emplace_back("--same-frame");
  if (rules.vertical_as_is) words.insert(words.end(), {"--vertical-datum", "as-is"});
  return words;
}

}  // namespace landfall::cli
