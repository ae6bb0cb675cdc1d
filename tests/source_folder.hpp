#pragma once

#include <filesystem>
#include <string_view>

namespace saltus::tests {

/// Gives the path of a file or folder of the source tree. It is a function, not a macro, so that the place of the tree
/// is compiled into one object only and a compiler cache serves every tree.
std::filesystem::path source_folder(std::string_view below = "");

}  // namespace saltus::tests
