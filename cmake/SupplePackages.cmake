# What `cmake --install` puts beside the programs, and the packages for Debian 12 (deploy/build_packages.sh):
#
#   supple-server     the server with its helper, the networks, the web editor and the systemd unit
#   supple            the command line client
#   libsupple-dev     the engine as a library, its headers and examples
#   python3-supple    the Python package
set(share ${CMAKE_INSTALL_DATADIR}/supple)
file(GLOB networks CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/models/*.h5)
install(FILES ${networks} DESTINATION ${share}/models COMPONENT server)
# What GET /v1/families/{family}/atlas answers at once.
install(DIRECTORY models/families/atlas DESTINATION ${share}/models/families COMPONENT server OPTIONAL
  FILES_MATCHING PATTERN "*.json")
# npm builds it; a server without it serves no page at /.
install(DIRECTORY clients/web/dist/ DESTINATION ${share}/web COMPONENT server OPTIONAL)
install(FILES api/openapi.yaml api/errors.yaml DESTINATION ${share}/api COMPONENT server)
install(FILES deploy/supple-server.service DESTINATION lib/systemd/system COMPONENT server)
install(FILES deploy/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/supple-server COMPONENT server)
# Where Debian's Python looks for packages of its own. Elsewhere `pip install clients/python` is the way.
install(DIRECTORY clients/python/supple DESTINATION lib/python3/dist-packages COMPONENT python
  FILES_MATCHING PATTERN "*.py" PATTERN py.typed PATTERN __pycache__ EXCLUDE)

set(CPACK_PACKAGE_VENDOR "The Supple developers")
set(CPACK_PACKAGE_CONTACT "The Supple developers <supple@localhost>")
# A version that is not released sorts before the release (Debian Policy, 5.6.12).
string(REPLACE "-dev" "~dev" CPACK_PACKAGE_VERSION "${SUPPLE_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL server client library python)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME supple-server)
set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME supple)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libsupple-dev)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-supple)
set(CPACK_DEBIAN_SERVER_DESCRIPTION "design service for elastic things
 Answers JSON requests over HTTP for inverse design of tilings, geodesics, elastic networks and Voronoi diagrams on triangle
 meshes, and woven sheets. Contains the neural networks and the web editor.")
set(CPACK_DEBIAN_CLIENT_DESCRIPTION "command line client of supple-server
 Sends meshes, designs and weaves to a supple-server and writes its answers as files and pictures.")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "engine of supple-server as a C++ library
 Static libraries and headers: geodesics, tilings, networks, inverse design, weaves. For find_package(Supple) of CMake.")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Python client of supple-server
 Requests and answers as typed Python objects and numpy arrays.")
set(CPACK_DEBIAN_SERVER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS "supple, python3-supple")
# Plots as PNG are made by librsvg, which the client loads only then.
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS "librsvg2-2, supple-server")
# What find_package(Supple) looks for: for geodesics, Voronoi diagrams and weaves, and for all other components.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libsuitesparse-dev, libtbb-dev")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS
  "libfmt-dev, libgmsh-dev, libhdf5-dev, libpolyclipping-dev, libpugixml-dev, libzip-dev, pkg-config")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.9), python3-numpy, python3-requests")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, supple-server")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA deploy/debian/postinst deploy/debian/prerm deploy/debian/postrm)
list(TRANSFORM CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA PREPEND ${PROJECT_SOURCE_DIR}/)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Debian wants each package to say whose it is.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} name)
  install(FILES deploy/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${name}_PACKAGE_NAME}
    COMPONENT ${component})
endforeach()
include(CPack)
