#include "saltus/io/toml/other_formats.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "saltus/base/docs_page.hpp"
#include "saltus/base/text.hpp"

namespace saltus::io {
namespace {

struct Format {
  std::string_view what;    ///< after "this is"
  std::string_view anchor;  ///< in docs/coming-from.md
};

std::string_view first_word(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  text = trimmed(text, blanks);
  return text.substr(0, text.find_first_of(blanks));
}

Format of_xml(std::string_view text) {
  const auto begin = text.substr(0, 4096);
  const auto has = [&](std::string_view part) { return begin.find(part) != std::string_view::npos; };
  if (has("<sbml") || has(":sbml")) return {"SBML", "sbml-tools-copasi-tellurium"};
  if (has("<COPASI")) return {"a model of COPASI", "sbml-tools-copasi-tellurium"};
  if (has("cellml")) return {"CellML", "sbml-tools-copasi-tellurium"};
  if (has("fmiModelDescription")) return {"the description of an FMU", "modelica"};
  if (has("<mujoco") || has("<robot") || has("<sdf")) return {"a robot's XML (MJCF, URDF or SDF)", "drake-mujoco"};
  return {"XML", ""};
}

bool is_modelica(std::string_view text) {
  constexpr std::array<std::string_view, 10> words{"within",  "model",  "package",  "class",     "block",
                                                   "partial", "record", "function", "connector", "encapsulated"};
  const auto word = first_word(text);
  return word.starts_with("//") || word.starts_with("/*") || std::find(words.begin(), words.end(), word) != words.end();
}

/// A line that begins with "model", or a reaction, "S1 -> S2; k*S1", without a table of TOML before it.
bool is_antimony(std::string_view text) {
  for (auto line : split(text.substr(0, 4096), '\n')) {
    line = trimmed(line, " \t\r");
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) continue;
    if (line.starts_with('[') || line.find('"') != std::string_view::npos) return false;
    const auto word = first_word(line);
    if (word == "model" || word == "module") return line.find('=') == std::string_view::npos;
    const auto arrow = std::min(line.find("->"), line.find("=>"));
    if (arrow != std::string_view::npos && line.find(';', arrow) != std::string_view::npos) return true;
  }
  return false;
}

/// A model file, whatever its name is, begins with a table or a comment; so does no program.
bool is_program(std::string_view text) {
  const auto word = first_word(text);
  return !word.empty() && !word.starts_with('[') && !word.starts_with('#');
}

std::optional<Format> format_of(std::string_view text, std::string_view file) {
  if (text.starts_with("PK\x03\x04")) {
    if (file.ends_with(".fmu")) return Format{"an FMU", "modelica"};
    if (file.ends_with(".slx")) return Format{"a model of Simulink", "matlab-simulink-stateflow"};
    if (file.ends_with(".omex")) return Format{"a COMBINE archive", "sbml-tools-copasi-tellurium"};
    return std::nullopt;
  }
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  if (first_word(text).starts_with('<')) return of_xml(text);
  if (file.ends_with(".mo") && (is_modelica(text) || text.find("\nequation") != std::string_view::npos))
    return Format{"Modelica", "modelica"};
  if (is_antimony(text)) return Format{"Antimony", "sbml-tools-copasi-tellurium"};
  if (file.ends_with(".m") && is_program(text)) return Format{"a program of MATLAB", "matlab-simulink-stateflow"};
  if (file.ends_with(".mdl")) return Format{"a model of Simulink", "matlab-simulink-stateflow"};
  return std::nullopt;
}

}  // namespace

std::optional<Error> other_format(std::string_view text, const std::string& file) {
  const auto format = format_of(text, file);
  if (!format) return std::nullopt;
  return Error{ErrorCode::parse_failure,
               fmt::format("this is {}: Saltus does not read it yet", format->what),
               fmt::format("state the model as a .toml file: see {}", docs_page("coming-from", format->anchor)),
               {file, 0, 0},
               {}};
}

}  // namespace saltus::io
