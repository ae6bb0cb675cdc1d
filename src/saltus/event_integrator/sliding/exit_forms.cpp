#include "saltus/event_integrator/sliding/exit_forms.hpp"

namespace saltus::event_integrator {

const evaluation::AffineRow* ExitForms::of(int surface, const evaluation::FixedState& fixed,
                                           const std::vector<double>& alpha, const void* motion) {
  if (motion == nullptr) return kernel_.lie_row(surface, fixed, alpha.data(), form_) ? &form_ : nullptr;
  for (const auto& known : known_) {
    if (known.motion == motion && known.surface == surface && known.fixed.component == fixed.component &&
        known.fixed.value == fixed.value && known.alpha == alpha) {
      return &known.form;
    }
  }
  if (!kernel_.lie_row(surface, fixed, alpha.data(), form_)) return nullptr;
  auto& oldest = known_[next_++ % known_.size()];
  oldest.motion = motion;
  oldest.surface = surface;
  oldest.fixed = fixed;
  oldest.alpha = alpha;
  oldest.form = form_;
  return &oldest.form;
}

}  // namespace saltus::event_integrator
