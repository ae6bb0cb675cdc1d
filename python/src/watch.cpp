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
  if (came_) return true;
  const auto now = Clock::now();
  if (now < next_) return false;
  next_ = now + interval;
  const nb::gil_scoped_acquire held;
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (step != nullptr && !progress_.is_none()) {
      progress_(step->t, step->from, step->until, step->steps, step->events);
    }
  } catch (nb::python_error& error) {
    came_.emplace(std::move(error));
    return true;
  }
  return false;
}

void Watch::call(const nb::object& function, const std::string& line) {
  if (came_) return;
  const nb::gil_scoped_acquire held;
  try {
    function(nb::str(line.c_str()));
  } catch (nb::python_error& error) {
    came_.emplace(std::move(error));
  }
}

void Watch::raise_what_came(const nb::object& result) {
  if (!came_) return;
  const nb::object exception = nb::borrow(came_->value());
  exception.attr("result") = result;
  throw nb::python_error(std::move(*came_));
}

}  // namespace saltus::python
