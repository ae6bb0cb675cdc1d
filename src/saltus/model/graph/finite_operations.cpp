#include "saltus/model/graph/finite_operations.hpp"

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

namespace saltus::model {

bool stays_finite(int operation) {
  switch (operation) {
    case casadi::OP_ADD:
    case casadi::OP_SUB:
    case casadi::OP_MUL:
    case casadi::OP_NEG:
    case casadi::OP_SQ:
    case casadi::OP_TWICE:
    case casadi::OP_SIN:
    case casadi::OP_COS:
    case casadi::OP_ATAN:
    case casadi::OP_TANH:
      return true;
    default:
      return false;
  }
}

}  // namespace saltus::model
