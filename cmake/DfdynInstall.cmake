# SPDX-License-Identifier: Apache-2.0
# The config package: find_package(dfdyn) gives dfdyn::firmware and dfdyn::hal, and dfdyn::eigen where there is Eigen. The program is
# installed where it was built; its library is not: it is no interface.
include(CMakePackageConfigHelpers)

set(dfdyn_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/dfdyn")

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME library)
install(TARGETS dfdyn_firmware EXPORT dfdynFirmwareTargets)
install(EXPORT dfdynFirmwareTargets NAMESPACE dfdyn:: DESTINATION "${dfdyn_package_dir}")
install(TARGETS dfdyn_hal EXPORT dfdynHalTargets)
install(EXPORT dfdynHalTargets NAMESPACE dfdyn:: DESTINATION "${dfdyn_package_dir}")
install(
    DIRECTORY firmware_lib/include/ firmware_lib/eigen/include/ hal/include/
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libdfdyn-dev")
install(DIRECTORY hal/dbc DESTINATION "${CMAKE_INSTALL_DATADIR}/dfdyn")
if(DFDYN_BUILD_TOOLS)
    install(TARGETS dfdyn COMPONENT program)
    # Manual pages and completion come from the help texts: the program prints them, where it can run.
    if(NOT CMAKE_CROSSCOMPILING)
        install(CODE "
            set(root \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
            file(MAKE_DIRECTORY \"\${root}/bash-completion/completions\")
            execute_process(COMMAND \"$<TARGET_FILE:dfdyn>\" man -o \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\"
                COMMAND_ERROR_IS_FATAL ANY)
            execute_process(COMMAND \"$<TARGET_FILE:dfdyn>\" completion bash
                OUTPUT_FILE \"\${root}/bash-completion/completions/dfdyn\" COMMAND_ERROR_IS_FATAL ANY)"
            COMPONENT program)
    endif()
    install(FILES LICENSE CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/dfdyn" COMPONENT program)
endif()

# For other build systems: pkg-config dfdyn (headers), dfdyn-hal (with the backend for Linux). The files can be moved with the prefix.
set(dfdyn_pc_dir "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH dfdyn_prefix_from_pc "/prefix/${dfdyn_pc_dir}" "/prefix")
string(REGEX REPLACE "/$" "" dfdyn_prefix_from_pc "${dfdyn_prefix_from_pc}")
foreach(dfdyn_pc_name IN ITEMS dfdyn dfdyn-hal)
    set(dfdyn_pc_libs "")
    if(dfdyn_pc_name STREQUAL "dfdyn-hal" AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
        set(dfdyn_pc_libs "-L\${libdir} -ldfdyn_hal")
    endif()
    configure_file("${CMAKE_CURRENT_LIST_DIR}/dfdyn.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/${dfdyn_pc_name}.pc" @ONLY)
    install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${dfdyn_pc_name}.pc" DESTINATION "${dfdyn_pc_dir}")
endforeach()

configure_package_config_file(
    "${CMAKE_CURRENT_LIST_DIR}/dfdynConfig.cmake.in" "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfig.cmake"
    INSTALL_DESTINATION "${dfdyn_package_dir}"
    NO_SET_AND_CHECK_MACRO)
# The headers serve any processor.
write_basic_package_version_file(
    "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfigVersion.cmake" COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES
    "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfig.cmake"
    "${CMAKE_CURRENT_BINARY_DIR}/dfdynConfigVersion.cmake"
    DESTINATION "${dfdyn_package_dir}")
