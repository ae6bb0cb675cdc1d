#include "saltus/cli/terminal.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fmt/format.h>

namespace saltus::cli {
namespace {

int lost = 0;  // errno of the first write to standard output that failed

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
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fputc('\n', stderr);
}

ExitCode refuse(const Error& error) {
  print_error(to_text(error));
  return ExitCode::bad_input;
}

}  // namespace saltus::cli
