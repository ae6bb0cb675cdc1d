#include "saltus/cli/text/terminal.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

namespace saltus::cli {
namespace {

int lost = 0;  // errno of the first write to standard output that failed

/// Colours are for people: on a terminal that shows them, unless NO_COLOR is set to anything (no-color.org).
bool has_colours(int stream) {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(stream) != 0 && (refused == nullptr || *refused == '\0') &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

/// The line with its first "error:" in red, or its first "warning:" in yellow.
std::string coloured(std::string_view line) {
  std::string text(line);
  for (const auto& [word, code] : {std::pair{"error:", "31"}, std::pair{"warning:", "33"}}) {
    const auto place = text.find(word);
    if (place == std::string::npos) continue;
    return text.replace(place, std::string_view(word).size(), fmt::format("\x1b[1;{}m{}\x1b[0m", code, word));
  }
  return text;
}

}  // namespace

void print(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && lost == 0 && errno != EPIPE) lost = errno;
}

std::optional<Error> lost_output() {
  if (lost == 0) return std::nullopt;
  return Error{ErrorCode::io_failure,
               fmt::format("cannot write to standard output: {}", std::strerror(lost)),
               "files that were asked for are complete",
               {},
               {}};
}

void print_error(std::string_view line) {
  static const bool colours = has_colours(STDERR_FILENO);
  const std::string text = colours ? coloured(line) : std::string();
  if (colours) line = text;
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fputc('\n', stderr);
}

ExitCode refuse(const Error& error) {
  print_error(to_text(error));
  return ExitCode::bad_input;
}

}  // namespace saltus::cli
