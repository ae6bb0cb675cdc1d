// What a page has not: Ipopt, and with it the methods that solve nonlinear programs, and other processes.
#include <cerrno>
#include <spawn.h>

#include "saltus/pipeline/simulate/methods_internal.hpp"

namespace saltus::pipeline {
namespace {

Error only_elsewhere() {
  return {ErrorCode::not_available,
          "method = \"fesd\" and \"timestepping\" need Ipopt, which is not in this page",
          "method = \"event\" or \"smoothed\" here, or install Saltus",
          {},
          {}};
}

}  // namespace

Expected<result::Result> simulate_elements(const Simulation&) { return tl::unexpected(only_elsewhere()); }
Expected<result::Result> simulate_frozen(const Simulation&) { return tl::unexpected(only_elsewhere()); }

}  // namespace saltus::pipeline

/// The library declares it and has none. Who starts a compiler is told that there is none.
extern "C" int posix_spawnp(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*,
                            char* const[], char* const[]) {
  return ENOSYS;
}
