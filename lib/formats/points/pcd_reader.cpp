// SPDX-License-Identifier: GPL-3.0-or-later
// PCD 0.7 of the Point Cloud Library. The compressed form holds field after field, each of all points.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/core/parallel.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "formats/points/cloud_formats.h"
#include "formats/points/lzf.h"
#include "formats/points/row_reader.h"
#include "formats/points/text_rows.h"

namespace landfall {
namespace {

constexpr std::uint64_t kMaxField = 1U << 16U;

struct PcdHeader {
  std::vector<std::string> fields, sizes, types, counts, viewpoint;
  std::optional<std::uint64_t> width, height;
  std::uint64_t points = 0;
  bool has_points = false;
  std::string data;
  std::uint64_t end = 0;
  std::size_t lines = 0;
};

std::uint64_t count_of(const CloudBytes& file, const std::vector<std::string>& words) {
  const std::string text = words.size() > 1 ? words[1] : "";
  const auto value = exact_number<std::uint64_t>(text);
  if (!value || *value > (1ULL << 48U)) file.fail(words[0] + " '" + shown_word(text) + "' is not a count");
  return *value;
}

std::vector<std::string> rest_of(const std::vector<std::string>& words) {
  return {words.begin() + 1, words.end()};
}

void take_line(const CloudBytes& file, const std::vector<std::string>& words, PcdHeader& pcd) {
  const std::string& key = words[0];
  if (key == "FIELDS" || key == "COLUMNS") pcd.fields = rest_of(words);
  if (key == "SIZE") pcd.sizes = rest_of(words);
  if (key == "TYPE") pcd.types = rest_of(words);
  if (key == "COUNT") pcd.counts = rest_of(words);
  if (key == "VIEWPOINT") pcd.viewpoint = rest_of(words);
  if (key == "WIDTH") pcd.width = count_of(file, words);
  if (key == "HEIGHT") pcd.height = count_of(file, words);
  if (key == "DATA") pcd.data = words.size() > 1 ? words[1] : "";
  if (key != "POINTS") return;
  pcd.points = count_of(file, words);
  pcd.has_points = true;
}

PcdHeader read_pcd_header(const CloudBytes& file) {
  const std::vector<std::byte> bytes = beginning_of(file, [](std::string_view text) {
    const std::size_t data = text.find("\nDATA");
    return data != std::string_view::npos && text.find('\n', data + 1) != std::string_view::npos;
  });
  const std::string text(text_of(bytes));
  PcdHeader pcd;
  while (pcd.data.empty()) {
    const std::size_t end = text.find('\n', pcd.end);
    if (end == std::string::npos) file.fail("ends within its PCD header: it has no line DATA");
    const std::vector<std::string> words = split_words(text.substr(pcd.end, end - pcd.end));
    pcd.end = end + 1;
    ++pcd.lines;
    if (!words.empty() && words[0][0] != '#') take_line(file, words, pcd);
  }
  const std::uint64_t width = pcd.width.value_or(0);
  const std::uint64_t height = pcd.height.value_or(0);
  if (height > 0 && width > (1ULL << 48U) / height) file.fail("declares too many points");
  if (!pcd.has_points) pcd.points = width * height;
  if (pcd.width && pcd.height && width * height != pcd.points)
    file.fail("declares " + std::to_string(pcd.points) + " POINTS, but WIDTH x HEIGHT is " +
              std::to_string(width * height) + ": correct its header");
  return pcd;
}

NumberType type_of(const CloudBytes& file, const std::string& type, const std::string& size) {
  struct Known {
    const char *type, *size;
    NumberType value;
  };
  constexpr std::array<Known, 10> kKnown = {{{"I", "1", NumberType::int8},
                                             {"U", "1", NumberType::uint8},
                                             {"I", "2", NumberType::int16},
                                             {"U", "2", NumberType::uint16},
                                             {"I", "4", NumberType::int32},
                                             {"U", "4", NumberType::uint32},
                                             {"I", "8", NumberType::int64},
                                             {"U", "8", NumberType::uint64},
                                             {"F", "4", NumberType::float32},
                                             {"F", "8", NumberType::float64}}};
  for (const Known& known : kKnown)
    if (type == known.type && size == known.size) return known.value;
  file.fail("a field of TYPE " + shown_word(type) + " and SIZE " + shown_word(size) + " is not known");
}

/// A field with its place in a row, and its bytes.
struct Field {
  RowColumn column;
  std::size_t bytes;
  std::size_t values;
};

std::vector<Field> fields_of(const CloudBytes& file, const PcdHeader& pcd) {
  const std::size_t count = pcd.fields.size();
  if (count == 0 || pcd.sizes.size() != count || pcd.types.size() != count ||
      (!pcd.counts.empty() && pcd.counts.size() != count))
    file.fail("FIELDS, SIZE, TYPE and COUNT differ in length");
  std::vector<Field> fields;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t values = pcd.counts.empty() ? 1 : count_of(file, {"COUNT", pcd.counts[i]});
    if (values == 0 || values > kMaxField) file.fail("a COUNT of " + std::to_string(values));
    const bool is_padding = pcd.fields[i] == "_";
    const std::uint64_t size = is_padding ? count_of(file, {"SIZE", pcd.sizes[i]}) : 0;
    if (size > kMaxField) file.fail("a SIZE of " + std::to_string(size));
    const NumberType type = is_padding ? NumberType::uint8 : type_of(file, pcd.types[i], pcd.sizes[i]);
    const std::size_t bytes = static_cast<std::size_t>(values) * (is_padding ? size : size_of(type));
    fields.push_back({{pcd.fields[i], type, offset}, bytes, static_cast<std::size_t>(values)});
    offset += bytes;
  }
  return fields;
}

/// Reads each wanted field through a separate stream, which begins where the field does.
class CompressedReader final : public CloudReader {
 public:
  CompressedReader(std::unique_ptr<CloudBytes> file, CloudInfo info, const std::vector<Field>& fields,
                   std::uint64_t count, const LzfStream& stream)
      : file_(std::move(file)), fields_(fields), count_(count) {
    info_ = std::move(info);
    LzfStream at = stream;
    for (std::size_t column = 0; column < fields.size(); ++column) {
      for (std::size_t f = 0; f < kCloudFieldCount; ++f)
        if (info_.columns[f] == column) begins_[f] = at;
      if (column + 1 < fields.size()) at.skip(fields[column].bytes * count);
    }
    streams_ = begins_;
    read_time_base();
  }

  bool next(CloudBatch& batch) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kCloudBatchPoints, count_ - next_));
    if (count == 0) return false;
    parallel_for(kCloudFieldCount, 1, [&](std::size_t f, std::size_t) {
      batch.columns[f].resize(info_.columns[f] ? count : 0);
      if (info_.columns[f]) read(f, batch.columns[f]);
    });
    next_ += count;
    return true;
  }
  void rewind() override {
    streams_ = begins_;
    next_ = 0;
  }
  [[nodiscard]] double progress() const override {
    return static_cast<double>(next_) / static_cast<double>(count_);
  }

 private:
  void read_time_base() {
    if (!info_.has(CloudField::t)) return;
    const Field& field = fields_[*info_.columns[kTimeField]];
    LzfStream stream = *begins_[kTimeField];
    std::vector<std::byte> first(field.bytes);
    stream.read(first);
    info_.time_base = stored_time_base(field.column.type, first.data(), false);
  }

  void read(std::size_t f, std::vector<double>& out) {
    const Field& field = fields_[*info_.columns[f]];
    const std::int64_t base = f == kTimeField ? info_.time_base : 0;
    std::vector<std::byte> bytes(field.bytes);
    for (double& value : out) {
      streams_[f]->read(bytes);
      value = number_from(base, field.column.type, bytes.data(), false);
    }
  }

  std::unique_ptr<CloudBytes> file_;
  std::vector<Field> fields_;
  std::uint64_t count_;
  std::array<std::optional<LzfStream>, kCloudFieldCount> begins_, streams_;
  std::uint64_t next_ = 0;
};

std::unique_ptr<CloudReader> open_compressed(std::unique_ptr<CloudBytes> file, const PcdHeader& pcd,
                                             const std::vector<Field>& fields, CloudInfo info) {
  const std::vector<std::byte> sizes = file->up_to(pcd.end, 8);
  if (sizes.size() < 8) file->fail("ends before its compressed points");
  const std::uint64_t packed = number_at<std::uint32_t>(sizes, 0);
  const std::uint64_t unpacked = number_at<std::uint32_t>(sizes, 4);
  std::uint64_t row = 0;
  for (const Field& field : fields) row += field.bytes;
  if (pcd.points == 0) file->fail("has no points");
  if (pcd.points > unpacked / row || unpacked != row * pcd.points)
    file->fail("declares " + std::to_string(pcd.points) + " points of " + std::to_string(row) +
               " bytes, but " + std::to_string(unpacked) + " unpacked bytes");
  if (packed > file->size() - pcd.end - 8)
    file->fail("declares " + std::to_string(packed) + " compressed bytes, more than it has: it is truncated");
  if (const std::uint64_t rest = file->size() - pcd.end - 8 - packed; rest > 0)
    info.notes.push_back("has " + std::to_string(rest) +
                         " bytes behind its compressed points; they are not read");
  const LzfStream stream(*file, pcd.end + 8, packed);
  info.point_count = static_cast<std::int64_t>(pcd.points);
  return std::make_unique<CompressedReader>(std::move(file), std::move(info), fields, pcd.points, stream);
}

/// Columns of text: a field of several values takes as many.
CloudColumns text_columns(const CloudColumns& fields, const std::vector<Field>& all) {
  CloudColumns columns = fields;
  for (auto& column : columns) {
    if (!column) continue;
    std::size_t before = 0;
    for (std::size_t i = 0; i < *column; ++i) before += all[i].values;
    column = before;
  }
  return columns;
}

}  // namespace

std::unique_ptr<CloudReader> open_pcd(std::unique_ptr<CloudBytes> file, const ColumnChoice& choice) {
  const PcdHeader pcd = read_pcd_header(*file);
  const std::vector<Field> fields = fields_of(*file, pcd);
  CloudInfo info = info_of("PCD, " + abbreviated(pcd.data), cloud_columns(pcd.fields, choice, file->name()));
  info.is_float32 = float32_axes(info.columns, [&](std::size_t i) { return fields[i].column.type; });
  if (!pcd.viewpoint.empty() && pcd.viewpoint != split_words("0 0 0 1 0 0 0"))
    info.notes.emplace_back("its VIEWPOINT is ignored: the points are taken as they are stored");
  if (pcd.data == "binary_compressed") return open_compressed(std::move(file), pcd, fields, std::move(info));
  RowLayout rows{.begin = pcd.end, .row_size = 0, .count = pcd.points, .columns = {}};
  std::size_t values = 0;
  for (const Field& field : fields) {
    rows.row_size += field.bytes;
    values += field.values;
    rows.columns.push_back(field.column);
  }
  if (pcd.data == "binary") {
    require_rows(*file, rows);
    info.notes.push_back(judge_rest(*file, rows, file->size() - rows.begin - rows.count * rows.row_size));
    std::erase(info.notes, "");
    return read_rows(std::move(file), std::move(rows), std::move(info));
  }
  if (pcd.data != "ascii") file->fail("DATA '" + shown_word(pcd.data) + "' is not a form of PCD");
  info.columns = text_columns(info.columns, fields);
  const TextRows in_text{.begin = pcd.end,
                         .first_line = pcd.lines + 1,
                         .count = static_cast<std::int64_t>(pcd.points),
                         .column_count = values};
  return std::make_unique<TextReader>(std::move(file), in_text, std::move(info));
}

}  // namespace landfall
