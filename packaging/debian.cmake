# `cpack -G DEB`: `phatextures`, the program, and `libphatextures-dev`, the core library.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME phatextures)
set(CPACK_PACKAGE_VENDOR "The PHATextures authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Interactive glossy global illumination from a bake")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The PHATextures authors <phatextures@users.noreply.github.com>")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME phatextures)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# libepoxy loads these when the program first draws, GLFW the libraries of X11.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libegl1, libgl1")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libphatextures-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libembree-dev, libtbb-dev, libglm-dev, libnanoflann-dev, libstb-dev, pkg-config | pkgconf")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
"Bakes the indirect light of a glTF scene into a texture that stores one
sample of incident radiance per texel. From these samples glossy surfaces
are drawn with reflections that follow the eye, in a window, in pictures,
and on web pages; roughness, colour and view may change after the bake.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"The algorithms of phatextures as a static library with headers and a CMake
package: charts, path tracing, photons, PHATexels, the bake.")

# Policy asks for a changelog, compressed without a date.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component program development)
    string(TOUPPER ${component} upper)
    set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
    set(changelog ${binary}/debian/${package}/changelog.Debian)
    file(CONFIGURE OUTPUT ${changelog} @ONLY CONTENT
"@package@ (@PROJECT_VERSION@-@CPACK_DEBIAN_PACKAGE_RELEASE@) stable; urgency=medium

  * See CHANGELOG.md of the sources.

 -- @CPACK_DEBIAN_PACKAGE_MAINTAINER@  @date@
")
    execute_process(COMMAND gzip -9nkf ${changelog} COMMAND_ERROR_IS_FATAL ANY)
    # It is no package of Debian's archive, where a first upload closes a bug.
    file(WRITE ${binary}/debian/${package}/overrides "${package}: initial-upload-closes-no-bugs\n")
    install(FILES ${binary}/debian/${package}/overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
        RENAME ${package} COMPONENT ${component})
    install(FILES ${changelog}.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
include(CPack)
