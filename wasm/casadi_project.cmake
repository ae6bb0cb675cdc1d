# Included by CasADi's own project (CMAKE_PROJECT_INCLUDE): these of its sources cannot be joined with others.
set(alone sx_instantiator.cpp dm_instantiator.cpp im_instantiator.cpp)
list(TRANSFORM alone PREPEND ${CMAKE_SOURCE_DIR}/casadi/core/)
# Deferred: the folder has its sources then. Its arguments are taken when they are evaluated, the list now.
string(JOIN " " files ${alone})
cmake_language(EVAL CODE "cmake_language(DEFER CALL set_source_files_properties ${files}
  DIRECTORY ${CMAKE_SOURCE_DIR}/casadi/core PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)")
