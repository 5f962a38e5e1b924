# SPDX-License-Identifier: Apache-2.0
# dfdyn_ur5_tables: the examples' headers, and those that are made from a recording when they are built: ur5_samples.hpp and
# ur5_frames.hpp.
find_program(DFDYN_AWK awk REQUIRED)
set(recording "${CMAKE_CURRENT_LIST_DIR}/../../tests/data/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv")
set(table_script "${CMAKE_CURRENT_LIST_DIR}/ur5_tables.awk")
set(table_folder "${CMAKE_CURRENT_BINARY_DIR}/ur5_tables")
file(MAKE_DIRECTORY "${table_folder}")
foreach(table IN ITEMS samples frames)
    add_custom_command(OUTPUT "${table_folder}/ur5_${table}.hpp"
        COMMAND "${DFDYN_AWK}" -v table=${table} -f "${table_script}" "${recording}" > "${table_folder}/ur5_${table}.hpp"
        DEPENDS "${table_script}" "${recording}" VERBATIM)
endforeach()
add_custom_target(dfdyn_make_ur5_tables DEPENDS "${table_folder}/ur5_samples.hpp" "${table_folder}/ur5_frames.hpp")
add_library(dfdyn_ur5_tables INTERFACE)
add_dependencies(dfdyn_ur5_tables dfdyn_make_ur5_tables)
target_include_directories(dfdyn_ur5_tables INTERFACE "${CMAKE_CURRENT_LIST_DIR}" "${table_folder}")
