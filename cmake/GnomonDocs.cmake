# The target `docs`: the reference of the public headers, in docs/html of the build folder. Warnings are errors. Without
# doxygen there is no such target.
find_program(DOXYGEN_PROGRAM doxygen)
if(DOXYGEN_PROGRAM)
    configure_file("${PROJECT_SOURCE_DIR}/docs/Doxyfile.in" "${PROJECT_BINARY_DIR}/Doxyfile" @ONLY)
    add_custom_target(docs
        COMMAND "${DOXYGEN_PROGRAM}" "${PROJECT_BINARY_DIR}/Doxyfile"
        COMMENT "Writing the reference of the public headers to docs/html")
endif()
