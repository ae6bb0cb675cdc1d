#include "saltus/report/page_text.hpp"

#include <variant>

#include "report_style.hpp"
#include "saltus/report/json_internal.hpp"
#include "saltus/report/page_data_internal.hpp"

namespace saltus::report {

std::string_view page_style() { return embedded::report_style; }

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string script_json(const result::OptionValue& value) {
  return to_script_text(std::visit([](const auto& content) { return nlohmann::json(content); }, value));
}

std::string script_json(const result::OptionRecord& members) {
  std::string text;
  for (const auto& [name, value] : members) {
    text += (text.empty() ? "" : ",") + script_json(result::OptionValue(name)) + ":" + script_json(value);
  }
  return "{" + text + "}";
}

}  // namespace saltus::report
