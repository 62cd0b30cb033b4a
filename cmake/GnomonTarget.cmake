# Flags that every gnomon target shares. Decisions must not depend on the compiler (same inputs, same
# decision), hence no contraction of a*b+c and no fast-math anywhere.
add_library(gnomon_flags INTERFACE)
target_compile_features(gnomon_flags INTERFACE cxx_std_20)
target_compile_options(gnomon_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers # Vulkan structs: what is not named is zero
    $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
    -ffp-contract=off
    $<$<BOOL:${GNOMON_WARNINGS_AS_ERRORS}>:-Werror>
    $<$<BOOL:${GNOMON_ASSERTIONS}>:-UNDEBUG>) # after the build type's -DNDEBUG

# Headers that most sources include. Parsing them is a quarter to a half of what a source takes. One form of them for
# libraries, one for programs, whose code is position-independent in another way, and one for tests, which are optimised
# less (gnomon_add_test()) and all include doctest.
set(GNOMON_TEST_OPTIONS $<$<CONFIG:Release>:-O1>) # a quarter off what a test takes to compile
if(GNOMON_PRECOMPILE_HEADERS)
    find_package(glm REQUIRED)
    file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/precompiled.cpp" CONTENT "")
    set(forms library program)
    if(GNOMON_BUILD_TESTS)
        list(APPEND forms test)
    endif()
    foreach(form IN LISTS forms)
        add_library(gnomon_precompiled_${form} OBJECT "${PROJECT_BINARY_DIR}/precompiled.cpp")
        target_link_libraries(gnomon_precompiled_${form} PRIVATE gnomon_flags glm::glm)
        set_target_properties(gnomon_precompiled_${form} PROPERTIES CXX_EXTENSIONS OFF
            CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        target_precompile_headers(gnomon_precompiled_${form} PRIVATE
            <algorithm> <array> <atomic> <bit> <chrono> <cmath> <cstdint> <cstdio> <cstdlib> <cstring> <functional>
            <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <random> <set> <span> <string>
            <string_view> <unordered_map> <utility> <variant> <vector>
            <glm/geometric.hpp> <glm/gtc/quaternion.hpp> <glm/mat3x3.hpp> <glm/mat4x4.hpp> <glm/matrix.hpp>)
    endforeach()
    if(GNOMON_BUILD_TESTS)
        target_precompile_headers(gnomon_precompiled_test PRIVATE
            <condition_variable> <deque> <filesystem> <fstream> <sstream> <thread> <doctest/doctest.h>
            <vulkan/vulkan.h>)
        target_compile_options(gnomon_precompiled_test PRIVATE
            ${CMAKE_CXX_COMPILE_OPTIONS_PIE} ${GNOMON_TEST_OPTIONS})
    endif()
    set_property(TARGET gnomon_precompiled_library PROPERTY POSITION_INDEPENDENT_CODE ON)
    target_compile_options(gnomon_precompiled_program PRIVATE ${CMAKE_CXX_COMPILE_OPTIONS_PIE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU") # which takes precompiled functions of std::string for ours
        target_compile_options(gnomon_flags INTERFACE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
    endif()
endif()

# Applies the shared flags to a target of ours and hides its symbols. A test of gnomon_add_test() says TEST.
function(gnomon_target name)
    set_target_properties(${name} PROPERTIES
        C_STANDARD 11 C_EXTENSIONS OFF CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
        CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:gnomon_flags>)
    get_target_property(sources ${name} SOURCES)
    get_target_property(type ${name} TYPE)
    if(GNOMON_PRECOMPILE_HEADERS AND NOT sources MATCHES "\\.c(;|$)")
        if("TEST" IN_LIST ARGN)
            target_precompile_headers(${name} REUSE_FROM gnomon_precompiled_test)
        elseif(type STREQUAL "EXECUTABLE")
            target_precompile_headers(${name} REUSE_FROM gnomon_precompiled_program)
        else()
            target_precompile_headers(${name} REUSE_FROM gnomon_precompiled_library)
        endif()
    endif()
endfunction()
