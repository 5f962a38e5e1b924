# SPDX-License-Identifier: Apache-2.0

# dfdyn_embed_assets(OUTPUT name=file ...) writes a source file that defines each `name` of report_assets.hpp as
# the bytes of `file` (relative to the calling folder). The bytes become arrays of characters, not string
# literals, whose length compilers limit. A changed file configures again.
function(dfdyn_embed_assets output)
    set(source "#include \"tools/report/report_assets.hpp\"\n\nnamespace dfdyn::tools::assets {\n")
    foreach(pair IN LISTS ARGN)
        string(REGEX MATCH "^([a-z_]+)=(.+)$" matched "${pair}")
        set(name ${CMAKE_MATCH_1})
        set(file ${CMAKE_CURRENT_SOURCE_DIR}/${CMAKE_MATCH_2})
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
        file(READ ${file} bytes HEX)
        string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
        string(APPEND source "constexpr char ${name}_bytes[] = {${bytes}};\n"
            "constinit const std::string_view ${name}{${name}_bytes, sizeof ${name}_bytes};\n")
    endforeach()
    string(APPEND source "} // namespace dfdyn::tools::assets\n")
    file(CONFIGURE OUTPUT ${output} CONTENT "${source}" @ONLY)
endfunction()
