#include "saltus/io/toml/other_formats.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/docs_page.hpp"
#include "saltus/base/text.hpp"

namespace saltus::io {
namespace {

struct Format {
  std::string_view what;    ///< after "this is"
  std::string_view remedy;  ///< what to do with such a file
  std::string_view page;    ///< of the documentation, where there is one to read
  std::string_view anchor;  ///< a heading of it
};

constexpr std::string_view restate = "state the model as a .toml file";
constexpr std::string_view run = "run the program itself, or state its equations as a .toml file";
constexpr std::string_view solve = "saltus mpcc reads it";
constexpr std::string_view nothing = "a model is a .toml file, or a .json that saltus simulate --out has written";

constexpr Format from(std::string_view what, std::string_view anchor, std::string_view remedy = restate) {
  return {what, remedy, "coming-from", anchor};
}

constexpr std::string_view biology = "sbml-tools-copasi-tellurium", matlab = "matlab-simulink-stateflow",
                           wolfram = "mathematicas-ndsolve", python = "scipys-solve_ivp";

/// Files that are known by their endings. No model is among them: whatever its ending is, it begins with a table.
constexpr std::array by_ending{
    std::pair{".fmu", from("an FMU", "modelica")},
    std::pair{".mo", from("Modelica", "modelica")},
    std::pair{".slx", from("a model of Simulink", matlab)},
    std::pair{".mdl", from("a model of Simulink", matlab)},
    std::pair{".m", from("a program of MATLAB", matlab, run)},
    std::pair{".omex", from("a COMBINE archive", biology)},
    std::pair{".py", from("a program of Python", python, run)},
    std::pair{".ipynb", from("a notebook of Jupyter", python, run)},
    std::pair{".jl", from("a program of Julia", "julias-differentialequationsjl", run)},
    std::pair{".nb", from("a notebook of Mathematica", wolfram, run)},
    std::pair{".wl", from("a program of Mathematica", wolfram, run)},
    std::pair{".wls", from("a program of Mathematica", wolfram, run)},
    std::pair{".ode", from("a model of XPPAUT", "")},
    std::pair{".yaml", from("YAML", "")},
    std::pair{".yml", from("YAML", "")},
    std::pair{".nl", Format{"a problem of AMPL", solve, "foreign-mpcc", ""}},
    std::pair{".mod", Format{"a model of AMPL", "AMPL writes it as .nl, for saltus mpcc", "foreign-mpcc", ""}},
    std::pair{".cpp", Format{"a program of C++", "compile and run it", "embedding", ""}},
    std::pair{".csv", Format{"a table of numbers", nothing, "", ""}},
    std::pair{".npz", Format{"a file of NumPy", nothing, "", ""}},
    std::pair{".html", Format{"a page", nothing, "", ""}},
    std::pair{".svg", Format{"a picture", nothing, "", ""}},
    std::pair{".png", Format{"a picture", nothing, "", ""}},
    std::pair{".pdf", Format{"a PDF", nothing, "", ""}},
};

constexpr std::size_t first_bytes = 4096;  // say what a file is

Format of_xml(std::string_view text) {
  const auto begin = text.substr(0, first_bytes);
  const auto has = [&](std::string_view part) { return begin.find(part) != std::string_view::npos; };
  if (has("<sbml") || has(":sbml")) return from("SBML", biology);
  if (has("<COPASI")) return from("a model of COPASI", biology);
  if (has("cellml")) return from("CellML", biology);
  if (has("fmiModelDescription")) return from("the description of an FMU", "modelica");
  if (has("<mujoco") || has("<robot") || has("<sdf")) return from("a robot's XML (MJCF, URDF or SDF)", "drake-mujoco");
  return from("XML", "");
}

/// JSON that says no format: a stored result says its own.
std::optional<Format> of_json(std::string_view text) {
  const auto has = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  if (has("\"format\"")) return std::nullopt;
  if (has("\"G_fun\"")) return Format{"a problem with complementarities", solve, "foreign-mpcc", ""};
  return Format{"JSON", nothing, "", ""};
}

/// A line that begins with "model", or a reaction, "S1 -> S2; k*S1", without a table of TOML before it.
bool is_antimony(std::string_view text) {
  for (auto line : split(text.substr(0, first_bytes), '\n')) {
    line = trimmed(line, " \t\r");
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) continue;
    if (line.starts_with('[') || line.find('"') != std::string_view::npos) return false;
    const auto word = line.substr(0, line.find_first_of(" \t"));
    if (word == "model" || word == "module") return line.find('=') == std::string_view::npos;
    const auto arrow = std::min(line.find("->"), line.find("=>"));
    if (arrow != std::string_view::npos && line.find(';', arrow) != std::string_view::npos) return true;
  }
  return false;
}

/// The first letter behind blanks and comments; 0 where there is none.
char first_letter(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    if (text.empty()) return '\0';
    if (text.front() != '#') return text.front();
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
}

std::optional<Format> format_of(std::string_view text, std::string_view file) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const char first = first_letter(text);
  if (first == '\0' || first == '[') return std::nullopt;
  const auto* const known =
      std::find_if(by_ending.begin(), by_ending.end(), [&](const auto& entry) { return file.ends_with(entry.first); });
  if (known != by_ending.end()) return known->second;
  if (first == '<') return of_xml(text);
  if (first == '{' && !file.ends_with(".toml")) return of_json(text);
  if (is_antimony(text)) return from("Antimony", biology);
  return std::nullopt;
}

}  // namespace

std::optional<Error> other_format(std::string_view text, const std::string& file) {
  const auto format = format_of(text, file);
  if (!format) return std::nullopt;
  return Error{ErrorCode::parse_failure,
               fmt::format("this is {}, no model of Saltus", format->what),
               format->page.empty()
                   ? std::string(format->remedy)
                   : fmt::format("{}: see {}", format->remedy, docs_page(format->page, format->anchor)),
               {file, 0, 0},
               {}};
}

}  // namespace saltus::io
