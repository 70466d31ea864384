// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace landfall {

/// Statements in the comments at the beginning of a text or of a header: lines that begin with #, //, %,
/// `comment` or `obj_info` (PLY). Empty where there is none.
struct PlaceComments {
  std::string y_up;  ///< says that the second axis points up; in comments with #, also that Blender wrote it
  std::string offset;  ///< has an offset, shift, origin or translation of at least two numbers, not all 0
};

/// Bytes at the beginning of a file that place_comments() reads at most.
inline constexpr std::size_t kHeadOfComments = std::size_t{1} << 16U;

/// Reads the head of a file; of PLY and PCD, the header.
[[nodiscard]] PlaceComments place_comments(std::string_view text);

/// Whether relief of this extent in x, y and z stands on edge: far longer in x and in z than in y.
[[nodiscard]] bool stands_on_edge(const std::array<double, 3>& extent);

/// The warnings, without the file's name, of a file whose relief may stand on edge (`on_edge`) or whose
/// comments say what is not applied. `offset_remedy` ends the sentence about an offset.
[[nodiscard]] std::vector<std::string> place_warnings(const PlaceComments& comments, bool on_edge,
                                                      bool up_is_given, const std::string& offset_remedy);

}  // namespace landfall
