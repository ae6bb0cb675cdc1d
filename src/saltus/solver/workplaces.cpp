#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/solver/workplaces_internal.hpp"

namespace saltus::solver {

void share_out(const Place& own, const SolveOptions& options, int count, FunctionRef<void(int, const Place&)> task) {
  std::atomic<int> next = 0;
  std::atomic<bool> is_stopped = false;
  const auto ask = [&] {
    if (options.is_interrupted && options.is_interrupted()) is_stopped = true;
    return is_stopped.load();
  };
  const auto hear = [&] { return is_stopped.load(); };
  const auto work = [&](const Place& place) {
    for (int i = next++; i < count; i = next++) task(i, place);
  };
  // Functions are only evaluated, and whoever is asked may want the lock.
  const SymbolicPause pause;
  const auto work_elsewhere = [&] {
    std::optional<Workplace> place;
    {
      const SymbolicLock lock;
      if (next < count) place = options.make_workplace();
    }
    if (place) work({*place->problem, *place->nlp, *place->lpcc, hear});
    const SymbolicLock lock;
    place.reset();
  };
  std::vector<std::future<void>> threads;
  const int others = options.make_workplace ? std::min(count, options.threads) - 1 : 0;
  for (int k = 0; k < others; ++k) threads.push_back(std::async(std::launch::async, work_elsewhere));
  work({own.problem, own.nlp, own.lpcc, ask});
  constexpr auto between_questions = std::chrono::milliseconds(20);
  for (auto& thread : threads) {
    while (thread.wait_for(between_questions) != std::future_status::ready) static_cast<void>(ask());
    thread.get();  // what it has thrown
  }
}

}  // namespace saltus::solver
