// libFuzzer target: whatever a model file contains, reading and building it ends with a system or with an error that
// has a message, a remedy and a place in the file; never with an exception, a crash or a hang. Build and run:
// tests/fuzz/README.md.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"

namespace {

constexpr std::string_view file_name = "fuzz.toml";

/// An error within a file that the model names (a table, an input) has that place, and that of the model in its trail.
bool names_the_model(const saltus::Error& error) {
  return error.location.file == file_name ||
         std::any_of(error.context.begin(), error.context.end(), [](const std::string& frame) {
           return frame.starts_with("line ") && frame.ends_with(fmt::format("of {}", file_name));
         });
}

/// Empty if the error is one that helps, else what it lacks.
std::string_view what_lacks(const saltus::Error& error, std::string_view text) {
  const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
  if (error.message.empty()) return "a message";
  if (error.message.find("CasADi") != std::string::npos) return "a cause of our own: CasADi threw";
  if (!names_the_model(error)) return "the file";
  if (error.location.file == file_name && error.location.line > lines) return "a line of the file";
  return "";
}

void stop_if(std::string_view lack, const saltus::Error& error) {
  if (lack.empty()) return;
  std::fprintf(stderr, "the error lacks %.*s:\n%s\n", static_cast<int>(lack.size()), lack.data(),
               saltus::to_text(error).c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto file = saltus::io::parse_model(text, std::string(file_name));
  if (!file) {
    stop_if(what_lacks(file.error(), text), file.error());
    return 0;
  }
  if (const auto checked = saltus::io::check_options(*file); !checked) {
    stop_if(what_lacks(checked.error(), text), checked.error());
  }
  const auto system = saltus::model::build(file->description, {});
  if (system) return 0;
  const auto error = saltus::io::located(system.error(), *file);
  stop_if(error.location.line < 1 ? "a line" : what_lacks(error, text), error);
  return 0;
}
