#define SALTUS_COMPILES_EIGEN
#include "saltus/linalg/compiled_internal.hpp"
