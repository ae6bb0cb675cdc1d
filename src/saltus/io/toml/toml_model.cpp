#include "saltus/io/toml/toml_model.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/base/same_place.hpp"
#include "saltus/base/text.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/sha256.hpp"
#include "saltus/io/toml/other_formats.hpp"
#include "saltus/io/toml/toml_sections_internal.hpp"
#include "saltus/io/toml/toml_slips_internal.hpp"
#include "saltus/model/mistakes.hpp"
#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::io {
namespace {

using SectionReader = void (*)(TomlReader&, const TomlEntry&, ModelFile&);

/// A table of name = expression that goes into one member of the description.
template <auto member>
void read_into(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  read_expressions(reader, entry.value, fmt::format("the table [{}] of names and expressions", entry.key),
                   model.description.*member);
}

struct Section {
  std::string_view name;
  SectionReader read;
};

constexpr std::array sections{
    Section{"model", read_model_table},
    Section{"parameters", read_parameters},
    Section{"states", read_states},
    Section{"controls", read_controls},
    Section{"definitions", read_into<&model::Description::definitions>},
    Section{"switching", read_into<&model::Description::switching>},
    Section{"dynamics", read_into<&model::Description::dynamics>},
    Section{"modes", read_modes},
    Section{"jumps", read_jumps},
    Section{"hysteresis", read_hysteresis},
    Section{"mechanics", read_mechanics},
    Section{"contacts", read_contacts},
    Section{"outputs", read_outputs},
    Section{"events", read_events},
    Section{"tables", read_tables},
    Section{"simulate", read_simulate},
    Section{"optimize", read_optimize},
    Section{"time_freezing", read_time_freezing},
};

struct LaterTable {
  std::string_view name;
  std::string_view written;
};
constexpr std::array later_tables{
    LaterTable{"sensitivity", "[sensitivity]"},
};

std::vector<std::string> known_tables() {
  std::vector<std::string> names;
  for (const auto& section : sections) names.emplace_back(section.name);
  return names;
}

void read_section(TomlReader& reader, const TomlEntry& entry, ModelFile& model) {
  for (const auto& section : sections) {
    if (section.name != entry.key) continue;
    constexpr std::array arrays{"events", "modes", "jumps", "hysteresis", "contacts"};
    const bool is_array = contains(arrays, entry.key);
    reader.enter(is_array ? fmt::format("[[{}]]", entry.key) : fmt::format("[{}]", entry.key));
    section.read(reader, entry, model);
    reader.enter("");
    return;
  }
  for (const auto& table : later_tables) {
    if (table.name == entry.key) reader.not_available(entry.location, table.written);
  }
  if (entry.key == "inputs") {
    reader.fail({ErrorCode::unknown_name,
                 "unknown table [inputs]",
                 "controls are declared under [controls]; what they are during a simulation stands under [simulate]: "
                 "inputs = { u = \"sin(t)\" }",
                 entry.location,
                 {}});
    return;
  }
  const bool is_table =
      std::holds_alternative<TomlTable>(entry.value.value) || std::holds_alternative<TomlArray>(entry.value.value);
  reader.fail({ErrorCode::unknown_name,
               is_table ? fmt::format("unknown table [{}]", entry.key)
                        : fmt::format("unknown key '{}' outside of all tables", entry.key),
               suggest_word(entry.key, known_tables()),
               entry.location,
               {}});
}

Error freezing_mistake(std::string message, std::string remedy, const SourceLocation& location) {
  return with_context({ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {}},
                      "in [time_freezing]");
}

/// Contacts and hysteresis have a clock of their own.
Expected<void> check_own_clock(const model::Description& description) {
  if (!description.clock || description.clock->clock.empty()) return {};
  const char* beside = description.contacts.empty() ? "[[hysteresis]]" : "[[contacts]]";
  return tl::unexpected(freezing_mistake(fmt::format("`clock` beside {}", beside),
                                         "leave it out: they have a clock of their own", description.clock->location));
}

/// The clock of [time_freezing] is a state.
Expected<void> check_clock(const model::Description& description) {
  if (!description.contacts.empty() || !description.hysteresis.empty()) return check_own_clock(description);
  if (!description.clock) return {};
  if (description.clock->clock.empty()) {
    return tl::unexpected(freezing_mistake("[time_freezing] names no clock",
                                           "write clock = \"tau\", the state that is physical time",
                                           description.clock->location));
  }
  std::vector<std::string> states;
  for (const auto& state : description.states) states.push_back(state.name);
  if (contains(states, description.clock->clock)) return {};
  return tl::unexpected(with_context({ErrorCode::unknown_name,
                                      fmt::format("the clock '{}' is no state", description.clock->clock),
                                      suggest(description.clock->clock, states),
                                      description.clock->location,
                                      {}},
                                     "in [time_freezing]"));
}

enum class AfterMistake { stop, read_on };

/// Reads the tables into the model; returns the mistakes.
std::vector<Error> read_document(const TomlTable& document, ModelFile& model, AfterMistake after) {
  const auto& file = model.description.file;
  TomlReader reader(file, model.files);
  reader.set_functions(table_names(document), value_names(document));
  for (const auto& entry : document) {
    model.table_locations.emplace_back(entry.key, entry.location);
    read_section(reader, entry, model);
    if (!reader.errors().empty() && after == AfterMistake::stop) return reader.errors();
  }
  auto errors = reader.errors();
  if (std::none_of(document.begin(), document.end(), [](const auto& entry) { return entry.key == "model"; })) {
    errors.push_back({ErrorCode::parse_failure,
                      "the model has no table [model] with a name",
                      "begin the file with [model] and name = \"my-model\"",
                      {file, 1, 1},
                      {}});
  }
  if (auto fits = check_clock(model.description); !fits) errors.push_back(fits.error());
  return errors;
}

/// Takes what is no TOML out of a line, so that the rest can be read: the value of its key, then the line. False if
/// that cannot help. `is_whole` becomes false if the line has a name that cannot be read.
bool withdraw(std::string& text, int line, int attempt, bool& is_whole) {
  std::size_t begin = 0;
  for (int i = 1; i < line && begin != std::string::npos; ++i) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (line < 1 || begin >= text.size() || attempt > 1) return false;
  const auto end = std::min(text.find('\n', begin), text.size());
  const std::string_view content = std::string_view(text).substr(begin, end - begin);
  const auto equal = content.find('=');
  if (equal == std::string_view::npos || content.substr(0, equal).find_first_of("[{\"'#") != std::string_view::npos) {
    return false;
  }
  // A date is no value of any key: whoever reads it complains, in a line of which that is known.
  constexpr std::string_view date = " 0001-01-01";
  std::string instead;
  if (attempt == 0) {
    instead = fmt::format("{}{}", content.substr(0, equal + 1), date);
  } else if (!is_plain_name(trimmed(content.substr(0, equal), " \t"))) {
    instead = fmt::format("line_{} ={}", line, date);
    is_whole = false;
  }
  text.replace(begin, end - begin, instead);
  return true;
}

/// The document, with the lines that are no TOML taken out; their errors go into the diagnosis.
Expected<TomlTable> parse_in_parts(std::string text, const std::string& file, Diagnosis& diagnosis) {
  auto& errors = diagnosis.errors;
  constexpr std::size_t most_errors = 20;
  auto document = parse_toml(text, file);
  int attempt = 0;
  while (!document && errors.size() < most_errors) {
    const Error error = document.error();
    const bool again = !errors.empty() && errors.back().location.line == error.location.line;
    attempt = again ? attempt + 1 : 0;
    if (!again) errors.push_back(error);
    if (!withdraw(text, error.location.line, attempt, diagnosis.model.is_whole)) break;
    document = parse_toml(text, file);
  }
  return document;
}

bool is_before(const Error& a, const Error& b) {
  return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
}

}  // namespace

Expected<ModelFile> parse_model(std::string_view text, const std::string& file, std::vector<result::NamedFile> files) {
  const auto document = parse_toml(text, file);
  if (!document) return tl::unexpected(document.error());
  ModelFile model;
  model.description.file = file;
  model.text = text;
  model.sha256 = sha256(text);
  model.files = std::move(files);
  const auto errors = read_document(*document, model, AfterMistake::stop);
  if (!errors.empty()) return tl::unexpected(errors.front());
  return model;
}

Diagnosis diagnose_model(std::string_view text, const std::string& file) {
  Diagnosis diagnosis;
  auto& model = diagnosis.model;
  auto& errors = diagnosis.errors;  // no structured binding: clang 14 takes none into a lambda
  model.description.file = file;
  model.sha256 = sha256(text);
  const auto document = parse_in_parts(std::string(text), file, diagnosis);
  if (!document) return diagnosis;
  const std::vector<Error> syntax = errors;
  const auto known = [&](const Error& error) {
    const auto same_line = [&](const Error& other) { return other.location.line == error.location.line; };
    const auto same = [&](const Error& other) { return same_place(other.location, error.location); };
    return std::any_of(syntax.begin(), syntax.end(), same_line) || std::any_of(errors.begin(), errors.end(), same);
  };
  const auto add = [&](const std::vector<Error>& found) {
    for (const auto& error : found) {
      if (!known(error)) errors.push_back(error);
    }
  };
  add(read_document(*document, model, AfterMistake::read_on));
  add(model::find_mistakes(model.description, model.is_whole));
  std::stable_sort(errors.begin(), errors.end(), is_before);
  return diagnosis;
}

namespace {

constexpr std::size_t most_read = std::size_t{64} << 20;  // of what has no size, like a pipe

/// No TOML begins with a brace.
bool is_stored_result(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

Expected<ModelText> model_in_result(const std::string& text, const std::string& file) {
  auto stored = parse_result(text, file);
  if (!stored) return tl::unexpected(stored.error());
  auto& record = stored->model;
  if (record.text.empty()) {
    return tl::unexpected(Error{ErrorCode::io_failure,
                                "this result does not contain its model",
                                fmt::format("run the model file of '{}' itself", record.name),
                                {file, 0, 0},
                                {}});
  }
  return ModelText{std::move(record.file), std::move(record.text), std::move(record.files), std::move(record.settings)};
}

/// Whether the file is too large for a model, and no result.
bool is_too_large(const std::filesystem::path& file) {
  std::error_code unknown_size;
  const auto size = std::filesystem::file_size(file, unknown_size);
  if (unknown_size || size <= max_model_bytes) return false;
  std::string begin(16, '\0');
  std::ifstream(file).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return !is_stored_result(begin);
}

}  // namespace

Expected<ModelFile> read_model(const std::filesystem::path& file) {
  auto text = read_model_text(file);
  if (!text) return tl::unexpected(text.error());
  return parse_model(text->text, text->name, std::move(text->files));
}

Expected<ModelText> read_model_text(const std::filesystem::path& file) {
  if (is_too_large(file)) {
    return tl::unexpected(
        Error{ErrorCode::io_failure,
              fmt::format("the file is too large for a model: {} bytes", std::filesystem::file_size(file)),
              fmt::format("a model file has at most {} bytes", max_model_bytes),
              {file.string(), 0, 0},
              {}});
  }
  auto text = file == "-" ? read_file("/dev/stdin", most_read) : read_file(file);
  if (!text) return tl::unexpected(text.error());
  // Standard input is in the working folder, as far as files beside it are concerned.
  const std::string name = file == "-" ? "<standard input>" : file.string();
  if (auto other = other_format(*text, name)) return tl::unexpected(std::move(*other));
  if (is_stored_result(*text) && file.extension() != ".toml") {
    auto stored = model_in_result(*text, name);
    if (stored) stored->path = file.string();
    return stored;
  }
  return ModelText{name, std::move(*text), {}, {}, file.string()};
}

Error located(Error error, const ModelFile& model) {
  if (!error.location.file.empty()) return error;
  for (const auto& frame : error.context) {
    if (!frame.starts_with("in [") || !frame.ends_with(']')) continue;
    error.location = {model.description.file, 1, 1};
    for (const auto& [table, location] : model.table_locations) {
      if (frame == fmt::format("in [{}]", table)) error.location = location;
    }
  }
  for (const auto& contact : model.description.contacts) {
    if (contains(error.context, fmt::format("in [[contacts]] {}", contact.name)))
      error.location = contact.gap->location;
  }
  for (const auto& [key, location] : model.option_locations) {
    const auto frame = fmt::format("in simulate.{}", key);
    if (contains(error.context, frame)) error.location = location;
  }
  for (const auto& [key, location] : model.optimize_locations) {
    const auto frame = fmt::format("in optimize.{}", key);
    if (contains(error.context, frame)) error.location = location;
  }
  return error;
}

Expected<void> check_options(const ModelFile& model) {
  auto problem = pipeline::find_problem(model.simulate);
  if (!problem) return {};
  // Of a file that states nothing it is not said first that it has no end time: that it has no states comes next.
  const auto& stated = model.description;
  if (problem->key == "until" && stated.states.empty() && stated.outputs.empty() && stated.events.empty() &&
      stated.hysteresis.empty()) {
    return {};
  }
  auto& error = problem->error;
  error.location = {model.description.file, 1, 1};
  for (const auto& [table, location] : model.table_locations) {
    if (table == "simulate") error.location = location;
  }
  for (const auto& [key, location] : model.option_locations) {
    if (key == problem->key) error.location = location;
  }
  return tl::unexpected(with_context(std::move(error), "in [simulate]"));
}

}  // namespace saltus::io
