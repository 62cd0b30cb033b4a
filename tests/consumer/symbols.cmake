# Run by CTest: the shared library exports the functions that the headers declare, and nothing else.
#   cmake -DHEADERS=... -DLIBRARY=... -DNM=... -P symbols.cmake
file(GLOB headers "${HEADERS}/*.h")
set(declared "")
foreach(header IN LISTS headers)
    file(READ "${header}" text)
    string(REGEX MATCHALL "GN_API [^;#]*GN_CALL[ \n]+gn[A-Za-z]+\\(" functions "${text}")
    foreach(function IN LISTS functions)
        string(REGEX REPLACE ".*[ \n](gn[A-Za-z]+)\\($" "\\1" name "${function}")
        list(APPEND declared "${name}")
    endforeach()
endforeach()
list(SORT declared)
list(LENGTH declared count)
if(count LESS 40)
    message(FATAL_ERROR "only ${count} functions found in the headers: ${declared}")
endif()

execute_process(COMMAND "${NM}" --dynamic --defined-only --format=posix "${LIBRARY}" OUTPUT_VARIABLE text
    COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" lines "${text}")
set(exported "")
foreach(line IN LISTS lines)
    string(REGEX REPLACE "[ @].*" "" name "${line}")
    if(NOT line MATCHES "^GNOMON_0[@ ]") # the version itself
        list(APPEND exported "${name}")
    endif()
endforeach()
list(SORT exported)
if(NOT declared STREQUAL exported)
    message(FATAL_ERROR "declared: ${declared}\nexported: ${exported}")
endif()

message(STATUS "${count} functions")
