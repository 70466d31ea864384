// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace landfall {

/// A value that stands for "no data" although nothing declares it.
struct Fill {
  double raw = 0;    ///< as the file stores it
  double value = 0;  ///< scale raw + offset
  std::int64_t count = 0;
};

/// The number of values that are fills.
[[nodiscard]] std::int64_t count_of(const std::vector<Fill>& fills);
/// "-9999,-32768", as nodata takes them.
[[nodiscard]] std::string nodata_text(const std::vector<Fill>& fills);
/// "-9999 or -32768, which look like undeclared fill values".
[[nodiscard]] std::string suspicion_text(const std::vector<Fill>& fills);

/// Searches a stream of values for undeclared fill values:
/// - numbers that producers use for "no data" (-32768, -32767, -9999, -99999, 9999, 1e6, extremes of the
///   types and the like) and that are isolated from the rest: farther from it than a tenth of its range, or
///   at its end, more than a thousandth of its range off and more than 1 % of the values;
/// - raw numbers beyond 1e12;
/// - any value that is repeated exactly, lies at an end of the rest, and is farther from it than the rest's
///   range, where the rest has at least 16 distinct values. Up to two such values at each end are set aside
///   together, repeated or not.
///
/// The result is exact and does not depend on the order of the values. Some nanoseconds per value; memory for
/// a few dozen.
class FillSearch {
 public:
  /// Values are scale raw + offset; those of `is_integer` numbers have steps of `scale`.
  struct Stored {
    double scale = 1;
    double offset = 0;
    bool is_integer = false;
  };
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    [[nodiscard]] bool empty() const { return low > high; }
  };
  /// The fill values, and the range of the rest.
  struct Result {
    std::vector<Fill> fills;
    Range rest;
    std::int64_t total = 0;
  };

  explicit FillSearch(const Stored& stored) : stored_(stored) {}
  FillSearch() : FillSearch(Stored{}) {}

  /// NaN is ignored.
  void add(double value) {
    total_ += value == value ? 1 : 0;
    if (value <= lowest_.limit() || -value <= highest_.limit()) add_end(value);
  }
  void add(std::span<const double> values) {
    for (const double value : values) add(value);
  }
  [[nodiscard]] Result result() const;

 private:
  struct Counted {
    double value;
    std::int64_t count;
  };

  /// The lowest distinct values of a stream. One that leaves them cannot come back, so their counts are
  /// exact.
  class Lowest {
   public:
    /// Greater values do not count.
    [[nodiscard]] double limit() const { return limit_; }
    void count(double value);
    /// Ascending.
    [[nodiscard]] std::vector<Counted> values() const;

   private:
    static constexpr std::size_t kKept = 40;
    std::vector<Counted> values_;  ///< descending, so that a falling stream appends; up to 2 kKept
    std::size_t last_ = 0;         ///< the entry counted last
    double limit_ = std::numeric_limits<double>::infinity();
  };

  void add_end(double value);
  [[nodiscard]] std::vector<Counted> ends() const;
  [[nodiscard]] Fill fill(const Counted& counted) const;
  [[nodiscard]] bool is_known(const Counted& entry) const;
  void take_known(std::vector<Counted>& values, Result& result) const;
  void take_apart(std::vector<Counted>& values, Result& result) const;

  Stored stored_;
  Lowest lowest_, highest_;  ///< those of the negated values
  Lowest absurd_;            ///< beyond any elevation
  std::int64_t total_ = 0;
};

}  // namespace landfall
