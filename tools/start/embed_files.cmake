# SPDX-License-Identifier: Apache-2.0

# dfdyn_embed_files(OUTPUT name=place ...) writes a source file that defines embedded_files() of embedded_files.hpp: for each file of a
# folder, or a single file, `name/path` and its bytes. A changed file configures again.
function(dfdyn_embed_files output)
    set(arrays "")
    set(entries "")
    set(number 0)
    foreach(pair IN LISTS ARGN)
        string(REGEX MATCH "^([a-z_]+)=(.+)$" matched "${pair}")
        set(name ${CMAKE_MATCH_1})
        set(place ${CMAKE_MATCH_2})
        if(IS_DIRECTORY "${place}")
            file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE "${place}" "${place}/*")
            list(TRANSFORM files PREPEND "${place}/" OUTPUT_VARIABLE paths)
            list(TRANSFORM files PREPEND "${name}/")
        else()
            set(paths "${place}")
            set(files "${name}")
        endif()
        foreach(path file IN ZIP_LISTS paths files)
            set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${path}")
            file(READ "${path}" bytes HEX)
            string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
            string(APPEND arrays "constexpr char file_${number}[] = {${bytes}};\n")
            string(APPEND entries "    {\"${file}\", {file_${number}, sizeof file_${number}}},\n")
            math(EXPR number "${number} + 1")
        endforeach()
    endforeach()
    file(CONFIGURE OUTPUT ${output} CONTENT "#include \"tools/start/embedded_files.hpp\"

namespace dfdyn::tools {
namespace {
${arrays}constexpr EmbeddedFile files[] = {
${entries}};
} // namespace

std::span<const EmbeddedFile> embedded_files() { return files; }

} // namespace dfdyn::tools
" @ONLY)
endfunction()
