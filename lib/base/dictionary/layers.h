// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "base/dictionary/tables/layers.h"
#include "base/dictionary/tables/maps.h"

namespace landfall::dictionary {

/// The words of a layer in a file of a kind ("dem", "draws", ...) from schemas/dictionary/layers.json; null
/// where no tool writes such a layer.
[[nodiscard]] const Layer* find_layer(std::string_view file, std::string_view name);

/// Throws std::logic_error where find_layer() finds none.
[[nodiscard]] const Layer& layer(std::string_view file, std::string_view name);

/// The names of all layers, each once, in the order of the dictionary.
[[nodiscard]] std::vector<const char*> layer_names();

/// The classes of the layer `safe` or `outcome`, from the worst to the best for a lander that touches down
/// there: a pixel that covers several places is drawn in the worst of their classes (D293).
[[nodiscard]] std::vector<PlaceClass> place_classes(std::string_view layer);

}  // namespace landfall::dictionary
