// A stop that a person asks for, heeded inside of long loops.
#pragma once

#include <chrono>
#include <exception>
#include <functional>

namespace saltus {

/// Is thrown out of a loop whose run is to stop; whoever has the StopScope catches it and keeps what there is.
struct Stopped : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "stopped"; }
};

/// Says for this thread, as long as it lives, whom loops ask whether they are to stop. Scopes nest: the last one
/// counts.
class StopScope {
 public:
  using Clock = std::chrono::steady_clock;
  /// How long a person waits without noticing.
  static constexpr Clock::duration usual_pause = std::chrono::milliseconds(50);

  /// @param is_wanted  asked at most once in a `pause`; empty: never
  explicit StopScope(std::function<bool()> is_wanted, Clock::duration pause = usual_pause);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  friend void heed_stop();
  std::function<bool()> is_wanted_;
  Clock::duration pause_;
  Clock::time_point asked_ = Clock::now();
  StopScope* outer_;
};

/// Throws Stopped where this thread's run is to stop. To be called in each round of a loop that may last. Cost: a look
/// at the clock.
void heed_stop();

}  // namespace saltus
