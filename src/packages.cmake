# What cpack makes: Debian's packages peel, libpeel0.1 and libpeel-dev, or archives of the same.
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME peel)
set(CPACK_PACKAGE_VENDOR Peel)
set(CPACK_PACKAGE_CONTACT "The authors of Peel <peel@localhost.localdomain>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "reference for order-independent transparency")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program runtime dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
  GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(about "Renders a scene as an OpenGL pipeline does, bit for bit, in that pipeline
itself, and exactly, and says where and why the three differ.")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${about}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME peel)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
# Loaded while it runs, so that no tool finds them; gnuplot draws the plots of reports.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS libosmesa6)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS libegl1)

set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${about}
This is the library: blending, rendering and comparing in memory.")
set(version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libpeel${version})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(control ${PROJECT_BINARY_DIR}/control)
file(WRITE ${control}/triggers "activate-noawait ldconfig\n")
file(WRITE ${control}/shlibs "libpeel ${version} libpeel${version} (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${control}/triggers ${control}/shlibs)

set(CPACK_COMPONENT_DEV_DESCRIPTION "${about}
This is what compiling and linking with the library takes.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpeel-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "${CPACK_DEBIAN_RUNTIME_PACKAGE_NAME} (= ${PROJECT_VERSION}), libgmp-dev")
include(CPack)
