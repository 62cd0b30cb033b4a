# Run by CTest: a run of every method says nothing on stderr, and no driver or loader does because of it.
#   cmake -DPROGRAM=... -P quiet.cmake
execute_process(COMMAND "${PROGRAM}" bench room --size 48x32 --map 128 --repeat 3
    RESULT_VARIABLE code OUTPUT_VARIABLE table ERROR_VARIABLE errors)
if(NOT code EQUAL 0 OR NOT table MATCHES "stencil_volume")
    message(FATAL_ERROR "${code}\n${table}${errors}")
endif()
if(NOT errors STREQUAL "")
    message(FATAL_ERROR "on stderr:\n${errors}")
endif()
