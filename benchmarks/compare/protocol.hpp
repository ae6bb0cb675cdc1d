// What every C++ program of the comparison takes and prints: PROBLEM METHOD VARIANT SECONDS TOLERANCE…, one JSON object
// a line.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <time.h>
#include <utility>
#include <vector>

namespace compare {

struct Tolerances {
  double rtol = 1e-8;
  double atol = 1e-10;
};

/// One integration from the start to the end of a problem.
struct Run {
  std::string status = "completed";
  std::vector<double> x;       ///< at the end
  std::vector<double> events;  ///< times of all changes of mode
  long steps = 0;
  long evaluations = 0;  ///< of the right-hand side
};

struct Request {
  std::string problem, method, variant;
  double seconds = 0.2;  ///< to spend on each tolerance
  std::vector<double> tolerances;
};

struct Timing {
  double median = 0.0;
  long repeats = 0;
};

/// Time this process has computed: what other processes do on the machine does not count.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Median time of calls of `body`, repeated until the seconds are used up: at least 3 times, at most 2001 times.
template <class Body>
Timing median_time(double seconds, Body&& body) {
  body();  // caches and branch predictors
  std::vector<double> times;
  const double start = cpu_seconds();
  double now = start;
  while (times.size() < 3 || (now - start < seconds && times.size() < 2001)) {
    const double begin = now;
    body();
    now = cpu_seconds();
    times.push_back(now - begin);
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return {*middle, static_cast<long>(times.size())};
}

inline std::string json_numbers(const std::vector<double>& values) {
  std::string text;
  char number[40];
  for (const double value : values) {
    std::snprintf(number, sizeof number, "%s%.17g", text.empty() ? "" : ",", value);
    text += number;
  }
  return "[" + text + "]";
}

/// `extra`: further members of the object, each with a leading comma.
inline void print(const Request& request, double tolerance, const Timing& timing, const Run& run,
                  const std::string& extra = {}) {
  std::printf(
      "{\"problem\":\"%s\",\"method\":\"%s\",\"variant\":\"%s\",\"tolerance\":%.17g,\"seconds\":%.17g,\"repeats\":%ld,"
      "\"status\":\"%s\",\"steps\":%ld,\"evaluations\":%ld,\"x\":%s,\"events\":%s%s}\n",
      request.problem.c_str(), request.method.c_str(), request.variant.c_str(), tolerance, timing.median,
      timing.repeats, run.status.c_str(), run.steps, run.evaluations, json_numbers(run.x).c_str(),
      json_numbers(run.events).c_str(), extra.c_str());
  std::fflush(stdout);
}

inline Request request_from(int count, char** arguments) {
  if (count < 6) {
    std::fprintf(stderr, "usage: %s PROBLEM METHOD VARIANT SECONDS TOLERANCE…\n", arguments[0]);
    std::exit(2);
  }
  Request request{arguments[1], arguments[2], arguments[3], std::atof(arguments[4]), {}};
  for (int i = 5; i < count; ++i) request.tolerances.push_back(std::atof(arguments[i]));
  return request;
}

[[noreturn]] inline void unknown(const Request& request) {
  std::fprintf(stderr, "no such case: %s %s %s\n", request.problem.c_str(), request.method.c_str(),
               request.variant.c_str());
  std::exit(2);
}

}  // namespace compare
