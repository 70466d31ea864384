// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace landfall {

/// Whether B is better than A in words (D468), from the result of compare_files() and both describe_file().
/// An object with `conclusion` ("better", "worse", "mixed", "equal" or "unknown"), `sentence`, `points`
/// (name, change, text and the numbers of each; docs/reference/info-json.md) and `notes`. Null for kinds of
/// files that nothing judges.
///
/// A point is better or worse where its verdict changes; where both fail, by the value that is judged; where
/// nothing is judged, by its number. A change of at most 1 % of the larger number, or of the limit, counts as
/// none. B is better if some point is better and none worse, mixed if there are both. Only if no point
/// changes so, the margins of the requirements that both meet decide in the same way.
[[nodiscard]] nlohmann::ordered_json answer_of(const nlohmann::ordered_json& comparison,
                                               const nlohmann::ordered_json& a,
                                               const nlohmann::ordered_json& b);

}  // namespace landfall
