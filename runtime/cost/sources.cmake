# The sources of the cost model, for whoever compiles it: sets GNOMON_COST_SOURCES. The shipped knowledge travels inside
# the library, which reads no file that the host did not name.
foreach(device lavapipe h100)
    set(table "${PROJECT_SOURCE_DIR}/rules/knowledge/${device}.csv")
    file(READ "${table}" shipped_${device})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${table}")
endforeach()
configure_file("${CMAKE_CURRENT_LIST_DIR}/shipped_knowledge.cpp.in" shipped_knowledge.cpp @ONLY)
set(GNOMON_COST_SOURCES "${CMAKE_CURRENT_BINARY_DIR}/shipped_knowledge.cpp")
foreach(source cost_model exponent knowledge_base method_measures teach workload)
    list(APPEND GNOMON_COST_SOURCES "${CMAKE_CURRENT_LIST_DIR}/${source}.cpp")
endforeach()
