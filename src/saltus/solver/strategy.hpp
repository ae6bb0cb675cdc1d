// How problems with complementarities are solved.
#pragma once

namespace saltus::solver {

/// Names how the relaxed problems are solved.
enum class Strategy {
  structured,  ///< all in one loop of the interior-point method, with factors in the order of the problem
  ipopt,       ///< one after the other, as Ipopt with MUMPS does
};

}  // namespace saltus::solver
