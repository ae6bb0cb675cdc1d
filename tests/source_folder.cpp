#include "source_folder.hpp"

namespace saltus::tests {

std::filesystem::path source_folder(std::string_view below) { return std::filesystem::path(SALTUS_SOURCE_DIR) / below; }

}  // namespace saltus::tests
