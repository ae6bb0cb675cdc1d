#include "saltus/report/html.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "report_script.hpp"
#include "report_style.hpp"
#include "saltus/report/packing_internal.hpp"
#include "saltus/report/page_data_internal.hpp"
#include "saltus/report/page_overlays_internal.hpp"
#include "saltus/report/page_text.hpp"
#include "saltus/result/drawn.hpp"

namespace saltus::report {
namespace {

/// Inside the strings of a script, the only places where these can stand, the backslash changes nothing; for the HTML
/// parser it hides the end of the element.
std::string escape_script(std::string_view script) {
  constexpr std::string_view closing = "</script";
  const auto same_letter = [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a - 'A' + 'a' == b); };
  std::string safe;
  safe.reserve(script.size());
  for (std::size_t i = 0; i < script.size(); ++i) {
    safe += script[i];
    if (script[i] != '<') continue;
    const auto rest = script.substr(i, closing.size());
    const bool closes = std::equal(rest.begin(), rest.end(), closing.begin(), closing.end(), same_letter);
    if (closes || rest.starts_with("<!--")) safe += '\\';
  }
  return safe;
}

/// FNV-1a: the page allows only scripts that carry this number, which text inside the data cannot know beforehand.
std::uint64_t fingerprint(std::string_view text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 1099511628211U;
  }
  return hash;
}

/// A page shows what the rows have, and events between them; all of the others is in the result.
/// @param go_on  false ends it, with a part of the data
nlohmann::json everything_shown(const result::Result& result, const std::vector<Overlay>& overlays, const GoOn& go_on) {
  const auto drawn = as_drawn(result);
  const auto& shown = drawn ? *drawn : result;
  const std::size_t share = numbers_in_page / (1 + overlays.size());
  auto everything = page_data(shown, share, go_on);
  if (go_on()) everything["overlays"] = overlays_data(shown, overlays, share);
  everything["kept"] = nullptr;
  if (result.kept) {
    everything["kept"] = {{"states", result.states.size()}, {"switching functions", result.switching_functions.size()}};
  }
  return everything;
}

}  // namespace

std::string to_html(const result::Result& result, std::string_view plotly_source, const std::vector<Overlay>& overlays,
                    const GoOn& go_on) {
  bool ended = false;
  const GoOn more = [&] { return !(ended = ended || (go_on && !go_on())); };
  Packed packed = pack(everything_shown(result, overlays, more), more);
  const std::string data = more() ? to_script_text(packed.skeleton) : "";
  const std::string numbers = deflated_base64(shuffled_bytes(packed.numbers), more);
  const std::string plotly = deflated_base64(plotly_source, more);
  if (ended) return "";
  const std::string nonce = fmt::format("{:016x}", fingerprint(data) ^ fingerprint(numbers));
  const std::string title = escape_html(result.model.name.empty() ? "simulation" : result.model.name);
  std::string page;
  page.reserve(data.size() + numbers.size() + plotly.size() + 300000);
  page += "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  // Nothing may be fetched from anywhere; plotly needs style attributes and pictures made in the page.
  page += fmt::format(
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'nonce-{}'; "
      "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'\">\n",
      nonce);
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += fmt::format("<title>{} - Saltus</title>\n<style>\n", title);
  page += embedded::report_style;
  page += "</style>\n</head>\n<body>\n";
  page += fmt::format("<noscript><p>Report of {}: {}. {} The pictures need JavaScript.</p></noscript>\n", title,
                      result::name(result.status.termination), escape_html(result.status.message));
  page += "<main id=\"report\"></main>\n";
  page += fmt::format("<script type=\"application/json\" id=\"result\">{}</script>\n", data);
  const auto add_bytes = [&](std::string_view name, std::string_view text) {
    page += fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", name, text);
  };
  add_bytes("numbers", numbers);
  add_bytes("plotly", plotly);
  page += fmt::format("<script nonce=\"{}\">\n", nonce);
  page += escape_script(embedded::report_script);
  page += "\n</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace saltus::report
