// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace landfall::fuzz {

/// The words of a dictionary as libFuzzer has them: a text in quotes per line, with \\, \" and \xAB; lines
/// that begin with # are skipped. Throws std::runtime_error for another line.
[[nodiscard]] std::vector<std::string> read_dictionary(const std::filesystem::path& path);

/// Makes inputs of inputs: flips, replaces, inserts, repeats and removes bytes, puts in words of the
/// dictionary, other numbers, and parts of other inputs; one to eight of these at a time. The same seed gives
/// the same inputs everywhere.
class Mutator {
 public:
  /// `inputs` must outlive this and not be empty.
  Mutator(const std::vector<std::string>& inputs, std::vector<std::string> words, std::uint64_t seed);

  /// The next input, of at most kLongest bytes.
  [[nodiscard]] std::string next();
  static constexpr std::size_t kLongest = 4096;

 private:
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  void change(std::string& input);
  void put(std::string& input, const std::string& part);
  void replace_number(std::string& input);
  [[nodiscard]] std::string part_of(const std::string& input);

  const std::vector<std::string>& inputs_;
  std::vector<std::string> words_;
  std::mt19937_64 engine_;  // its numbers are fixed by the standard
};

}  // namespace landfall::fuzz
