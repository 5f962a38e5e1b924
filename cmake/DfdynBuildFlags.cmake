# SPDX-License-Identifier: Apache-2.0
# Generates the source of dfdyn::tools::build_flags() with the compiler and the flags that dfdyn_tools is built with (without
# warnings, which do not change the result).
set(dfdyn_config_flags "")
foreach(config IN ITEMS Debug Release RelWithDebInfo MinSizeRel)
    string(TOUPPER "${config}" config_upper)
    string(APPEND dfdyn_config_flags "$<$<CONFIG:${config}>:${CMAKE_CXX_FLAGS_${config_upper}}>")
endforeach()
set(dfdyn_target_flags "$<JOIN:$<REMOVE_DUPLICATES:$<FILTER:$<TARGET_PROPERTY:dfdyn_tools,COMPILE_OPTIONS>,EXCLUDE,^(-W|--param)>>, >")

configure_file(build_flags.cpp.in "${CMAKE_CURRENT_BINARY_DIR}/build_flags.cpp.genex" @ONLY)
file(GENERATE
    OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/$<CONFIG>/build_flags.cpp"
    INPUT "${CMAKE_CURRENT_BINARY_DIR}/build_flags.cpp.genex")
target_sources(dfdyn_tools PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/$<CONFIG>/build_flags.cpp")
