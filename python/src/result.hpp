// A result as Python sees it.
#pragma once

#include <memory>
#include <nanobind/nanobind.h>
#include <optional>
#include <string>
#include <vector>

#include "saltus/model/system.hpp"
#include "saltus/result/result.hpp"

namespace saltus::python {

/// Rows of numbers, kept by their changes, as one block that arrays of Python look at.
template <class T>
struct Block {
  std::vector<T> columns;  ///< one after the other
  bool made = false;
};

/// A result, or one of its branches, and the arrays that were asked for. Lives in Python, under the interpreter's lock.
struct Run {
  std::shared_ptr<result::Result> result;       ///< of a branch: into that of its root
  std::shared_ptr<const model::System> system;  ///< null for one that was loaded, and for branches
  Block<double> alpha, theta;
  Block<int> mode;
};

/// An event, and what only its result tells: which way a hysteresis turned, the names of states.
struct RunEvent : result::Event {
  std::optional<std::string> turned;
  std::shared_ptr<const std::vector<std::string>> states;  ///< one list for all events
};

/// An array of Python with its own numbers.
nanobind::object owned_array(std::vector<double> values);

/// Rows of `between`, which is continuous, at any times, as a run with the columns of `run`.
nanobind::object values_at(const Run& run, const Run& between, const std::vector<double>& times, bool before);

std::vector<std::string> words_of(const std::vector<result::ContactMode>& modes);

}  // namespace saltus::python
