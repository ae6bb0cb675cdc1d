# Run by CTest with -P: install, move, find_package, build, run. Any step that fails ends the test.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${work_dir}/first ${work_dir}/prefix ${work_dir}/build)
run(${CMAKE_COMMAND} --install ${binary_dir} --prefix ${work_dir}/first)
# A package is relocatable if it still works after a move, and says nothing of the machine that built it.
file(RENAME ${work_dir}/first ${work_dir}/prefix)
file(GLOB_RECURSE package_files ${work_dir}/prefix/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "the installation holds no CMake package")
endif()
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  foreach(folder ${source_dir} ${binary_dir} ${work_dir})
    string(FIND "${text}" "${folder}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} names ${folder}: not relocatable")
    endif()
  endforeach()
endforeach()
file(GLOB_RECURSE private_headers ${work_dir}/prefix/*_internal.hpp)
if(private_headers)
  message(FATAL_ERROR "private headers were installed: ${private_headers}")
endif()

# build_and_run(NAME FOLDER): configures, builds and runs a project that uses the installation; its output in `output`.
function(build_and_run name folder)
  run(${CMAKE_COMMAND} -S ${folder} -B ${work_dir}/build/${name} -G ${generator}
    -D CMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror" -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_CXX_COMPILER_LAUNCHER=${launcher}
    "-DCMAKE_PREFIX_PATH=${work_dir}/prefix\;${casadi_dir}" -D wanted_version=${version})
  run(${CMAKE_COMMAND} --build ${work_dir}/build/${name})
  run(${work_dir}/build/${name}/${name})
  set(output "${output}" PARENT_SCOPE)
endfunction()

# CasADi of the active Python, the first one in PATH, is found by itself; where it has none, one sentence says where it
# was expected. The next try in the same folder may have another Python.
function(configure_with_python path)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=VIRTUAL_ENV --unset=CONDA_PREFIX "PATH=${path}:$ENV{PATH}"
    ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${work_dir}/build/python -G ${generator}
    -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_PREFIX_PATH=${work_dir}/prefix -D wanted_version=${version}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(result "${result}" PARENT_SCOPE)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(output "${output}" PARENT_SCOPE)
endfunction()
set(without ${work_dir}/build/without/bin)
file(WRITE ${without}/python3 "#!/bin/sh\necho /nowhere/casadi/cmake\n")
file(CHMOD ${without}/python3 PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
configure_with_python(${without})
if(result EQUAL 0 OR NOT output MATCHES "CasADi was expected in .* the active Python \\(/nowhere/casadi/cmake\\) .* pip install")
  message(FATAL_ERROR "find_package without CasADi said\n${output}")
endif()
if(EXISTS ${source_dir}/.venv/bin/python3)
  configure_with_python(${source_dir}/.venv/bin)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "find_package did not find CasADi of the active Python:\n${output}")
  endif()
endif()

build_and_run(consumer ${CMAKE_CURRENT_LIST_DIR}/project)
build_and_run(first_simulation ${source_dir}/examples/01_first_simulation)
if(NOT output MATCHES "t = 1\\.2001[0-9]+  enter_sliding" OR NOT output MATCHES "at rest at x = 1\\.8920")
  message(FATAL_ERROR "examples/01_first_simulation printed\n${output}")
endif()

build_and_run(small_mpcc ${source_dir}/examples/02_small_mpcc)
if(NOT output MATCHES "completed: f = 1 at")
  message(FATAL_ERROR "examples/02_small_mpcc printed\n${output}")
endif()

# Installed, it runs without CasADi's folder.
build_and_run(embedded ${source_dir}/examples/03_embedded)
run(${CMAKE_COMMAND} --install ${work_dir}/build/embedded --prefix ${work_dir}/build/embedded_installed)
run(${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH ${work_dir}/build/embedded_installed/bin/embedded)
foreach(expected "x\\(0.5\\) = 1\\.22" "the same end: yes" "the same in threads: yes" "was built for mu = 0")
  if(NOT output MATCHES "${expected}")
    message(FATAL_ERROR "examples/03_embedded printed\n${output}")
  endif()
endforeach()

build_and_run(optimal_control ${source_dir}/examples/04_optimal_control)
if(NOT output MATCHES "completed: T = 13\\.3333.*completed: T = 13\\.[0-9]+ with [0-9]+ instead")
  message(FATAL_ERROR "examples/04_optimal_control printed\n${output}")
endif()

foreach(file LICENSE CITATION.cff docs/python.md examples/01_first_simulation/main.cpp)
  if(NOT EXISTS ${work_dir}/prefix/share/doc/saltus/${file})
    message(FATAL_ERROR "share/doc/saltus/${file} was not installed")
  endif()
endforeach()

# The installed tool has no other library path than its own, and finds the catalogue and plotly beside itself.
if(EXISTS ${work_dir}/prefix/bin/saltus)
  set(tool ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH --unset=SALTUS_MODELS --unset=SALTUS_PLOTLY
    ${work_dir}/prefix/bin/saltus)
  run(${tool} --version)
  if(NOT output MATCHES "${version}")
    message(FATAL_ERROR "saltus --version says '${output}', expected ${version}")
  endif()
  run(${tool} simulate stick-slip --quiet --out ${work_dir}/build/result.json --report ${work_dir}/build/report.html)
endif()
