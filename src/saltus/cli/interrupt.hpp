// Ctrl-C: stop at the next step; a second one kills.
#pragma once

namespace saltus::cli {

/// Lets the first SIGINT only make `interrupted` true; the next one ends the process as if nothing was set.
void catch_interrupt();

/// Returns whether SIGINT arrived since catch_interrupt.
[[nodiscard]] bool interrupted();

}  // namespace saltus::cli
