#include "saltus/base/contracts.hpp"

#include <string>

namespace saltus {

InternalError::~InternalError() = default;

void contract_violation(const char* what, const char* file, int line) {
  throw InternalError(std::string("internal error: ") + what + " (" + file + ":" + std::to_string(line) +
                      "); please report this with the model file");
}

}  // namespace saltus
