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

# Applies the shared flags to a target of ours and hides its symbols.
function(gnomon_target name)
    set_target_properties(${name} PROPERTIES
        C_STANDARD 11 C_EXTENSIONS OFF CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
        CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:gnomon_flags>)
endfunction()
