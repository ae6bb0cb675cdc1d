# The sanitized build by clang 16 where it is there with its runtime (scripts/install.sh sanitize): half of what it costs by
# g++, and a second reader of the sources. Debian's usual clang 14 refuses structured bindings in lambdas.
find_program(SALTUS_CLANG clang++-16)
mark_as_advanced(SALTUS_CLANG)
if(SALTUS_CLANG)
  execute_process(COMMAND ${SALTUS_CLANG} -print-file-name=libclang_rt.asan-x86_64.a OUTPUT_VARIABLE runtime OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(EXISTS "${runtime}")
    set(CMAKE_CXX_COMPILER ${SALTUS_CLANG})
  endif()
endif()
