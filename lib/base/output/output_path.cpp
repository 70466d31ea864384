// SPDX-License-Identifier: GPL-3.0-or-later
// Multiple outputs of a run are flushed to the disk before the first is renamed, and then renamed one
// after another, the layers first. They are not undone if a rename in between is refused: an old file that
// was replaced is lost.
#include "base/output/output_path.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/output/byte_sink.h"
#include "base/output/temporary_files.h"
#include "base/text/split_text.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

std::string system_message(int error_number) { return std::generic_category().message(error_number); }

/// Identifies the machine or container in which a process number is valid. Eight hexadecimal digits.
std::string machine() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  std::error_code unknown;
  const fs::path numbers = fs::read_symlink("/proc/self/ns/pid", unknown);
  return Hash().update(std::string_view(host.data())).update(numbers.string()).hex().substr(0, 8);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// The most bytes that the name of a file has in this folder.
std::size_t longest_name(const fs::path& folder) {
  const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);
  return longest > 0 ? static_cast<std::size_t>(longest) : 255;
}

/// ".NAME.", with a hash in place of a NAME with which a name with `more` bytes would be too long.
std::string hidden_name(const fs::path& output, std::size_t more) {
  const std::string name = output.filename().string();
  const bool fits = name.size() + 2 + more <= longest_name(folder_of(output));
  return "." + (fits ? name : Hash().update(name).hex().substr(0, 16)) + ".";
}

/// ".NAME.MACHINE-", the prefix of this machine's temporary files.
std::string part_prefix(const fs::path& output) {
  static const std::string here = machine() + "-";
  constexpr std::size_t kProcessAndSuffix = std::string_view("2147483647.part").size();
  return hidden_name(output, here.size() + kProcessAndSuffix) + here;
}

/// The process number in ".NAME.MACHINE-PID.part", 0 for any other name.
int owner_of_part(const std::string& file, const std::string& prefix) {
  std::string_view number = file;
  if (!number.starts_with(prefix) || !number.ends_with(".part")) return 0;
  number.remove_prefix(prefix.size());
  return exact_number<int>(number.substr(0, number.rfind('.'))).value_or(0);
}

void remove_abandoned_parts(const fs::path& path) {
  const std::string prefix = part_prefix(path);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_of(path), error)) {
    const int pid = owner_of_part(entry.path().filename().string(), prefix);
    if (pid > 0 && ::kill(pid, 0) != 0 && errno == ESRCH) fs::remove(entry.path(), error);
  }
}

void flush_to_disk(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw IoError(file.string() + ": " + system_message(errno));
  const int result = ::fsync(descriptor);
  const int error_number = errno;
  ::close(descriptor);
  if (result != 0)
    throw IoError(file.string() + ": flushing to disk failed: " + system_message(error_number));
}

/// Makes an empty file of this process, so that no process that opens it by name follows a link that another
/// user of the folder has made. What has the name is left from an ended process of this number.
void claim(const fs::path& output, const fs::path& temporary) {
  ::unlink(temporary.c_str());
  const int descriptor =
      ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    forget_temporary_file(temporary.string());
    throw IoError("output " + output.string() + ": cannot be made: " + system_message(errno));
  }
  ::close(descriptor);
}

std::function<void()>& before_naming() {
  static std::function<void()> call;
  return call;
}

}  // namespace

fs::path temporary_of(const fs::path& output) {
  fs::path temporary = output;
  return temporary.replace_filename(part_prefix(output) + std::to_string(::getpid()) + ".part");
}

BeforeNaming::BeforeNaming(std::function<void()> call) { before_naming() = std::move(call); }

BeforeNaming::~BeforeNaming() { before_naming() = nullptr; }

void require_usable_output(const fs::path& path, bool overwrite) {
  std::error_code ignored;
  if (path.empty() || path.filename().empty())
    throw UsageError("output '" + path.string() + "' does not name a file");
  if (fs::is_directory(path, ignored)) throw UsageError("output " + path.string() + " is a directory");
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder, ignored))
    throw UsageError("output " + path.string() + ": directory " + folder.string() + " does not exist");
  if (const std::size_t longest = longest_name(folder); path.filename().string().size() > longest)
    throw UsageError("output " + path.string() + ": its name has more than the " + std::to_string(longest) +
                     " bytes that a file name has there");
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw UsageError("output " + path.string() + " is not a regular file");
  if (!overwrite && fs::exists(fs::symlink_status(path, ignored)))
    throw UsageError("output " + path.string() + " exists; use -O to overwrite it");
}

OutputPath::OutputPath(fs::path path, bool overwrite) : path_(std::move(path)), overwrite_(overwrite) {
  require_usable_output(path_, overwrite_);
  remove_abandoned_parts(path_);
  temporary_ = temporary_of(path_);
  register_temporary_file(temporary_.string());
  claim(path_, temporary_);
}

OutputPath::~OutputPath() {
  if (!committed_) ::unlink(temporary_.c_str());
  forget_temporary_file(temporary_.string());
}

void OutputPath::flush() {
  flush_to_disk(temporary_);
  flushed_ = true;
}

void OutputPath::commit() {
  if (!flushed_) flush();
  ignore_interrupts();
  if (const auto call = std::exchange(before_naming(), nullptr)) call();
  if (overwrite_) {
    struct stat replaced {};  // the new file gets the permissions of the old one
    if (::stat(path_.c_str(), &replaced) == 0)
      static_cast<void>(
          ::chmod(temporary_.c_str(), replaced.st_mode & 0777U));  // some file systems have none
    if (::rename(temporary_.c_str(), path_.c_str()) != 0)
      throw IoError("output " + path_.string() + ": renaming failed: " + system_message(errno));
  } else if (::link(temporary_.c_str(), path_.c_str()) == 0) {  // unlike rename, refuses an existing name
    ::unlink(temporary_.c_str());
  } else if (errno == EEXIST) {
    throw UsageError("output " + path_.string() + " was created during this run; use -O to overwrite it");
  } else if (::rename(temporary_.c_str(), path_.c_str()) != 0) {  // file systems without hard links
    throw IoError("output " + path_.string() + ": renaming failed: " + system_message(errno));
  }
  committed_ = true;
}

void write_text(OutputPath& output, const std::string& text) {
  FileSink file(output);
  file.write(text);
  file.flush();
}

fs::path hidden_beside(const fs::path& output, const std::string& suffix) {
  return output.parent_path() / (hidden_name(output, suffix.size()) + suffix);
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  // For a file that does not exist yet, "x" and "./x" would differ without absolute().
  return fs::weakly_canonical(fs::absolute(a, ignored), ignored) ==
         fs::weakly_canonical(fs::absolute(b, ignored), ignored);
}

}  // namespace landfall
