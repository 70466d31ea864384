// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads lines "SCHEMA CONFIGURATION" and writes a line for each: the resolved configuration, or "! " and the
/// message.
#include <iostream>
#include <string>

#include "base/core/error.h"
#include "store/config/schema.h"

namespace {

std::string answer(const std::string& schema, const std::string& text) {
  try {
    const landfall::JsonSource source{"c", nlohmann::json::parse(text)};
    return landfall::resolve_config(source, landfall::embedded_schema(schema)).dump();
  } catch (const landfall::UsageError& error) {
    return std::string("! ") + error.what();
  }
}

}  // namespace

int main() {
  std::string line;
  while (std::getline(std::cin, line)) {
    const std::size_t blank = line.find(' ');
    std::cout << answer(line.substr(0, blank), line.substr(blank + 1)) << '\n';
  }
}
