// How long something takes. Nothing but time limits and statistics depends on it.
#pragma once

#include <chrono>

namespace saltus {

class Stopwatch {
 public:
  /// Returns the wall time since it was made.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace saltus
