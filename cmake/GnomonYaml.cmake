# yaml-cpp with coverage and sanitizers for fuzzing, from the sources that GNOMON_FUZZ_YAML_CPP names. Not ours, so
# without our warnings.
file(GLOB yaml_sources "${GNOMON_FUZZ_YAML_CPP}/src/*.cpp")
if(NOT yaml_sources)
    message(FATAL_ERROR "GNOMON_FUZZ_YAML_CPP: no yaml-cpp sources in '${GNOMON_FUZZ_YAML_CPP}'")
endif()
add_library(yaml-cpp STATIC ${yaml_sources})
target_compile_features(yaml-cpp PUBLIC cxx_std_17)
target_compile_options(yaml-cpp PRIVATE -w)
target_include_directories(yaml-cpp SYSTEM PUBLIC "${GNOMON_FUZZ_YAML_CPP}/include")
