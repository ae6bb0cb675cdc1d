#include "saltus/event_integrator/solution.hpp"

#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/record/pieces.hpp"
#include "saltus/event_integrator/record/recorder.hpp"

namespace saltus::event_integrator {

struct Solution::Implementation {
  Implementation(std::shared_ptr<const Pieces> of, evaluation::ModelKernel of_it)
      : pieces(std::move(of)),
        kernel(std::move(of_it)),
        field(kernel, kernel.layout().affine_in_selections),
        contacts(kernel),
        holding(kernel),
        x(at(kernel.states())),
        slope(at(kernel.states())) {
    holding.keep(&contacts);
  }

  bool enter(std::size_t number);
  bool write(double t, Recorder& recorder);

  std::shared_ptr<const Pieces> pieces;
  evaluation::ModelKernel kernel;
  ModeField field;
  Contacts contacts;
  Holding holding;
  std::optional<std::size_t> entered;  ///< mode
  std::vector<double> x, slope;
};

/// As the run did where the mode began; false where its guards cannot be held.
bool Solution::Implementation::enter(std::size_t number) {
  if (entered == number) return true;
  entered.reset();
  const PieceMode& mode = pieces->modes[number];
  if (!holding.put(mode.held)) return false;
  for (std::size_t c = 0; c < mode.cells.size(); ++c) kernel.set_cell(static_cast<int>(c), mode.cells[c]);
  kernel.set_activities(mode.state.activities);
  set_references(kernel, mode.state);
  ModeState state = mode.state;
  state.alpha = mode.start;
  field.enter(state);
  if (!state.sliding.empty()) field(mode.t, mode.x.data(), slope.data());
  entered = number;
  return true;
}

bool Solution::Implementation::write(double t, Recorder& recorder) {
  const Piece* piece = pieces->find(t);
  if (piece == nullptr || !enter(piece->mode)) return false;
  const ModeState& state = pieces->modes[piece->mode].state;
  piece->step.evaluate((t - piece->step.t) / piece->step.h, x.data());
  if (t > piece->step.t) {
    field.project(t, x.data());
    static_cast<void>(holding.project(t, state.alpha, x));
  }
  if (!state.sliding.empty()) field(t, x.data(), slope.data());
  recorder.row(t, x, state, state.sliding.empty() ? state.alpha : field.alpha());
  return true;
}

Solution::Solution(std::shared_ptr<const Pieces> pieces, evaluation::ModelKernel kernel)
    : implementation_(std::make_unique<Implementation>(std::move(pieces), std::move(kernel))) {}
Solution::Solution(Solution&&) noexcept = default;
Solution::~Solution() = default;

result::Trajectory Solution::rows(const std::vector<double>& times) {
  Recorder recorder(implementation_->kernel);
  for (const double t : times) static_cast<void>(implementation_->write(t, recorder));
  return recorder.take().trajectory(implementation_->kernel.layout());
}

}  // namespace saltus::event_integrator
