# `make package`: a tarball that can be unpacked anywhere and a Debian package, both of what `cmake --install` gives.
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_PACKAGE_NAME saltus)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The Saltus authors <saltus@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/../package)
set(CPACK_MONOLITHIC_INSTALL ON)
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_DEB_COMPONENT_INSTALL OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# What the tool and the libraries link that the package has not itself; CasADi is in it, for the tool.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libc6 (>= 2.36), libstdc++6 (>= 12), libgcc-s1, zlib1g")
# To write programs: what the headers include. CasADi's headers are in the wheel of PyPI.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "cmake, g++, libfmt-dev, libexpected-dev, libtomlplusplus-dev, zlib1g-dev, gcc")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/package_options.cmake)
include(CPack)
