# Run by CTest: builds and runs the samples against the shared library, and compares what they print.
#   cmake -DSOURCE=... -DSCRATCH=... -DINCLUDE=... -DGNOMON=... -DDEVICE=... -DCXX=... [-DCLANG_CXX=...] [-DPYTHON3=...]
#         [-DRUSTC=...] -P bindings.cmake
get_filename_component(gnomon_dir "${GNOMON}" DIRECTORY)
get_filename_component(device_dir "${DEVICE}" DIRECTORY)
set(answers "")

# Adds the line that a sample prints.
macro(answer name)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE errors)
    if(code EQUAL 77)
        message(STATUS "no Vulkan device")
        return()
    endif()
    if(NOT code EQUAL 0 OR NOT text MATCHES "^decision: [a-z_]+, reason [0-9]+\n$")
        message(FATAL_ERROR "${name}: ${code}\n${text}${errors}")
    endif()
    message(STATUS "${name}: ${text}")
    list(APPEND answers "${text}")
endmacro()

foreach(compiler "${CXX}" "${CLANG_CXX}")
    if(compiler)
        execute_process(COMMAND "${compiler}" -std=c++20 -O1 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
                -Wno-missing-field-initializers "-I${INCLUDE}" "-I${SCRATCH}" "${SOURCE}/sample.cpp" "${GNOMON}"
                "${DEVICE}" "-Wl,-rpath,${gnomon_dir}:${device_dir}" -o "${SCRATCH}/sample_cpp"
            COMMAND_ERROR_IS_FATAL ANY)
        answer("${compiler}" "${SCRATCH}/sample_cpp")
    endif()
endforeach()
if(PYTHON3)
    answer(python3 "${PYTHON3}" "${SOURCE}/sample.py" "${GNOMON}" "${DEVICE}")
else()
    message(STATUS "python3: not found, left out")
endif()
if(RUSTC)
    execute_process(COMMAND "${RUSTC}" --edition 2021 -D warnings "${SOURCE}/sample.rs" -o "${SCRATCH}/sample_rs"
            -C "link-args=${GNOMON} ${DEVICE} -Wl,-rpath,${gnomon_dir}:${device_dir}"
        COMMAND_ERROR_IS_FATAL ANY)
    answer(rustc "${SCRATCH}/sample_rs")
else()
    message(STATUS "rustc: not found, left out")
endif()

list(REMOVE_DUPLICATES answers)
list(LENGTH answers different)
if(NOT different EQUAL 1)
    message(FATAL_ERROR "the samples differ: ${answers}")
endif()
