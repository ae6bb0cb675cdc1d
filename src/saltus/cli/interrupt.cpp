#include "saltus/cli/interrupt.hpp"

#include <csignal>

namespace saltus::cli {
namespace {

// A signal handler can reach nothing but what lives here.
volatile std::sig_atomic_t arrived = 0;

extern "C" void remember_interrupt(int) { arrived = 1; }

}  // namespace

void catch_interrupt() {
  arrived = 0;
  struct sigaction action = {};
  action.sa_handler = remember_interrupt;
  // RESETHAND: the second signal finds the default, which kills.
  action.sa_flags = static_cast<int>(SA_RESETHAND | static_cast<unsigned>(SA_RESTART));
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);  // a queue that wants its machine back
}

bool interrupted() { return arrived != 0; }

}  // namespace saltus::cli
