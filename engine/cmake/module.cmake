# graspdb_module(NAME SOURCES a.cc … DEPENDS base math … LIBS lib …)
#
# One static library per module, named graspdb::NAME. DEPENDS names modules of
# this project, LIBS third-party targets, which stay PRIVATE. The layers
# themselves are checked by tests/meta/include_layers_test.py against
# engine/LAYERS, since every Debian header is visible to every target.
function(graspdb_module NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LIBS" ${ARGN})
  set(target graspdb_${NAME})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(graspdb::${NAME} ALIAS ${target})
  target_link_libraries(${target} PUBLIC graspdb_options Eigen3::Eigen)
  foreach(module IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC graspdb::${module})
  endforeach()
  target_link_libraries(${target} PRIVATE ${ARG_LIBS})
endfunction()

# graspdb_test(NAME SOURCES a_test.cc … LIBS graspdb::x … LABEL unit)
#
# One GoogleTest program; ctest knows it by NAME and LABEL.
function(graspdb_test NAME)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_executable(${NAME} ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${ARG_LIBS} GTest::gmock
                                        GTest::gtest_main)
  target_compile_definitions(
    ${NAME} PRIVATE GRASPDB_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${NAME} COMMAND ${NAME})
  set_tests_properties(${NAME} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT
                                          ${ARG_TIMEOUT})
endfunction()

# ccache and mold when they are installed; neither is needed.
macro(graspdb_use_fast_tools)
  find_program(GRASPDB_CCACHE ccache)
  if(GRASPDB_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${GRASPDB_CCACHE})
  endif()
  find_program(GRASPDB_MOLD mold)
  if(GRASPDB_MOLD)
    add_link_options(-fuse-ld=mold)
  endif()
endmacro()
