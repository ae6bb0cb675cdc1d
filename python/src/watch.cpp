#include "watch.hpp"

namespace nb = nanobind;

namespace saltus::python {

pipeline::Observers Watch::observers() {
  pipeline::Observers observers;
  observers.on_step = [this](const pipeline::StepRecord& step) {
    return look(&step) ? pipeline::Proceed::stop : pipeline::Proceed::on;
  };
  return observers;
}

bool Watch::look(const pipeline::StepRecord* step) {
  has_begun_ = has_begun_ || step != nullptr;
  if (came_) return true;
  const auto now = Clock::now();
  if (now < next_) return false;
  next_ = now + interval;
  attempt([&] {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (step != nullptr && !progress_.is_none()) {
      progress_(step->t, step->from, step->until, step->steps, step->events);
    }
  });
  return came_.has_value();
}

bool Watch::goes_on(const Preparation& preparation) {
  if (has_begun_) return true;
  attempt([&] {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress_.is_none() && nb::hasattr(progress_, "prepare")) {
      const std::string phase(preparation.phase);
      progress_.attr("prepare")(nb::str(phase.c_str()), preparation.done, preparation.of);
    }
  });
  return !came_.has_value();
}

void Watch::call(const nb::object& function, const std::string& line) {
  attempt([&] { function(nb::str(line.c_str())); });
}

void Watch::tell(const nb::object& function, double done, double total) {
  const auto now = Clock::now();
  if (now < next_telling_) return;
  next_telling_ = now + 2 * interval;
  attempt([&] { function(done, total); });
}

void Watch::raise_what_came(const nb::object& result) {
  if (!came_) return;
  // A second Ctrl-C meanwhile says the same: it must not take the place of the exception that has the result.
  if (PyErr_CheckSignals() != 0) PyErr_Clear();
  const nb::object exception = nb::borrow(came_->value());
  exception.attr("result") = result;
  throw nb::python_error(std::move(*came_));
}

}  // namespace saltus::python
