#include "saltus/cli/terminal.hpp"

#include <cstdio>
#include <string>

namespace saltus::cli {

void print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
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
