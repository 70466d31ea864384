// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/run_log.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/core/error.h"
#include "base/text/shown_text.h"

namespace landfall::cli {
namespace {

constexpr const char* kFirstLine = "# landfall log";

}  // namespace

void RunLog::open(const std::string& path) {
  std::error_code missing;
  const bool is_new = !std::filesystem::exists(path, missing);
  if (!is_new) {
    std::string first;
    if (!std::filesystem::is_regular_file(path, missing) || !std::getline(std::ifstream(path), first) ||
        first != kFirstLine)
      throw UsageError("--log " + path + ": exists and is not a log of landfall; name another file");
  }
  file_.open(path, std::ios::app);
  if (!file_)
    throw UsageError("--log " + path + ": cannot be written: " + std::generic_category().message(errno));
  if (is_new) write(kFirstLine);
}

void RunLog::write(const std::string& line) {
  if (file_.is_open()) file_ << shown_text(line) << std::endl;  // flushed, because a run may be killed
}

}  // namespace landfall::cli
