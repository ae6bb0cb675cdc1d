// What is done before a run begins, said to who waits for it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "saltus/base/stop.hpp"

namespace saltus {

/// Holds what is under way: "reading the model", and how many of how many parts of it are done.
struct Preparation {
  std::string_view phase{};
  std::size_t done = 0, of = 0;  ///< of = 0: nobody knows

  /// Returns "reading the model: 120 of 200".
  [[nodiscard]] std::string text() const;
};

/// Says for this thread, as long as it lives, who hears of preparations, and whom they ask whether to go on. Scopes
/// nest as those of stops do.
class PreparationScope {
 public:
  /// @param tell  called at most once in StopScope::usual_pause; returns whether to go on
  explicit PreparationScope(std::function<bool(const Preparation&)> tell);
  ~PreparationScope();
  PreparationScope(const PreparationScope&) = delete;
  PreparationScope& operator=(const PreparationScope&) = delete;

 private:
  friend void prepares(std::string_view phase, std::size_t done, std::size_t of);
  std::function<bool(const Preparation&)> tell_;
  Preparation now_;
  StopScope stop_;
  PreparationScope* outer_;
};

/// Notes what is done now, and heeds a stop: throws Stopped where the scope says so. Cost: a look at the clock.
/// @param phase  a literal
void prepares(std::string_view phase, std::size_t done = 0, std::size_t of = 0);

}  // namespace saltus
