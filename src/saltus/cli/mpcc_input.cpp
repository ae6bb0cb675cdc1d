#include "saltus/cli/mpcc_input.hpp"

#include <cstdint>
#include <filesystem>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "saltus/foreign/parse.hpp"
#include "saltus/io/atomic_file.hpp"
#include "saltus/io/option_text.hpp"
#include "saltus/io/sha256.hpp"
#include "saltus/pipeline/mpcc/solve_mpcc.hpp"
#include "saltus/pipeline/options/mpcc_options.hpp"

namespace saltus::cli {
namespace {

/// What AMPL may have written beside an .nl file.
foreign::Names names_beside(const std::string& file) {
  const auto text_of = [&](const char* suffix) {
    const auto path = std::filesystem::path(file).replace_extension(suffix);
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return std::string();
    return io::read_file(path).value_or("");
  };
  return {text_of(".col"), text_of(".row")};
}

Expected<void> set_time_limit(solver::SolveOptions& options, std::string_view text, const std::string& written) {
  const auto value = io::option_value(text);
  const auto* real = std::get_if<double>(&value);
  const auto* whole = std::get_if<std::int64_t>(&value);
  options.time_limit = real != nullptr ? *real : whole != nullptr ? static_cast<double>(*whole) : -1.0;
  if (*options.time_limit > 0.0) return {};
  return tl::unexpected(Error{ErrorCode::invalid_option,
                              fmt::format("expected a number of seconds > 0, found {}", text),
                              "",
                              {written, 0, 0},
                              {}});
}

}  // namespace

Expected<MpccInput> read_mpcc(const std::string& file) {
  const auto text = io::read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto problem = foreign::parse(*text, file, names_beside(file));
  if (!problem) return tl::unexpected(problem.error());
  return MpccInput{std::move(*problem), io::sha256(*text)};
}

Expected<void> set_mpcc_option(solver::SolveOptions& options, std::string_view key, std::string_view value,
                               const std::string& written) {
  if (key == "time_limit") return set_time_limit(options, value, written);
  auto done = pipeline::set_mpcc_option(options, key, io::option_value(value));
  if (!done) done.error().location = {written, 0, 0};
  return done;
}

}  // namespace saltus::cli
