// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutation.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>

namespace landfall::fuzz {
namespace {

/// The text between the quotes of a line.
std::string unquoted(const std::string& line) {
  const std::size_t begin = line.find('"');
  const std::size_t end = line.rfind('"');
  if (begin == end) throw std::runtime_error("no dictionary line: " + line);
  std::string word;
  for (std::size_t i = begin + 1; i < end; ++i) {
    if (line[i] != '\\') {
      word += line[i];
    } else if (line[i + 1] == 'x') {
      word += static_cast<char>(std::stoi(line.substr(i + 2, 2), nullptr, 16));
      i += 3;
    } else {
      word += line[++i];
    }
  }
  return word;
}

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; }

}  // namespace

std::vector<std::string> read_dictionary(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::vector<std::string> words;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && line.front() != '#') words.push_back(unquoted(line));
  return words;
}

Mutator::Mutator(const std::vector<std::string>& inputs, std::vector<std::string> words, std::uint64_t seed)
    : inputs_(inputs), words_(std::move(words)), engine_(seed) {
  if (words_.empty()) words_.emplace_back(1, '\0');
}

std::string Mutator::next() {
  std::string input = inputs_[below(inputs_.size())];
  for (std::size_t n = 1 + below(8); n > 0; --n) change(input);
  if (input.size() > kLongest) input.resize(kLongest);
  return input;
}

std::string Mutator::part_of(const std::string& input) {
  if (input.empty()) return {};
  const std::size_t begin = below(input.size());
  return input.substr(begin, 1 + below(std::min<std::size_t>(64, input.size() - begin)));
}

/// In between, or over what is there.
void Mutator::put(std::string& input, const std::string& part) {
  const std::size_t at = below(input.size() + 1);
  input.replace(at, below(2) == 0 ? 0 : std::min(part.size(), input.size() - at), part);
}

void Mutator::replace_number(std::string& input) {
  static const std::array<std::string, 16> kNumbers = {
      "0",      "-1",         "1",          "0.5", "1e-9", "1e9",   "1e300", "-1e300",
      "1e-320", "2147483647", "4294967296", "nan", "inf",  "1e999", "-0",    "9007199254740993"};
  const auto begin = std::find_if(input.begin() + static_cast<std::ptrdiff_t>(below(input.size() + 1)),
                                  input.end(), is_of_number);
  const auto end = std::find_if_not(begin, input.end(), is_of_number);
  input.replace(begin, end, kNumbers[below(kNumbers.size())]);
}

void Mutator::change(std::string& input) {
  if (input.empty()) return put(input, words_[below(words_.size())]);
  const std::size_t at = below(input.size());
  switch (below(8)) {
    case 0:
      input[at] = static_cast<char>(static_cast<unsigned char>(input[at]) ^ (1U << below(8)));
      break;
    case 1:
      input[at] = static_cast<char>(below(256));
      break;
    case 2:
      input.erase(at, 1 + below(std::min<std::size_t>(32, input.size() - at)));
      break;
    case 3:
      put(input, part_of(input));
      break;
    case 4:
      put(input, part_of(inputs_[below(inputs_.size())]));
      break;
    case 5:
      replace_number(input);
      break;
    default:
      put(input, words_[below(words_.size())]);
  }
}

}  // namespace landfall::fuzz
