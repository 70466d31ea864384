// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/classic_netcdf.h"

#include <cpl_vsi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kMaxElements = 65536;  ///< largest accepted length of a list in the header

/// The values of one variable; those of a single record if it has the record dimension.
struct Values {
  double bytes = 0;
  double begin = 0;
  bool in_records = false;
};

double padded(double bytes) { return 4 * std::ceil(bytes / 4); }

struct Closer {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// The header of a classic file, read once from its beginning; the grammar is in the netCDF User's Guide,
/// "File Format Specifications". Sizes are doubles because products of the numbers in a damaged header may be
/// huge.
class Header {
 public:
  Header(const std::string& path, double file_bytes)
      : file_(VSIFOpenL(path.c_str(), "rb")), file_bytes_(file_bytes), failed_(file_ == nullptr) {
    const std::array<unsigned char, 8> magic = read(4);
    version_ = magic[0] == 'C' && magic[1] == 'D' && magic[2] == 'F' ? magic[3] : 0;
  }

  /// The smallest possible size of the file; 0 if it is not a classic file or its header is not readable.
  [[nodiscard]] double promised_bytes() {
    if (version_ != 1 && version_ != 2) return 0;
    const double records = number(4);
    const bool streamed = records == 0xffffffffp0;
    read_dimensions();
    skip_attributes();
    const std::vector<Values> variables = read_variables();
    return failed_ ? 0 : end_of(variables, streamed ? 0 : records);
  }

 private:
  std::array<unsigned char, 8> read(std::size_t bytes) {
    std::array<unsigned char, 8> data{};
    failed_ = failed_ || VSIFReadL(data.data(), 1, bytes, file_.get()) != bytes;
    return data;
  }
  /// Reads a big-endian number.
  double number(std::size_t bytes) {
    const std::array<unsigned char, 8> digits = read(bytes);
    double value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = 256 * value + digits.at(i);
    return value;
  }
  double count() { return number(4); }
  double offset() { return number(version_ == 1 ? 4 : 8); }
  /// Reads the length of a list, which follows a tag.
  double list() {
    (void)number(4);
    const double elements = count();
    failed_ = failed_ || elements > kMaxElements;
    return elements;
  }
  void skip(double bytes) {
    failed_ = failed_ || bytes > file_bytes_ ||
              VSIFSeekL(file_.get(), static_cast<vsi_l_offset>(padded(bytes)), SEEK_CUR) != 0;
  }
  void skip_name() { skip(count()); }
  double type_bytes() {
    constexpr std::array<double, 7> kBytes{0, 1, 1, 2, 4, 4, 8};
    const double type = number(4);
    if (type >= 1 && type < kBytes.size()) return kBytes.at(static_cast<std::size_t>(type));
    failed_ = true;
    return 0;
  }
  void read_dimensions() {
    for (double left = list(); left > 0 && !failed_; --left) {
      skip_name();
      dimensions_.push_back(count());
    }
  }
  void skip_attributes() {
    for (double left = list(); left > 0 && !failed_; --left) {
      skip_name();
      const double bytes = type_bytes();
      skip(bytes * count());
    }
  }
  std::vector<Values> read_variables() {
    std::vector<Values> variables;
    for (double left = list(); left > 0 && !failed_; --left) variables.push_back(read_variable());
    return variables;
  }
  Values read_variable() {
    skip_name();
    Values values{1, 0, false};
    for (double left = count(); left > 0 && !failed_; --left) {
      const double dimension = count();
      failed_ = failed_ || dimension >= static_cast<double>(dimensions_.size());
      const double length = failed_ ? 0 : dimensions_[static_cast<std::size_t>(dimension)];
      values.in_records = values.in_records || length == 0;  // the record dimension has length 0
      if (length > 0) values.bytes *= length;
    }
    skip_attributes();
    values.bytes *= type_bytes();
    (void)count();  // the size in the header is skipped: it cannot represent large variables
    values.begin = offset();
    return values;
  }
  static double end_of(const std::vector<Values>& variables, double records) {
    const auto in_records = std::ranges::count_if(variables, &Values::in_records);
    double record_bytes = 0;
    for (const Values& values : variables)
      if (values.in_records) record_bytes += in_records > 1 ? padded(values.bytes) : values.bytes;
    double end = 0;
    for (const Values& values : variables) {
      if (!values.in_records) end = std::max(end, values.begin + values.bytes);
      if (values.in_records && records > 0)
        end = std::max(end, values.begin + (records - 1) * record_bytes + values.bytes);
    }
    return end;
  }

  std::unique_ptr<VSILFILE, Closer> file_;
  double file_bytes_;
  bool failed_;
  int version_ = 0;
  std::vector<double> dimensions_;  ///< 0: the record dimension
};

}  // namespace

void require_whole_classic_netcdf(const std::string& path) {
  std::error_code unreachable;
  if (!std::filesystem::is_regular_file(path, unreachable)) return;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, unreachable));
  if (unreachable) return;
  const double promised = Header(path, bytes).promised_bytes();
  if (promised > bytes)
    throw FormatError(path + ": holds " + number_text(bytes) + " of the " + number_text(promised) +
                      " bytes that its netCDF header declares: it is truncated; get or export it again");
}

}  // namespace landfall
