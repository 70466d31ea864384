// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_values.h"

#include <algorithm>
#include <array>
#include <limits>

namespace landfall::fuzz {
namespace {

using h5::Handle;

Handle simple_space(const std::vector<hsize_t>& extent, bool growing) {
  std::vector<hsize_t> maximum = extent;
  if (growing) maximum.assign(extent.size(), H5S_UNLIMITED);
  return {H5Screate_simple(static_cast<int>(extent.size()), extent.data(), maximum.data()), H5Sclose};
}

std::size_t count_of(const std::vector<hsize_t>& extent) {
  constexpr hsize_t kMax = hsize_t{1} << 20U;
  hsize_t count = 1;
  for (const hsize_t size : extent) count = size > kMax || count > kMax ? kMax + 1 : count * size;
  return count > kMax ? 0 : count;
}

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), size);
  return type;
}

Handle compound_type() {
  Handle type(H5Tcreate(H5T_COMPOUND, 16), H5Tclose);
  H5Tinsert(type.get(), "r", 0, H5T_IEEE_F64LE);
  H5Tinsert(type.get(), "i", 8, H5T_IEEE_F64LE);
  return type;
}

Handle enum_type() {
  Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
  const std::int8_t one = 1;
  H5Tenum_insert(type.get(), "ONE", &one);
  return type;
}

Handle array_type() {
  const hsize_t three = 3;
  return {H5Tarray_create2(H5T_IEEE_F64LE, 1, &three), H5Tclose};
}

void set_filters(hid_t storage, InputBytes& input) {
  switch (input.below(7)) {
    case 0:
      break;
    case 1:
      H5Pset_deflate(storage, 1);
      break;
    case 2:
      H5Pset_fletcher32(storage);
      break;
    case 3:
      H5Pset_scaleoffset(storage, H5Z_SO_INT, 0);
      break;
    case 4:
      H5Pset_nbit(storage);
      break;
    default:  // as our writers do
      H5Pset_shuffle(storage);
      H5Pset_deflate(storage, 1);
  }
}

/// Chunks as our readers decode them, or others.
std::vector<hsize_t> any_chunk(const std::vector<hsize_t>& extent, InputBytes& input) {
  constexpr hsize_t kTableChunk = 65536;
  constexpr hsize_t kTile = 256;
  const std::size_t how = input.below(4);
  std::vector<hsize_t> chunk;
  for (const hsize_t size : extent) {
    const hsize_t ours = extent.size() == 1 ? kTableChunk : std::clamp<hsize_t>(size, 1, kTile);
    chunk.push_back(how == 0 ? 1 : how == 1 ? std::clamp<hsize_t>(size, 1, 7) : ours);
  }
  return chunk;
}

void set_fill_value(hid_t storage, InputBytes& input) {
  const double value = any_number(input);
  H5Pset_fill_value(storage, H5T_NATIVE_DOUBLE, &value);
}

}  // namespace

double any_number(InputBytes& input) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::array kNumbers = {std::numeric_limits<double>::quiet_NaN(),
                                   kInfinity,
                                   -kInfinity,
                                   0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   0.5,
                                   2.0,
                                   3.0,
                                   7.0,
                                   127.0,
                                   128.0,
                                   255.0,
                                   65536.0,
                                   1e6,
                                   1e9,
                                   1e12,
                                   1e13,
                                   1e300,
                                   -1e300,
                                   5e-324,
                                   1e-9,
                                   -128.0,
                                   0x1p31,
                                   0x1p31 - 1,
                                   -0x1p31,
                                   0x1p32,
                                   0x1p53,
                                   0x1p62,
                                   0x1p63,
                                   -0x1p63};
  const std::size_t choice = input.below(64);
  return choice < kNumbers.size() ? kNumbers[choice] : static_cast<double>(choice) - 40;
}

std::vector<double> ramp(std::size_t count, InputBytes& input) {
  const double first = any_number(input);
  const double step = any_number(input);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = first + static_cast<double>(i) * step;
  return values;
}

std::string any_text(InputBytes& input) {
  static const std::array<std::string, 24> kTexts = {"",
                                                     "landfall.terrain",
                                                     "landfall.scan",
                                                     "landfall.dem",
                                                     "landfall.evaluation",
                                                     "landfall.plan",
                                                     "1.0",
                                                     "2.0",
                                                     "\xff\xfe\x80",
                                                     "a\nb\x1b[31m",
                                                     "{}",
                                                     "[]",
                                                     "null",
                                                     "0",
                                                     "\"text\"",
                                                     "1e999",
                                                     "[{}]",
                                                     "[null]",
                                                     R"([{"tool": 1, "file_id": "x"}])",
                                                     R"([{"tool": "terrain-gen", "file_id": "x"}])",
                                                     R"({"role": 5})",
                                                     std::string(60000, 'x'),
                                                     std::string(20000, '['),
                                                     "m"};
  const std::size_t choice = input.below(32);
  if (choice == 24) return std::string(20000, '[') + std::string(20000, ']');
  return choice < kTexts.size() ? kTexts[choice] : input.until(0);
}

Handle any_type(InputBytes& input) {
  const std::array<hid_t, 14> plain = {H5T_STD_I8LE,       H5T_STD_U8LE,   H5T_STD_I16BE, H5T_STD_I32LE,
                                       H5T_STD_I32BE,      H5T_STD_I64LE,  H5T_STD_U64LE, H5T_IEEE_F32LE,
                                       H5T_IEEE_F64LE,     H5T_IEEE_F64BE, H5T_STD_U16LE, H5T_STD_B8LE,
                                       H5T_NATIVE_LDOUBLE, H5T_STD_REF_OBJ};
  const std::size_t choice = input.below(plain.size() + 10);
  if (choice < plain.size()) return {H5Tcopy(plain[choice]), H5Tclose};
  switch (choice - plain.size()) {
    case 0:
      return text_type(1);
    case 1:
      return text_type(16);
    case 2:
      return text_type(std::size_t{1} << 31U);
    case 3:
      return text_type(H5T_VARIABLE);
    case 4:
      return compound_type();
    case 5:
      return enum_type();
    case 6:
      return array_type();
    case 7:
      return {H5Tvlen_create(H5T_NATIVE_INT), H5Tclose};
    case 8:
      return {H5Tcreate(H5T_OPAQUE, 5), H5Tclose};
    default:
      return {H5Tcopy(H5T_IEEE_F32BE), H5Tclose};
  }
}

hsize_t any_size(InputBytes& input) {
  constexpr std::array<hsize_t, 12> kSizes = {0,   1,     2,     3,         255,         256,
                                              257, 65536, 65537, 1U << 26U, 1ULL << 31U, 1ULL << 40U};
  const std::size_t choice = input.below(32);
  return choice < kSizes.size() ? kSizes[choice] : choice - kSizes.size();
}

Shape any_shape(const std::vector<hsize_t>& old_extent, InputBytes& input) {
  Shape shape;
  const std::size_t how = input.below(8);
  if (how == 0) return {{H5Screate(H5S_SCALAR), H5Sclose}, {}, 1};
  if (how == 1) return {{H5Screate(H5S_NULL), H5Sclose}, {}, 0};
  shape.extent = old_extent;
  if (how == 2) shape.extent.resize(1 + input.below(3), 1);
  if (how == 3) std::reverse(shape.extent.begin(), shape.extent.end());
  if (shape.extent.empty()) shape.extent = {1};
  if (how == 2 || how == 4) shape.extent[input.below(shape.extent.size())] = any_size(input);
  shape.space = simple_space(shape.extent, input.below(4) == 0);
  shape.count = count_of(shape.extent);
  return shape;
}

Handle any_storage(const Shape& shape, InputBytes& input) {
  Handle storage(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::size_t layout = input.below(4);
  if (layout == 0) H5Pset_layout(storage.get(), H5D_COMPACT);
  if (layout > 1 && !shape.extent.empty()) {
    const std::vector<hsize_t> chunk = any_chunk(shape.extent, input);
    H5Pset_chunk(storage.get(), static_cast<int>(chunk.size()), chunk.data());
    set_filters(storage.get(), input);
  }
  if (input.below(4) == 0) set_fill_value(storage.get(), input);
  return storage;
}

}  // namespace landfall::fuzz
