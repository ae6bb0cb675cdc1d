#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/solver/workplaces_internal.hpp"

namespace saltus::solver {

void share_out(const Place& own, const SolveOptions& options, int count, FunctionRef<void(int, const Place&)> task) {
  std::vector<Workplace> others;
  while (options.make_workplace && static_cast<int>(others.size()) + 1 < std::min(count, options.threads)) {
    auto made = options.make_workplace();
    if (!made) break;
    others.push_back(std::move(*made));
  }
  std::atomic<int> next = 0;
  const auto work = [&](const Place& place) {
    for (int i = next++; i < count; i = next++) task(i, place);
  };
  // Functions are only evaluated, and the other threads may ask for the lock, to see whether they are interrupted.
  const SymbolicPause pause;
  std::vector<std::jthread> threads;
  for (auto& [problem, nlp, lpcc] : others) {
    threads.emplace_back([&work, place = Place{*problem, *nlp, *lpcc}] { work(place); });
  }
  work(own);
}

}  // namespace saltus::solver
