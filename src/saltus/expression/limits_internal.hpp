// How large an expression may be. The limits keep every recursion over a tree, ours and the model's, within the stack.
#pragma once

#include <cstddef>

namespace saltus::expression {

/// A thousand lines; what is longer is data and belongs into a table. Ten times as much would still parse in
/// milliseconds, but messages that quote it would not help anybody.
inline constexpr std::size_t max_text_size = 65536;

/// Parentheses, calls, signs, nots and exponents inside each other. One level costs the parser up to six pairs of
/// calls; measured at the limit: 1.2 MB of stack with AddressSanitizer, 0.4 MB without.
inline constexpr int max_nesting = 200;

/// Nodes on the longest way down. The sum of n terms leans to the left and is n nodes high, without any nesting; trees
/// are destroyed, printed and translated by recursion. Measured for to_text at the limit: 0.7 MB of stack with
/// AddressSanitizer; leaves a translator several kilobytes per node.
inline constexpr int max_height = 1000;

}  // namespace saltus::expression
