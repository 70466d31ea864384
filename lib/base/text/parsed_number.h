// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace landfall {

/// Parses a number from text.
struct ParsedNumber {
  enum class Outcome { number, not_a_number, too_large };
  Outcome outcome = Outcome::not_a_number;
  double value = 0;
};

namespace parsing {

/// Whether a decimal number that no double can hold is too small rather than too large: by the power of ten
/// of its first digit other than 0.
inline bool is_too_small(std::string_view text) {
  constexpr std::int64_t kFar = std::int64_t{1} << 62U;
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view digits = text.substr(0, e);
  const std::size_t first = digits.find_first_of("123456789");
  if (first == std::string_view::npos) return true;
  std::string_view power = text.substr(std::min(e + 1, text.size()));
  if (power.substr(0, 1) == "+") power.remove_prefix(1);
  std::int64_t exponent = 0;
  const auto error = std::from_chars(power.data(), power.data() + power.size(), exponent).ec;
  if (error == std::errc::result_out_of_range) return power.front() == '-';
  const auto dot = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  return std::clamp(exponent, -kFar, kFar) + dot - static_cast<std::int64_t>(first) < 0;
}

}  // namespace parsing

/// The double that is nearest to a decimal text without blanks: 1, -1.5, +1.0e0, .5, 1.0D+00 (Fortran), nan,
/// inf. A number too small for a double, such as 1e-400, is 0.
inline ParsedNumber parsed_number(std::string_view text) {
  using enum ParsedNumber::Outcome;
  std::string in_c;
  if (text.find_first_of("dD") != std::string_view::npos) {  // the exponent of Fortran's double precision
    in_c = text;
    std::ranges::replace(in_c, 'd', 'e');
    std::ranges::replace(in_c, 'D', 'e');
    text = in_c;
  }
  if (text.substr(0, 1) == "+" && text.substr(1, 1) != "-") text.remove_prefix(1);
  ParsedNumber parsed;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, parsed.value);
  if (stop != end || text.empty() || error == std::errc::invalid_argument) return {};
  if (error == std::errc()) return {number, parsed.value};
  return parsing::is_too_small(text) ? ParsedNumber{number, text.front() == '-' ? -0.0 : 0.0}
                                     : ParsedNumber{too_large, 0};
}

}  // namespace landfall
