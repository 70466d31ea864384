// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D444
// QFIT (.qi) of NASA's Airborne Topographic Mapper: records of 10, 12 or 14 words of 4 bytes, big-endian
// until 2010, little-endian after. The first word of the file is the length of a record in bytes. Further
// records of its header begin with -9000008 to -9000000; the second word of the first of these is the offset
// of the shots. The last word of a shot is its GPS time of day as digits, hhmmssmmm.
#include <array>
#include <limits>
#include <utility>

#include "formats/points/cloud_formats.h"
#include "formats/points/row_reader.h"

namespace landfall {
namespace {

constexpr std::size_t kWord = 4;
constexpr std::array<std::int32_t, 3> kLengths = {40, 48, 56};

/// Longitudes, latitudes and heights refer to the ellipsoid of WGS 84.
constexpr const char* kCrsWkt =
    R"wkt(GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],)wkt"
    R"wkt(CS[ellipsoidal,3],AXIS["latitude",north,ANGLEUNIT["degree",0.0174532925199433]],)wkt"
    R"wkt(AXIS["longitude",east,ANGLEUNIT["degree",0.0174532925199433]],)wkt"
    R"wkt(AXIS["ellipsoidal height",up,LENGTHUNIT["metre",1]],ID["EPSG",4979]])wkt";

std::int32_t word_at(const std::byte* bytes, bool is_big_endian) {
  return static_cast<std::int32_t>(stored_number(NumberType::int32, bytes, is_big_endian));
}

struct QfitHeader {
  std::size_t length = 0;  ///< of a record, bytes; 0: none that QFIT has
  bool is_big_endian = false;
};

QfitHeader header_of(const CloudBytes& file) {
  const std::vector<std::byte> bytes = file.up_to(0, kWord);
  for (const bool is_big_endian : {true, false})
    for (const std::int32_t length : kLengths)
      if (bytes.size() == kWord && word_at(bytes.data(), is_big_endian) == length)
        return {static_cast<std::size_t>(length), is_big_endian};
  return {};
}

bool is_header_record(std::int32_t first_word) {
  return first_word >= -9'000'008 && first_word <= -9'000'000;
}

/// Shots of the file. A header record among them, and a shot whose latitude, longitude and height are 0, has
/// no position.
class QfitReader final : public RowReader {
 public:
  QfitReader(std::unique_ptr<CloudBytes> file, const RowLayout& shots) : RowReader(std::move(file), shots) {
    info_.format = "QFIT, " + std::to_string(shots.row_size / kWord) + " words" +
                   (shots.is_big_endian ? ", big-endian" : ", little-endian");
    for (const CloudField field :
         {CloudField::x, CloudField::y, CloudField::z, CloudField::intensity, CloudField::t})
      info_.columns[static_cast<std::size_t>(field)] = 0;
    info_.point_count = static_cast<std::int64_t>(shots.count);
    info_.crs_wkt = kCrsWkt;
    info_.clock = "GPS time of day";
  }

 protected:
  void decode(std::span<const std::byte> bytes, std::size_t begin, std::size_t end,
              CloudBatch& batch) const override {
    for (std::size_t i = begin; i < end; ++i) {
      const std::byte* const shot = bytes.data() + i * layout().row_size;
      const auto word = [&](std::size_t w) { return word_at(shot + w * kWord, layout().is_big_endian); };
      const bool is_shot = word(0) >= 0 && (word(1) != 0 || word(2) != 0 || word(3) != 0);
      batch[CloudField::x][i] = is_shot ? word(2) / 1e6 : std::numeric_limits<double>::quiet_NaN();
      batch[CloudField::y][i] = word(1) / 1e6;
      batch[CloudField::z][i] = word(3) / 1e3;
      batch[CloudField::intensity][i] = word(5);
      batch[CloudField::t][i] = seconds_of_day(word(layout().row_size / kWord - 1));
    }
  }

 private:
  static double seconds_of_day(std::int32_t digits) {
    const std::int32_t minutes = digits / 10'000'000 * 60 + digits / 100'000 % 100;
    return minutes * 60.0 + digits % 100'000 / 1e3;
  }
};

}  // namespace

bool is_qfit(const CloudBytes& file) {
  const QfitHeader header = header_of(file);
  if (header.length == 0 || file.size() < header.length + 2 * kWord) return false;
  const std::vector<std::byte> second = file.up_to(header.length, kWord);
  return is_header_record(word_at(second.data(), header.is_big_endian));
}

std::unique_ptr<CloudReader> open_qfit(std::unique_ptr<CloudBytes> file) {
  const QfitHeader header = header_of(*file);
  if (header.length == 0)
    file->fail(
        "is not QFIT: its first word is not 40, 48 or 56, the bytes of a record, in either byte order");
  if (!is_qfit(*file))
    file->fail("is not a QFIT that is read: its second record does not begin with -9000008 to -9000000");
  const std::vector<std::byte> word = file->up_to(header.length + kWord, kWord);
  const std::int32_t offset = word_at(word.data(), header.is_big_endian);
  const std::uint64_t begin = offset > 0 ? static_cast<std::uint64_t>(offset) : 0;
  if (begin < 2 * header.length || begin % header.length != 0 || begin > file->size())
    file->fail("its shots begin at byte " + std::to_string(offset) +
               " by its header: that is not behind its header, at a " + "multiple of its " +
               std::to_string(header.length) + " bytes per record, and within the file");
  const std::uint64_t bytes = file->size() - begin;
  if (bytes % header.length != 0)
    file->fail("ends within a record of " + std::to_string(header.length) + " bytes: it is truncated");
  RowLayout shots{.begin = begin,
                  .row_size = header.length,
                  .count = bytes / header.length,
                  .is_big_endian = header.is_big_endian,
                  .columns = {}};
  return std::make_unique<QfitReader>(std::move(file), shots);
}

}  // namespace landfall
