# SPDX-License-Identifier: Apache-2.0
# Finds a package or stops with the name of the Debian package that has it.
macro(dfdyn_require package debian_package)
    find_package(${package} ${ARGN} QUIET)
    if(NOT ${package}_FOUND)
        message(FATAL_ERROR "dfdyn needs ${package}, which was not found. On Debian or Ubuntu: apt-get install ${debian_package}")
    endif()
endmacro()
