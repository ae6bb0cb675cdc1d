// How large an expression may be. The limits keep every recursion over a tree, ours and the model's, within the stack.
#pragma once

#include <cstddef>

namespace saltus::expression {

/// A thousand lines; what is longer is data and belongs into a table. Ten times as much would still parse in
/// milliseconds, but messages that quote it would not help anybody.
inline constexpr std::size_t max_text_size = 65536;

/// Parentheses, calls, signs, nots and exponents inside each other. One level costs the parser up to seven pairs of
/// calls: below 2 MB of stack with AddressSanitizer, below 0.5 MB without.
inline constexpr int max_nesting = 200;

/// Nodes on the longest way down. The sum of n terms leans to the left and is n nodes high, without any nesting; trees
/// are destroyed, printed and translated recursively, a few hundred bytes to a kilobyte of stack per node.
inline constexpr int max_height = 1000;

}  // namespace saltus::expression
