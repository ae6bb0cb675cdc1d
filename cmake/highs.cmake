# saltus_wheel::highs: the libhighs and its headers that lie beside CasADi's library, and SALTUS_HIGHS_LIBRARIES: all the
# files that an installation needs of it. Needs the target casadi::casadi; used by the build and by the installed package.
if(TARGET saltus_wheel::highs)
  return()
endif()
get_target_property(saltus_casadi_library casadi::casadi IMPORTED_LOCATION_RELEASE)
if(NOT saltus_casadi_library)
  get_target_property(saltus_casadi_library casadi::casadi LOCATION)
endif()
get_filename_component(saltus_casadi_folder "${saltus_casadi_library}" DIRECTORY)
set(saltus_highs_file ${saltus_casadi_folder}/libhighs.so.1)
set(saltus_highs_headers ${saltus_casadi_folder}/include/highs)
if(EXISTS ${saltus_highs_file} AND EXISTS ${saltus_highs_headers}/Highs.h)
  add_library(saltus_wheel::highs SHARED IMPORTED)
  set_target_properties(saltus_wheel::highs PROPERTIES IMPORTED_LOCATION ${saltus_highs_file}
    IMPORTED_SONAME libhighs.so.1 INTERFACE_INCLUDE_DIRECTORIES ${saltus_highs_headers})
  # What it needs lies in the same folder and is found by its own RPATH, $ORIGIN.
  file(GLOB SALTUS_HIGHS_LIBRARIES ${saltus_highs_file} ${saltus_casadi_folder}/libz.so.1)
endif()
