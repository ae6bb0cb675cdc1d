// What the tool tells the shell.
#pragma once

namespace saltus::cli {

enum class ExitCode : int {
  done = 0,
  internal_error = 1,
  different = 1,      ///< of diff: the results differ
  bad_input = 2,      ///< nothing was computed or written
  stopped_early = 3,  ///< what was computed is written; the status says why
};

}  // namespace saltus::cli
