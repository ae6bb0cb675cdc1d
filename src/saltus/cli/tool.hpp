// The command-line tool as a function.
#pragma once

namespace saltus::cli {

/// Runs the tool with the arguments of main(): argv[0] is its name.
/// @return the exit code
[[nodiscard]] int run_tool(int argc, char** argv);

}  // namespace saltus::cli
