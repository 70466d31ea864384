// SPDX-License-Identifier: GPL-3.0-or-later
// A closed pipe is a success (exit 0): the reader does not need the rest, and `pipefail` scripts continue.
//
// Texts on a closed pipe (`landfall-info`, `--help`, `--print-config`) end the tool by SIGPIPE, like any
// other program; only for the data of `landfall-export -o -` is there a reason to read a part.
#include "base/output/byte_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

#include "base/core/error.h"

namespace landfall {
namespace {

/// Returns 0 or the system's error number.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

FileSink::FileSink(OutputPath& output)
    : output_(output),
      descriptor_(::open(output_.temporary().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC,
                         S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH)) {
  if (descriptor_ < 0) fail("cannot be made");
}

FileSink::~FileSink() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void FileSink::fail(const char* what) const {
  throw IoError("output " + output_.path().string() + ": " + what + ": " +
                std::generic_category().message(errno));
}

void FileSink::write(std::string_view bytes) {
  const int error = write_all(descriptor_, bytes);
  if (error == 0) return;
  errno = error;
  fail("writing failed");
}

void FileSink::flush() {
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail("closing failed");
  output_.flush();
}

void FileSink::finish() {
  if (descriptor_ >= 0) flush();
  output_.commit();
}

StandardOutputSink::StandardOutputSink() { std::signal(SIGPIPE, SIG_IGN); }

void StandardOutputSink::write(std::string_view bytes) {
  const int error = write_all(STDOUT_FILENO, bytes);
  if (error == EPIPE) throw ClosedPipe();
  if (error != 0)
    throw IoError("writing to standard output failed: " + std::generic_category().message(error));
}

}  // namespace landfall
