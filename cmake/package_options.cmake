# Read by CPack for each kind of package: what is unpacked anywhere has no prefix of its own.
if(CPACK_GENERATOR STREQUAL "TGZ")
  set(CPACK_PACKAGING_INSTALL_PREFIX "/")
endif()
