# saltus_wheel::ipopt: the libipopt and its headers that lie beside CasADi's library, and SALTUS_IPOPT_LIBRARIES: all the
# files that an installation needs of it. Needs the target casadi::casadi; used by the build and by the installed package.
# Never another libipopt of the system: two of them in one process end in each other's memory.
if(TARGET saltus_wheel::ipopt)
  return()
endif()
get_target_property(saltus_casadi_library casadi::casadi IMPORTED_LOCATION_RELEASE)
if(NOT saltus_casadi_library)
  get_target_property(saltus_casadi_library casadi::casadi LOCATION)
endif()
get_filename_component(saltus_casadi_folder "${saltus_casadi_library}" DIRECTORY)
if(APPLE)
  set(saltus_ipopt_name libipopt.3.dylib)
  set(saltus_ipopt_needs libcoinmumps.3.dylib libcoinmetis.2.dylib libgfortran.5.dylib libquadmath.0.dylib libgcc_s.1.1.dylib)
else()
  set(saltus_ipopt_name libipopt.so.3)
  set(saltus_ipopt_needs libcoinmumps.so.3 libcoinmetis.so.2 libcasadi-tp-openblas.so.0 libgfortran-*.so.* libquadmath-*.so.*)
endif()
set(saltus_ipopt_file ${saltus_casadi_folder}/${saltus_ipopt_name})
set(saltus_ipopt_headers ${saltus_casadi_folder}/include/coin-or)
if(EXISTS ${saltus_ipopt_file} AND EXISTS ${saltus_ipopt_headers}/IpIpoptApplication.hpp)
  add_library(saltus_wheel::ipopt SHARED IMPORTED)
  set_target_properties(saltus_wheel::ipopt PROPERTIES IMPORTED_LOCATION ${saltus_ipopt_file}
    IMPORTED_SONAME ${saltus_ipopt_name} INTERFACE_INCLUDE_DIRECTORIES ${saltus_ipopt_headers})
  # What it needs lies in the same folder and is found by its own RPATH, $ORIGIN.
  list(TRANSFORM saltus_ipopt_needs PREPEND ${saltus_casadi_folder}/)
  file(GLOB SALTUS_IPOPT_LIBRARIES ${saltus_ipopt_file} ${saltus_ipopt_needs})
endif()
