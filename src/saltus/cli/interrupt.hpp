// Ctrl-C: stop at the next step; a second one kills.
#pragma once

namespace saltus::cli {

/// From now on the first SIGINT only makes `interrupted` true; the next one ends the process as if nothing was set.
void catch_interrupt();

/// Whether SIGINT arrived since catch_interrupt.
[[nodiscard]] bool interrupted();

}  // namespace saltus::cli
