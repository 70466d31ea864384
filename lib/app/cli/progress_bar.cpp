// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/progress_bar.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace landfall::cli {
namespace {

constexpr int kWidth = 30;

std::string seconds_text(double seconds) {
  std::array<char, 32> text{};
  if (seconds < 99.95) {
    std::snprintf(text.data(), text.size(), "%.1f s", seconds);
  } else {
    const auto whole = std::lround(seconds);
    std::snprintf(text.data(), text.size(), "%ld min %02ld s", whole / 60, whole % 60);
  }
  return text.data();
}

}  // namespace

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

ProgressBar::ProgressBar(std::string phase) : phase_(std::move(phase)), start_s_(wall_seconds()) {
  draw(0, "");
}

ProgressBar::~ProgressBar() { std::fputs("\r\x1b[K", stderr); }

void ProgressBar::update(double fraction) {
  const double now = wall_seconds();
  if (now - drawn_s_ < 0.1) return;
  drawn_s_ = now;
  const double elapsed = now - start_s_;
  std::string tail =
      fraction > 0.01 && elapsed > 0.5 ? "ETA " + seconds_text(elapsed * (1 - fraction) / fraction) : "";
  if (!note_.empty()) tail += (tail.empty() ? "" : "  ") + note_;
  draw(fraction, tail);
}

void ProgressBar::finish() {
  draw(1, seconds_text(wall_seconds() - start_s_) + (note_.empty() ? "" : "  " + note_));
  std::fputs("\n", stderr);
}

void ProgressBar::draw(double fraction, const std::string& tail) const {
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '.');
  std::fprintf(stderr, "\r\x1b[K%-10s [%s] %3d %%  %s", phase_.c_str(), bar.c_str(),
               static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0)), tail.c_str());
  std::fflush(stderr);
}

}  // namespace landfall::cli
