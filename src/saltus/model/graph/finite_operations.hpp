// Which operations of expressions need no guard.
#pragma once

namespace saltus::model {

/// Returns whether an operation (casadi::Operation) gives finite results for finite arguments of moderate size.
[[nodiscard]] bool stays_finite(int operation);

}  // namespace saltus::model
