// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

// For libraries that link nlohmann_json.

namespace landfall {

/// Whether a text is UTF-8, which JSON requires.
inline bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// Replaces each byte that is not UTF-8 by U+FFFD.
inline std::string as_utf8(const std::string& text) {
  if (is_utf8(text)) return text;
  const std::string json =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return nlohmann::json::parse(json).get<std::string>();
}

/// A handler for Json::sax_parse(). It builds no value. Parsing stops and returns false where the text is not
/// JSON or nests deeper than `max_levels` levels: code that walks a JSON value recurses once per level.
class JsonLevels : public nlohmann::json_sax<nlohmann::json> {
 public:
  using Json = nlohmann::json;

  explicit JsonLevels(int max_levels) : max_levels_(max_levels) {}

  bool start_object(std::size_t /*size*/) override { return go_down(); }
  bool start_array(std::size_t /*size*/) override { return go_down(); }
  bool end_object() override { return go_up(); }
  bool end_array() override { return go_up(); }
  bool key(std::string& /*text*/) override { return true; }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(Json::number_integer_t /*value*/) override { return true; }
  bool number_unsigned(Json::number_unsigned_t /*value*/) override { return true; }
  bool number_float(Json::number_float_t /*value*/, const std::string& /*text*/) override { return true; }
  bool string(std::string& /*value*/) override { return true; }
  bool binary(Json::binary_t& /*value*/) override { return true; }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*error*/) override {
    return false;
  }

 protected:
  /// Called at the first level beyond the limit.
  virtual bool too_deep() { return false; }

 private:
  bool go_down() { return ++level_ <= max_levels_ || too_deep(); }
  bool go_up() {
    --level_;
    return true;
  }

  int max_levels_;
  int level_ = 0;
};

}  // namespace landfall
