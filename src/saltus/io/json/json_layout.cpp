#include "saltus/io/json/json_layout_internal.hpp"

namespace saltus::io {
namespace {

bool fits_on_a_line(const Json& json) {
  if (!json.is_structured()) return true;
  for (const auto& element : json) {
    if (element.is_structured()) return false;
  }
  return json.is_array() || json.size() <= 2;
}

}  // namespace

/// Texts of a result may come from anywhere; what is no UTF-8 in them is replaced, not thrown at the user.
std::string compact(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

void append_laid_out(const Json& json, std::size_t indent, std::string& text) {
  if (fits_on_a_line(json)) {
    text += compact(json);
    return;
  }
  const std::string margin(indent + 2, ' ');
  const bool is_object = json.is_object();
  text += is_object ? "{\n" : "[\n";
  std::size_t written = 0;
  for (auto element = json.begin(); element != json.end(); ++element) {
    text += margin;
    if (is_object) text += compact(Json(element.key())) + ": ";
    append_laid_out(*element, indent + 2, text);
    text += ++written < json.size() ? ",\n" : "\n";
  }
  text += std::string(indent, ' ') + (is_object ? "}" : "]");
}

std::string laid_out(const Json& json) {
  std::string text;
  append_laid_out(json, 0, text);
  return text + "\n";
}

}  // namespace saltus::io
