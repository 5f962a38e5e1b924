# SPDX-License-Identifier: Apache-2.0
# The config package: find_package(dfdyn) gives dfdyn::firmware, dfdyn::hal, and dfdyn::tools where it was built.
include(CMakePackageConfigHelpers)

set(dfdyn_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/dfdyn")

install(TARGETS dfdyn_firmware dfdyn_hal EXPORT dfdynFirmwareTargets)
install(DIRECTORY firmware_lib/include/ hal/include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY hal/dbc DESTINATION "${CMAKE_INSTALL_DATADIR}/dfdyn")
install(EXPORT dfdynFirmwareTargets NAMESPACE dfdyn:: DESTINATION "${dfdyn_package_dir}")

if(DFDYN_BUILD_TOOLS)
    install(TARGETS dfdyn_tools dfdyn EXPORT dfdynToolsTargets)
    install(DIRECTORY tools DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/dfdyn" FILES_MATCHING PATTERN "*.hpp")
    install(EXPORT dfdynToolsTargets NAMESPACE dfdyn:: DESTINATION "${dfdyn_package_dir}")
endif()

configure_package_config_file(
    "${CMAKE_CURRENT_LIST_DIR}/dfdynConfig.cmake.in" "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfig.cmake"
    INSTALL_DESTINATION "${dfdyn_package_dir}"
    NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/dfdynConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES
    "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfig.cmake"
    "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfigVersion.cmake"
    DESTINATION "${dfdyn_package_dir}")
